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

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from raylab.jit import njit
from raylab.record import record
from raylab.rng import combine, mix, permute, u64, uniform
from raylab.view import View

_M32 = 0xFFFFFFFF
SOBOL_DIMENSIONS = 4  # a block of dimensions that one Sobol' sequence serves; later blocks are shuffled anew
TABLE_BITS = 12  # points 0 .. 4095 are tabulated, the further ones are differences to them

# Primitive polynomials and initial numbers of dimensions 2 to 4 (degree, coefficients, m): Joe and Kuo 2008,
# "Constructing Sobol sequences with better two-dimensional projections".
_JOE_KUO = ((1, 0, (1,)), (2, 1, (1, 3)), (3, 1, (1, 3, 1)))


class Counter(NamedTuple):
    """The dimension that the current sample draws next; one array for each thread."""

    next: View


def new_counter() -> Counter:
    return Counter(View(np.zeros(1, np.int64)))


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


# --- Owen-scrambled Sobol' ---


@njit
def reverse_bits(x):
    """The 32 bits of x in the opposite order."""
    x = u64(x)
    x = ((x >> u64(1)) & u64(0x55555555)) | ((x & u64(0x55555555)) << u64(1))
    x = ((x >> u64(2)) & u64(0x33333333)) | ((x & u64(0x33333333)) << u64(2))
    x = ((x >> u64(4)) & u64(0x0F0F0F0F)) | ((x & u64(0x0F0F0F0F)) << u64(4))
    x = ((x >> u64(8)) & u64(0x00FF00FF)) | ((x & u64(0x00FF00FF)) << u64(8))
    return ((x >> u64(16)) | (x << u64(16))) & u64(_M32)


@njit
def scramble_reversed(x, seed):
    """Nested uniform (Owen) scramble of a 32-bit fraction whose bits stand in reversed order.

    Each step lets a bit depend on lower ones only, which in reversed order are the more significant digits.
    Source: Laine and Karras 2011, "Stratified sampling for stochastic transparency", with the constants of
    Vegdahl 2021, "Building a better LK hash".
    """
    x, seed, m32 = u64(x), u64(seed) & u64(_M32), u64(_M32)
    x = (x ^ (x * u64(0x3D20ADEA))) & m32
    x = (x + seed) & m32
    x = (x * ((seed >> u64(16)) | u64(1))) & m32
    x = (x ^ (x * u64(0x05526C56))) & m32
    return (x ^ (x * u64(0x53A22864))) & m32


@njit
def shuffle_index(i, seed):
    """A nested shuffle of sample numbers that keeps every range [2^k, 2^(k+1)), and so each prefix of 2^k."""
    if i < 2:
        return i
    bits = 1
    while (i >> (bits + 1)) != 0:
        bits += 1
    low = i & ((1 << bits) - 1)
    scrambled = reverse_bits(scramble_reversed(reverse_bits(low << (32 - bits)), seed))
    return (1 << bits) | int(scrambled >> u64(32 - bits))


@record
class SobolStream(NamedTuple):
    """Point `place` of a sequence scrambled by `key`; `table` holds reversed points, `columns` the generators."""

    key: int
    place: int
    table: View  # (4, 2^TABLE_BITS) uint32
    columns: View  # (4, 32) uint32

    counter: Counter

    def number(self):
        d = self.counter.next[0]
        self.counter.next[0] = d + 1
        return sobol_number(self, d, block_index(self, d // SOBOL_DIMENSIONS))

    def square(self):
        d = self.counter.next[0]
        d += d & 1  # pairs of dimensions (0, 1), (2, 3): the best two-dimensional projections
        self.counter.next[0] = d + 2
        index = block_index(self, d // SOBOL_DIMENSIONS)
        return sobol_number(self, d, index), sobol_number(self, d + 1, index)


@njit
def block_index(stream, block):
    """The sample's number in the sequence that serves the `block`-th four dimensions."""
    if block == 0:
        return stream.place
    return shuffle_index(stream.place, combine(stream.key, -block))


@njit
def sobol_number(stream, d, index):
    """Coordinate d of point `index`, Owen-scrambled; random digits below 2^-32 fill up 53 bits."""
    axis = d & (SOBOL_DIMENSIONS - 1)
    x = u64(stream.table[axis, index & ((1 << TABLE_BITS) - 1)])
    rest, bit = index >> TABLE_BITS, TABLE_BITS
    while rest != 0:
        if rest & 1:
            x ^= u64(stream.columns[axis, bit])
        rest >>= 1
        bit += 1
    seed = combine(stream.key, d)
    x = reverse_bits(scramble_reversed(x, seed))
    digits = u64(u64(x ^ (seed >> u64(32))) * u64(0x9E3779B97F4A7C15)) >> u64(43)
    return ((x << u64(21)) | digits) * 1.1102230246251565e-16


@record
class Sobol(NamedTuple):
    """Owen-scrambled Sobol' points, four dimensions at a time."""

    seed: int
    table: View
    columns: View
    counter: Counter

    def stream(self, pixel, stream, sample):
        self.counter.next[0] = 0
        key = combine(combine(self.seed, pixel), stream)
        return SobolStream(key, sample, self.table, self.columns, self.counter)


@cache
def sobol_columns() -> np.ndarray:
    """Generator matrices (4, 32) uint32, bit-reversed: column k is XORed in when bit k of the index is set."""
    columns = np.zeros((SOBOL_DIMENSIONS, 32), np.uint32)
    columns[0] = 1 << np.arange(32, dtype=np.uint64)
    for axis, (degree, coefficients, initial) in enumerate(_JOE_KUO, start=1):
        v = [m << (31 - k) for k, m in enumerate(initial)]
        for k in range(degree, 32):
            bits = v[k - degree] ^ (v[k - degree] >> degree)
            for j in range(1, degree):
                if (coefficients >> (degree - 1 - j)) & 1:
                    bits ^= v[k - j]
            v.append(bits)
        columns[axis] = [int(f"{bits:032b}"[::-1], 2) for bits in v]
    return columns


@cache
def sobol_table() -> np.ndarray:
    """The first 2^TABLE_BITS points (4, 2^TABLE_BITS) uint32, bit-reversed."""
    table = np.zeros((SOBOL_DIMENSIONS, 1 << TABLE_BITS), np.uint32)
    for k in range(TABLE_BITS):
        table[:, 1 << k : 2 << k] = table[:, : 1 << k] ^ sobol_columns()[:, k : k + 1]
    return table


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
