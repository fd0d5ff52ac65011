"""Jail: what a process gives up before it meets a student's code. Standard library only.

In this order: limits of time and memory, the user, new privileges, all files but the interpreter's and raylab's,
system calls that nobody needs. What the machine does not have is left out and said so in the record of the
isolation; `Record.shut` tells whether what is closed is enough to run hostile code. Nothing can be written anywhere.
"""

from __future__ import annotations

import contextlib
import os
import resource
import socket
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from raylab.grading import kernel, landlock, seccomp

MB = 1 << 20
TASKS = 64  # threads and processes of a student who has a user id of his own


@dataclass(frozen=True)
class Rules:
    """What is left: folders and files to read, seconds of CPU in all, bytes of address space, a user id (or None)."""

    read: tuple[str, ...]
    cpu: int = 600
    space: int = 2048 * MB
    user: int | None = None


@dataclass
class Record:
    """What was achieved: of each wall, how strong; and what could still be done although it should not."""

    system: str = field(default_factory=lambda: f"{sys.platform} {os.uname().release} {os.uname().machine}")
    limits: bool = False
    user: str = "same"  # or "own"; "own, may read" if the interpreter stands in a folder that only we can read
    no_new_privileges: bool = False
    landlock: int = 0  # version of the interface
    seccomp: bool = False
    open: list[str] = field(default_factory=list)

    @property
    def shut(self) -> bool:
        """Is this enough for hostile code?"""
        return self.limits and self.seccomp and (self.landlock > 0 or self.user == "own") and not self.open

    def as_json(self) -> dict[str, Any]:
        return asdict(self) | {"shut": self.shut}


def close(rules: Rules) -> Record:
    """Shut the door of this process, which must still have one thread, and try its handle."""
    record = Record()
    limit(rules)
    record.limits = True
    if kernel.COLUMN is not None:
        with contextlib.suppress(OSError):
            Path("/proc/self/oom_score_adj").write_text("1000")
        record.user = change_user(rules)
        kernel.prctl(kernel.PDEATHSIG, 9)  # the kernel ends this process if the grader ends
        kernel.prctl(kernel.NO_NEW_PRIVS, 1)
        record.no_new_privileges = True
        record.landlock = landlock.version()
        if record.landlock:
            landlock.restrict(path for path in rules.read if os.path.exists(path))
        record.seccomp = has_seccomp()
        if record.seccomp:
            seccomp.install()
    record.open = try_handles(record)
    return record


def limit(rules: Rules) -> None:
    """Hard limits; `space` is no promise on macOS."""
    limits = {"CPU": rules.cpu, "AS": rules.space, "FSIZE": 0, "NOFILE": 64, "CORE": 0, "MEMLOCK": 0, "MSGQUEUE": 0}
    if rules.user is not None:
        limits["NPROC"] = TASKS
    for name, most in limits.items():
        which = getattr(resource, f"RLIMIT_{name}", None)
        if which is not None:
            hard = resource.getrlimit(which)[1]
            most = most if hard == resource.RLIM_INFINITY else min(most, hard)
            with contextlib.suppress(ValueError, OSError):
                resource.setrlimit(which, (most, most))


def change_user(rules: Rules) -> str:
    """Become the student's user, and lose every capability.

    One may be kept: reading files whatever their mode says, if the interpreter is below a folder that is closed to
    others (such as /root), and only where Landlock says what may be read.
    """
    keep = 0 if all(map(readable, rules.read)) or not landlock.version() else kernel.READ_SEARCH
    if rules.user is None:
        with contextlib.suppress(OSError):  # an ordinary user has none
            kernel.keep_capabilities(keep)
        return "same"
    kernel.prctl(kernel.KEEPCAPS, 1)
    try:
        os.setgroups([])
        os.setresgid(rules.user, rules.user, rules.user)
        os.setresuid(rules.user, rules.user, rules.user)
    except OSError:  # a container may have taken this right from root
        kernel.keep_capabilities(keep)
        return "same"
    kernel.keep_capabilities(keep)
    return "own, may read" if keep else "own"


def readable(path: str) -> bool:
    """May every user read this path, and get to it?"""
    if not os.path.exists(path):
        return True
    ways = [*Path(path).absolute().parents, *Path(path).resolve().parents]
    return bool(os.stat(path).st_mode & 0o004) and all(way.stat().st_mode & 0o001 for way in ways)


def has_seccomp() -> bool:
    """Filters can be told from no filters by asking for one without an address: EFAULT or EINVAL."""
    try:
        kernel.prctl(kernel.SET_SECCOMP, 2, 0)
    except OSError as error:
        return error.errno == 14
    return False


def try_handles(record: Record) -> list[str]:
    """What should be refused and is not, although the walls that are there should refuse it."""
    found = []
    if record.landlock:
        for path, flags in (("/etc/passwd", os.O_RDONLY), ("/tmp/raylab-handle", os.O_CREAT | os.O_WRONLY)):
            with contextlib.suppress(OSError):
                os.close(os.open(path, flags, 0o600))
                found.append(f"opening {path}")
    if record.seccomp:
        with contextlib.suppress(OSError):
            socket.socket().close()
            found.append("sockets")
        with contextlib.suppress(OSError):
            if os.fork() == 0:
                os._exit(0)
            os.wait()
            found.append("processes")
    if record.user != "same":
        with contextlib.suppress(OSError):
            os.setuid(0)
            found.append("root")
    return found
