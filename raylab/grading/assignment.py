"""Assignment: a folder with a handout, tasks, a rubric of properties and starter scenes, read from assignment.toml.

id = "a1"                       # and title, slide, file
[[task]]                        # the fields of raylab.submission.task.Task, and:
solution = "shade:area_diffuse" # the marked function of the package that is the answer
[[property]]                    # one line of the rubric
task, name, points              # and how it is judged, see raylab.grading.judge
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import raylab
from raylab.errors import UserError
from raylab.submission.task import Task

NAMES = ("a1", "a2", "a3", "a4", "a5", "a6", "a7")


@dataclass(frozen=True)
class Property:
    """A line of the rubric: what is true of a right solution, what that is worth, and the claim that asks for it."""

    task: str
    name: str  # such as "visibility"
    points: float
    claim: str  # a method of raylab.grading.judge.Judge
    says: str  # what is claimed, for students
    hint: str = ""  # where to look when it does not hold
    options: dict[str, Any] = field(default_factory=dict)

    @property
    def id(self) -> str:
        return f"{self.task}: {self.name}"


@dataclass(frozen=True)
class Assignment:
    """What is asked, and what it is worth."""

    id: str
    title: str
    slide: str
    file: str  # what students hand in
    tasks: tuple[Task, ...]
    solutions: dict[str, str]  # task id -> "module:function"
    properties: tuple[Property, ...]
    scenes: dict[str, str]  # task id of a shade() -> starter scene
    diagnosis: dict[str, tuple[str, ...]]  # task id -> trials in which its variants are compared
    docs: dict[str, str]  # task id -> docstring of the stub, where the solution's would give it away
    needs: tuple[str, ...]  # functions of the package that its own checks call
    folder: Path

    @cached_property
    def points(self) -> float:
        return sum(p.points for p in self.properties)

    def task(self, name: str) -> Task:
        """The task of an id; UserError if there is none."""
        for task in self.tasks:
            if task.id == name:
                return task
        raise UserError(f"assignment {self.id} has no task {name!r}; expected {', '.join(t.id for t in self.tasks)}")

    def of(self, task: str) -> list[Property]:
        return [p for p in self.properties if p.task == task]


def root() -> Path:
    """Where the assignments are: beside the package's sources, or in the package as a course wheel has them."""
    package = Path(raylab.__file__).parent
    for folder in (package / "assignments", package.parent / "assignments"):
        if (folder / "a1" / "assignment.toml").is_file():
            return folder
    raise UserError("this installation of raylab has no assignments; expected the source tree or a course wheel")


def load(name: str | Path) -> Assignment:
    """The assignment called `name`, or the one in a folder; UserError with a sentence when it cannot be."""
    folder = Path(name) if isinstance(name, Path) else root() / name
    if not (folder / "assignment.toml").is_file():
        raise UserError(f"unknown assignment {str(name)!r}; expected one of {', '.join(NAMES)}, or a folder of one")
    table = _toml().loads((folder / "assignment.toml").read_text("utf-8"))
    try:
        return _assignment(table, folder)
    except (KeyError, TypeError) as error:
        raise UserError(f"{folder / 'assignment.toml'}: {error}") from None


def _assignment(table: dict[str, Any], folder: Path) -> Assignment:
    tasks, solutions, scenes, diagnosis, docs = [], {}, {}, {}, {}
    for own in table["task"]:
        own = dict(own)
        solutions[own["id"]] = own.pop("solution")
        diagnosis[own["id"]] = tuple(own.pop("diagnosis", ()))
        docs[own["id"]] = own.pop("doc", "")
        if "scene" in own:
            scenes[own["id"]] = own.pop("scene")
        tasks.append(Task.from_dict(own))
    known = {"task", "name", "points", "claim", "says", "hint"}
    properties = []
    for row in table["property"]:
        options = {key: value for key, value in row.items() if key not in known}
        properties.append(Property(**{k: v for k, v in row.items() if k in known}, options=options))
        if row["task"] not in solutions:
            raise KeyError(f"property {row['name']!r} is about task {row['task']!r}, which is not there")
    return Assignment(
        table["id"], table["title"], table["slide"], table["file"], tuple(tasks), solutions, tuple(properties),
        scenes, diagnosis, docs, tuple(table.get("needs", ())), folder,
    )  # fmt: skip


def _toml() -> Any:
    if sys.version_info >= (3, 11):
        import tomllib

        return tomllib
    import tomli  # type: ignore[import-not-found]

    return tomli
