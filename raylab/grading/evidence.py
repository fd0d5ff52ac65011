"""Evidence: a cause that explains the numbers of a submission, how well, and with which constant besides."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from raylab.grading.causes import CAUSES

SAME = 2e-5  # relative: other orders of the same operations, and float32 in the table


@dataclass(frozen=True)
class Diagnosis:
    """A cause, the price of believing it (less is likelier), and what spoke for it."""

    cause: str
    cost: float
    evidence: str
    factor: str = ""

    def hint(self, level: int) -> str:
        """In the words of the slide, from 1 (where to look) to 3 (what it is)."""
        return CAUSES[self.cause].hints[level - 1].format(factor=self.factor or "a constant")


def ranked(found: Iterable[Diagnosis]) -> list[Diagnosis]:
    """Each cause once, by its price; if the reference explains all, there is nothing to name."""
    best: dict[str, Diagnosis] = {}
    for d in sorted(found, key=lambda d: d.cost):
        best.setdefault(d.cause, d)
    return [] if "none" in best else list(best.values())


def composed(variant: str, others: Sequence[tuple[str, str]], cost: float, text: str) -> list[Diagnosis]:
    """All that must be wrong at once, the variant itself first; pairs of a cause and its factor."""
    every = [(variant, ""), *others] if variant != "none" or not others else list(others)
    text = text if len(every) == 1 else f"{text}, with several things wrong at once"
    return [Diagnosis(cause, cost + len(every) + 0.01 * i, text, factor) for i, (cause, factor) in enumerate(every)]


def named_constant(c: float) -> list[tuple[str, str]]:
    """The constant in the words of the slides, if it is made of pi and small numbers."""
    if c < 0.0:
        rest = [] if abs(c + 1.0) < SAME else named_constant(-c)
        return [("negated", ""), *rest]
    if abs(c - 2.0) < 2 * SAME:
        return [("factor", "2"), ("counted twice", "")]
    return [("factor", words_of(c))]


def words_of(c: float) -> str:
    """2 pi, pi / 2, 1 / 4, ... or just the number."""
    for k, i, j in itertools.product((0, 1, -1, 2, -2), (1, 2, 3, 4, 8), (1, 2, 3, 4, 8)):
        if math.gcd(i, j) == 1 and abs(c / (math.pi**k * i / j) - 1.0) < 3 * SAME:
            power = "" if k == 0 else "pi" if abs(k) == 1 else "pi^2"
            above = " ".join([str(i)] * (i != 1 or k <= 0) + [power] * (k > 0))
            below = " ".join([str(j)] * (j != 1) + [power] * (k < 0))
            return above if not below else f"{above} / ({below})" if " " in below else f"{above} / {below}"
    return f"{c:.4g}"


def about(c: float) -> str:
    """A constant that is known within a few percent."""
    for k, i, j in itertools.product((0, 1, -1), (1, 2, 4), (1, 2, 4)):
        if abs(c / (math.pi**k * i / j) - 1.0) < 0.02 and math.gcd(i, j) == 1:
            return "about " + words_of(math.pi**k * i / j)
    return f"about {c:.3g}"
