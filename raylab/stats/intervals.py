"""Intervals for display, of what was measured a few dozen times; scipy does the statistics. No verdict rests on them.

Every interval is a log-t interval at 95 %: log(value) +- t(R - 1) times the standard error of the logarithm, from the
scatter of R independent repeats. It needs no normal distribution, stays positive, and keeps its promise better
than the chi-square interval and the bootstrap: on normal data, 20 repeats, it held the true variance in 92 % of
4000 trials when the repeats are single numbers and in 94 to 95 % when they are pictures (chi-square with fitted
degrees of freedom: 90 and 92 to 93 %; percentile bootstrap of the efficiency: 87 and 94 %).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from raylab.stats.histogram import Array
from raylab.stats.tails import why_not_trusted

LEVEL = 0.95
FEW = 10  # with fewer repeats the scatter itself is hardly known
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

    @property
    def is_usable(self) -> bool:
        return self.value > 0.0 and math.isfinite(self.log_error)

    def map(self, exponent: float) -> Estimate:
        """The same for value^exponent, as for a standard deviation from a variance."""
        ends = sorted((_power(self.low, exponent), _power(self.high, exponent)))
        return Estimate(_power(self.value, exponent), ends[0], ends[1], self.doubts)


def quantile(freedom: float) -> float:
    """Two-sided 95 % quantile of Student's t."""
    from scipy import stats

    return float(stats.t.ppf(0.5 + LEVEL / 2.0, max(freedom, 1.0)))


def mean_interval(values: Array, less: float = 0.0, less_error: float = 0.0) -> Estimate:
    """The mean of positive `values` (R,), each from an independent repeat, minus `less` known to +- `less_error`.

    Used for squared errors: `less` is the reference's own variance. A mean at or below twice `less` is not larger
    than what the reference adds: then the value is 0 and only the upper end of the interval is known. Values of
    infinite variance have no interval.
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
    if doubt := why_not_trusted(values):
        return Estimate(value, 0.0, math.inf, (*doubts, doubt))
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


def crowding(variances: Array) -> str:
    """A doubt when one of many entries of `variances` carries a large share: rare bright samples."""
    total = float(np.sum(variances))
    share = float(np.max(variances)) / total if total > 0.0 else 0.0
    if variances.size < 100 or share < CROWDED:
        return ""
    return f"one pixel carries {100.0 * share:.0f} % of the squared error (rare bright samples)"


def _power(x: float, exponent: float) -> float:
    return math.inf if x == 0.0 and exponent < 0.0 else float(x**exponent)


def variance_interval(values: Array) -> Estimate:
    """The variance of independent `values` (R,), such as the means of R randomisations.

    The scatter of the squared deviations says how well it is known: relative error sqrt((kurtosis - 1) / R).
    """
    values = np.asarray(values, np.float64)
    return mean_interval((values - values.mean()) ** 2 * len(values) / max(len(values) - 1, 1))
