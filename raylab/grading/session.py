"""Session: a submission, asked for numbers. It runs in another process; here come only bytes and float64.

    with Session() as session:
        findings = session.load(source, tasks)
        values = session.samples("a1.diffuse", "polygons", 5, seed=1, first=0, n=1000)  # (1000, 3)

A worker that dies is replaced, and what is asked next is compiled anew. `Fault` is raised for what the submission did,
`GraderFault` for what it cannot help.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab.grading.faults import Fault, GraderFault
from raylab.grading.jail import MB, Rules
from raylab.grading.process import Budget, Process
from raylab.grading.protocol import Kind, ProtocolError, pack, pack_words, unpack_words
from raylab.grading.replies import KEYS, fault_of, findings_of

Array = npt.NDArray[np.float64]
Task = Any  # raylab.submission.task.Task, which is not imported here, or a mapping with its fields
PACKAGE = Path(__file__).resolve().parents[1]
SYSTEM = ("/lib", "/lib64", "/usr/lib", "/usr/lib64", "/etc/ld.so.cache", "/sys/devices/system/cpu")
WIDTH = {"number": 1, "pair": 2, "vector": 3}  # of what a plain function takes and gives


@dataclass(frozen=True)
class Limits:
    """What a submission may cost: seconds of computing and on the clock, for each request and in all; bytes."""

    cpu: float = 60.0
    wall: float = 180.0
    total: float = 480.0
    memory: int = 450 * MB
    patience: int = 2  # deaths of the worker in one task, then it is not asked again
    must_be_shut: bool = False  # refuse to run where the machine cannot shut the jail


class Session:
    """One submission and its worker."""

    def __init__(
        self, limits: Limits | None = None, library: Path | None = None, read: Sequence[Path] = (),
        ladder: Path | None = None,
    ) -> None:  # fmt: skip
        """`library`: the folder in which the worker finds its raylab, such as a course wheel without the solutions;
        `read`: what else it may read; `ladder`: a file with another climb(), for tests of the jail."""
        self.limits = limits or Limits()
        self.library = (library or PACKAGE.parent).resolve()
        self.ladder = str(ladder.resolve()) if ladder else None
        self.user = a_user() if os.geteuid() == 0 else None
        more = [str(path.resolve()) for path in read] + ([self.ladder] if self.ladder else [])
        self.rules = Rules(
            (*interpreter(), str(self.library / "raylab"), *more), int(self.limits.total), user=self.user
        )
        self.isolation: dict[str, Any] = {}
        self.source, self.tasks = b"", dict[str, Any]()
        self.deaths: dict[str, int] = {}
        self.printed: list[str] = []  # by workers that have ended
        self.workers = 0
        self._loaded: set[str] = set()
        self._number = 0
        self._process: Process | None = None
        self._end = time.monotonic() + self.limits.total
        self._folder = tempfile.TemporaryDirectory(prefix="raylab-")
        os.chmod(self._folder.name, 0o755)  # empty: the worker's current folder, out of which numba reads its settings

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the worker and all that belongs to it."""
        self._bury()
        self._folder.cleanup()

    @property
    def output(self) -> str:
        """What the submission has printed."""
        return "".join([*self.printed, str(self._process.output) if self._process else ""])

    def load(self, source: bytes, tasks: Sequence[Task]) -> list[dict[str, Any]]:
        """Compile the submission; what there is to say about it, as the findings of `raylab.submission`.

        If the worker dies of it, the tasks are tried one by one; a Fault is raised if all of them kill it.
        """
        self.source, self.tasks = source, {task["id"]: task for task in map(_plain, tasks)}
        self.deaths = {}
        self._bury()
        try:
            return self._climb(list(self.tasks))
        except Fault as fault:
            if len(self.tasks) < 2 or not fault.killed:
                raise
        found, faults = [], []
        for task in self.tasks:
            try:
                found += self._climb([task])
            except Fault as fault:
                faults.append(fault)
                told = {"stage": "run", "task": task, "kind": "error", "sentence": str(fault), "detail": fault.detail}
                found.append(dict.fromkeys(KEYS) | told)
        if len(faults) == len(self.tasks):
            raise faults[0]
        return found

    def samples(self, task: str, trial: str, trial_seed: int, seed: int, first: int, n: int) -> Array:
        """Samples first .. first + n - 1 of a shade() in a trial of `raylab.trials`, (n, 3)."""
        words = {"trial": trial, "trial_seed": trial_seed, "seed": seed, "first": first, "n": n}
        return self._numbers("samples", task, words, b"", (n, 3))

    def rays(self, task: str, trial: str, trial_seed: int, seed: int, n: int) -> float:
        """How many rays the first n samples trace, as the worker says; nobody can check it."""
        words = {"trial": trial, "trial_seed": trial_seed, "seed": seed, "n": n}
        return float(self._numbers("rays", task, words, b"", (1, 1))[0, 0])

    def map(self, task: str, rows: npt.ArrayLike, columns: int | None = None) -> Array:
        """A plain function, called with each row of (n, k) numbers: (n, m) numbers."""
        given = np.ascontiguousarray(rows, np.float64)
        columns = columns or sum(WIDTH[name] for name in self.tasks[task].get("gives", ("number",)))
        words = {"shape": given.shape, "columns": columns}
        return self._numbers("map", task, words, given.tobytes(), (len(given), columns))

    def _numbers(self, what: str, task: str, words: dict[str, Any], blob: bytes, shape: tuple[int, int]) -> Array:
        self._spend(task)
        if task not in self._loaded:
            self._climb([task])
        reply = self._ask({"do": what, "task": task, **words}, blob, 8 * shape[0] * shape[1], task)
        return np.frombuffer(reply, "<f8").astype(np.float64).reshape(shape)

    def _climb(self, tasks: list[str]) -> list[dict[str, Any]]:
        words = {"do": "load", "tasks": [self.tasks[task] for task in tasks]}
        try:
            found = findings_of(self._ask(words, self.source, None, *tasks))
        except ProtocolError as error:
            raise self._died(Fault("protocol", f"the program sent {error}", self.output), *tasks) from None
        self._loaded.update(tasks)
        return found

    def _spend(self, task: str) -> None:
        if self.deaths.get(task, 0) >= self.limits.patience:
            raise Fault("given up", "not asked again: an earlier test ended the program", task=task)

    def _ask(self, words: dict[str, Any], blob: bytes, expected: int | None, *tasks: str) -> bytes:
        """One request and its answer, by a worker that is started if there is none."""
        process = self._process or self._start()
        left = self._end - time.monotonic()
        if left <= 0.0:
            raise Fault("time", f"the {self.limits.total:g} s for a submission are used up", task=tasks[0])
        self._number += 1
        request = pack_words(self._number, words) + pack(self._number, Kind.NUMBERS, blob)
        budget = Budget(self.limits.cpu, min(self.limits.wall, left), self.limits.memory)
        try:
            kind, reply = process.exchange(self._number, request, expected, budget)
            if kind == Kind.FAULT:
                raise fault_of(unpack_words(reply), str(process.output))
        except ProtocolError as error:
            raise self._died(Fault("protocol", f"the program sent {error}", self.output), *tasks) from None
        except Fault as fault:
            raise self._died(fault, *tasks) from None
        return reply

    def _died(self, fault: Fault, *tasks: str) -> Fault:
        """A fault in a request about some tasks, entered in the books if it was deadly."""
        if fault.killed:
            self._bury()
            for task in tasks:
                self.deaths[task] = self.deaths.get(task, 0) + 1
        fault.task = tasks[0] if len(tasks) == 1 else ""
        return fault

    def _start(self) -> Process:
        """A new worker; its first words, before it has seen anything of the student's, are about its jail."""
        started = Process(self.rules, str(self.library), self._folder.name, self.ladder)
        self._process, self._loaded = started, set()
        self.workers += 1
        try:
            words = unpack_words(started.exchange(0, b"", None, Budget(120.0, 240.0, 4 * self.limits.memory))[1])
            self.isolation = words["isolation"]
        except (Fault, ProtocolError, KeyError, TypeError) as error:
            started.close()
            self._process = None
            raise GraderFault(f"no worker could be started: {error}\n{started.output}") from None
        if self.limits.must_be_shut and not self.isolation["shut"]:
            self._bury()
            raise GraderFault(f"this machine cannot shut the jail: {self.isolation}")
        return started

    def _bury(self) -> None:
        if self._process:
            self._process.close()
            self.printed.append(str(self._process.output))
        self._process, self._loaded = None, set()


def probe() -> dict[str, Any]:
    """What this machine allows: the record of a jail that was closed and tried, see `raylab.grading.jail.Record`."""
    with Session() as session:
        session._start()
        return session.isolation


def a_user() -> int:
    """A user id that nobody has: high, since the limit on processes counts each id on the whole machine."""
    with contextlib.suppress(OSError, ValueError, IndexError):
        start, _, count = map(int, Path("/proc/self/uid_map").read_text().split("\n")[0].split())
        if start + count < 1 << 21:
            return 20000 + secrets.randbelow(40000)
    return 200000 + secrets.randbelow(1 << 20)


def interpreter() -> tuple[str, ...]:
    """What Python and the libraries of this environment must read to run."""
    own = (f"{sys.base_prefix}/lib", f"{sys.prefix}/lib", f"{sys.prefix}/pyvenv.cfg")
    return (*own, *(path for path in SYSTEM if os.path.exists(path)))


def _plain(task: Task) -> Mapping[str, Any]:
    return asdict(task) if is_dataclass(task) and not isinstance(task, type) else dict(task)
