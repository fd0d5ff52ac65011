"""Public tests: what the test file in a student's folder calls."""

from __future__ import annotations

import functools
from dataclasses import replace
from pathlib import Path

from raylab.grading.assignment import load
from raylab.grading.check import source_of, verdict
from raylab.grading.judge import Judge
from raylab.grading.judged import Judged, refused
from raylab.grading.raised import Raised, Watched
from raylab.submission.ladder import Climb, climb


def properties(name: str) -> list[str]:
    """The rubric's lines."""
    return [p.id for p in load(name).properties]


@functools.cache
def _climbed(name: str, path: Path) -> tuple[Climb, Judge]:
    assignment = load(name)
    source = source_of(path, assignment)
    climbed = climb(source, assignment.tasks)
    return climbed, Judge(assignment, Watched(climbed.functions, source, assignment.tasks))


def judged(name: str, path: Path, which: str) -> Judged:
    """The verdict on one property of the student's file; an error is a FAIL that says all there is to say."""
    climbed, judge = _climbed(name, path)
    own = next(p for p in judge.assignment.properties if p.id == which)
    try:
        found = verdict(judge, own, climbed)
    except Raised as error:
        return refused(own, "FAIL", str(error.finding))
    if found.outcome != "ERROR":
        return found
    return replace(found, outcome="FAIL", seen="; ".join(str(f) for f in climbed.of(own.task) if f.kind == "error"))
