"""Randomness: numbers at the ends of their interval, and streams that must not know of one another."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from raylab import samplers
from raylab.image import estimate
from raylab.jit import njit
from raylab.pixels import COLUMNS, COUNT, MEAN
from raylab.rng import mix, uniform
from raylab.stats.intervals import quantile
from raylab.stress.case import U53, Found, case
from raylab.stress.stiff_lights import SAME

Array = npt.NDArray[np.float64]
GOLDEN = 0x9E3779B97F4A7C15
ENDS = np.arange(4096, dtype=np.uint64)  # how far below the largest word
FAR = 4.5  # standard errors


@njit
def _uniforms(bits, numbers):
    for i in range(len(bits)):
        numbers[i] = uniform(bits[i])


@njit
def _mixed(bits, mixed):
    for i in range(len(bits)):
        mixed[i] = mix(bits[i])


@njit
def _draw(sampler, places, numbers):
    """The first number of the samples (pixel, stream, sample)."""
    for i in range(len(places)):
        numbers[i] = sampler.stream(places[i, 0], places[i, 1], places[i, 2]).number()


@njit
def _means(sampler, samples, means):
    """Of exp(-u1^2 - u2^2) over a stream of each trial: means (streams, trials)."""
    for stream in range(len(means)):
        for trial in range(means.shape[1]):
            total = 0.0
            for sample in range(samples):
                u = sampler.stream(trial, stream, sample).square()
                total += math.exp(-u[0] * u[0] - u[1] * u[1])
            means[stream, trial] = total / samples


def uniforms(bits: npt.NDArray[np.uint64]) -> Array:
    numbers = np.empty(len(bits))
    _uniforms(bits, numbers)
    return numbers


def first(seed: int, places: npt.ArrayLike, sampler: str = "independent") -> Array:
    """The first numbers of samples, rows (pixel, stream, sample)."""
    places = np.asarray(places, np.int64)
    numbers = np.empty(len(places))
    _draw(samplers.make(sampler, seed, 16), places, numbers)
    return numbers


def along(axis: int, n: int, fixed: int = 0) -> npt.NDArray[np.int64]:
    """n places of which one index runs; `fixed` is the stream where another does."""
    places = np.zeros((n, 3), np.int64)
    places[:, 1] = fixed
    places[:, axis] = np.arange(n)
    return places


def related(a: Array, b: Array, shifts: int = 4) -> float:
    """Largest sqrt(n) |correlation| of two sequences, shifted by up to some places; infinite where numbers repeat."""
    found = 0.0
    for shift in range(-shifts, shifts + 1):
        p, q = a[max(shift, 0) : len(a) + min(shift, 0)], b[max(-shift, 0) : len(b) - max(shift, 0)]
        if (p == q).any():
            return math.inf
        found = max(found, abs(float(np.corrcoef(p, q)[0, 1])) * math.sqrt(len(p)))
    return found


@case(
    "F01", "the 4096 largest of 32 random bits", usual="word * 2^-32 in float32", rule="53 bits in float64",
    truth="below 1", unit="numbers that are 1", allowed=0.0,
)  # fmt: skip
def words_of_32_bits() -> Found:
    words = np.uint64(2**32 - 1) - ENDS
    usual = words.astype(np.float32) * np.float32(2.0**-32)
    ours = uniforms((words << np.uint64(32)) | np.uint64(2**32 - 1))
    return Found(int((ours >= 1.0).sum()), int((usual >= 1.0).sum()))


@case(
    "F02", "the 4096 largest of 64 random bits", usual="word * 2^-64", rule="(word >> 11) * 2^-53",
    truth="at most 1 - 2^-53", unit="numbers above that", allowed=0.0,
)  # fmt: skip
def words_of_64_bits() -> Found:
    words = np.uint64(2**64 - 1) - ENDS
    usual = words.astype(np.float64) * 2.0**-64
    return Found(int((uniforms(words) > 1.0 - U53).sum()), int((usual > 1.0 - U53).sum()))


@case(
    "F03", "the 4096 largest numbers, where they are used", usual="rounded to float32",
    rule="float64 up to the map of the square (a time is rounded, and may be 1)", truth="below 1",
    unit="numbers that are 1", allowed=0.0,
)  # fmt: skip
def rounded_numbers() -> Found:
    numbers = uniforms((np.uint64(2**53 - 1) - ENDS) << np.uint64(11))
    return Found(int((numbers >= 1.0).sum()), int((numbers.astype(np.float32) >= 1.0).sum()))


@case(
    "F04", "the smallest step between two numbers, for events of probability 1e-11", usual="32 bits: 2.3e-10",
    rule="53 bits, those of Sobol' points below 2^-32 random", truth="2^-53", unit="step", allowed=U53,
)  # fmt: skip
def rare_events() -> Found:
    steps = [float(np.diff(uniforms(np.array([0, 2048], np.uint64)))[0])]
    for name in ("independent", "stratified", "latin", "sobol"):
        numbers = first(7, along(2, 10_000), name)
        coarse = int((np.ldexp(numbers, 32) % 1.0 == 0.0).sum())  # 2^-21 of them are
        steps.append(2.0**-32 if coarse > 3 else U53)
    return Found(max(steps), 2.0**-32)


@case(
    "F05", "seeds s and s + 2^64 / golden ratio, s = 0, 1, 12345", usual="SplitMix64: the same stream, one later",
    rule="each index is mixed into the key of the next", truth="independent numbers",
    unit="sqrt(n) times the largest correlation, infinite where numbers repeat", allowed=FAR,
)  # fmt: skip
def seeds_of_one_sequence() -> Found:
    ours = usual = 0.0
    for seed in (0, 1, 12345):
        other = (seed + GOLDEN) % 2**64
        other -= 2**64 if other >= 2**63 else 0
        for axis in (0, 1, 2):
            places = along(axis, 20_000)
            ours = max(ours, related(first(seed, places), first(other, places)))
        usual = max(usual, related(split_mix(seed), split_mix(seed + GOLDEN)))
    return Found(ours, usual)


def split_mix(seed: int, n: int = 1000) -> Array:
    """SplitMix64: the state goes up by 2^64 / golden ratio."""
    bits = np.array([(seed + (i + 1) * GOLDEN) % 2**64 for i in range(n)], np.uint64)
    mixed = np.empty_like(bits)
    _mixed(bits, mixed)
    return uniforms(mixed)


@case(
    "F06", "the first number of 10,000 pixels, seeds 0 to 3", usual="a 32-bit LCG seeded with the pixel",
    rule="each index is mixed into the key of the next", truth="uniform and independent", allowed=1.0,
    unit="largest of Kolmogorov's distance over its 1e-6 quantile, correlation of neighbours over 4.5 standard errors",
)  # fmt: skip
def first_numbers() -> Found:
    n = 10_000

    def share(numbers: Array) -> float:
        ordered, steps = np.sort(numbers), np.arange(n + 1) / n
        distance = max(np.abs(ordered - steps[1:]).max(), np.abs(ordered - steps[:-1]).max()) * math.sqrt(n)
        return float(max(distance / SAME, abs(np.corrcoef(numbers[1:], numbers[:-1])[0, 1]) * math.sqrt(n) / FAR))

    usual = (np.arange(n, dtype=np.uint64) * np.uint64(1664525) + np.uint64(1013904223)) % np.uint64(2**32)
    return Found(max(share(first(seed, along(0, n))) for seed in range(4)), share(usual / 2.0**32))


@case(
    "F07", "eight streams of one seed", usual="PCG32 with increments 1, 3, 5, ...",
    rule="each index is mixed into the key of the next", truth="independent numbers",
    unit="sqrt(n) times the largest correlation of two, infinite where numbers repeat", allowed=FAR,
)  # fmt: skip
def streams_of_one_seed() -> Found:
    def worst(streams: list[Array]) -> float:
        return max(related(a, b) for i, a in enumerate(streams) for b in streams[:i])

    return Found(worst([first(3, along(2, 20_000, s)) for s in range(8)]), worst([pcg(s) for s in range(8)]))


def pcg(stream: int, n: int = 20_000) -> Array:
    """PCG32 (O'Neill 2014), XSH RR, seeded with 42 as its author does."""
    a, c, words = 6364136223846793005, 2 * stream + 1, []
    state = (c + 42) * a + c
    for _ in range(n):
        old, state = state % 2**64, (state * a + c) % 2**64
        word, turn = (((old >> 18) ^ old) >> 27) & 0xFFFFFFFF, old >> 59
        words.append(((word >> turn) | (word << (-turn & 31))) & 0xFFFFFFFF)
    return np.array(words) / 2.0**32


@case(
    "F08", "the first Sobol' point of 100,000 pixels", usual="not scrambled: (0, 0)", rule="Owen-scrambled, 53 bits",
    truth="between 0 and 1", unit="numbers that are 0 or 1", allowed=0.0,
)  # fmt: skip
def first_sobol_points() -> Found:
    numbers = first(5, along(0, 100_000), "sobol")
    return Found(int(((numbers <= 0.0) | (numbers >= 1.0)).sum()), 100_000 * int(samplers.sobol_table()[0, 0] == 0))


@case(
    "F09", "intervals for the mean of exp(-u1^2 - u2^2) over 1024 Owen-scrambled points, 1000 times",
    usual="the standard error of independent samples", rule="16 streams scrambled independently are compared",
    truth="95 % of the intervals hold the integral", unit="error of that share", allowed=0.04,
)  # fmt: skip
def intervals_of_sobol_points() -> Found:
    streams, trials, samples = 16, 1000, 1024
    means = np.empty((streams, trials))
    _means(samplers.make("sobol", 11, samples), samples, means)
    pixels = np.zeros((streams, 1, trials, COLUMNS))
    pixels[:, 0, :, MEAN : MEAN + 3] = means[..., None]
    pixels[..., COUNT] = samples
    mean, error, _ = estimate(pixels, independent=False)
    one, square = math.erf(1.0) * math.sqrt(math.pi) / 2.0, math.erf(math.sqrt(2.0)) * math.sqrt(math.pi / 8.0)
    off = np.abs(mean[0, :, 0] - one**2)
    usual = 1.96 * math.sqrt((square**2 - one**4) / (streams * samples))
    held = [float((off <= reach).mean()) for reach in (quantile(streams - 1.0) * error[0, :, 0], usual)]
    return Found(abs(held[0] - 0.95), abs(held[1] - 0.95))


@case(
    "F11", "3840 x 2160 pixels of 1024 samples, and indices around 2^31 and 2^32",
    usual="pixel * 1024 + sample in int32", rule="indices of 64 bits, mixed one after the other",
    truth="another number everywhere", unit="numbers that repeat", allowed=0.0,
)  # fmt: skip
def many_samples() -> Found:
    pixels = [0, 1, 2**22, 2**22 + 1, 3840 * 2160 - 1, 2**31 - 1, 2**31, 2**32 - 1, 2**32, 2**32 + 1]
    places = np.array([(p, 0, s) for p in pixels for s in (0, 1, 255, 1023, 2**30 - 1, 2**31, 2**32)])
    numbers, screen = first(1, places), places[(places[:, 0] < 3840 * 2160) & (places[:, 2] < 1024)]
    indices = (screen[:, 0] * 1024 + screen[:, 2]).astype(np.int32)
    return Found(len(numbers) - len(set(numbers.tolist())), len(indices) - len(set(indices.tolist())))
