"""Samplers: where the random points of a sample come from.

A sampler gives each sample of each pixel a stream of numbers; the stream is what a slide's `sample(...)` draws from:
`rng.number()` is uniform in [0, 1), `rng.square()` in the unit square. A sample draws dimension after dimension;
what a scene does not need (a lens, a shutter) it does not draw, so no dimension is spent on it.

`independent` numbers are unrelated. `stratified` points fall one into each cell of a grid over the unit square, for
each pair of dimensions. `latin` numbers (a Latin hypercube) fall one into each of n intervals, for each dimension, in
an order of its own. `sobol` points are an Owen-scrambled Sobol' sequence, good at each prefix of 2^k points.
`centre` is not random: every point is the middle of its square.
The points of all but the first depend on one another within a stream, so an honest standard error compares several
streams, which are scrambled independently (randomised quasi-Monte Carlo).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from raylab.jit import njit
from raylab.lanes import one_by_one
from raylab.record import record
from raylab.rng import Counter, combine, mix, new_counter, permute, uniform
from raylab.sobol import Sobol, sobol_columns, sobol_table
from raylab.view import View

# --- centre ---


@record
class CentreStream(NamedTuple):
    """Every point is the middle of the square."""

    counter: Counter

    def number(self):
        return 0.5

    def square(self):
        return 0.5, 0.5


@record
class Centre(NamedTuple):
    """One ray through the centre of each pixel (slide "Basic ray tracing"); one sample says all there is."""

    counter: Counter

    def stream(self, pixel, stream, sample):
        return CentreStream(self.counter)

    def lanes(self, packet, pixel, streams, first, last):
        return one_by_one(self, packet, pixel, streams, first, last)


# --- independent ---


@record
class IndependentStream(NamedTuple):
    """Unrelated numbers."""

    key: int
    counter: Counter

    def number(self):
        d = self.counter.next[0]
        self.counter.next[0] = d + 1
        return uniform(combine(self.key, d))

    def square(self):
        d = self.counter.next[0]
        self.counter.next[0] = d + 2
        return uniform(combine(self.key, d)), uniform(combine(self.key, d + 1))


@record
class Independent(NamedTuple):
    """Independent samples."""

    seed: int
    counter: Counter

    def stream(self, pixel, stream, sample):
        self.counter.next[0] = 0
        return IndependentStream(combine(combine(combine(self.seed, pixel), stream), sample), self.counter)

    def lanes(self, packet, pixel, streams, first, last):
        return one_by_one(self, packet, pixel, streams, first, last)


# --- stratified ---


@record
class StratifiedStream(NamedTuple):
    """Point `place` of a jittered grid of `across` x `down` cells, in another order in each pair of dimensions."""

    key: int
    place: int
    across: int
    down: int
    counter: Counter

    def number(self):
        d = self.counter.next[0]
        self.counter.next[0] = d + 1
        key, n = combine(self.key, d), self.across * self.down
        return stratum(permute(self.place, n, key), n, combine(key, n + self.place))

    def square(self):
        d = self.counter.next[0]
        self.counter.next[0] = d + 2
        key, n = combine(self.key, d), self.across * self.down
        cell = permute(self.place, n, key)
        jitter = combine(key, n + self.place)
        u = stratum(cell % self.across, self.across, jitter)
        return u, stratum(cell // self.across, self.down, mix(jitter))


@njit
def stratum(i, n, bits):
    """A random point of the i-th of n equal intervals of [0, 1), never the next interval's first."""
    return min((i + uniform(bits)) / n, np.nextafter((i + 1.0) / n, 0.0))


@record
class Stratified(NamedTuple):
    """`across` x `down` samples for each grid; further samples begin a new grid."""

    seed: int
    across: int
    down: int
    counter: Counter

    def stream(self, pixel, stream, sample):
        self.counter.next[0] = 0
        n = self.across * self.down
        key = combine(combine(combine(self.seed, pixel), stream), sample // n)
        return StratifiedStream(key, sample % n, self.across, self.down, self.counter)

    def lanes(self, packet, pixel, streams, first, last):
        return one_by_one(self, packet, pixel, streams, first, last)


# --- Latin hypercube ---


@record
class LatinStream(NamedTuple):
    """Interval `place` of `n`, in another order in each dimension: McKay, Beckman, Conover 1979."""

    key: int
    place: int
    n: int
    counter: Counter

    def number(self):
        d = self.counter.next[0]
        self.counter.next[0] = d + 1
        return latin_number(self, d)

    def square(self):
        d = self.counter.next[0]
        self.counter.next[0] = d + 2
        return latin_number(self, d), latin_number(self, d + 1)


@njit
def latin_number(stream, d):
    """A random point of the interval that dimension d's permutation gives to this sample."""
    key = combine(stream.key, d)
    return stratum(permute(stream.place, stream.n, key), stream.n, combine(key, stream.n + stream.place))


@record
class Latin(NamedTuple):
    """`n` samples for each hypercube; further samples begin a new one."""

    seed: int
    n: int
    counter: Counter

    def stream(self, pixel, stream, sample):
        self.counter.next[0] = 0
        key = combine(combine(combine(self.seed, pixel), stream), sample // self.n)
        return LatinStream(key, sample % self.n, self.n, self.counter)

    def lanes(self, packet, pixel, streams, first, last):
        return one_by_one(self, packet, pixel, streams, first, last)


def grid(n: int) -> tuple[int, int]:
    """The most nearly square grid of exactly n cells."""
    down = next(d for d in range(int(n**0.5), 0, -1) if n % d == 0)
    return n // down, down


NAMES = ("independent", "stratified", "latin", "sobol")
ALL_NAMES = (*NAMES, "centre")


def make(name: str, seed: int, samples: int) -> Any:
    """The sampler called `name`; `samples` is the number of samples in one stream (cells, intervals)."""
    if name == "centre":
        return Centre(new_counter())
    if name == "independent":
        return Independent(seed, new_counter())
    if name == "stratified":
        return Stratified(seed, *grid(samples), new_counter())
    if name == "latin":
        return Latin(seed, samples, new_counter())
    return Sobol(seed, View(sobol_table()), View(sobol_columns()), new_counter())
