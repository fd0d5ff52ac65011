"""Raised: what a compiled function raises, with the line, which compiled code does not know.

The first sample that raises is found by halving, and called again in plain Python with the same random numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab.grading.source import Array, InProcess, plain_of
from raylab.jit import interpreted
from raylab.probe import SEEDS
from raylab.submission.finding import Finding, Problem
from raylab.submission.interpret import run, unpack
from raylab.submission.shape import ENTRY, check_shape
from raylab.submission.source import Source, read
from raylab.submission.task import Task


class Raised(Exception):  # noqa: N818 (it is the student's, not ours)
    """What is known of it; `token` is for `raylab replay`."""

    def __init__(self, finding: Finding, trial: str = "", numbers: tuple[int, ...] = ()) -> None:
        super().__init__(finding.sentence)
        self.finding, self.trial, self.numbers = finding, trial, numbers


class Watched(InProcess):
    """Functions of a submission in this process; what they raise becomes Raised."""

    def __init__(self, functions: Mapping[str, Any], source: bytes, tasks: Sequence[Task]) -> None:
        super().__init__(functions)
        self.source, self.tasks = source, {task.id: task for task in tasks}

    def samples(self, task: str, trial: str, trial_seed: int, seed: int, first: int, n: int) -> Array:
        ask = super().samples
        try:
            return ask(task, trial, trial_seed, seed, first, n)
        except Exception as error:
            number = first_that_raises(lambda low, high: ask(task, trial, trial_seed, seed, low, high - low), first, n)
            plain, own = plain_of(self.trial(trial, trial_seed), seed & SEEDS), self.tasks[task]
            finding = self._again(own, error, number, lambda function: plain.call(function, number))
            raise Raised(finding, trial, (number, trial_seed, seed & SEEDS)) from None

    def map(self, task: str, rows: npt.ArrayLike) -> Array:
        ask, given = super().map, np.asarray(rows, np.float64)
        try:
            return ask(task, given)
        except Exception as error:
            number = first_that_raises(lambda low, high: ask(task, given[low:high]), 0, len(given))
            own = self.tasks[task]
            arguments = tuple(unpack(own.takes, given[number]))
            raise Raised(self._again(own, error, number, lambda function: function(*arguments))) from None

    def _again(self, task: Task, error: Exception, number: int, call: Callable[[Any], Any]) -> Finding:
        """What plain Python says of the same sample."""
        source = read(self.source)
        function = source.namespace(check_shape(source, task)[0])[ENTRY]
        try:
            with interpreted():
                run(source, task, lambda: call(function))
        except Problem as problem:
            return _finding(task, problem, source)
        said = (
            f"Compiled, `{task.function}` raises {type(error).__name__}: {error}, in sample {number}; in plain Python "
            "the same sample runs, so the line is not known."
        )
        advice = "Usually an index past the end, or an integer that overflows: begin with floats (0.0)."
        return _finding(task, Problem(said, advice), source)


def first_that_raises(ask: Callable[[int, int], Any], first: int, n: int) -> int:
    """The first number of first .. first + n - 1 with which ask(low, high) raises; one of them does."""
    low, high = first, first + n
    while high - low > 1:
        middle = (low + high) // 2
        try:
            ask(low, middle)
        except Exception:
            high = middle
        else:
            low = middle
    return low


def _finding(task: Task, problem: Problem, source: Source) -> Finding:
    line = source.line(problem.line)
    return Finding(
        "cross-check", task.id, "error", problem.line, line, problem.sentence, problem.advice, problem.detail
    )  # fmt: skip
