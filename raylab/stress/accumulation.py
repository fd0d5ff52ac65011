"""Accumulation: many samples, large means, merged streams, samples that are no numbers."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab import samplers
from raylab.image import estimate
from raylab.jit import njit
from raylab.pixels import COLUMNS, COUNT, INVALID, MEAN, SQUARES, receive
from raylab.record import record
from raylab.scene import Scene
from raylab.stress.case import Found, case
from raylab.vec3 import Vec3, black
from raylab.view import View

Array = npt.NDArray[np.float64]


# --- the renderer's own running mean, fed with given values: an empty scene, eye rays that meet nothing ---


@record
class Rays(NamedTuple):
    """A packet of rays upwards."""

    tag: int = 0

    def time(self, lane):
        return 0.0

    def o(self, lane):
        return black

    def d(self, lane):
        return Vec3(0.0, 0.0, 1.0)

    def hit(self, lane):
        return -1, -1


@record
class Given(NamedTuple):
    """A strategy whose samples are `values`, over and over."""

    values: View
    next: View

    def visible(self, light):
        i = self.next[0]
        self.next[0] = i + 1 if i + 1 < len(self.values) else 0
        return Vec3(self.values[i], 0.0, 0.0)

    def shade(self, x, V, brdf, N, scene, rng):
        return black


@njit
def _add(scene, strategy, sampler, packet, pixels, n):
    receive(scene, strategy, sampler, packet, 0, 0, pixels, 0, 0, 0, 0, n)


def accumulated(values: npt.ArrayLike, n: int = 0) -> Array:
    """The row of the accumulator after n samples, one of each value by default."""
    given = np.asarray(values, float)
    row = np.zeros((1, COLUMNS))
    strategy = Given(View(given), View(np.zeros(1, np.int64)))
    sampler = samplers.make("independent", 1, 1)
    _add(Scene(d.SceneDescription()).data, strategy, sampler, Rays(), View(row), n or len(given))
    return row[0]


@njit
def _single(values, n, mean):
    """A sum, or a running mean, in float32."""
    total = np.float32(0.0)
    k = 0
    for i in range(n):
        v = np.float32(values[k])
        k = k + 1 if k + 1 < len(values) else 0
        total = np.float32(total + (v - total) / np.float32(i + 1)) if mean else np.float32(total + v)
    return total


@njit
def _double(values, n):
    """A sum in float64, one after the other."""
    total = 0.0
    k = 0
    for _ in range(n):
        total += values[k]
        k = k + 1 if k + 1 < len(values) else 0
    return total


MANY = 30_000_000


@case(
    "G01", "3e7 samples of 1", usual="a sum in float32, stuck at 2^24", rule="a running mean in float64",
    truth="mean 1, 3e7 samples, no variance", unit="relative error of the mean or the number", allowed=0.0,
)  # fmt: skip
def many_ones() -> Found:
    row, ones = accumulated([1.0], MANY), np.ones(1)
    error = max(abs(row[MEAN] - 1.0), abs(row[COUNT] / MANY - 1.0), abs(row[SQUARES]))
    return Found(float(error), abs(float(_single(ones, MANY, False)) / MANY - 1.0))


@case(
    "G02", "3e7 uniform numbers", usual="a running mean in float32", rule="a running mean in float64",
    truth="the exact sum", unit="drift in standard errors", allowed=0.01,
)  # fmt: skip
def drift() -> Found:
    values = np.random.default_rng(6).random(1_000_000)
    truth = math.fsum(values) / len(values)
    one = float(values.std()) / math.sqrt(MANY)
    usual = float(_single(values.astype(np.float32), MANY, True))
    return Found(abs(accumulated(values, MANY)[MEAN] - truth) / one, abs(usual - truth) / one)


@case(
    "G03", "3e7 samples of 0.1, 0.3 and 0.7 in turn", usual="a sum in float64", rule="a running mean in float64",
    truth="the exact sum", unit="relative error of the mean", allowed=1e-12,
)  # fmt: skip
def tenths() -> Found:
    values = np.array([0.1, 0.3, 0.7])
    truth = math.fsum(values) / 3.0
    return Found(abs(accumulated(values, MANY)[MEAN] / truth - 1.0), abs(_double(values, MANY) / MANY / truth - 1.0))


@case(
    "G03x", "a pixel of 1e9 samples, 250 times the same million in each of four streams", usual="a sum in float64",
    rule="a running mean in float64 of each stream, put together", truth="the exact sum, and exact squares",
    unit="relative error of the mean, or of the standard error", allowed=1e-12, slow=True, limit=300.0,
)  # fmt: skip
def a_billion() -> Found:
    values = np.random.default_rng(6).random((4, 1_000_000))
    rounds, n = 250, 250_000_000
    rows = np.array([accumulated(own, n) for own in values])
    mean, error, counts = estimate(rows.reshape(4, 1, 1, COLUMNS), independent=True)
    truth = math.fsum(values.ravel()) / values.size
    squares = math.fsum(rounds * math.fsum((own - math.fsum(own) / own.size) ** 2) for own in values)
    spread = math.sqrt(squares / (n - 1) / n) / 4
    usual = sum(_double(own, n) for own in values) / (4 * n)
    found = max(abs(mean[0, 0, 0] / truth - 1.0), abs(error[0, 0, 0] / spread - 1.0))
    return Found(float(found) if counts[0, 0] == 1e9 else math.inf, abs(usual / truth - 1.0))


@case(
    "G04", "1e6 samples of 1 after one of 2^24",
    usual="a sum in float32, which is what fastmath leaves of Kahan's",
    rule="a running mean in float64, compiled as it is written",
    truth="the exact sum", unit="relative error of the sum", allowed=1e-12,
)  # fmt: skip
def compensation() -> Found:
    n = 1_000_000
    values = np.ones(n + 1)
    values[0] = 2.0**24
    row, truth = accumulated(values), 2.0**24 + n
    return Found(abs(row[MEAN] * row[COUNT] / truth - 1.0), abs(float(_single(values, n + 1, False)) / truth - 1.0))


@case(
    "G05", "the variance of 1e5 samples of mean 1e6, 1e8, 1e10 and standard deviation 1",
    usual="sum of squares less square of the sum", rule="Welford's update",
    truth="differences from the mean, exact sums", unit="relative error of the variance, in 1e-11 mean / sd",
    allowed=1.0,
)  # fmt: skip
def large_means() -> Found:
    error = usual = 0.0
    for mean in (1e6, 1e8, 1e10):
        values = mean + np.random.default_rng(6).standard_normal(100_000)
        n, rest = len(values), values - mean  # exact
        truth = (math.fsum(rest * rest) - math.fsum(rest) ** 2 / n) / (n - 1)
        scale = 1e-11 * mean
        error = max(error, abs(accumulated(values)[SQUARES] / (n - 1) / truth - 1.0) / scale)
        naive = ((values * values).sum() - values.sum() ** 2 / n) / (n - 1)
        usual = max(usual, abs(float(naive) / truth - 1.0) / scale)
    return Found(error, usual)


def streams(*parts: tuple[float, float, float]) -> tuple[Array, Array]:
    """Mean and standard error of streams (mean, squares, number), as independent samples and compared."""
    rows = np.zeros((len(parts), 1, 1, COLUMNS))
    for row, (mean, squares, count) in zip(rows, parts, strict=True):
        row[..., MEAN : MEAN + 3], row[..., SQUARES : SQUARES + 3], row[..., COUNT] = mean, squares, count
    means, compared, _ = estimate(rows, independent=False)
    _, independent, _ = estimate(rows, independent=True)
    return means[0, 0, :1], np.array([compared[0, 0, 0], independent[0, 0, 0]])


@case(
    "G06", "streams of no sample and of some, and two of 4e9 samples, put together",
    usual="n_a n_b / (n_a + n_b) in int64", rule="weights n_a / n in float64, empty streams left out",
    truth="the weighted mean", unit="error of the mean, NaN if it is one", allowed=4 * 2.0**-53,
)  # fmt: skip
def merged() -> Found:
    few, many = streams((0.0, 0.0, 0.0), (0.75, 1.0, 10.0)), streams((1.0, 1e9, 4e9), (2.0, 1e9, 4e9))
    error = max(abs(few[0][0] - 0.75), abs(many[0][0] - 1.5), abs(many[1][0] - 0.5))  # two means 1 apart: SE 1/2
    n = np.array(4_000_000_000)
    with np.errstate(over="ignore"):
        between = float(n * n) / float(n + n)  # times the squared difference of the means
    return Found(float(error), abs(between / 2e9 - 1.0))


@case(
    "G07", "the standard error of no sample and of one", usual="variance 0 for n <= 1", rule="NaN: not known",
    truth="not known", unit="numbers where there is none", allowed=0.0,
)  # fmt: skip
def unknown() -> Found:
    none, one = streams((0.0, 0.0, 0.0)), streams((0.5, 0.0, 1.0))
    values = [none[0][0], *none[1], *one[1]]
    return Found(sum(not math.isnan(v) for v in values), len(values))


@case(
    "G11", "three samples of 1e6 that are NaN or infinite", usual="added up, or taken for black",
    rule="left out and counted", truth="the mean of the others, and 3",
    unit="relative error of the mean, infinite if not counted", allowed=1e-12,
)  # fmt: skip
def not_numbers() -> Found:
    values = np.random.default_rng(6).random(1_000_000)
    values[[5, 77_777, 999_999]] = (math.nan, math.inf, -math.inf)
    row, good = accumulated(values), values[np.isfinite(values)]
    truth = math.fsum(good) / len(good)
    counted = row[INVALID] == 3.0 and row[COUNT] == len(good)
    with np.errstate(invalid="ignore"):
        return Found(abs(row[MEAN] / truth - 1.0) if counted else math.inf, abs(float(values.mean()) / truth - 1.0))
