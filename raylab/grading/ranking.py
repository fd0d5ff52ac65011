"""Ranking: how efficient a right submission is, without a clock: variance times rays.

The variance of one sample, in units of that of the slide's technique, times the rays that it traces. Twice the rays
for half the variance is the same value; less is better. It is worth no points: the variance is measured on numbers
that were asked for, but the rays are counted in the submission's process, and nobody outside can see them. So a claim
is taken for LEAST at least, and values below DOUBTFUL are marked for the staff.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping, Sequence

from raylab.grading.assignment import Assignment
from raylab.grading.faults import Fault, GraderFault
from raylab.grading.judged import Judged
from raylab.grading.source import Asked
from raylab.trials import Answer

SAMPLES = 1 << 16  # enough to know a variance to a percent or so
LEAST = 1.0  # rays of a sample: without one it is not known what is hidden, and "visibility" must hold to be here
DOUBTFUL = 0.25  # of the slide's technique
Row = tuple[str, float, str]


def column(task: str) -> str:
    """What the value is called."""
    return f"{task}: variance x rays"


def ranked(assignment: Assignment) -> list[str]:
    """The tasks that have a value."""
    return [p.task for p in assignment.properties if p.claim == "variance"]


def is_right(assignment: Assignment, task: str, judged: Sequence[Judged]) -> bool:
    """Whether all that was asked of a task was found to hold; its variance may be any."""
    passed = {j.name for j in judged if j.task == task and j.outcome == "PASS"}
    return {p.name for p in assignment.of(task) if p.claim != "variance"} <= passed


def rows(
    assignment: Assignment, judged: Sequence[Judged], scattered: Mapping[str, tuple[Asked, Answer, int]]
) -> list[Row]:
    """(name, value, "asc"), to three digits; a task of which the numbers do not come has none."""
    found = []
    for task in ranked(assignment):
        if task in scattered and is_right(assignment, task, judged):
            with contextlib.suppress(Fault, GraderFault):
                value = value_of(*scattered[task])
                if math.isfinite(value):
                    found.append((column(task), float(f"{value:.3g}"), "asc"))
    return found


def value_of(asked: Asked, answer: Answer, seed: int) -> float:
    """Variance of one sample, relative to the technique's, times the rays that it is said to trace."""
    assert answer.variance is not None
    values = asked.sample(seed, SAMPLES)[:, 1]
    rays = asked.rays(seed, SAMPLES) / SAMPLES
    return float(values.var() / answer.variance[1]) * (max(LEAST, rays) if rays == rays else math.nan)
