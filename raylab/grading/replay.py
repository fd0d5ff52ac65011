"""Replay: one sample again, in plain Python, with every line that was run and what it changed."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

from raylab import trials
from raylab.errors import UserError
from raylab.grading.assignment import Assignment, load
from raylab.grading.check import in_python, source_of, table_of
from raylab.grading.source import plain_of
from raylab.grading.table import SEED, TRIAL_SEED
from raylab.vec3 import Vec3

LONGEST = 400  # lines of a table


def parse(token: str) -> tuple[Assignment, str, int, int, int, int]:
    """assignment, task, trial number, sample number, trial seed, seed of TASK:TRIAL:SAMPLE[:TRIAL SEED:SEED]."""
    task, *numbers = token.strip().split(":")
    try:
        values = [int(n) for n in numbers]
    except ValueError:
        values = []
    if len(values) not in (2, 4):
        raise UserError(f"expected a token such as a1.diffuse:0:17, got {token!r}")
    trial, number, trial_seed, seed = [*values, TRIAL_SEED, SEED][:4]
    assignment = load(task.partition(".")[0])
    if assignment.task(task).kind != "shade" or trial not in range(len(assignment.diagnosis[task])):
        raise UserError(f"token {token!r}: there is no such scene")
    return assignment, task, trial, number, trial_seed, seed


def replay(token: str, path: Path, say: Callable[[str], None], debug: bool = False) -> None:
    """Say what one sample does, line by line."""
    assignment, name, trial, number, trial_seed, seed = parse(token)
    task = assignment.task(name)
    source = source_of(path, assignment)
    function = in_python(source, task)
    made = trials.make(assignment.diagnosis[name][trial], trial_seed)
    plain = plain_of(made, seed)
    say(f"{name}, {made.name}, sample {number}")
    for label, value in zip(task.arguments, plain.arguments(function), strict=False):
        say(f"    {label} = {shown(value)}")
    if debug:
        import pdb

        found = pdb.Pdb().runcall(plain.call, function, number)
    else:
        try:
            with Steps(source.decode("utf-8-sig").splitlines(), say):
                found = plain.call(function, number)
        except Exception as error:  # the student's; what was run has been said
            say(f"raises {type(error).__name__}: {error}")
            return
    say(f"result    {shown(found)}")
    table = table_of(assignment, name)
    if table is not None and (trial_seed, seed) == (TRIAL_SEED, SEED) and number < table.samples.shape[2]:
        say(f"reference {shown(Vec3(*table.samples[0, trial, number]))}, if one rng.square() is drawn for each light")


class Steps:
    """Says each line of the student's file as it is run, and the values that it has changed."""

    def __init__(self, lines: list[str], say: Callable[[str], None]) -> None:
        self.lines, self.say, self.said = lines, say, 0
        self.before: dict[int, tuple[int, dict[str, str]]] = {}

    def __enter__(self) -> None:
        self.old = sys.gettrace()
        sys.settrace(self._call)

    def __exit__(self, *_: object) -> None:
        sys.settrace(self.old)

    def _call(self, frame: FrameType, event: str, argument: Any) -> Any:
        from raylab.submission.source import FILE

        if frame.f_code.co_filename != FILE:
            return None
        self.before[id(frame)] = (0, {k: shown(v) for k, v in frame.f_locals.items()})
        return self._line

    def _line(self, frame: FrameType, event: str, argument: Any) -> Any:
        line, old = self.before[id(frame)]
        new = {k: shown(v) for k, v in frame.f_locals.items()}
        if line and self.said < LONGEST:
            text = self.lines[line - 1].strip() if line <= len(self.lines) else ""
            changed = ", ".join(f"{k} = {v}" for k, v in new.items() if old.get(k) != v)
            self.say(f"{line:4}  {text:60} {changed}".rstrip())
            self.said += 1
        self.before[id(frame)] = (frame.f_lineno, new)
        return self._line


def shown(value: Any) -> str:
    """A value on one line."""
    if isinstance(value, Vec3):
        return f"({value.x:.6g}, {value.y:.6g}, {value.z:.6g})"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, bool | int | str):
        return repr(value)
    if isinstance(value, tuple) and type(value) is tuple:
        return "(" + ", ".join(shown(v) for v in value) + ")"
    if hasattr(value, "p") and hasattr(value, "n") and isinstance(value.p, Vec3):
        return f"<point {shown(value.p)}, normal {shown(value.n)}>"
    return f"<{type(value).__name__}>"
