"""Planted: mistakes in what students write, each with the causes that would be right to name.

The right answers, in many manners, are those of tests/manners.py; a row of tests/planted_rows.py is an edit of one of
them: `old` must occur in the function or in its helpers, and causes have | between. `python planted.py`
(PYTHONPATH=..:.) diagnoses all of them in plain Python and writes docs/diagnosis.md.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import manners
import numpy as np
from manners import Right
from planted_rows import ROWS

from raylab.grading import assignment
from raylab.grading.diagnosis import diagnose
from raylab.grading.evidence import Diagnosis
from raylab.grading.source import Interpreted
from raylab.grading.table import Table, path_of

HERE = Path(__file__).parent
FOR_MOMENTS = 1 << 10  # samples of each scene, in plain Python
TASKS = tuple(task.id for name in assignment.NAMES for task in assignment.load(name).tasks)
RIGHT: dict[str, Right] = {right.style: right for task in TASKS for right in manners.of_task(task)}


@dataclass(frozen=True)
class Planted:
    """A mistake in a right answer, and what is right to say of it."""

    right: Right
    causes: tuple[str, ...]
    edits: tuple[tuple[str, str], ...]

    @property
    def name(self) -> str:
        return f"{self.right.style}: {self.edits[0][0]} -> {self.edits[0][1]}".replace("\n", " ")

    def function(self) -> Any:
        return self.right.function(self.edits)


def corpus() -> list[Planted]:
    return [
        Planted(RIGHT[style], tuple(causes.split("|")), tuple(zip(rest[::2], rest[1::2], strict=True)))
        for style, causes, *rest in ROWS
    ]


@cache
def table(task: str) -> Table:
    return Table.read(path_of(assignment.load(task.partition(".")[0]).folder, task))


def diagnosed(right: Right, function: Any, n: int = FOR_MOMENTS) -> list[Diagnosis]:
    """What is said of a function, all of it in plain Python."""
    with np.errstate(all="ignore"):
        source = Interpreted({right.task: function}, {right.task: right.asked})
        return diagnose(table(right.task), source, right.task, n=n)


def page(rows: list[tuple[Planted, list[str]]], accused: list[str]) -> str:
    """docs/diagnosis.md; of each mistake what was named."""
    total, first, among, missed = Counter[str](), Counter[str](), Counter[str](), []
    for planted, named in rows:
        task = planted.right.task
        total[task] += 1
        first[task] += named[:1] != [] and named[0] in planted.causes
        among[task] += any(cause in planted.causes for cause in named)
        if not (named and named[0] in planted.causes):
            missed.append(f"| {task} | `{planted.name}` | {planted.causes[0]} | {', '.join(named) or 'nothing'} |")
    share = [f"{count.total()} ({100 * count.total() / len(rows):.1f} %)" for count in (first, among)]
    lines = [
        "# Naming the mistake", "",
        "`cd tests && PYTHONPATH=.. python planted.py` plants mistakes in right answers that are written in many",
        "manners (tests/planted_rows.py, tests/submissions), compares them in plain Python with the tables of",
        "variants, and writes this page.", "",
        f"- {len(rows)} planted mistakes: the right cause is named first in {share[0]}, among three in {share[1]}.",
        f"- {len(RIGHT)} right answers: {len(accused)} accused.", "",
        "| task | planted | named first | among three |", "|---|---|---|---|",
        *(f"| {t} | {n} | {first[t]} | {among[t]} |" for t, n in sorted(total.items())), "",
        "Where the right cause is not named first:", "",
        "| task | planted | cause | named |", "|---|---|---|---|", *missed, "",
    ]  # fmt: skip
    return "\n".join(lines)


def main(out: Path) -> None:
    start = time.time()
    rows = [(planted, [d.cause for d in diagnosed(planted.right, planted.function())]) for planted in corpus()]
    accused = [style for style, right in RIGHT.items() if diagnosed(right, right.function())]
    out.write_text(page(rows, accused))
    print(out.read_text(), f"{time.time() - start:.0f} s; accused: {accused}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE.parent / "docs" / "diagnosis.md")
