"""Convergence: how fast the variance falls with the number of samples.

The mean of N points that are not independent of each other (strata, Sobol') has no standard error of its own: the
scatter of the N values knows nothing of what the strata save. Several means from independent randomisations have.
The fitted slope is for display; the verdicts are bets (`raylab.stats.betting`), exact at every number of means.
For independent points, N Var(mean of N) = Var(mean of 1) is `claims.shrinks_as`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from raylab.stats.betting import Claim
from raylab.stats.claims import ALPHA, BETA, decide
from raylab.stats.histogram import Array
from raylab.stats.intervals import FEW, Estimate, quantile, variance_interval
from raylab.stats.verdict import Verdict

Means = Callable[[int, int], Array]  # (N, R) -> R means of N points each, independently randomised
OFF_LINE = 0.1  # distance of a point from the fitted line, in the logarithm, from which on it is said

# Exponents of N in the variance of a mean, in two dimensions: independent points, a jittered grid (smooth integrand,
# edge), a Latin hypercube (sum of functions of one coordinate each, anything else), Owen-scrambled Sobol' points
# (smooth, up to a power of log N; edge). Sources: Mitchell 1996, "Consequences of stratified sampling in graphics";
# Stein 1987; Owen 1997, "Scrambled net variance for integrals of smooth functions".
EXPECTED = {
    ("independent", "smooth"): -1.0, ("independent", "edge"): -1.0,
    ("stratified", "smooth"): -2.0, ("stratified", "edge"): -1.5,
    ("latin", "additive"): -3.0, ("latin", "smooth"): -1.0, ("latin", "edge"): -1.0,
    ("sobol", "smooth"): -3.0, ("sobol", "edge"): -1.5,
}  # fmt: skip


@dataclass(frozen=True)
class Slope:
    """Exponent of a power law, fitted over log-log points."""

    value: float
    low: float
    high: float
    doubts: tuple[str, ...] = ()


def variance_slope(samples: Sequence[int], means: Sequence[Array]) -> Slope | None:
    """d log Var / d log N from R means each (`means[i]` (R,)) of `samples[i]` points; powers of 4 suit all samplers.

    Interval by the delta method: each log variance has the standard error sqrt((kurtosis - 1) / R), which are the
    weights; where the points do not lie on a line their own scatter widens it.
    """
    variances = [variance_interval(m) for m in means]
    fitted = fit([float(n) for n in samples], variances, min(len(m) for m in means))
    if fitted is None:
        return None
    doubts = tuple(dict.fromkeys((*(d for v in variances for d in v.doubts), *fitted.doubts)))
    return Slope(fitted.value, fitted.low, fitted.high, doubts)


def honest_error(means: Array) -> Estimate:
    """Standard error s / sqrt(R) of the average of R independently randomised means (R,), with its own interval."""
    found = variance_interval(means)
    repeats = len(means)
    return Estimate(found.value / repeats, found.low / repeats, found.high / repeats, found.doubts).map(0.5)


def fit(x: Sequence[float], y: Sequence[Estimate], repeats: int) -> Slope | None:
    """Weighted least squares of log y on log x; None with fewer than two usable points.

    Weights are 1 / variance of log y. When the points scatter about the line by more than their errors
    (chi^2 > degrees of freedom), the interval is widened by the root of that ratio.
    """
    usable = [(math.log(a), math.log(b.value), b.log_error) for a, b in zip(x, y, strict=True) if b.is_usable]
    if len(usable) < 2:
        return None
    u, v, half = np.array(usable).T
    sigma = np.maximum(half, 1e-6) / quantile(repeats - 1)
    weights = 1.0 / sigma**2
    centre = np.average(u, weights=weights)
    spread = float(np.sum(weights * (u - centre) ** 2))
    value = float(np.sum(weights * (u - centre) * v)) / spread
    residuals = v - np.average(v, weights=weights) - value * (u - centre)
    freedom = len(u) - 2
    ratio = float(np.sum(weights * residuals**2)) / freedom if freedom else 1.0
    error, factor = spread**-0.5, quantile(repeats - 1)
    doubts = [f"only {repeats} repeats"] if repeats < FEW else []
    if freedom == 0:
        doubts.append("two points only: whether they lie on a line is unknown")
    if ratio > 1.0:
        error, factor = error * math.sqrt(ratio), quantile(freedom)
        if ratio > 4.0 and float(np.max(np.abs(residuals))) > OFF_LINE:
            doubts.append("the points do not lie on a line; the slope is an average")
    return Slope(value, value - factor * error, value + factor * error, tuple(doubts))


# --- verdicts ---


def variance_at_most(
    name: str, draw_means: Means, samples: int, limit: float, *, reach: float, alpha: float = ALPHA,
    beta: float = BETA, cap: int = 1 << 20,
) -> Verdict:  # fmt: skip
    """Var(mean of N = `samples`) <= `limit`; a variance of twice the limit must be noticed.

    Two means differ by at most `reach`: for strata that is the sum over them of how much the integrand varies in
    each, divided by N, and a mean beyond it refutes the strata at once. For 2 u1 on a grid of N cells the variance is
    1 / (3 N^2), so limit = 4 / (3 N^2) is a gate that plain random points, 1 / (3 N), do not pass.
    """
    claim = Claim(name, 0.5 * limit, 0.0, max(0.5 * reach**2, 2.0 * limit), 1.5 * limit, 0.5 * limit, alpha, beta)
    return decide(claim, lambda n: 0.5 * (draw_means(samples, n) - draw_means(samples, n)) ** 2, cap)


def median_error_at_most(
    name: str, draw_means: Means, samples: int, truth: float, limit: float, *, alpha: float = ALPHA,
    beta: float = BETA, cap: int = 1 << 20,
) -> Verdict:  # fmt: skip
    """|mean of N - truth| <= `limit` at least every other time: the sign test, for errors too heavy for a variance.

    Noticed must be a limit that three in four exceed. The estimate is the share that does.
    """
    claim = Claim(name, 0.25, 0.0, 1.0, 0.5, 0.25, alpha, beta)
    return decide(claim, lambda n: (np.abs(draw_means(samples, n) - truth) > limit).astype(float), cap)
