"""Efficiency: 1 / (variance x time), for display. No verdict rests on a clock."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from raylab.stats.histogram import Array
from raylab.stats.intervals import Estimate, mean_interval, quantile
from raylab.stats.tails import why_not_trusted

Draw = Callable[[int], Array]
BLOCKS = 30


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


@dataclass(frozen=True)
class Blocks:
    """Blocks of equally many observations each: their variance (blocks,) and seconds (blocks,)."""

    variances: Array
    seconds: Array
    doubt: str = ""

    @property
    def variance(self) -> Estimate:
        """The mean of the blocks' variances, with an interval from their scatter."""
        found = mean_interval(self.variances)
        return Estimate(found.value, 0.0, math.inf, (self.doubt, *found.doubts)) if self.doubt else found


def interleave(draws: list[Draw], n: int, blocks: int = BLOCKS) -> list[Blocks]:
    """Time `blocks` blocks of `n` observations of each estimator, in turns, every other turn reversed (ABBA).

    A first block of each, which may compile, is thrown away. A slow spell of the machine meets all of them.
    """
    for draw in draws:
        draw(n)
    seconds, values = np.zeros((len(draws), blocks)), np.zeros((len(draws), blocks, n))
    for block in range(blocks):
        order = range(len(draws)) if block % 2 == 0 else range(len(draws) - 1, -1, -1)
        for i in order:
            start = time.perf_counter()
            values[i, block] = draws[i](n)
            seconds[i, block] = time.perf_counter() - start
    return [
        Blocks(v.var(axis=1, ddof=1), t, why_not_trusted((v - v.mean()) ** 2))
        for v, t in zip(values, seconds, strict=True)
    ]


def compare(one: Blocks, other: Blocks) -> Estimate:
    """Efficiency of `one` over that of `other`, times compared block by block; none if a variance is not trusted."""
    return efficiency_ratio(one.variance, one.seconds, other.variance, other.seconds)


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
    if cost <= 0.0 or any(not v.is_usable for v in variances):
        return Estimate(math.inf if cost <= 0.0 else 1.0 / cost, 0.0, math.inf, doubts or ("the variance is zero",))
    half = math.hypot(*(v.log_error for v in variances), quantile(repeats - 1) * time_error)
    half = min(half, 700.0)
    return Estimate(1.0 / cost, math.exp(-half) / cost, math.exp(half) / cost, doubts)
