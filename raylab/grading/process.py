"""Process: one worker in its jail, seen from outside: bytes in, bytes out, and an end that comes in any case.

Nothing here waits without a deadline, believes a length, or holds more than its share of what the worker prints.
"""

from __future__ import annotations

import contextlib
import json
import os
import selectors
import signal
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from raylab.grading.faults import Cause, Fault, GraderFault
from raylab.grading.jail import MB, Rules
from raylab.grading.output import Output
from raylab.grading.protocol import HEADER, Kind, ProtocolError, unpack_header

TICK = 0.02  # s between two looks at a working process
CHUNK = 1 << 16
ENVIRONMENT = {
    "LANG": "C.UTF-8", "MALLOC_ARENA_MAX": "2", "NUMBA_NUM_THREADS": "1", "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1", "NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING": "1", "NUMBA_SHOW_HELP": "0",
    "RAYLAB_CACHE": "off",
}  # fmt: skip
ENDS = {
    signal.SIGSEGV: "the program crashed (segmentation fault): most often a recursion without an end",
    signal.SIGBUS: "the program crashed (bus error)",
    signal.SIGFPE: "the program crashed (arithmetic error)",
    signal.SIGABRT: "the program ended itself (abort)",
    signal.SIGXCPU: "the program used up its computing time",
    signal.SIGKILL: "the program was killed, by itself or because the machine ran out of memory",
}


@dataclass(frozen=True)
class Budget:
    """What one request may cost: seconds of computing, seconds on the clock, bytes of memory at any time."""

    cpu: float
    wall: float
    memory: int = 450 * MB


class Clock:
    """Seconds in which somebody looked: a machine that sleeps, or stops the grader, costs the student nothing."""

    def __init__(self) -> None:
        self.seen, self.last = 0.0, time.monotonic()

    def tick(self) -> float:
        now = time.monotonic()
        self.seen, self.last = self.seen + min(now - self.last, 1.0), now
        return self.seen


class Process:
    """A worker, from its start to its certain end."""

    def __init__(self, rules: Rules, library: str, folder: str, ladder: str | None = None) -> None:
        self.user, self.output = rules.user, Output()
        theirs_in, self.requests = os.pipe()
        self.replies, theirs_out = os.pipe()
        order = {
            "rules": asdict(rules), "library": library, "ladder": ladder, "requests": theirs_in, "replies": theirs_out,
        }  # fmt: skip
        launch = str(Path(__file__).with_name("launch.py"))
        self.popen = subprocess.Popen(
            [sys.executable, "-I", launch, json.dumps(order)],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, bufsize=0,
            pass_fds=(theirs_in, theirs_out), env=ENVIRONMENT, cwd=folder, start_new_session=True,
        )  # fmt: skip
        os.close(theirs_in)
        os.close(theirs_out)
        assert self.popen.stdout
        self.printed = self.popen.stdout.fileno()
        for end in (self.requests, self.replies, self.printed):
            os.set_blocking(end, False)

    def exchange(self, number: int, request: bytes, expected: int | None, budget: Budget) -> tuple[Kind, bytes]:
        """Send a request, wait for the frame that answers it. After a Fault that killed, only close() is left."""
        if number and self._read(self.replies):
            raise self.fault("protocol", "the program sent a reply before it was asked")
        clock, cpu = Clock(), self.cpu()
        reply = bytearray()
        with selectors.DefaultSelector() as selector:
            selector.register(self.replies, selectors.EVENT_READ)
            selector.register(self.printed, selectors.EVENT_READ)
            if request:
                selector.register(self.requests, selectors.EVENT_WRITE)
            while True:
                for key, _ in selector.select(TICK):
                    if key.fd == self.requests:
                        request = self._send(request)
                        if not request:
                            selector.unregister(self.requests)
                    elif key.fd == self.printed:
                        if not self._drain():
                            selector.unregister(self.printed)
                    elif not self._take(reply):
                        raise self.ended()
                try:
                    done = _whole(reply, number, expected)
                except ProtocolError as error:
                    raise self.fault("protocol", f"the program sent {error}") from None
                if done:
                    self._drain()
                    return done
                self._watch(clock.tick(), self.cpu() - cpu, budget)

    def _send(self, request: bytes) -> bytes:
        try:
            return request[os.write(self.requests, request[:CHUNK]) :]
        except BlockingIOError:
            return request
        except BrokenPipeError:
            return b""  # the end of the replies will say why

    def _read(self, end: int) -> bytes | None:
        """What is there now: b"" at the end, None if nothing is."""
        try:
            return os.read(end, CHUNK)
        except BlockingIOError:
            return None

    def _take(self, reply: bytearray) -> bool:
        came = self._read(self.replies)
        reply += came or b""
        return came != b""

    def _drain(self) -> bool:
        for _ in range(64):  # at most 4 MB before somebody looks at the clock again
            came = self._read(self.printed)
            if not came:
                return came is None
            self.output.add(came)
        return True

    def _watch(self, wall: float, cpu: float, budget: Budget) -> None:
        if wall > budget.wall:
            raise self.fault("time", f"no answer after {budget.wall:g} s; the program was stopped")
        if cpu > budget.cpu:
            sentence = f"no answer after {budget.cpu:g} s of computing; is there a loop that never ends?"
            raise self.fault("time", sentence)
        if self.memory() > budget.memory:
            raise self.fault("memory", f"the program used more than {budget.memory // MB} MB of memory")

    def fault(self, cause: Cause, sentence: str) -> Fault:
        """Kill, and the Fault to raise."""
        self.close()
        return Fault(cause, sentence, str(self.output))

    def ended(self) -> Fault:
        """The replies have ended: the Fault that says how the process did."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.popen.wait(1.0)
        code = self.popen.poll()
        if code is None:
            sentence = "the program closed its connection to the grader"
        elif code < 0:
            sentence = ENDS.get(signal.Signals(-code), f"the program was ended by {signal.Signals(-code).name}")
        else:
            sentence = f"the program ended its process (exit code {code}); a function must return instead"
        return self.fault("crash", sentence)

    def cpu(self) -> float:
        """Seconds of computing so far; 0 where the machine does not say."""
        try:
            fields = Path(f"/proc/{self.popen.pid}/stat").read_text().rpartition(")")[2].split()
        except OSError:
            return 0.0
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def memory(self) -> int:
        """Resident bytes; 0 where the machine does not say."""
        try:
            return int(Path(f"/proc/{self.popen.pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
        except (OSError, IndexError):
            return 0

    def close(self) -> None:
        """Kill the process and all that it may have started, and wait for its end."""
        if self.popen.returncode is not None and self.requests < 0:
            return
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self.popen.pid, signal.SIGKILL)
        self.popen.kill()
        self.popen.wait()
        sweep(self.popen.pid, self.user)
        self._drain()
        assert self.popen.stdout
        self.popen.stdout.close()
        for end in (self.requests, self.replies):
            os.close(end)
        self.requests = self.replies = -1


def _whole(reply: bytearray, number: int, expected: int | None) -> tuple[Kind, bytes] | None:
    """The frame, once all of it is there; it must be all there is."""
    if len(reply) < HEADER.size:
        return None
    kind, length = unpack_header(bytes(reply[: HEADER.size]), number, expected)
    if len(reply) < HEADER.size + length:
        return None
    if len(reply) > HEADER.size + length:
        raise ProtocolError("more than one reply")
    return kind, bytes(reply[HEADER.size :])


def relatives(session: int, user: int | None) -> list[int]:
    """Living processes of a session, or of a student's user."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            state, _, _, group, *_ = (entry / "stat").read_text().rpartition(")")[2].split()
            owners = (entry / "status").read_text().partition("\nUid:")[2].split()[:4]
        except (OSError, ValueError):
            continue
        if state not in "ZX" and (int(group) == session or str(user) in owners):
            found.append(int(entry.name))
    return found


def sweep(session: int, user: int | None) -> None:
    """Kill what is left of a submission, until nothing is; GraderFault if that does not come to an end."""
    for _ in range(100):
        left = relatives(session, user)
        if not left:
            return
        for process in left:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(process, signal.SIGKILL)
        time.sleep(0.01)
    raise GraderFault(f"{len(left)} processes of the submission could not be ended")
