"""Judged: what was found of one property."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from raylab.grading.assignment import Property


@dataclass(frozen=True)
class Judged:
    """What was found of one property.

    `outcome`: PASS, FAIL, INCONCLUSIVE (which costs nothing); ERROR or NOT ATTEMPTED where there is nothing to judge.
    """

    task: str
    name: str
    outcome: str
    score: float
    points: float
    says: str
    seen: str = ""
    variance: float | None = None  # relative to that of the technique, where it is asked for
    p_value: float | None = None  # of the first look at the mean, two-sided: even for right submissions
    samples: int = 0
    seconds: float = 0.0

    def to_dict(self) -> dict[str, Any]:
        return asdict(self)


def refused(own: Property, outcome: str = "NOT ATTEMPTED", seen: str = "") -> Judged:
    """A property of which nothing can be said, for there is nothing to judge."""
    return Judged(own.task, own.name, outcome, 0.0, own.points, own.says, seen)
