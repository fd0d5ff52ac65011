"""Ladder: parse, shape, vet, interpret, compile, cross-check; each task climbs as far as it can.

If plain Python runs and the compiler refuses, the finding says which line it cannot handle; if both run and differ,
that is a finding too: an unset variable, an integer that overflows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, get_args

import numpy as np

from raylab.jit import interpreted
from raylab.plain import Plain
from raylab.probe import Probe
from raylab.submission.compile import Mapped, compile_shade, prepare, unset
from raylab.submission.example import SAMPLES, SEED, Example, example_rows, examples
from raylab.submission.finding import Finding, Kind, Problem, Stage
from raylab.submission.interpret import interpret_map, interpret_shade
from raylab.submission.shape import ENTRY, check_shape
from raylab.submission.source import Source, read
from raylab.submission.task import Task
from raylab.submission.vet import vet

STAGES: tuple[Stage, ...] = get_args(Stage)
AGREEMENT = 2.0**-20  # relative to the largest value: both round to 2^-53 and may differ in float32 shadow rays
Tell = Callable[[Finding], None]


@dataclass
class Climb:
    """What was found, and a function for each task that reached the top.

    kind "shade": for `Probe`, `render` and whoever takes a shade(); kind "map": rows (n, k) -> (n, m).
    """

    findings: list[Finding] = field(default_factory=list)
    functions: dict[str, Any] = field(default_factory=dict)

    def of(self, task: str) -> list[Finding]:
        """What concerns one task: its own findings and those of the whole file."""
        return [f for f in self.findings if f.task in ("", task)]


def climb(source: bytes, tasks: Sequence[Task], tell: Tell | None = None, until: Stage = "cross-check") -> Climb:
    """Take all tasks of a file as far as stage `until`; `tell` hears each finding at once.

    First all tasks run in plain Python, which takes milliseconds; then they are compiled, which takes seconds.
    """
    climbed = Climb()
    note = _Notes(climbed, tell)
    try:
        read_in = read(source)
    except Problem as problem:
        note.add("parse", "", problem)
        return climbed
    note.source = read_in
    for line, sentence in read_in.remarks:
        note.add("parse", "", Problem(sentence, line=line, kind="note"))
    ascents = [_Ascent(read_in, task, note) for task in tasks]
    for ascent in ascents:
        ascent.go(STAGES[1:4], until)
    for ascent in ascents:
        ascent.go(STAGES[4:], until)
        if ascent.function is not None:
            climbed.functions[ascent.task.id] = ascent.function
    return climbed


@dataclass
class _Notes:
    """Where findings go."""

    climbed: Climb
    tell: Tell | None
    source: Source | None = None

    def add(self, stage: Stage, task: str, problem: Problem, kind: Kind | None = None) -> None:
        text = self.source.line(problem.line) if self.source else ""
        finding = Finding(
            stage, task, kind or problem.kind, problem.line, text, problem.sentence, problem.advice, problem.detail
        )
        self.climbed.findings.append(finding)
        if self.tell:
            self.tell(finding)


class _Ascent:
    """One task on its way up."""

    def __init__(self, source: Source, task: Task, notes: _Notes) -> None:
        self.source, self.task, self.notes = source, task, notes
        self.function: Any = None
        self.stopped = False
        self.entry, self.values = "", np.zeros((0, 3))
        self.example: Example  # what is compiled for

    def go(self, stages: Sequence[Stage], until: Stage) -> None:
        for stage in stages:
            if self.stopped or STAGES.index(stage) > STAGES.index(until):
                return
            try:
                self._step(stage)
            except Problem as problem:
                self.notes.add(stage, self.task.id, problem)
                self.stopped, self.function = True, None

    def _step(self, stage: Stage) -> None:
        {
            "shape": self._shape, "vet": self._vet, "interpret": self._interpret, "compile": self._compile,
            "cross-check": self._cross_check,
        }[stage]()  # fmt: skip

    def _shape(self) -> None:
        self.entry, remarks = check_shape(self.source, self.task)
        for line, sentence in remarks:
            self.notes.add("shape", self.task.id, Problem(sentence, line=line, kind="note"))

    def _vet(self) -> None:
        vet(self.source, self.task)

    def _interpret(self) -> None:
        function = self.source.namespace(self.entry)[ENTRY]
        found: Any
        if self.task.kind == "map":
            with interpreted():
                found, odd = interpret_map(self.source, self.task, function, example_rows(self.task))
        else:
            odd = []
            for example in examples(self.task):
                self.example, plain = example, Plain(example.scene, example.place, SEED)
                found, more = interpret_shade(self.source, self.task, function, plain, SAMPLES)
                odd += more
        self.values = np.array(found)
        for problem in _of_a_kind(odd):
            self.notes.add("interpret", self.task.id, problem)

    def _compile(self) -> None:
        compiled = prepare(self.source, self.task, self.entry)
        for problem in unset(self.source, self.task):
            self.notes.add("compile", self.task.id, problem)
        if self.task.kind == "map":
            self.function = Mapped(self.source, self.task, compiled)
        else:
            compile_shade(self.source, self.task, compiled, Plain(self.example.scene, self.example.place, SEED))
            self.function = compiled

    def _cross_check(self) -> None:
        try:
            if self.task.kind == "map":
                found = self.function(example_rows(self.task))
            else:
                probe = Probe(self.example.scene, self.function, self.example.place, 1)
                found = probe.sample(SEED, len(self.values))
        except Exception as error:
            raise Problem(
                f"Compiled, `{self.task.function}` raises {type(error).__name__}: {error}, and in plain Python it does "
                "not.", "Usually an index past the end, or an integer that overflows.",
            ) from None  # fmt: skip
        largest = np.nanmax(np.abs(self.values), initial=2.0**-1000)
        same = np.isclose(found, self.values, rtol=AGREEMENT, atol=AGREEMENT * largest, equal_nan=True)
        if not same.all():
            number = int(np.argmin(same.all(axis=1)))
            raise Problem(
                f"Python and the compiled version disagree: sample {number} is {_shown(self.values[number])} and "
                f"{_shown(found[number])}.",
                "Usually a variable that is not set on some way through the function, or an integer that overflows: "
                "begin with floats (0.0).",
            )


def _of_a_kind(problems: Sequence[Problem]) -> list[Problem]:
    """The first problem of each line."""
    return list({problem.line: problem for problem in reversed(problems)}.values())[::-1]


def _shown(values: np.ndarray) -> str:
    return "(" + ", ".join(f"{v:.6g}" for v in values) + ")"
