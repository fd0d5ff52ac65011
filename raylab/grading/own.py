"""Own: what is in a student's file, to be rendered and held against the reference of its task."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import raylab
from raylab.direct import direct
from raylab.errors import UserError
from raylab.grading import goal
from raylab.grading.assignment import Assignment
from raylab.grading.check import source_of
from raylab.grading.own_lens import through
from raylab.grading.which import LENS, assignments, candidates, choose
from raylab.image import Image
from raylab.scene import Scene
from raylab.strategies import strategy
from raylab.study.compare import Comparison, Reference
from raylab.submission.compile import explained, prepare, type_errors
from raylab.submission.finding import Problem
from raylab.submission.ladder import climb
from raylab.submission.shape import check_shape
from raylab.submission.source import Source, read
from raylab.submission.task import Task

MORE = 4  # times the samples of the picture: what a reference that is rendered for it has
Say = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Own:
    """A student's file, what it answers, and what to render: a scene with a function that is not compiled yet.

    `given` is the scene before the student's camera looked at it; `like` is the slide's function.
    """

    path: Path
    assignment: Assignment
    tasks: tuple[Task, ...]
    source: Source
    given: Scene
    scene: Scene
    function: Any
    like: str

    @classmethod
    def read(cls, path: Path, scene: Scene, wanted: str, say: Say) -> Own:
        """Up to where it runs in plain Python; UserError with the student's line where it does not."""
        data = source_of(path, assignments()[0])
        try:
            source = read(data)
        except Problem as problem:
            raise UserError(f"{path}: {_in_lines(problem)}") from None
        assignment, task = choose(candidates(source, path, wanted), source, path, scene)
        tasks = (task,) if task.kind == "shade" else tuple(t for t in assignment.tasks if t.function in LENS)
        if task.kind == "shade":
            strategy(task.like, scene)  # has the scene what the task is about?
        for finding in climb(data, tasks, until="interpret").findings:
            if finding.fatal:
                head = "not attempted: " if finding.kind == "unfinished" else ""
                raise UserError(f"{path}: {head}{finding}")
            say(str(finding))
        try:
            functions = {t.function: prepare(source, t, check_shape(source, t)[0]) for t in tasks}
        except Problem as problem:
            raise UserError(f"{path}: {_in_lines(problem, source)}") from None
        if task.kind == "shade":
            return cls(path, assignment, tasks, source, scene, scene, functions[task.function], task.like)
        seen = through(scene, **functions)
        return cls(path, assignment, tasks, source, scene, seen, direct, "direct")

    @property
    def label(self) -> str:
        return " and ".join(task.id for task in self.tasks)

    @property
    def name(self) -> str:
        return f"{self.path.name}:{' and '.join(task.function for task in self.tasks)} ({self.label})"

    @property
    def called(self) -> str:
        """The functions in a sentence."""
        return " or ".join(f"`{task.function}`" for task in self.tasks)

    @property
    def picture(self) -> Path:
        """Where the picture goes if nobody says."""
        stem = (self.given.description.path or Path("scene")).stem
        return self.path.with_name(f"{stem}_{self.tasks[-1].function}.png")

    def explained(self) -> AbstractContextManager[None]:
        """Around a rendering: says what the compiler, or the compiled function, has to say."""
        return _Told(self)

    def reference(self, image: Image, parameters: set[str], threads: int | None, progress: Any) -> Reference | None:
        """The one that is kept with the assignment; else, where raylab has the solution, rendered here and now."""
        path = self.given.description.path
        found = goal.stored(self.assignment, self.tasks[0], path, parameters) if path else None
        if found is not None and found.mean.shape == image.mean.shape:
            return found
        if self.like != "direct" and (self.assignment.folder / "stub.py").is_file():  # a course wheel
            return None
        spp = MORE * max(1, round(float(image.samples.mean())))
        made = raylab.render(
            self.given, self.like, sampler="independent", spp=spp, seed=image.report["seed"] + 1, threads=threads,
            progress=progress,
        )  # fmt: skip
        if not made.complete:
            raise KeyboardInterrupt
        return Reference.of(made, f"{self.like}, {spp} samples per pixel")

    def compare(self, image: Image, reference: Reference, out: Path) -> Comparison:
        """Write the picture beside the reference."""
        comparison = Comparison(image, reference)
        where = (self.given.description.path or Path("scene")).name
        comparison.write(out, f"{self.label} in {where}, {image.samples.mean():g} samples per pixel")
        return comparison


class _Told:
    """Turns what goes wrong in a student's function into a UserError with its line."""

    def __init__(self, own: Own) -> None:
        self.own, self.compiling = own, explained(own.source, type_errors)

    def __enter__(self) -> None:
        self.compiling.__enter__()

    def __exit__(self, kind: Any, error: BaseException | None, trace: Any) -> None:
        try:
            self.compiling.__exit__(kind, error, trace)
        except Problem as problem:
            raise UserError(f"{self.own.path}: {_in_lines(problem, self.own.source)}") from None
        if isinstance(error, Exception) and not isinstance(error, UserError):
            own, said = self.own, f"{type(error).__name__}: {error}"
            raise UserError(
                f"{own.path}: somewhere in the picture {own.called} raises {said}. "
                f"Which line it is: raylab check {own.assignment.id} {own.path}"
            ) from None


def _in_lines(problem: Problem, source: Source | None = None) -> str:
    line = source.line(problem.line).strip() if source else ""
    where = f"line {problem.line}: " if problem.line else ""
    return "\n".join(t for t in (f"{where}{problem.sentence}", f"    {line}" if line else "", problem.advice) if t)
