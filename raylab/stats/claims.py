"""Claims: what a test can say of an estimator. Each takes functions that draw, and returns a Verdict.

A draw is a function n -> (n,) independent observations. Every claim is about the mean of something bounded, so all of
them use `raylab.stats.betting`, and their error rates are theorems.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from raylab.stats.betting import PILOT, Claim, Test
from raylab.stats.histogram import Array
from raylab.stats.tails import why_not_trusted
from raylab.stats.verdict import Verdict

Draw = Callable[[int], Array]
ALPHA, BETA, DELTA = 3.3e-9, 1e-3, 0.01
LARGEST_BLOCK = 1 << 17


def decide(claim: Claim, draw: Draw, cap: int) -> Verdict:
    """Draw in growing blocks until the claim is decided or `cap` observations have been made."""
    test, start, block, values = Test(claim), time.perf_counter(), PILOT, np.zeros(0)
    while test.outcome == "INCONCLUSIVE" and test.samples < cap:
        values = draw(min(block, cap - test.samples))
        test.update(values)
        block = min(max(64, test.samples // 4), LARGEST_BLOCK)
    if test.outcome == "INCONCLUSIVE" and why_not_trusted(values - claim.truth):
        test.reason = f"the mean is {why_not_trusted(values - claim.truth)}"
    return test.verdict(time.perf_counter() - start)


def _cap(cap: int | None, spread: float, delta: float, width: float) -> int:
    """Eight times what a true claim needs on average: 23 (spread / delta)^2, or 8 width / delta where that is more."""
    return cap or int(8 * max(23.0 * (spread / delta) ** 2, 8.0 * width / delta, 4.0 * PILOT))


def mean_is(
    name: str, draw: Draw, truth: float, *, high: float, low: float = 0.0, truth_error: float = 0.0,
    delta: float | None = None, alpha: float = ALPHA, beta: float = BETA, cap: int | None = None,
) -> Verdict:  # fmt: skip
    """E X = truth, within `truth_error`; a bias of `delta` (1 % of the truth by default) must be noticed.

    X lies in [low, high]; a sample outside is a FAIL.
    """
    delta = DELTA * abs(truth) if delta is None else delta
    claim = Claim(name, truth, low, high, delta, truth_error, alpha, beta)
    spread = float(np.std(draw(PILOT))) if cap is None else 0.0
    return decide(claim, draw, _cap(cap, spread, delta, high - low))


def same_mean(
    name: str, draw_x: Draw, draw_y: Draw, *, high_x: float, high_y: float, delta: float | None = None,
    alpha: float = ALPHA, beta: float = BETA, cap: int | None = None,
) -> Verdict:  # fmt: skip
    """E X = E Y, with X in [0, high_x] and Y in [0, high_y]; `delta` is 1 % of the mean of a pilot by default."""
    x, y = draw_x(PILOT), draw_y(PILOT)
    delta = DELTA * float(np.mean([x, y])) if delta is None else delta
    claim = Claim(name, 0.0, -high_y, high_x, delta, 0.0, alpha, beta)
    cap = _cap(cap, float(np.std(x - y)), delta, high_x + high_y)
    return decide(claim, lambda n: draw_x(n) - draw_y(n), cap)


def half_square(draw: Draw) -> Draw:
    """Observations (X - X')^2 / 2 of independent pairs, whose mean is the variance of X."""
    return lambda n: 0.5 * (draw(n) - draw(n)) ** 2


def variance_is(
    name: str, draw: Draw, variance: float, *, high: float, low: float = 0.0, tolerance: float = 0.1,
    alpha: float = ALPHA, beta: float = BETA, cap: int | None = None,
) -> Verdict:  # fmt: skip
    """Var X = variance; a deviation by the factor 1 +- `tolerance` must be noticed, below as well as above."""
    return mean_is(
        name, half_square(draw), variance, high=0.5 * (high - low) ** 2, delta=tolerance * variance,
        alpha=alpha, beta=beta, cap=cap,
    )  # fmt: skip


def variance_ratio_is(
    name: str, draw_x: Draw, draw_y: Draw, ratio: float, *, high_x: float, high_y: float, tolerance: float = 0.1,
    alpha: float = ALPHA, beta: float = BETA, cap: int | None = None,
) -> Verdict:  # fmt: skip
    """Var X = ratio Var Y."""
    u_x, u_y = half_square(draw_x), half_square(draw_y)
    pilot = u_x(PILOT)
    spread = float(np.hypot(pilot.std(), ratio * u_y(PILOT).std()))
    delta = tolerance * float(pilot.mean())
    claim = Claim(name, 0.0, -0.5 * ratio * high_y**2, 0.5 * high_x**2, delta, 0.0, alpha, beta)
    cap = _cap(cap, spread, delta, claim.high - claim.low)
    return decide(claim, lambda n: u_x(n) - ratio * u_y(n), cap)


def shrinks_as(
    name: str, draw_mean: Callable[[int, int], Array], samples: int, *, high: float, tolerance: float = 0.25,
    alpha: float = ALPHA, beta: float = BETA, cap: int | None = None,
) -> Verdict:  # fmt: skip
    """N Var(mean of N) = Var(mean of 1): `draw_mean(N, n)` gives n independent means of N = `samples` values each."""
    one, many = half_square(lambda n: draw_mean(1, n)), half_square(lambda n: draw_mean(samples, n))
    pilot = one(PILOT)
    delta, bound = tolerance * float(pilot.mean()), 0.5 * high**2
    claim = Claim(name, 0.0, -bound, samples * bound, delta, 0.0, alpha, beta)
    cap = _cap(cap, 2.0 * float(pilot.std()), delta, claim.high - claim.low)
    return decide(claim, lambda n: samples * many(n) - one(n), cap)


def uncorrelated(
    name: str, draw_pairs: Callable[[int], tuple[Array, Array]], mean: float, *, high: float, low: float = 0.0,
    tolerance: float = 0.05, alpha: float = ALPHA, beta: float = BETA, cap: int | None = None,
) -> Verdict:  # fmt: skip
    """E (X - mean)(X' - mean) = 0 for neighbouring calls or streams; a correlation of `tolerance` must be noticed."""

    def products(n: int) -> Array:
        x, y = draw_pairs(n)
        return (x - mean) * (y - mean)

    pilot = draw_pairs(PILOT)
    variance = float(np.mean([np.var(p) for p in pilot]))
    reach = max(high - mean, mean - low)
    claim = Claim(name, 0.0, -(reach**2), reach**2, tolerance * variance, 0.0, alpha, beta)
    cap = _cap(cap, variance, claim.delta, 2.0 * reach**2)
    return decide(claim, products, cap)
