"""Manners: right answers to every task of the assignments, each written in another manner (tests/submissions).

A function of a file answers a task by the beginning of its name: `hemisphere_angles` of a3.py answers a3.hemisphere.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from raylab.grading.assignment import load
from raylab.grading.check import in_python
from raylab.submission.task import Task

FOLDER = Path(__file__).parent / "submissions"
DIFFUSE = (  # those whose variance is the slide's as well
    "slide", "with_helpers", "early_ends", "by_hand", "by_index", "with_while", "other_numbers", "with_arrays",
    "decorated", "inner", "with_lists",
)  # fmt: skip
OTHERS = {"a5.shade": "phong_", "a7.shade": "mis_"}  # how others.py calls what a5.py and a7.py call shade_


@dataclass(frozen=True)
class Right:
    """A right answer: a function of a file."""

    task: str
    file: str
    name: str

    @property
    def style(self) -> str:
        return self.name if self.file in ("area_diffuse.py", "others.py") else f"{self.file[:-3]}.{self.name}"

    @property
    def text(self) -> str:
        return text_of(self.file)

    @property
    def asked(self) -> Task:
        """The task, with the function under its own name."""
        return replace(load(self.task.partition(".")[0]).task(self.task), function=self.name)

    @property
    def withheld(self) -> set[str]:
        """Words it uses that would be the answer."""
        text = self.text
        used = {word for a, b in parts(text, self.name) for word in re.findall(r"\w+", text[a:b])}
        return used & set(self.asked.withheld)

    def edited(self, edits: Sequence[tuple[str, str]]) -> str:
        """The file with mistakes in the function or in its helpers; LookupError when an edit does not fit."""
        text = self.text
        for old, new in edits:
            spans = [(a, b) for a, b in parts(text, self.name) if old in text[a:b]]
            if not spans:
                raise LookupError(f"{self.style}: {old!r} does not occur")
            for a, b in sorted(spans, reverse=True):
                text = text[:a] + text[a:b].replace(old, new) + text[b:]
        return text

    def function(self, edits: Sequence[tuple[str, str]] = ()) -> Any:
        """To be called in plain Python."""
        return in_python(self.edited(edits).encode(), self.asked, silent=True)


@cache
def text_of(file: str) -> str:
    return (FOLDER / file).read_text()


@cache
def functions(text: str) -> dict[str, ast.FunctionDef]:
    return {node.name: node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef)}


@cache
def parts(text: str, name: str) -> list[tuple[int, int]]:
    """Where the function stands, and every function of the file that it reaches."""
    found = functions(text)
    reached, waiting = {name}, [name]
    while waiting:
        used = {n.id for n in ast.walk(found[waiting.pop()]) if isinstance(n, ast.Name)} & found.keys() - reached
        reached |= used
        waiting += used
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    return [(starts[found[f].lineno - 1], starts[found[f].end_lineno or 0]) for f in reached]


@cache
def of_task(task: str) -> tuple[Right, ...]:
    """All right answers to a task."""
    if task == "a1.diffuse":
        return tuple(Right(task, "area_diffuse.py", name) for name in DIFFUSE)
    assignment, _, short = task.partition(".")
    files = {f"{assignment}.py": f"{short}_"}
    if load(assignment).task(task).kind == "shade":
        files["others.py"] = OTHERS.get(task, f"{short}_")
    return tuple(
        Right(task, file, node.name)
        for file, beginning in files.items()
        for node in functions(text_of(file)).values()
        if node.name.startswith(beginning)
        if len(node.args.args) == len(load(assignment).task(task).arguments)
    )


def of_assignment(name: str) -> list[tuple[Right, ...]]:
    """Complete submissions: an answer to each task, by those that use no word that would be the answer."""
    columns = [[right for right in of_task(task.id) if not right.withheld] for task in load(name).tasks]
    return [tuple(c[i % len(c)] for c in columns) for i in range(max(map(len, columns)))]
