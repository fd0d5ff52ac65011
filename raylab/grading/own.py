"""Own: the shade() in a student's file, to be rendered and held against the reference of its task."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import raylab
from raylab.errors import UserError
from raylab.grading import goal
from raylab.grading.assignment import NAMES, Assignment, load
from raylab.grading.check import source_of
from raylab.image import Image
from raylab.scene import Scene
from raylab.strategies import strategy
from raylab.study.compare import Comparison, Reference
from raylab.submission.compile import explained, prepare, type_errors
from raylab.submission.finding import Problem
from raylab.submission.ladder import climb
from raylab.submission.shape import check_shape, is_stub
from raylab.submission.source import Source, read
from raylab.submission.task import Task

MORE = 4  # times the samples of the picture: what a reference that is rendered for it has
Candidate = tuple[Assignment, Task]


@dataclass(frozen=True, eq=False)
class Own:
    """A student's file, the task that its function answers, and the function, to be compiled for the scene."""

    path: Path
    assignment: Assignment
    task: Task
    source: Source
    function: Any

    @classmethod
    def read(cls, path: Path, scene: Scene, wanted: str, say: Callable[[str], None]) -> Own:
        """Up to where it runs in plain Python; UserError with the student's line where it does not."""
        data = source_of(path, _assignments()[0])
        try:
            source = read(data)
        except Problem as problem:
            raise UserError(f"{path}: {_in_lines(problem)}") from None
        assignment, task = choose(candidates(source, path, wanted), source, path, scene)
        strategy(task.like, scene)  # has the scene what the task is about?
        climbed = climb(data, [task], until="interpret")
        for finding in climbed.findings:
            if finding.fatal:
                head = "not attempted: " if finding.kind == "unfinished" else ""
                raise UserError(f"{path}: {head}{finding}")
            say(str(finding))
        try:
            function = prepare(source, task, check_shape(source, task)[0])
        except Problem as problem:
            raise UserError(f"{path}: {_in_lines(problem, source)}") from None
        return cls(path, assignment, task, source, function)

    @property
    def name(self) -> str:
        return f"{self.path.name}:{self.task.function} ({self.task.id})"

    def picture(self, scene: Scene) -> Path:
        """Where the picture goes if nobody says."""
        stem = (scene.description.path or Path("scene")).stem
        return self.path.with_name(f"{stem}_{self.task.function}.png")

    def explained(self) -> AbstractContextManager[None]:
        """Around a rendering: says what the compiler, or the compiled function, has to say."""
        return _Told(self)

    def reference(
        self, scene: Scene, image: Image, parameters: set[str], threads: int | None, progress: Any
    ) -> Reference | None:
        """The one that is kept with the assignment; else, where raylab has the solution, rendered here and now."""
        path, shape = scene.description.path, image.mean.shape
        found = goal.stored(self.assignment, self.task, path, parameters) if path else None
        if found is not None and found.mean.shape == shape:
            return found
        if (self.assignment.folder / "stub.py").is_file():  # a course wheel
            return None
        spp = MORE * max(1, round(float(image.samples.mean())))
        made = raylab.render(
            scene, self.task.like, sampler="independent", spp=spp, seed=image.report["seed"] + 1, threads=threads,
            progress=progress,
        )  # fmt: skip
        if not made.complete:
            raise KeyboardInterrupt
        return Reference.of(made, f"{self.task.like}, {spp} samples per pixel")

    def compare(self, image: Image, reference: Reference, scene: Scene, out: Path) -> Comparison:
        """Write the picture beside the reference."""
        comparison = Comparison(image, reference)
        where = (scene.description.path or Path("scene")).name
        comparison.write(out, f"{self.task.id} in {where}, {image.samples.mean():g} samples per pixel")
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
                f"{own.path}: somewhere in the picture `{own.task.function}` raises {said}. "
                f"Which line it is: raylab check {own.assignment.id} {own.path}"
            ) from None


def _in_lines(problem: Problem, source: Source | None = None) -> str:
    line = source.line(problem.line).strip() if source else ""
    where = f"line {problem.line}: " if problem.line else ""
    return "\n".join(t for t in (f"{where}{problem.sentence}", f"    {line}" if line else "", problem.advice) if t)


# --- which task is meant ---


def candidates(source: Source, path: Path, wanted: str) -> list[Candidate]:
    """The tasks whose function is in the file; UserError if there is none that makes a picture."""
    every = [(a, t) for a in _assignments() for t in a.tasks]
    if wanted and not any(wanted in (a.id, t.id) for a, t in every):
        known = ", ".join(t.id for _, t in every if t.kind == "shade")
        raise UserError(f"--task: there is no task {wanted!r}; expected one of {known}")
    found = [(a, t) for a, t in every if t.function in source.functions and wanted in ("", a.id, t.id)]
    shades = [(a, t) for a, t in found if t.kind == "shade"]
    if shades:
        return shades
    if found:
        a, names = found[0][0], ", ".join(f"`{t.function}`" for _, t in found)
        raise UserError(
            f"{path}: {names} {'is a plain function' if len(found) == 1 else 'are plain functions'} of numbers, which "
            f"make no picture by themselves; try them with: raylab check {a.id} {path}"
        )
    meant = [t for a, t in every if wanted in ("", a.id, t.id) and t.kind == "shade"]
    asked = " or ".join(dict.fromkeys(f"`{t.function}`" for t in meant))
    there = ", ".join(f"`{name}`" for name in source.functions) or "no function"
    raise UserError(f"{path}: expected a function {asked}{f' ({wanted})' if wanted else ''}; the file has {there}")


def choose(found: list[Candidate], source: Source, path: Path, scene: Scene) -> Candidate:
    """The one task that all clues together leave; UserError if they leave several."""
    text, file = "\n".join(source.lines), scene.description.path.name if scene.description.path else ""
    clues: tuple[Callable[[Assignment, Task], bool], ...] = (
        lambda a, t: path.with_name(f"test_{a.id}.py").is_file(),
        lambda a, t: f"Assignment {a.id}:" in text,
        lambda a, t: a.id in (path.resolve().parent.name, path.stem),
        lambda a, t: a.scenes.get(t.id) == file,
        lambda a, t: set(t.arguments) == {x.arg for x in source.functions[t.function].args.args},
        lambda a, t: _fits(t, scene),
        lambda a, t: not is_stub(source.functions[t.function]),
    )
    for clue in clues:
        found = [c for c in found if clue(*c)] or found
    if len(found) > 1:
        names = " or ".join(f"--task {t.id}" for _, t in found)
        raise UserError(f"{path} may answer {len(found)} tasks; say which is meant: {names}")
    return found[0]


def _fits(task: Task, scene: Scene) -> bool:
    try:
        strategy(task.like, scene)
    except UserError:
        return False
    return True


def _assignments() -> list[Assignment]:
    """Those of this installation: a course wheel has some of them."""
    found = []
    for name in NAMES:
        try:
            found.append(load(name))
        except UserError:
            continue
    if not found:
        raise UserError("this installation of raylab has no assignments; expected the source tree or a course wheel")
    return found
