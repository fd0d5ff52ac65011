"""Deciding: a claim for each column of what is drawn, all of them from the same samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from raylab.estimator_check import KINDS
from raylab.stats.betting import PILOT, Claim, Test
from raylab.stats.budget import Share
from raylab.stats.claims import LARGEST_BLOCK
from raylab.stats.verdict import Verdict
from raylab.testing.source import Array, Draw

CHANNELS = ("red", "green", "blue")
CAP = 8  # times what a true claim needs on average


@dataclass(frozen=True)
class Decision:
    """Verdicts, one for each claim, the rows drawn, and values that no correct estimator gives, in words."""

    verdicts: tuple[Verdict, ...]
    samples: int
    findings: tuple[str, ...]


def decide(claims: Sequence[Claim], draw: Draw, seconds: float = float("nan")) -> Decision:
    """Draw (n, k) for k claims in growing blocks until all are decided, one fails, or patience ends.

    A value that is not a finite number decides against; so does one outside its range.
    """
    tests = [Test(claim) for claim in claims]
    findings: list[str] = []
    values = draw(PILOT)
    caps = [patience(claim, values[:, c]) for c, claim in enumerate(claims)]
    taken = 0
    while True:
        taken += len(values)
        for c, test in enumerate(tests):
            test.update(values[:, c])
            findings += _named(test.claim, values[:, c])
        open_ = [t.outcome == "INCONCLUSIVE" and t.samples < cap for t, cap in zip(tests, caps, strict=True)]
        if not any(open_) or any(t.outcome == "FAIL" for t in tests):
            return Decision(tuple(test.verdict(seconds) for test in tests), taken, tuple(findings))
        values = draw(min(max(64, taken // 4), LARGEST_BLOCK))


def patience(claim: Claim, pilot: Array) -> int:
    """The samples after which a claim is given up as INCONCLUSIVE: CAP times what a true one needs on average."""
    finite = pilot[np.isfinite(pilot)]
    spread = float(finite.std()) if len(finite) else 0.0
    needed = max(23.0 * (spread / claim.delta) ** 2, 8.0 * (claim.high - claim.low) / claim.delta, 4.0 * PILOT)
    return int(CAP * needed)


def _named(claim: Claim, values: Array) -> list[str]:
    """The first value that no correct estimator gives, as what it is."""
    wrong = values[~((values >= claim.low) & (values <= claim.high))]
    if not len(wrong):
        return []
    kind = "nan" if not np.isfinite(wrong[0]) else "negative" if claim.low == 0.0 and wrong[0] < 0.0 else "bound"
    return [f"{claim.name}: {KINDS[kind]}: {wrong[0]:.6g}, expected [{claim.low:.6g}, {claim.high:.6g}]"]


def equal_means(share: Share, high_x: Array, high_y: Array, delta: Array) -> list[Claim]:
    """E X = E Y in each channel, X in [0, high_x] and Y in [0, high_y], claimed of X - Y."""
    return [
        Claim(f"{share.name}, {channel}", 0.0, -high_y[c], high_x[c], delta[c], 0.0, share.alpha / 3.0)
        for c, channel in enumerate(CHANNELS)
    ]
