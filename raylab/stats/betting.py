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

from raylab.stats.histogram import Array, Histogram, edges_for, log_growth
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
    return float(np.logaddexp.reduce(logs)) - math.log(len(logs))


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


class Bets:
    """The log capital of bets (k,) against a mean, for histograms with the same edges; logarithms are taken once."""

    def __init__(self, edges: Array, mean: float, bets: Array) -> None:
        self._at = log_growth(edges, mean, bets)

    def log_capital(self, histogram: Histogram) -> float:
        """Of a gambler whose capital is shared out evenly among the bets."""
        return _mix(histogram.log_capital_of(self._at))


class Gamblers:
    """Those who bet against a claim: that it is true, that the mean is `delta` above the truth, and `delta` below."""

    def __init__(self, claim: Claim, edges: Array, bet: float) -> None:
        low, high, above, below = claim.low, claim.high, claim.truth + claim.delta, claim.truth - claim.delta
        up, down = claim.truth + claim.truth_error, claim.truth - claim.truth_error
        self.up = Bets(edges, up, SIZES / (up - low)) if up > low else None
        self.down = Bets(edges, down, -SIZES / (high - down)) if down < high else None
        self.not_above = Bets(edges, above, -np.minimum(KELLY * bet, _most(high - above))) if above <= high else None
        self.not_below = Bets(edges, below, np.minimum(KELLY * bet, _most(below - low))) if below >= low else None

    def against(self, seen: Histogram) -> float:
        """Log capital of those who bet that the claim is wrong, up and down."""
        up, down = (0.0 if bets is None else bets.log_capital(seen) for bets in (self.up, self.down))
        return float(np.logaddexp(up, down)) - math.log(2.0)

    def against_delta(self, seen: Histogram) -> float:
        """The lesser log capital of the two who bet that the mean is nearer to the truth than delta."""
        both = (self.not_above, self.not_below)  # None: the observations cannot average as much
        return min(math.inf if bets is None else bets.log_capital(seen) for bets in both)


def _most(distance: float) -> float:
    return SAFE / distance if distance > 0.0 else math.inf


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
        self._gamblers: Gamblers | None = None

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
        if self._gamblers is not None and self._all is not None and self._late is not None:
            if self._gamblers.against(self._all) >= -math.log(self.claim.alpha):
                self.outcome = "FAIL"
            elif self._gamblers.against_delta(self._late) >= -math.log(self.claim.beta):
                self.outcome = "PASS"
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
            delta, ratio = float(claim.delta), spread / float(claim.delta)  # of which the squares may be too small
            self._gamblers = Gamblers(claim, edges, 1.0 / (delta * (1.0 + ratio * ratio)))
        assert self._late is not None
        self._all.add(values)
        self._late.add(values)

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
