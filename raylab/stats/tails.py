"""Tails: can a mean and its interval be trusted at all, and what is known of events that were hardly seen?"""

from __future__ import annotations

import math

import numpy as np

from raylab.stats.histogram import Array

FEWEST = 1000  # values of which the largest 1 % are ten, and lie in the tail
SCALES = (2.0**-8, 2.0**-10, 2.0**-12)  # shares of the values in which a power law shows the same index
STEADY = 1.5  # how much larger the index of the smallest share may be: three standard errors of 64 values


def tail_index(values: Array, share: float = 0.01) -> tuple[float, float]:
    """Hill's estimate of the tail index a of P(|X| > x) ~ x^-a, and its standard error a / sqrt(k).

    At most 2 means infinite variance: the error bar of a mean of such values is not to be trusted. Source: Hill 1975,
    "A simple general approach to inference about the tail of a distribution", Ann. Statist. 3. The k = `share` n
    largest absolute values are used, at least 10.
    """
    largest = np.sort(np.abs(np.asarray(values, np.float64).ravel()))[::-1]
    k = max(10, int(share * len(largest)))
    if len(largest) <= k or largest[k] <= 0.0:
        return math.inf, math.nan
    mean_log = float(np.mean(np.log(largest[:k] / largest[k])))
    if mean_log <= 0.0:
        return math.inf, math.nan
    return 1.0 / mean_log, 1.0 / mean_log / math.sqrt(k)


def is_trusted(values: Array) -> bool:
    """Whether the tail is light enough for a finite variance, as far as these values (n,) can tell.

    False when Hill's index is below 2 by no less than one standard error's doubt: it does not exceed 2 by one.
    """
    index, error = tail_index(values)
    return math.isinf(index) or index - error > 2.0


def why_not_trusted(values: Array) -> str:
    """Empty, or the sentence that stands instead of an interval for the mean; fewer than FEWEST values tell nothing."""
    values = np.asarray(values, np.float64).ravel()
    if len(values) < FEWEST or is_trusted(values):
        return ""
    index, error = tail_index(values)
    return f"not trusted: the variance looks infinite (tail index {index:.2f} +- {error:.2f}, which must be above 2)"


def infinite_variance(values: Array, bound: float = 0.0) -> str:
    """Empty, or the sentence that says so: a power law of an index of at most 2, the same on three SCALES.

    A law that is bounded, such as a lobe or a sun that is rarely hit, looks like a power law on one scale or two; the
    further out, the larger its index gets. 64 values of the smallest share take 2^18 values. Values up to `bound` are
    known to have a reason; it is the tail beyond that counts.
    """
    furthest = max(1, int(SCALES[-1] * np.size(values)))
    if np.size(values) < 2 * furthest or np.partition(np.ravel(values), -furthest)[-furthest] <= bound:
        return ""
    found = [tail_index(values, share) for share in SCALES]
    if any(math.isinf(index) or index - error > 2.0 for index, error in found) or found[-1][0] > STEADY * found[0][0]:
        return ""
    index, error = found[0]
    return (
        f"infinite variance: the interval is not trusted (tail index {index:.2f} +- {error:.2f} of "
        f"{np.size(values)} single samples, which must be above 2)"
    )


def wilson(hits: int, n: int, confidence: float = 0.95) -> tuple[float, float]:
    """Interval of a probability after `hits` in n trials, sound for rare hits as well (Wilson 1927)."""
    from scipy.stats import binomtest

    found = binomtest(hits, n).proportion_ci(confidence, "wilson")
    return float(found.low), float(found.high)


def rule_of_three(n: int, confidence: float = 0.95) -> float:
    """The largest probability that n trials without a hit leave open: 1 - (1 - confidence)^(1/n), about 3 / n."""
    return -math.expm1(math.log1p(-confidence) / n)
