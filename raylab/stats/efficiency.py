"""Efficiency: 1 / (variance x time), for display. No verdict rests on a clock."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from raylab.stats.histogram import Array
from raylab.stats.intervals import Estimate, quantile
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


def compare(one: Blocks, other: Blocks, resamples: int = 4000) -> Estimate:
    """Efficiency of `one` over that of `other`: times compared block by block, interval by the bootstrap over blocks.

    The logarithm of (mean variance x median time) of both is formed anew from blocks drawn with replacement; its 2.5
    and 97.5 % points are the interval. There is none if a variance is not to be trusted.
    """
    doubts = tuple(d for d in dict.fromkeys((one.doubt, other.doubt)) if d)
    ratio_of_times = np.log(other.seconds) - np.log(one.seconds)

    def log_ratio(chosen: npt.NDArray[np.int64]) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            variances = np.log(other.variances[chosen].mean(axis=-1)) - np.log(one.variances[chosen].mean(axis=-1))
        return np.asarray(variances + np.median(ratio_of_times[chosen], axis=-1))

    blocks = len(one.seconds)
    value = float(log_ratio(np.arange(blocks, dtype=np.int64)))
    if not math.isfinite(value):
        return Estimate(math.nan, 0.0, math.inf, (*doubts, "a variance is zero"))
    if doubts:
        return Estimate(math.exp(value), 0.0, math.inf, doubts)
    again = log_ratio(np.random.default_rng(0).integers(0, blocks, (resamples, blocks)))
    low, high = np.quantile(again, [0.025, 0.975])
    return Estimate(math.exp(value), math.exp(low), math.exp(high), doubts)


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
