"""Report: verdicts and causes as text for those who wrote the submission, the most informative first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from raylab.grading.assignment import Assignment
from raylab.grading.evidence import Diagnosis
from raylab.grading.judged import Judged

ORDER = {"ERROR": 0, "FAIL": 0, "NOT ATTEMPTED": 1, "NOT GRADED": 1, "INCONCLUSIVE": 2, "PASS": 3}


def line(judged: Judged) -> str:
    """One property."""
    head = f"{judged.outcome:13} {judged.score:g} of {judged.points:g}  {judged.task}: {judged.name}"
    if judged.outcome in ("PASS", "ERROR", "NOT ATTEMPTED"):
        return f"{head}\n    {judged.seen}" if judged.seen else head
    lines = [head, f"    {judged.says}"]
    if judged.seen:
        lines.append(f"    Seen: {judged.seen}.")
    if judged.outcome == "INCONCLUSIVE":
        lines.append("    Not decided within its samples: no points are lost by it.")
    return "\n".join(lines)


def verdicts(judged: Sequence[Judged]) -> str:
    """All properties, failures first."""
    return "\n".join(line(j) for j in sorted(judged, key=lambda j: ORDER[j.outcome]))


def causes(found: Sequence[Diagnosis], level: int) -> list[str]:
    """What the mistake may be, at a level of hint; at the first levels each sentence once."""
    return list(dict.fromkeys(d.hint(level) for d in found))


def total(judged: Sequence[Judged]) -> tuple[float, float]:
    return sum(j.score for j in judged), sum(j.points for j in judged)


def hints_of(assignment: Assignment, judged: Judged) -> str:
    """Where to look when a property does not hold."""
    return next(p.hint for p in assignment.properties if (p.task, p.name) == (judged.task, judged.name))


def as_dict(found: Sequence[Diagnosis]) -> list[dict[str, Any]]:
    return [
        {"cause": d.cause, "evidence": d.evidence, "factor": d.factor, "hints": [d.hint(k) for k in (1, 2, 3)]}
        for d in found
    ]


def rubric(assignment: Assignment) -> str:
    """The rubric as a table of the handout."""
    rows = ["| task | property | points | what is true of a right solution |", "|---|---|---|---|"]
    rows += [f"| `{p.task}` | {p.name} | {p.points:g} | {p.says} |" for p in assignment.properties]
    return "\n".join(rows)
