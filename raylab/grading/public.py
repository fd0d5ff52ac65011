"""Public tests: what the test file in a student's folder calls."""

from __future__ import annotations

import functools
from pathlib import Path

from raylab.grading.assignment import load
from raylab.grading.check import source_of
from raylab.grading.judge import Judge, Judged, refused
from raylab.grading.source import InProcess
from raylab.submission.ladder import Climb, climb


def properties(name: str) -> list[str]:
    """The rubric's lines."""
    return [p.id for p in load(name).properties]


@functools.cache
def _climbed(name: str, path: Path) -> tuple[Climb, Judge]:
    assignment = load(name)
    climbed = climb(source_of(path, assignment), assignment.tasks)
    return climbed, Judge(assignment, InProcess(climbed.functions))


def judged(name: str, path: Path, which: str) -> Judged:
    """The verdict on one property of the student's file."""
    climbed, judge = _climbed(name, path)
    own = next(p for p in judge.assignment.properties if p.id == which)
    if own.task in climbed.functions:
        return judge.judge(own)
    stops = [f for f in climbed.of(own.task) if f.fatal]
    outcome = "FAIL" if any(f.kind == "error" for f in stops) else "NOT ATTEMPTED"
    return refused(own, outcome, "; ".join(str(f) for f in stops))
