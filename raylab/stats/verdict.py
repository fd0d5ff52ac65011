"""Verdict: what a test says, with everything needed to judge the verdict itself."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

Outcome = Literal["PASS", "FAIL", "INCONCLUSIVE"]


@dataclass(frozen=True)
class Verdict:
    """The outcome of a claim.

    `estimate` and `interval` (which covers the true value at every sample size at once with probability 1 - beta)
    are in the units of `truth`; `detectable` is the smallest bias, up or down, that would have been caught with
    probability at least 1 - beta: everything further from the truth is outside the interval.
    """

    claim: str
    outcome: Outcome
    estimate: float
    interval: tuple[float, float]
    truth: float
    samples: int
    detectable: float
    alpha: float
    beta: float
    seconds: float = math.nan
    reason: str = ""

    def __str__(self) -> str:
        low, high = self.interval
        relative = f" ({100 * self.detectable / abs(self.truth):.2g} % of it)" if self.truth else ""
        text = (
            f"{self.outcome}  {self.claim}: estimate {self.estimate:.6g} in [{low:.6g}, {high:.6g}], expected "
            f"{self.truth:.6g}; {self.samples} samples; a bias of {self.detectable:.2g}{relative} would be seen"
        )
        return f"{text}; {self.reason}" if self.reason else text
