"""Betting: is the mean of a bounded quantity what it is said to be? Decided at any time, exact at every sample size.

A gambler starts with capital 1 and bets on each observation, at odds that would be fair if the claim were true. Then
the capital is a nonnegative martingale of mean 1, and by Ville's inequality it ever reaches 1 / alpha with probability
at most alpha: whoever gets that rich has refuted the claim. One gambler bets that the mean is not the truth (FAIL), two
more that it is not as much as delta above, and not as much as delta below it (PASS needs both).

Source: Waudby-Smith and Ramdas 2024, "Estimating means of bounded random variables by betting", JRSS-B 86(1).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from raylab.stats.histogram import Array, Histogram, edges_for
from raylab.stats.verdict import Outcome, Verdict

SAFE = 0.9  # of the largest bet that can never lose everything
SIZES = SAFE * 2.0 ** -np.arange(14.0)  # bets against the truth: all sizes, since it is not known how wrong it is
KELLY = 2.0 ** np.arange(-3.0, 2.0)  # bets against a bias of delta, in Kelly's sizes; small, for the pilot may err
PILOT = 256  # observations that set the size of those bets and are not bet on by them


@dataclass(frozen=True)
class Claim:
    """The mean of observations in [low, high] is `truth` within `truth_error`; a bias of `delta` must be noticed.

    FAIL has probability at most `alpha` when the claim is true, PASS at most `beta` when the bias is `delta` or more.
    """

    name: str
    truth: float
    low: float
    high: float
    delta: float
    truth_error: float = 0.0
    alpha: float = 3.3e-9
    beta: float = 1e-3

    def __post_init__(self) -> None:
        if not self.low <= self.truth - self.truth_error <= self.truth + self.truth_error <= self.high:
            raise ValueError(
                f"{self.name}: expected low <= truth <= high, got {self.low}, {self.truth} +- {self.truth_error}, "
                f"{self.high}"
            )
        if not (self.delta > self.truth_error and self.low < self.high):
            raise ValueError(
                f"{self.name}: expected delta above the truth's error {self.truth_error}, got {self.delta}"
            )
        if not (0.0 < self.alpha < 1.0 and 0.0 < self.beta < 1.0):
            raise ValueError(f"{self.name}: alpha and beta must be between 0 and 1, got {self.alpha}, {self.beta}")


def upward(histogram: Histogram, low: float, mean: float) -> float:
    """Log capital of a gambler who bets that the mean is above `mean`."""
    if mean <= low:  # the observations cannot average less
        return 0.0
    return _mix(histogram.log_capital(mean, SIZES / (mean - low)))


def downward(histogram: Histogram, high: float, mean: float) -> float:
    """Log capital of a gambler who bets that the mean is below `mean`."""
    if mean >= high:
        return 0.0
    return _mix(histogram.log_capital(mean, -SIZES / (high - mean)))


def _mix(logs: Array) -> float:
    return float(logsumexp(logs) - math.log(len(logs)))


def interval(histogram: Histogram, beta: float) -> tuple[float, float]:
    """The means that no gambler has refuted: they contain the true one for ever with probability 1 - beta."""
    low, high = float(histogram.edges[0]), float(histogram.edges[-1])
    estimate = float(np.clip(histogram.sums.sum() / max(histogram.counts.sum(), 1.0), low, high))
    enough = math.log(2.0 / beta)
    return (
        _boundary(low, estimate, lambda m: upward(histogram, low, m) >= enough),
        _boundary(high, estimate, lambda m: downward(histogram, high, m) >= enough),
    )


def _boundary(outer: float, inner: float, refuted: Callable[[float], bool]) -> float:
    """The end of the interval between `outer`, refuted if any mean is, and `inner`, which is not."""
    for _ in range(30):
        middle = 0.5 * (outer + inner)
        if refuted(middle):
            outer = middle
        else:
            inner = middle
    return outer


class Test:
    """A claim under test: `update(values)` until `outcome` is no longer INCONCLUSIVE, or patience ends."""

    __test__ = False  # not one of pytest's

    def __init__(self, claim: Claim) -> None:
        self.claim = claim
        self.samples = 0
        self.outcome: Outcome = "INCONCLUSIVE"
        self.reason = ""
        self._early: list[Array] = []
        self._all: Histogram | None = None
        self._late: Histogram | None = None  # without the pilot
        self._bet = 0.0

    def update(self, values: Array) -> Outcome:
        """Look at further observations (n,); once FAIL or PASS is said it stays."""
        if self.outcome != "INCONCLUSIVE":
            return self.outcome
        values = np.asarray(values, np.float64).ravel()
        self.samples += len(values)
        wrong = ~((values >= self.claim.low) & (values <= self.claim.high))
        if wrong.any():
            return self._out_of_range(float(values[wrong][0]))
        self._take(values)
        if self._all is not None and self._late is not None:
            self._decide(self._all, self._late)
        return self.outcome

    def _out_of_range(self, value: float) -> Outcome:
        self.outcome = "FAIL"
        self.reason = (
            f"sample {value:.6g} is outside [{self.claim.low:.6g}, {self.claim.high:.6g}], where a correct one is"
        )
        return self.outcome

    def _take(self, values: Array) -> None:
        if self._all is None:
            self._early.append(values)
            early = np.concatenate(self._early)
            if len(early) < PILOT:
                return
            self._early = []
            claim, pilot, values = self.claim, early[:PILOT], early[PILOT:]
            spread = float(np.hypot(pilot.std(), 1e-3 * claim.delta))
            edges = edges_for(claim.low, claim.high, claim.truth, spread)
            self._all, self._late = Histogram(edges), Histogram(edges)
            self._all.add(pilot)
            self._bet = claim.delta / (spread**2 + claim.delta**2)
        assert self._late is not None
        self._all.add(values)
        self._late.add(values)

    def _decide(self, everything: Histogram, late: Histogram) -> None:
        claim = self.claim
        against = np.logaddexp(
            upward(everything, claim.low, claim.truth + claim.truth_error),
            downward(everything, claim.high, claim.truth - claim.truth_error),
        ) - math.log(2.0)
        if against >= -math.log(claim.alpha):
            self.outcome = "FAIL"
        elif min(self._not_above(late), self._not_below(late)) >= -math.log(claim.beta):
            self.outcome = "PASS"

    def _not_above(self, late: Histogram) -> float:
        """Log capital of the gambler who bets that the mean is less than truth + delta."""
        mean, high = self.claim.truth + self.claim.delta, self.claim.high
        largest = SAFE / (high - mean) if high > mean else math.inf
        return math.inf if high < mean else _mix(late.log_capital(mean, -np.minimum(KELLY * self._bet, largest)))

    def _not_below(self, late: Histogram) -> float:
        """Log capital of the gambler who bets that the mean is more than truth - delta."""
        mean, low = self.claim.truth - self.claim.delta, self.claim.low
        largest = SAFE / (mean - low) if mean > low else math.inf
        return math.inf if low > mean else _mix(late.log_capital(mean, np.minimum(KELLY * self._bet, largest)))

    def verdict(self, seconds: float = math.nan) -> Verdict:
        """What is known so far."""
        claim, seen = self.claim, self._all
        if seen is None:
            values = np.concatenate(self._early) if self._early else np.zeros(0)
            inside = values[(values >= claim.low) & (values <= claim.high)]
            seen = Histogram(edges_for(claim.low, claim.high, claim.truth, claim.delta))
            seen.add(inside)
        low, high = interval(seen, claim.beta)
        estimate = float(seen.sums.sum() / max(seen.counts.sum(), 1.0))
        detectable = max(high - claim.truth, claim.truth - low)
        return Verdict(
            claim.name, self.outcome, estimate, (low, high), claim.truth, self.samples, detectable,
            claim.alpha, claim.beta, seconds, self.reason,
        )  # fmt: skip
