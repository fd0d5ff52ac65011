"""Owen-scrambled Sobol' points, eight dimensions at a time; the sampler `sobol` of `raylab.samplers`."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from raylab.jit import njit
from raylab.record import record
from raylab.rng import Counter, combine, u64
from raylab.view import View

_M32 = 0xFFFFFFFF
SOBOL_DIMENSIONS = 8  # a block of dimensions that one Sobol' sequence serves; later blocks are shuffled anew
TABLE_BITS = 12  # points 0 .. 4095 are tabulated, the further ones are differences to them

# Primitive polynomials and initial numbers of dimensions 2, 3, 4, 5, 7, 6 and 8 (degree, coefficients, m): Joe and
# Kuo 2008, "Constructing Sobol sequences with better two-dimensional projections". Points of the unit square are made
# of two neighbours: in this order of the dimensions the first 2^k of them put their share into every box of area
# 2^(t-k), with t = 0 for the first pair and at most 2 for the others up to k = 12.
_JOE_KUO = (
    (1, 0, (1,)), (2, 1, (1, 3)), (3, 1, (1, 3, 1)), (3, 2, (1, 1, 1)), (4, 4, (1, 3, 5, 13)), (4, 1, (1, 1, 3, 3)),
    (5, 2, (1, 1, 5, 5, 17)),
)  # fmt: skip


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
    table: View  # (SOBOL_DIMENSIONS, 2^TABLE_BITS) uint32
    columns: View  # (SOBOL_DIMENSIONS, 32) uint32

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
    """The sample's number in the sequence that serves the `block`-th eight dimensions."""
    if block == 0:
        return stream.place
    return shuffle_index(stream.place, combine(stream.key, -block))


@njit
def sobol_number(stream, d, index):
    """Coordinate d of point `index`, Owen-scrambled."""
    axis = d & (SOBOL_DIMENSIONS - 1)
    x = u64(stream.table[axis, index & ((1 << TABLE_BITS) - 1)])
    rest, bit = index >> TABLE_BITS, TABLE_BITS
    while rest != 0:
        if rest & 1:
            x ^= u64(stream.columns[axis, bit])
        rest >>= 1
        bit += 1
    return scrambled(x, combine(stream.key, d))


@njit
def scrambled(x, seed):
    """A reversed 32-bit fraction, Owen-scrambled, as a float64; random digits below 2^-32 fill up 53 bits."""
    x = reverse_bits(scramble_reversed(x, seed))
    digits = u64(u64(x ^ (seed >> u64(32))) * u64(0x9E3779B97F4A7C15)) >> u64(43)
    return ((x << u64(21)) | digits) * 1.1102230246251565e-16


@record
class SobolLanes(NamedTuple):
    """The points of a packet, drawn side by side: the same numbers, in a loop that the compiler makes a vector loop."""

    sampler: Any
    packet: Any
    pixel: int
    streams: int
    first: int
    last: int

    def number(self, row):
        d = self.sampler.counter.next[0]
        self.sampler.counter.next[0] = d + 1
        draw_rows(self, row, d, 1)

    def squares(self, row, count):
        d = self.sampler.counter.next[0]
        d += d & 1
        self.sampler.counter.next[0] = d + 2 * count
        draw_rows(self, row, d, 2 * count)


@njit
def draw_rows(lanes, row, first_dimension, count):
    """Coordinates first_dimension, first_dimension + 1, ... of each lane's point into rows row, row + 1, ..."""
    sampler, first, share = lanes.sampler, lanes.first, lanes.last - lanes.first
    for stream in range(lanes.streams):
        key, lane = combine(combine(sampler.seed, lanes.pixel), stream), stream * share
        for k in range(count):
            d = first_dimension + k
            if d < SOBOL_DIMENSIONS and lanes.last <= 1 << TABLE_BITS:
                seed = combine(key, d)
                for i in range(share):
                    lanes.packet.keep(row + k, lane + i, scrambled(u64(sampler.table[d, first + i]), seed))
            else:
                for i in range(share):
                    point = SobolStream(key, first + i, sampler.table, sampler.columns, sampler.counter)
                    index = block_index(point, d // SOBOL_DIMENSIONS)
                    lanes.packet.keep(row + k, lane + i, sobol_number(point, d, index))


@record
class Sobol(NamedTuple):
    """Owen-scrambled Sobol' points, eight dimensions at a time."""

    seed: int
    table: View
    columns: View
    counter: Counter

    def stream(self, pixel, stream, sample):
        self.counter.next[0] = 0
        key = combine(combine(self.seed, pixel), stream)
        return SobolStream(key, sample, self.table, self.columns, self.counter)

    def lanes(self, packet, pixel, streams, first, last):
        self.counter.next[0] = 0
        return SobolLanes(self, packet, pixel, streams, first, last)


@cache
def sobol_columns() -> np.ndarray:
    """Generator matrices (8, 32) uint32, bit-reversed: column k is XORed in when bit k of the index is set."""
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
    """The first 2^TABLE_BITS points (8, 2^TABLE_BITS) uint32, bit-reversed."""
    table = np.zeros((SOBOL_DIMENSIONS, 1 << TABLE_BITS), np.uint32)
    for k in range(TABLE_BITS):
        table[:, 1 << k : 2 << k] = table[:, : 1 << k] ^ sobol_columns()[:, k : k + 1]
    return table
