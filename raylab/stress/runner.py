"""Runner: cases, one after the other, in a process that is ended when one takes too long, and replaced when it dies."""

from __future__ import annotations

import multiprocessing
import time
import traceback
from collections.abc import Iterator, Sequence
from multiprocessing.connection import Connection
from typing import Any

from raylab.stress.case import Case, Found, Row, cases

START = 60.0  # s, for a process to begin


def _serve(pipe: Connection) -> None:
    """Measure what is asked for, by id."""
    known = cases()
    pipe.send("ready")
    while (id := pipe.recv()) is not None:
        try:
            pipe.send(known[id].measure())
        except Exception:
            pipe.send(traceback.format_exc())


class Runner:
    """Runs cases: `with Runner() as runner: row = runner.run(case)`."""

    def __init__(self) -> None:
        self._process: Any = None
        self._pipe: Any = None

    def __enter__(self) -> Runner:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._pipe.close()
        self._process = None

    def run(self, case: Case) -> Row:
        """The row of a case."""
        if self._process is None:
            self._start()
        start = time.monotonic()
        self._pipe.send(case.id)
        try:
            if not self._pipe.poll(case.limit):
                self.close()
                return Row(case, case.limit, failed=f"did not end within {case.limit:g} s")
            answer = self._pipe.recv()
        except (EOFError, ConnectionError):
            self._process.join()
            code = self._process.exitcode
            self.close()
            return Row(case, time.monotonic() - start, failed=f"the process ended with code {code}")
        seconds = time.monotonic() - start
        return Row(case, seconds, answer) if isinstance(answer, Found) else Row(case, seconds, failed=str(answer))

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs,), daemon=True)
        self._process.start()
        theirs.close()
        if not self._pipe.poll(START) or self._pipe.recv() != "ready":
            self.close()
            raise RuntimeError(f"no process for the cases within {START:g} s")


def run(chosen: Sequence[Case]) -> Iterator[Row]:
    """The rows of some cases, one by one."""
    with Runner() as runner:
        for one in chosen:
            yield runner.run(one)
