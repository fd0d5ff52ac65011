"""Seccomp: system calls that student code has no use for fail with EPERM. Standard library only.

A short list of what is refused; a list of what is allowed would break with every new libc or LLVM. No new processes,
no other programs, no sockets, no look into or signal to another process, no memory without a size limit.
"""

from __future__ import annotations

import ctypes
import os

from raylab.grading import kernel

# name: numbers on x86-64 and aarch64; -1: not there
REFUSED = {
    "execve": (59, 221), "execveat": (322, 281), "fork": (57, -1), "vfork": (58, -1),
    "setsid": (112, 157), "setpgid": (109, 154),
    "socket": (41, 198), "socketpair": (53, 199), "connect": (42, 203), "bind": (49, 200),
    "ptrace": (101, 117), "process_vm_readv": (310, 270), "process_vm_writev": (311, 271), "kcmp": (312, 272),
    "tkill": (200, 130), "rt_sigqueueinfo": (129, 138), "rt_tgsigqueueinfo": (297, 240),
    "pidfd_open": (434, 434), "pidfd_getfd": (438, 438), "pidfd_send_signal": (424, 424),
    "setpriority": (141, 140), "ioprio_set": (251, 30), "sched_setscheduler": (144, 119), "sched_setattr": (314, 274),
    "sched_setparam": (142, 118), "process_madvise": (440, 440), "process_mrelease": (448, 448),
    "memfd_create": (319, 279), "memfd_secret": (447, 447), "userfaultfd": (323, 282),
    "shmget": (29, 194), "msgget": (68, 186), "semget": (64, 190), "mq_open": (240, 180),
    "io_uring_setup": (425, 425), "bpf": (321, 280), "perf_event_open": (298, 241),
    "mount": (165, 40), "umount2": (166, 39), "pivot_root": (155, 41), "chroot": (161, 51), "open_tree": (428, 428),
    "move_mount": (429, 429), "fsopen": (430, 430), "mount_setattr": (442, 442), "unshare": (272, 97),
    "setns": (308, 268), "open_by_handle_at": (304, 265), "name_to_handle_at": (303, 264),
    "keyctl": (250, 219), "add_key": (248, 217), "request_key": (249, 218),
    "init_module": (175, 105), "finit_module": (313, 273), "kexec_load": (246, 104), "reboot": (169, 142),
    "personality": (135, 92), "acct": (163, 89), "quotactl": (179, 60), "swapon": (167, 224),
    "inotify_init1": (294, 26), "fanotify_init": (300, 262),
}  # fmt: skip
CLONE, CLONE3 = (56, 220), (435, 435)
KILL, TGKILL, PRCTL, PRLIMIT, AFFINITY = (62, 129), (234, 131), (157, 167), (302, 261), (203, 122)
ARCHITECTURE = (0xC000003E, 0xC00000B7)
X32 = 0x40000000  # numbers of the x32 interface, by which an x86-64 process could go round the list
CLONE_THREAD = 0x10000
EPERM, ENOSYS = 1, 38
# Berkeley packet filter, and what it may answer
LOAD, AND, EQUAL, NOT_BELOW, RETURN = 0x20, 0x54, 0x15, 0x35, 0x06
ALLOW, ERROR, DIE = 0x7FFF0000, 0x00050000, 0x80000000
NUMBER, MACHINE, ARGUMENT = 0, 4, 16  # offsets in struct seccomp_data; the lower half of the first argument


class Instruction(ctypes.Structure):
    _fields_ = [("code", ctypes.c_uint16), ("yes", ctypes.c_uint8), ("no", ctypes.c_uint8), ("k", ctypes.c_uint32)]


class Program(ctypes.Structure):
    _fields_ = [("length", ctypes.c_uint16), ("filter", ctypes.POINTER(Instruction))]


Code = list[tuple[int, int, int, int]]


def program(column: int, own: int) -> Code:
    """The filter: (code, jump if true, jump if false, number), for the process with the id `own`."""
    code: Code = [
        (LOAD, 0, 0, MACHINE), (EQUAL, 1, 0, ARCHITECTURE[column]), (RETURN, 0, 0, DIE),
        (LOAD, 0, 0, NUMBER), (NOT_BELOW, 0, 1, X32), (RETURN, 0, 0, ERROR | EPERM),
    ]  # fmt: skip
    for numbers in REFUSED.values():
        if numbers[column] >= 0:
            code += [(EQUAL, 0, 1, numbers[column]), (RETURN, 0, 0, ERROR | EPERM)]
    code += [(EQUAL, 0, 1, CLONE3[column]), (RETURN, 0, 0, ERROR | ENOSYS)]  # libc then asks clone, which can be read
    code += unless(CLONE[column], [(AND, 0, 0, CLONE_THREAD), (EQUAL, 0, 1, CLONE_THREAD)])
    code += unless(PRCTL[column], [(EQUAL, 1, 0, kernel.PDEATHSIG)])
    for number in (KILL[column], TGKILL[column]):
        code += unless(number, [(EQUAL, 0, 1, own)])
    for number in (PRLIMIT[column], AFFINITY[column]):  # 0: oneself
        code += unless(number, [(EQUAL, 1, 0, 0), (EQUAL, 0, 1, own)])
    return [*code, (RETURN, 0, 0, ALLOW)]


def unless(number: int, test: Code) -> Code:
    """Refuse the call `number` unless its first argument passes the test, which ends with a jump by 1 if it fails."""
    body = [(LOAD, 0, 0, ARGUMENT), *test, (RETURN, 0, 0, ALLOW), (RETURN, 0, 0, ERROR | EPERM)]
    return [(EQUAL, 0, len(body), number), *body]


def install() -> None:
    """Refuse from now on, for good. Asks for no_new_privs before."""
    assert kernel.COLUMN is not None
    code = program(kernel.COLUMN, os.getpid())
    instructions = (Instruction * len(code))(*(Instruction(*line) for line in code))
    filled = Program(len(code), instructions)
    kernel.prctl(kernel.SET_SECCOMP, 2, kernel.address(filled))
