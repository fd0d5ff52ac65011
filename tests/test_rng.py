"""Random numbers: bijections, known answers, and statistics of neighbours in every counter."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from helpers import ALPHA, COMPILED, chi_square_p, size
from scipy import stats

from raylab import samplers
from raylab.jit import njit
from raylab.rng import combine, mix, permute, u64, uniform

M64 = 2**64 - 1
GOLDEN = 0x9E3779B97F4A7C15


def finalise(z):
    """SplitMix64's output function, written anew from Steele, Lea and Flood 2014 with Stafford's variant 13."""
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9 % 2**64
    z = (z ^ (z >> 27)) * 0x94D049BB133111EB % 2**64
    return z ^ (z >> 31)


def bits(n, seed):
    return [int(b) for b in np.random.default_rng(seed).integers(0, 2**64, n, np.uint64)]


def test_mix_gives_the_published_numbers_of_splitmix64():
    # Rosetta Code, "Pseudo-random numbers/Splitmix64", seed 1234567
    published = [
        6457827717110365317, 3203168211198807973, 9817491932198370423, 4593380528125082431, 16408922859458223821,
    ]  # fmt: skip
    assert [int(mix((1234567 + k * GOLDEN) & M64)) for k in range(1, 6)] == published


def test_mix_and_combine_agree_with_plain_integers():
    for x, y in zip(bits(200, 1), bits(200, 2), strict=True):
        assert int(mix(x)) == finalise(x)
        assert int(combine(x, y)) == finalise(x ^ (y + 1) * GOLDEN % 2**64)
    for counter in (0, 1, -1, -5, 2**63 - 1, -(2**63)):
        assert int(combine(7, counter)) == finalise(7 ^ (counter + 1) * GOLDEN % 2**64)


def test_every_input_bit_of_mix_reaches_every_output_bit():
    reached = np.zeros(64, object)
    for x in bits(40, 3):  # a bit that depends would stay unseen with probability 2^-40
        reached |= np.array([int(mix(x)) ^ int(mix(x ^ (1 << k))) for k in range(64)], object)
    assert np.all(reached == M64)


@njit
def convert(x):
    return u64(x)


@pytest.mark.parametrize("x", [0, 1, -1, 2**63, 2**64 - 1, -(2**63)])
def test_u64_is_modulo_2_to_the_64(x):
    assert int(convert(x)) == x % 2**64


def test_uniform_is_a_multiple_of_two_to_the_minus_53_below_one():
    assert uniform(0) == 0.0
    assert uniform(2**11 - 1) == 0.0
    assert uniform(2**11) == 2.0**-53  # the smallest step
    assert uniform(M64) == 1.0 - 2.0**-53  # the largest value
    for b in bits(100, 4):
        assert uniform(b) == (b // 2**11) / 2**53


# --- numbers of a sampler ---


@njit
def draw(sampler, pixels, streams, samples, dimensions, out):
    """out[k] = the number of dimension dimensions[k] of sample samples[k], asked for alone."""
    for k in range(len(out)):
        stream = sampler.stream(pixels[k], streams[k], samples[k])
        for _ in range(dimensions[k]):
            stream.number()
        out[k] = stream.number()


def numbers(seed, pixels, streams, samples, dimensions):
    counters = np.broadcast_arrays(*(np.asarray(c, np.int64) for c in (pixels, streams, samples, dimensions)))
    flat = [np.ascontiguousarray(c.ravel()) for c in counters]
    out = np.empty(flat[0].size)
    draw(samplers.make("independent", seed, 1), *flat, out)
    return out.reshape(counters[0].shape)


def test_a_number_depends_on_its_counters_alone_and_on_all_of_them():
    side = 4
    grid = np.array(list(itertools.product(range(side), repeat=4))).T
    order = np.random.default_rng(5).permutation(grid.shape[1])
    values = [numbers(seed, *grid) for seed in (0, 1, 2**63 + 5)]
    assert np.array_equal(numbers(0, *grid[:, order]), values[0][order])  # the order of asking does not matter
    # All different: a counter without effect, or two that can be swapped, would repeat numbers. By chance: 3e-11.
    assert len(np.unique(values)) == 3 * side**4


def test_the_value_is_the_documented_chain_of_counters():
    key = 99
    for counter in (3, 1, 4):  # pixel, stream, sample
        key = finalise(key ^ (counter + 1) * GOLDEN % 2**64)
    want = finalise(key ^ (5 + 1) * GOLDEN % 2**64)
    assert numbers(99, [3], [1], [4], [5])[0] == (want >> 11) * 2.0**-53


def test_a_stream_can_be_asked_from_plain_python():
    """Also with the compiler on, for somebody who looks around: the keys are integers of all sizes."""
    sampler = samplers.make("independent", 7, 1)
    stream = sampler.stream(3, 0, 2)
    first, pair, last = stream.number(), stream.square(), stream.number()
    again = sampler.stream(3, 0, 2)
    assert [first, *pair, last] == [again.number() for _ in range(4)]


N, SIDE = size(100_000, 4_000), size(16, 6)
NEIGHBOURS = ["pixel", "stream", "sample", "dimension", "seed"]


def neighbours(which):
    """N numbers, and the numbers whose counter `which` is larger by one."""
    if which == "seed":
        a, b = (np.concatenate([numbers(s + k, np.arange(N // 50), 0, 0, 0) for s in range(50)]) for k in (0, 1))
        return a, b
    counters = {"pixel": 0, "stream": 0, "sample": 0, "dimension": 0}
    counters["sample" if which == "dimension" else which] = np.arange(N)
    if which != "dimension":
        line = numbers(11, *counters.values())
        return line[:-1], line[1:]
    a = numbers(11, *counters.values())
    return a, numbers(11, *(counters | {"dimension": 1}).values())


@pytest.mark.parametrize("which", NEIGHBOURS)
def test_neighbours_are_unrelated(which):
    a, b = neighbours(which)
    assert a.min() >= 0.0
    assert a.max() < 1.0
    limit = stats.norm.isf(ALPHA / 2) / math.sqrt(len(a))  # of the correlation of independent numbers
    assert abs(np.corrcoef(a, b)[0, 1]) < limit
    counts, *_ = np.histogram2d(a, b, bins=SIDE, range=[[0, 1], [0, 1]])
    assert chi_square_p(counts, np.full(SIDE**2, len(a) / SIDE**2)) > ALPHA


def test_numbers_are_uniform():
    values = numbers(12, np.arange(N // 8), 0, 0, np.arange(8)[:, None]).ravel()
    distance = stats.kstest(values, "uniform").statistic
    assert 2.0 * math.exp(-2.0 * len(values) * distance**2) > ALPHA  # Dvoretzky, Kiefer, Wolfowitz, Massart


# --- permutations ---


def test_permute_is_a_bijection_for_every_length():
    for n in range(1, 201):
        for key in (0, M64) if COMPILED or n < 40 else (n,):
            assert sorted(int(permute(i, n, key)) for i in range(n)) == list(range(n))


@pytest.mark.parametrize("n", [2, 3, 4, 5, 7, 8, 16, 25])
def test_every_element_goes_everywhere_equally_often(n):
    keys = bits(size(2000, 150) * n, 6)
    for i in (0, n - 1):
        counts = np.bincount([int(permute(i, n, key)) for key in keys], minlength=n)
        if n == 2:
            assert stats.binomtest(int(counts[0]), len(keys)).pvalue > ALPHA
        else:
            assert chi_square_p(counts, np.full(n, len(keys) / n)) > ALPHA


def test_keys_give_different_permutations():
    seen = {tuple(int(permute(i, 16, key)) for i in range(16)) for key in range(200)}
    assert len(seen) == 200  # of 16! = 2e13: a repetition has the probability 1e-9
