"""Which: the task that a student's file answers, from what is in it, where it is, and what is rendered."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from raylab.errors import UserError
from raylab.grading.assignment import NAMES, Assignment, load
from raylab.scene import Scene
from raylab.strategies import strategy
from raylab.submission.shape import is_stub
from raylab.submission.source import Source
from raylab.submission.task import Task

Candidate = tuple[Assignment, Task]
LENS = {"sample_aperture", "lens_direction"}  # plain functions that make a picture together


def candidates(source: Source, path: Path, wanted: str) -> list[Candidate]:
    """The tasks whose function is in the file; UserError if there is none that makes a picture."""
    every = [(a, t) for a in assignments() for t in a.tasks]
    if wanted and not any(wanted in (a.id, t.id) for a, t in every):
        known = ", ".join(t.id for _, t in every if t.kind == "shade")
        raise UserError(f"--task: there is no task {wanted!r}; expected one of {known}")
    found = [(a, t) for a, t in every if t.function in source.functions and wanted in ("", a.id, t.id)]
    shades = [(a, t) for a, t in found if t.kind == "shade"]
    if shades:
        return shades
    if {t.function for _, t in found} >= LENS:
        return [(a, t) for a, t in found if t.function in LENS][-1:]
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


def assignments() -> list[Assignment]:
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
