"""Sobol' points: nets in base 2 and the published table; Owen scrambling and shuffled blocks."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import ALPHA, chi_square_p, size
from scipy import stats
from scipy.stats import qmc
from test_samplers import numbers, points

from raylab import sobol
from raylab.rng import combine

M32 = 0xFFFFFFFF


def is_net(p, t=0):
    """Is p, 2^m points, a (t, m, s)-net in base 2: 2^t points in every elementary interval of volume 2^(t - m)?"""
    m, s = len(p).bit_length() - 1, p.shape[1]
    shapes = [k for k in np.ndindex((max(0, m - t) + 1,) * s) if sum(k) == max(0, m - t)]
    for shape in shapes:
        index = np.zeros(len(p), np.int64)
        for axis, k in enumerate(shape):
            index = (index << k) + (p[:, axis] * 2.0**k).astype(np.int64)
        if not np.all(np.bincount(index, minlength=len(p) >> min(t, m)) == 1 << min(t, m)):
            return False
    return True


MAX_M = size(10, 6)
FIRST_PAIRS = [0, 4]  # pairs of dimensions (0, 1) and (8, 9): the first two of each block of eight


@pytest.mark.parametrize("pixel", [0, 12345])
def test_sobol_pairs_are_nets_for_every_prefix_and_every_later_block_of_points(pixel):
    p = points("sobol", 2 << MAX_M, pairs=6, pixel=pixel)
    for m in range(MAX_M + 1):
        n = 1 << m
        for k in FIRST_PAIRS:
            assert is_net(p[:n, k])
            assert is_net(p[n : 2 * n, k])
            assert is_net(p[-n:, k])
    assert not is_net(np.random.default_rng(1).random((64, 2)))  # the check can fail


def test_the_first_four_dimensions_of_a_sobol_block_are_nets_of_quality_three():
    # Sobol' 1967: t = sum of (degree - 1) of the primitive polynomials, here 0 + 0 + 1 + 2
    p = points("sobol", 1 << size(8, 5), pairs=6)
    for block in (0, 4):
        assert is_net(p[:, block : block + 2].reshape(len(p), 4), t=3)


def test_every_sobol_pair_is_a_net_of_quality_two_for_every_prefix():
    p = points("sobol", 1 << MAX_M, pairs=8)
    for m in range(MAX_M + 1):
        for k in range(8):
            assert is_net(p[: 1 << m, k], t=2)


def test_sobol_numbers_are_stratified_for_every_prefix():
    u = numbers("sobol", 1 << MAX_M, 9)
    for m in range(MAX_M + 1):
        for k in range(9):
            assert is_net(u[: 1 << m, k : k + 1])


def test_a_sobol_square_starts_at_an_even_dimension():
    assert np.array_equal(points("sobol", 8, lone=1), points("sobol", 8, pairs=2)[:, 1:])
    u, p = numbers("sobol", 8, 2), points("sobol", 8)
    assert np.array_equal(u, p[:, 0])


def test_sobol_streams_are_scrambled_apart():
    p = np.stack([points("sobol", 64, pairs=4, pixel=i, stream=j, seed=k) for i, j, k in np.ndindex(2, 2, 2)])
    assert len(np.unique(p)) == p.size


def reversed_bits(x):
    return int(f"{int(x):032b}"[::-1], 2)


def unscrambled(first, n):
    """n points of scipy, 32 digits, from its number `first` on, and their numbers: it walks in Gray-code order."""
    engine = qmc.Sobol(8, scramble=False, bits=32)
    i = np.arange(first, first + n)
    drawn = ((engine.fast_forward(first) if first else engine).random(n) * 2.0**32).astype(np.uint64)
    return i ^ (i >> 1), drawn[:, [0, 1, 2, 3, 4, 6, 5, 7]]  # the pairs that go best together, see `raylab.sobol`


def test_the_table_is_the_sequence_of_joe_and_kuo():
    index, want = unscrambled(0, 4096)
    table = sobol.sobol_table()
    assert table.shape == (8, 4096)
    for axis in range(8):
        assert [reversed_bits(x) for x in table[axis, index]] == want[:, axis].tolist()


@pytest.mark.parametrize("first", [0, 4096, 3 << 12, 5 << 16])
def test_points_beyond_the_table_are_the_sequence_too(first):
    index, want = unscrambled(first, 64)
    drawn = numbers("sobol", index, 8)
    key = combine(np.uint64(combine(np.uint64(0), 0)), 0)
    for axis in range(8):
        seed = np.uint64(combine(np.uint64(key), axis))
        digits = [reversed_bits(scramble(reversed_bits(x), seed)) for x in want[:, axis]]
        assert np.floor(drawn[:, axis] * 2.0**32).astype(np.int64).tolist() == digits


def scramble(x, seed):
    return int(sobol.scramble_reversed(np.uint64(x), np.uint64(seed)))


def test_the_scramble_keeps_common_digits_and_tells_the_next_apart():
    """Nested: if two numbers first differ in digit k, so do their images. Hence it is a bijection."""
    rng = np.random.default_rng(2)
    for _ in range(size(20, 4)):
        seed, x = int(rng.integers(2**32)), int(rng.integers(2**32))
        for k in range(32):  # reversed: digit k is bit k
            y = (x ^ (1 << k) ^ (int(rng.integers(2**32)) << (k + 1))) & M32
            difference = scramble(x, seed) ^ scramble(y, seed)
            assert difference & ((2 << k) - 1) == 1 << k
            assert difference <= M32


def test_reverse_bits_reverses():
    for x in (0, 1, M32, 0x12345678, 1 << 31):
        assert int(sobol.reverse_bits(np.uint64(x))) == reversed_bits(x)


def test_the_scramble_uses_all_of_its_seed():
    assert len({scramble(0x12345678, 1 << k) for k in range(32)}) == 32


def test_points_are_uniform_over_the_scrambles():
    n, side = size(50_000, 2_000), size(16, 4)
    for index in (0, 5, 9000):
        p = points("sobol", np.full(n, index), pairs=3, pixel=np.arange(n))
        for pair in (p[:, 0], p[:, 1], p[:, 2], p[:, :2, 0], p[:, ::2, 0]):
            counts, *_ = np.histogram2d(*pair.T, bins=side, range=[[0, 1], [0, 1]])
            assert chi_square_p(counts, np.full(side**2, n / side**2)) > ALPHA
        distance = stats.kstest(p[:, 0, 0], "uniform").statistic
        assert 2.0 * math.exp(-2.0 * n * distance**2) > ALPHA


def test_the_two_halves_of_a_stream_are_scrambled_independently():
    """Owen's scramble: below the first digit, the points 0 and 1 (which differ there) are independent."""
    n, side = size(100_000, 2_000), size(16, 4)
    p = points("sobol", np.tile([0, 1], n), pixel=np.repeat(np.arange(n), 2))[:, 0, 0].reshape(n, 2)
    inside = (p * 2.0) % 1.0
    counts, *_ = np.histogram2d(*inside.T, bins=side, range=[[0, 1], [0, 1]])
    assert chi_square_p(counts, np.full(side**2, n / side**2)) > ALPHA


def test_blocks_of_dimensions_are_shuffled_apart():
    """Dimensions 0 and 4 are one sequence. Of 8 x 8 cells, 64 points in step would fill 8, at random 43.5."""
    p = points("sobol", np.tile(np.arange(64, 128), 20), pairs=3, pixel=np.repeat(np.arange(20), 64))
    cell = np.floor(p[:, ::2, 0] * 8).reshape(20, 64, 2)
    filled = [len(np.unique(pixel, axis=0)) for pixel in cell]
    assert min(filled) > 32


@pytest.mark.parametrize("bits", [1, 3, 6])
def test_the_shuffle_of_points_keeps_every_dyadic_range(bits):
    for seed in (1, 2**32 + 5):
        low, high = 1 << bits, 2 << bits
        image = [int(sobol.shuffle_index(i, np.uint64(seed))) for i in range(high)]
        assert sorted(image[low:high]) == list(range(low, high))
        assert image[:2] == [0, 1]
