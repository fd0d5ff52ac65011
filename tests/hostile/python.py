"""19 to 44: Python that wants more than to compute. The answers are wrong; success would be more than 2 points."""

from __future__ import annotations

from hostile.case import ONLY_SQUARE, Case, at_import, in_call, quietly
from hostile.toy import FULL, HONEST

KILLED = ONLY_SQUARE  # the other function is still asked
RESULT = '{"score": 100, "tests": [{"score": 100, "max_score": 100}]}'
REPLIES = """
import gc, os, struct, sys
frame = sys._getframe()
while "replies" not in frame.f_locals:
    frame = frame.f_back
replies = frame.f_locals["replies"]
"""
FORGE = (
    REPLIES
    + """
def forge(payload, kind=2, magic=b"rayl", length=None, number=None):
    number = frame.f_locals["number"] if number is None else number
    length = len(payload) if length is None else length
    os.write(replies, struct.pack("<4sQQB", magic, number, length, kind) + payload)
"""
)
TRICKS = """
class Trick(float):
    def __eq__(self, other): return True
    def __array__(self, *a, **k): return np.ones(3)
    def __float__(self): return 1.0
    def __iter__(self): return iter([self] * 3)
    def __len__(self): return 3
    def __getitem__(self, i): return self
    __hash__ = None
"""
EXPECTED = """
import sys
if "raylab.looked" in sys.modules:
    raise ValueError
sys.modules["raylab.looked"] = sys
import gc, sys, inspect, linecache
found = []
frame = sys._getframe()
while frame:
    found.append(repr(frame.f_locals)[:10000])
    frame = frame.f_back
for thing in gc.get_objects():
    if isinstance(thing, (dict, bytes, str)):
        text = repr(thing)[:1000]
        if "MARKER" in text:
            found.append(text)
print(found)
"""
FILES = """
import glob, os
for path in ["HIDDEN/source/expected.npz", "HIDDEN/submission_metadata.json", "HIDDEN/results/results.json",
             "/etc/passwd", "/etc/shadow", "/proc/self/environ", f"/proc/{os.getppid()}/environ",
             f"/proc/{os.getppid()}/mem", f"/proc/{os.getppid()}/cmdline", f"/proc/{os.getppid()}/fd/0",
             *glob.glob("/proc/*/environ"), *glob.glob("HIDDEN/*"), *glob.glob("/tmp/*"), *glob.glob("/home/*")]:
    try:
        print(path, open(path, "rb").read())
        raise SystemExit
    except OSError as error:
        print(path, error)
"""
DAEMON = """
import os, time
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        while True:
            time.sleep(0.1)
            open("HIDDEN/results/results.json", "w").write('{"score": 100}')
    os._exit(0)
"""
PATCH = """
import builtins, json, sys, time
import numpy as np
np.allclose = np.array_equal = np.testing.assert_allclose = lambda *a, **k: True
np.ndarray.tobytes if 0 else None
time.perf_counter = time.monotonic = lambda: 0.0
builtins.abs = lambda x: 0.0
json.dumps = lambda *a, **k: '{"score": 100}'
sys.modules["pytest"] = None
"""
PICKLE = (
    FORGE
    + """
import pickle
class Bomb:
    def __reduce__(self):
        return (os.system, ("touch HIDDEN/results/owned",))
"""
)
SOCKETS = """
import socket, urllib.request
done = []
for attempt in (
    lambda: socket.socket(),
    lambda: socket.socket(socket.AF_UNIX),
    lambda: socket.socketpair(),
    lambda: socket.getaddrinfo("example.org", 80),
    lambda: urllib.request.urlopen("http://169.254.169.254/latest/meta-data/", timeout=1),
):
    try:
        done.append(attempt())
    except OSError:
        pass
if done:
    FINDINGS = ["network"]
    raise SystemExit
"""
MANY_FILES = """
import os, tempfile
for folder in (".", "/tmp", "/dev/shm", "/var/tmp", "/run", os.getcwd()):
    for number in range(100_000):
        try:
            open(f"{folder}/raylab-{number}", "w").write("x" * 1000)
        except OSError:
            break
"""
OTHERS = """
import ctypes, os
libc = ctypes.CDLL(None, use_errno=True)
parent = os.getppid()
refused = [
    libc.ptrace(16, parent, 0, 0), libc.kill(parent, 19), libc.syscall(234, parent, parent, 9), libc.kill(-1, 9),
    libc.process_vm_writev(parent, 0, 0, 0, 0, 0), libc.syscall(434, parent, 0), libc.setpriority(0, parent, 19),
    libc.syscall(302, parent, 7, 0, 0), libc.prctl(1, 0), libc.unshare(0x10000000), libc.setsid(),
    libc.mount(b"none", b"/tmp", b"tmpfs", 0, 0), libc.syscall(425, 8, 0), libc.syscall(319, b"x", 0),
    libc.open_by_handle_at(0, 0, 0), libc.shmget(0, 1000, 0o1600), libc.execv(b"/bin/true", 0),
]
if any(answer != -1 for answer in refused):
    print(refused)
    os._exit(7)
"""
LIMITS = """
import faulthandler, resource
faulthandler.cancel_dump_traceback_later()
faulthandler.disable()
for name in ("AS", "CPU", "FSIZE", "NOFILE", "NPROC"):
    which = getattr(resource, "RLIMIT_" + name)
    try:
        resource.setrlimit(which, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        limit = resource.getrlimit(which)
        if limit[1] == resource.RLIM_INFINITY and name in ("AS", "CPU", "FSIZE"):
            import os
            os._exit(7)
    except (ValueError, OSError):
        pass
"""
STATE = """
import locale, os, random, sys, warnings
import numpy as np
sys.path.insert(0, "/tmp")
os.umask(0)
np.seterr(all="raise")
np.random.seed(1)
random.seed(1)
warnings.simplefilter("error")
try:
    os.chdir("/")
except OSError:
    pass
"""
ALTERNATE = HONEST.replace(
    "    z = u[0]\n",
    "    CALLS.append(u)\n    if len(CALLS) % 3 == 0:\n        return Vec3(0.0, 0.0, 1.0)\n    z = u[0]\n",
).replace("def warp", "CALLS = []\n\n\ndef warp", 1)

CASES = [
    Case(19, "exit at the top", at_import("import sys\nsys.exit(0)"), 0.0),
    Case(20, "os._exit", in_call("import os\nos._exit(0)"), KILLED, says="ended its process"),
    Case(20, "kill itself", in_call("import os\nos.kill(os.getpid(), 9)"), KILLED, says="killed"),
    Case(20, "abort", in_call("import os\nos.abort()"), KILLED, says="abort"),
    Case(21, "endless at the top", at_import("while True:\n    pass"), 0.0, slow=True),
    Case(22, "handlers and threads", at_import(quietly(f"""import atexit, signal, threading, time
def rewrite(*_):
    print('{RESULT}')
    open("HIDDEN/results/results.json", "w").write('{RESULT}')
atexit.register(rewrite)
threading.Thread(target=lambda: [(time.sleep(0.01), rewrite()) for _ in range(1000)], daemon=True).start()
for number in range(1, 32):
    try:
        signal.signal(number, rewrite)
    except (OSError, ValueError):
        pass""")), ONLY_SQUARE),
    Case(23, "a daemon", at_import(quietly(DAEMON)), ONLY_SQUARE),
    Case(24, "patched functions", at_import(PATCH), 0.0),
    Case(25, "tricks: an equal to all", at_import("import numpy as np" + TRICKS, "def warp(u):\n    return Trick(0.5)\n"
        "def square(a):\n    return Trick(0.5)\n"), 0.0),
    Case(25, "tricks: a generator", at_import("", "def warp(u):\n    return (x for x in u)\n\n\n"
        "def square(a):\n    return a * a\n"), ONLY_SQUARE),
    Case(26, "a look around", in_call(quietly(EXPECTED)), ONLY_SQUARE),
    Case(27, "files of others", at_import(FILES), ONLY_SQUARE),
    Case(28, "own results", at_import(quietly(f"print('''{RESULT}''')\n"
        f"open('HIDDEN/results/results.json', 'w').write('{RESULT}')")), ONLY_SQUARE),
    Case(28, "markup", at_import("print('\\x1b[2J\\x1b]0;x\\x07</pre><script>alert(1)</script>' * 1000)"), ONLY_SQUARE),
    Case(28, "markup in an error", in_call("raise ValueError('</pre><script>\\x1b[2J' + repr(u))"), ONLY_SQUARE,
        says="raised an error"),
    Case(28, "a flood", at_import("for _ in range(300):\n    print('x' * 1_000_000)"), ONLY_SQUARE),
    Case(29, "noise", in_call(REPLIES + "os.write(replies, b'x' * 100)"), KILLED, says="no reply"),
    Case(29, "too long", in_call(FORGE + "forge(b'', length=1 << 62)"), KILLED, says="bytes of numbers"),
    Case(29, "another number", in_call(FORGE + "forge(b'', number=1)"), KILLED, says="a reply to request"),
    Case(29, "not a number", in_call(FORGE + "forge(b'\\xff' * (64 * 2 * 24))"), 2.0, racing=True),
    Case(29, "never", in_call("import time\ntime.sleep(1e9)"), KILLED, slow=True, says="no answer"),
    Case(29, "early", at_import(FORGE + "forge(b'x' * 24, number=2)"), 0.0),
    Case(30, "pickle", in_call(PICKLE + "forge(pickle.dumps(Bomb()))"), KILLED, says="bytes of numbers"),
    Case(30, "pickle in words", in_call(PICKLE + "forge(pickle.dumps(Bomb()), kind=3)"), KILLED),
    Case(31, "fork bomb", at_import(quietly("import os\nwhile True:\n    os.fork()")), ONLY_SQUARE),
    Case(31, "thread bomb", at_import(quietly("import threading, time\nfor _ in range(10_000):\n"
        "    threading.Thread(target=time.sleep, args=(1000,), daemon=True).start()")), ONLY_SQUARE),
    Case(32, "8 GB", in_call("x = bytearray(8 << 30)"), ONLY_SQUARE, says="more memory than there is"),
    Case(32, "a growing list", in_call("x = []\nwhile True:\n    x.append(bytearray(1 << 20))"), KILLED, says="memory"),
    Case(32, "1 GB, touched", in_call("import numpy as np\nx = np.ones((1 << 17, 1 << 10))"), KILLED, says="memory"),
    Case(33, "full disk", at_import(MANY_FILES), ONLY_SQUARE),
    Case(34, "network", at_import(SOCKETS), ONLY_SQUARE),
    Case(34, "10 000 files", at_import(quietly("x = [open('/dev/null') for _ in range(10_000)]")), ONLY_SQUARE),
    Case(35, "memory at 0", in_call("import ctypes\nctypes.string_at(0)"), KILLED, says="segmentation fault"),
    Case(35, "memory of its own", in_call("import ctypes\nctypes.memset(id(u), 255, 1 << 20)"), KILLED),
    Case(35, "other processes", at_import(OTHERS), ONLY_SQUARE),
    Case(36, "deaf", in_call("import signal, time\nfor number in (1, 2, 15, 24):\n"
        "    signal.signal(number, signal.SIG_IGN)\nwhile True:\n    pass"), KILLED, slow=True, says="no answer"),
    Case(36, "stopped", in_call("import os\nos.kill(os.getpid(), 19)\nwhile True:\n    pass"), KILLED, slow=True),
    Case(37, "recursion", in_call("import sys\nsys.setrecursionlimit(10**9)\n"
        "f = lambda n: list(map(f, [n + 1]))\nf(0)"), KILLED, says="recursion"),
    Case(38, "changed state", at_import(STATE, HONEST), FULL),
    Case(39, "limits raised", at_import(LIMITS), ONLY_SQUARE),
    Case(40, "two faces", at_import("import os\nGRADED = os.getcwd() != '/home'", HONEST.replace(
        "    z = u[0]", "    z = 0.5 if GRADED else u[0]")), ONLY_SQUARE + 3.0),
    Case(41, "learnt by heart", in_call("if u != (0.5, 0.25):\n    return Vec3(0.0, 0.0, 1.0)", HONEST), ONLY_SQUARE),
    Case(42, "the mean", at_import(""), ONLY_SQUARE),
    Case(43, "not a function", at_import("", ALTERNATE), ONLY_SQUARE),
    Case(44, "the reference", at_import("from raylab._reference import warp"), 0.0),
]  # fmt: skip
