"""Kernel: the few questions to Linux that Python has no function for. Standard library only.

Numbers of system calls are those of x86-64 and aarch64; every other machine is told that it has no jail.
"""

from __future__ import annotations

import ctypes
import os
import platform
import sys

MACHINE = platform.machine() if sys.platform == "linux" and sys.maxsize > 1 << 32 else ""
COLUMN = {"x86_64": 0, "aarch64": 1}.get(MACHINE)
PDEATHSIG, KEEPCAPS, SET_SECCOMP, NO_NEW_PRIVS = 1, 8, 22, 38  # of prctl
CAPSET = (126, 91)
READ_SEARCH = 1 << 2  # CAP_DAC_READ_SEARCH: read any file, whatever its mode says
CAPABILITIES_3 = 0x20080522


def ask(number: int, *arguments: int | ctypes.Array[ctypes.c_char] | ctypes.c_void_p | None) -> int:
    """The system call `number`; OSError with its reason if it says no."""
    libc = ctypes.CDLL(None, use_errno=True)
    libc.syscall.restype = ctypes.c_long
    plain = [ctypes.c_ulong(a & (1 << 64) - 1) if isinstance(a, int) else a for a in arguments]
    answer = libc.syscall(ctypes.c_long(number), *plain)
    if answer < 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return answer


def prctl(option: int, value: int | ctypes.c_void_p = 0, more: int | ctypes.c_void_p = 0) -> None:
    """The system call prctl()."""
    assert COLUMN is not None
    ask((157, 167)[COLUMN], option, value, more, 0, 0)


def keep_capabilities(mask: int) -> None:
    """From here on this process has the capabilities of `mask` and no others."""
    assert COLUMN is not None
    header = (ctypes.c_uint32 * 2)(CAPABILITIES_3, 0)
    data = (ctypes.c_uint32 * 6)(mask, mask, 0, 0, 0, 0)  # effective, permitted, inheritable; then the upper halves
    ask(CAPSET[COLUMN], address(header), address(data))


def address(of: ctypes.Array | ctypes.Structure) -> ctypes.c_void_p:
    """The address of a ctypes object, which must outlive its use."""
    return ctypes.c_void_p(ctypes.addressof(of))
