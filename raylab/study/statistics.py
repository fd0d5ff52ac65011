"""Intervals for what a study measures; scipy does the statistics.

Every interval is a log-t interval at 95 %: log(value) +- t(R - 1) times the standard error of the logarithm, from the
scatter of R independent repeats. It needs no normal distribution, stays positive, and keeps its promise better
than the chi-square interval and the bootstrap: on normal data, 20 repeats, it held the true variance in 92 % of
4000 trials when the repeats are single numbers and in 94 to 95 % when they are pictures (chi-square with fitted
degrees of freedom: 90 and 92 to 93 %; percentile bootstrap of the efficiency: 87 and 94 %).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

LEVEL = 0.95
FEW = 10  # with fewer repeats the scatter itself is hardly known
OFF_LINE = 0.1  # distance of a point from the fitted line, in the logarithm, from which on it is said
CROWDED = 0.1  # share of the squared error in one pixel from which on it is said


@dataclass(frozen=True)
class Estimate:
    """A positive number with its 95 % interval; `doubts` say why the interval may not be trusted."""

    value: float
    low: float
    high: float
    doubts: tuple[str, ...] = ()

    @property
    def log_error(self) -> float:
        """Half the interval of the logarithm; infinite when nothing is known."""
        known = self.value > 0.0 and self.low > 0.0
        return 0.5 * math.log(self.high / self.low) if known else math.inf

    def map(self, exponent: float) -> Estimate:
        """The same for value^exponent, as for a standard deviation from a variance."""
        ends = sorted((_power(self.low, exponent), _power(self.high, exponent)))
        return Estimate(_power(self.value, exponent), ends[0], ends[1], self.doubts)


@dataclass(frozen=True)
class Slope:
    """Exponent of a power law, fitted over log-log points."""

    value: float
    low: float
    high: float
    doubts: tuple[str, ...] = ()


def quantile(freedom: float) -> float:
    """Two-sided 95 % quantile of Student's t."""
    from scipy import stats

    return float(stats.t.ppf(0.5 + LEVEL / 2.0, max(freedom, 1.0)))


def mean_interval(values: Array, less: float = 0.0, less_error: float = 0.0) -> Estimate:
    """The mean of positive `values` (R,), each from an independent repeat, minus `less` known to +- `less_error`.

    Used for squared errors: `less` is the reference's own variance. A mean at or below twice `less` is not larger
    than what the reference adds: then the value is 0 and only the upper end of the interval is known.
    """
    repeats = len(values)
    raw = float(np.mean(values))
    if repeats < 2:
        return Estimate(max(raw - less, 0.0), 0.0, math.inf, ("a single repeat has no scatter",))
    doubts = [f"only {repeats} repeats"] if repeats < FEW else []
    value = raw - less
    error = math.hypot(float(np.std(values, ddof=1)) / math.sqrt(repeats), less_error)
    if less > 0.0 and value <= less:
        high = max(value, 0.0) + quantile(repeats - 1) * error
        return Estimate(0.0, 0.0, high, (*doubts, "below the reference's own error"))
    if value <= 0.0:
        return Estimate(0.0, 0.0, quantile(repeats - 1) * error, tuple(doubts))
    relative = error / value
    if relative > 0.5:
        doubts.append("heavy tail: a few repeats carry most of it")
    half = min(quantile(repeats - 1) * relative, 700.0)
    return Estimate(value, value * math.exp(-half), value * math.exp(half), tuple(doubts))


def median_interval(values: Array) -> Estimate:
    """The median of `values` (R,) with the exact distribution-free interval from order statistics."""
    from scipy import stats

    median = float(np.median(values))
    interval = stats.quantile_test(values, q=median, p=0.5).confidence_interval(LEVEL)
    low, high = float(interval.low), float(interval.high)
    if math.isfinite(low) and math.isfinite(high):
        return Estimate(median, low, high)
    return Estimate(median, float(np.min(values)), float(np.max(values)), (f"only {len(values)} timings",))


def slope(x: Sequence[float], y: Sequence[Estimate], repeats: int) -> Slope | None:
    """Weighted least squares of log y on log x; None with fewer than two usable points.

    Weights are 1 / variance of log y. When the points scatter about the line by more than their errors
    (chi^2 > degrees of freedom), the interval is widened by the root of that ratio.
    """
    usable = [(math.log(a), math.log(b.value), b.log_error) for a, b in zip(x, y, strict=True) if _usable(b)]
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


def efficiency(variance: Estimate, seconds: Array) -> Estimate:
    """1 / (variance x median time), with the errors of both added in the logarithm."""
    log_time = np.log(seconds)
    return _inverse(variance.value * float(np.median(seconds)), [variance], _median_error(log_time), len(seconds))


def efficiency_ratio(one: Estimate, one_seconds: Array, other: Estimate, other_seconds: Array) -> Estimate:
    """Efficiency of `one` over that of `other`; times are compared block by block, so a slow spell cancels."""
    blocks = min(len(one_seconds), len(other_seconds))
    log_ratio = np.log(one_seconds[:blocks]) - np.log(other_seconds[:blocks])
    if not (one.value > 0.0 and other.value > 0.0):
        return Estimate(math.nan, 0.0, math.inf, ("a variance is zero",))
    cost = one.value / other.value * math.exp(float(np.median(log_ratio)))
    return _inverse(cost, [one, other], _median_error(log_ratio), blocks)


def crowding(variances: Array) -> str:
    """A doubt when one of many entries of `variances` carries a large share: rare bright samples."""
    total = float(np.sum(variances))
    share = float(np.max(variances)) / total if total > 0.0 else 0.0
    if variances.size < 100 or share < CROWDED:
        return ""
    return f"one pixel carries {100.0 * share:.0f} % of the squared error (rare bright samples)"


def _usable(estimate: Estimate) -> bool:
    return estimate.value > 0.0 and math.isfinite(estimate.log_error)


def _power(x: float, exponent: float) -> float:
    return math.inf if x == 0.0 and exponent < 0.0 else float(x**exponent)


def _median_error(values: Array) -> float:
    """Standard error of the median, by the bootstrap."""
    from scipy import stats

    if len(values) < 2 or np.ptp(values) == 0.0:
        return 0.0
    generator = np.random.default_rng(0)
    return float(stats.bootstrap((values,), np.median, n_resamples=1000, method="basic", rng=generator).standard_error)


def _inverse(cost: float, variances: list[Estimate], time_error: float, repeats: int) -> Estimate:
    """1 / cost, where the logarithm of the cost has the errors of `variances` and of the time."""
    doubts = tuple(dict.fromkeys(d for v in variances for d in v.doubts))
    if cost <= 0.0 or any(not _usable(v) for v in variances):
        return Estimate(math.inf if cost <= 0.0 else 1.0 / cost, 0.0, math.inf, doubts or ("the variance is zero",))
    half = math.hypot(*(v.log_error for v in variances), quantile(repeats - 1) * time_error)
    half = min(half, 700.0)
    return Estimate(1.0 / cost, math.exp(-half) / cost, math.exp(half) / cost, doubts)
