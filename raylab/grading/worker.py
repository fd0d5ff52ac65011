"""Worker: the process in the jail. It gets a submission, compiles it, and answers with numbers.

Whatever happens here is the student's own affair: the grader believes nothing but the length of the numbers.
"""

from __future__ import annotations

import os
import runpy
from collections.abc import Callable
from dataclasses import asdict
from functools import lru_cache
from typing import Any

import numpy as np

from raylab.grading.protocol import Kind, pack, pack_words, receive

Words = dict[str, Any]
Climb = Callable[..., Any]


def serve(requests: int, replies: int, isolation: Words, ladder: str | None = None) -> None:
    """Say how the jail is, then answer requests until they end."""
    worker = Worker(_climb_of(ladder))
    _write(replies, pack_words(0, {"isolation": isolation}))
    with os.fdopen(requests, "rb") as stream:
        while (request := receive(stream)) is not None:
            number, words, blob = request
            try:
                answer = getattr(worker, words["do"])(words, blob)
            except Exception as error:  # of the student's code, or caused by it
                said = {"error": type(error).__name__, "text": str(error)[:4000]}
                _write(replies, pack_words(number, said, Kind.FAULT))
                continue
            if isinstance(answer, np.ndarray):
                _write(replies, pack(number, Kind.NUMBERS, answer.astype("<f8").tobytes()))
            else:
                _write(replies, pack_words(number, answer))


class Worker:
    """A submission and its compiled functions."""

    def __init__(self, climb: Climb) -> None:
        self.climb = climb
        self.functions: dict[str, Any] = {}

    def load(self, words: Words, source: bytes) -> list[Words]:
        """Climb the ladder with some of the tasks."""
        climbed = self.climb(source, words["tasks"])
        self.functions.update(climbed.functions)
        return [finding if isinstance(finding, dict) else asdict(finding) for finding in climbed.findings]

    def samples(self, words: Words, _: bytes) -> np.ndarray:
        """Of a shade() in a trial."""
        return self._probe(words).sample(words["seed"], words["n"], words["first"])

    def rays(self, words: Words, _: bytes) -> np.ndarray:
        """How many of them its first samples trace."""
        return np.array([[self._probe(words).rays(words["seed"], words["n"])]], np.float64)

    def _probe(self, words: Words) -> Any:
        from raylab.probe import Probe

        trial = _trial(words["trial"], words["trial_seed"])
        return Probe(trial.scene, self._function(words["task"]), trial.place, threads=1)

    def map(self, words: Words, blob: bytes) -> np.ndarray:
        """Of a plain function."""
        rows = np.frombuffer(blob, "<f8").reshape(words["shape"])
        values = np.asarray(self._function(words["task"])(rows), np.float64)
        if values.shape != (len(rows), words["columns"]):
            raise TypeError(f"the function returned {values.shape[1:]} numbers, expected {words['columns']}")
        return values

    def _function(self, task: str) -> Any:
        if task not in self.functions:
            raise LookupError(f"{task} could not be compiled")
        return self.functions[task]


@lru_cache(maxsize=8)
def _trial(name: str, seed: int) -> Any:
    from raylab import trials

    return trials.make(name, seed)


def _climb_of(ladder: str | None) -> Climb:
    if ladder:
        return runpy.run_path(ladder)["climb"]
    from raylab.submission.ladder import climb
    from raylab.submission.task import Task

    return lambda source, tasks: climb(source, [Task.from_dict(task) for task in tasks])


def _write(end: int, frame: bytes) -> None:
    rest = memoryview(frame)
    while rest:
        rest = rest[os.write(end, rest) :]
