"""Samplers: uniform points, exact grids, the variance of theory."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import ALPHA, COMPILED, chi_square_p, size
from scipy import stats

from raylab import samplers
from raylab.jit import njit


@njit
def draw(sampler, pixels, stream, samples, lone, out):
    """Fill out[i] (pairs, 2) with the squares of sample samples[i] of pixel pixels[i], after `lone` single numbers."""
    for i in range(out.shape[0]):
        source = sampler.stream(pixels[i], stream, samples[i])
        for _ in range(lone):
            source.number()
        for k in range(out.shape[1]):
            out[i, k, 0], out[i, k, 1] = source.square()


@njit
def draw_numbers(sampler, samples, out):
    for i in range(out.shape[0]):
        source = sampler.stream(0, 0, samples[i])
        for k in range(out.shape[1]):
            out[i, k] = source.number()


def points(name, samples, pairs=1, pixel=0, stream=0, lone=0, seed=0, grid=1):
    """Squares (n, pairs, 2) of `samples` (how many, or which), of one pixel or of as many."""
    samples = np.atleast_1d(np.arange(samples) if isinstance(samples, int) else samples)
    pixels, samples = (a.astype(np.int64) for a in np.broadcast_arrays(pixel, samples))
    out = np.empty((len(samples), pairs, 2))
    draw(samplers.make(name, seed, grid), pixels, stream, samples, lone, out)
    assert out.min() >= 0.0
    assert out.max() < 1.0
    return out


def numbers(name, samples, dimensions, grid=1):
    samples = np.arange(samples) if isinstance(samples, int) else samples
    out = np.empty((len(samples), dimensions))
    draw_numbers(samplers.make(name, 0, grid), samples, out)
    return out


def cells(u, n):
    """The number of the cell [i/n, (i+1)/n), edges as rounded, that holds u."""
    return np.searchsorted(np.arange(n + 1) / n, u, side="right") - 1


# --- independent ---


def test_independent_points_are_uniform_in_the_square():
    n, side = size(100_000, 3_600), size(16, 6)
    p = points("independent", n, pairs=2)
    for pair in (p[:, 0], p[:, 1], p[:, :, 0]):  # the last: the first numbers of two squares
        counts, *_ = np.histogram2d(*pair.T, bins=side, range=[[0, 1], [0, 1]])
        assert chi_square_p(counts, np.full(side**2, n / side**2)) > ALPHA


# --- stratified ---


@pytest.mark.parametrize("n", [1, 2, 7, 16, 100])
def test_a_latin_hypercube_has_one_point_in_each_interval_of_each_dimension(n):
    for k in range(2):  # samples n .. 2 n - 1 are a new hypercube
        p = points("latin", np.arange(n) + k * n, pairs=3, grid=n)
        for axis in p.reshape(n, 6).T:
            assert sorted(cells(axis, n)) == list(range(n))


def test_the_dimensions_of_a_latin_hypercube_are_permuted_independently():
    """The pairs of intervals of any two dimensions, over many pixels, each as often; place 0 in each alike."""
    n, pixels = 4, size(8_000, 500)
    p = points("latin", np.tile(np.arange(n), pixels), pairs=2, pixel=np.repeat(np.arange(pixels), n), grid=n)
    cell = cells(p, n).reshape(pixels, n, 4)
    for first, second in ((0, 1), (0, 2), (1, 3)):
        pair = cell[:, 0, first] * n + cell[:, 0, second]  # one sample of each pixel: independent trials
        assert chi_square_p(np.bincount(pair, minlength=n * n), np.full(n * n, pixels / n**2), least=30.0) > ALPHA


@pytest.mark.parametrize("n", [1, 2, 3, 4, 7, 9, 12, 13, 16, 36, 64])
def test_stratified_points_fall_one_into_each_cell_of_each_pair(n):
    across, down = samplers.grid(n)
    assert across * down == n
    for k in range(2):  # samples n .. 2 n - 1 are a new grid
        p = points("stratified", np.arange(n) + k * n, pairs=3, grid=n)
        for pair in p.transpose(1, 2, 0):
            cell = cells(pair[1], down) * across + cells(pair[0], across)
            assert sorted(cell) == list(range(n))


@pytest.mark.parametrize("n", [1, 5, 16])
@pytest.mark.parametrize("name", ["stratified", "latin"])
def test_numbers_fall_one_into_each_interval(name, n):
    u = numbers(name, n, 3, grid=n)
    for k in range(3):
        assert sorted(cells(u[:, k], n)) == list(range(n))


@pytest.mark.parametrize("name", ["stratified", "latin"])
def test_grids_pixels_and_pairs_differ(name):
    n = 16
    p = points(name, 2 * n, pairs=2, grid=n)
    other = points(name, n, pairs=2, pixel=1, grid=n)
    stream = points(name, n, pairs=2, stream=1, grid=n)
    assert len(np.unique(np.concatenate([p, other, stream]))) == 4 * n * 4  # no number twice


def test_a_point_in_its_cell_is_uniform():
    n = size(20_000, 1_000)
    p = points("stratified", np.arange(n), grid=4)[:, 0]
    inside = (p * 2) % 1.0
    counts, *_ = np.histogram2d(*inside.T, bins=3, range=[[0, 1], [0, 1]])
    assert chi_square_p(counts, np.full(9, len(p) / 9)) > ALPHA


@pytest.mark.parametrize(("n", "want"), [(1, (1, 1)), (7, (7, 1)), (12, (4, 3)), (16, (4, 4)), (1000, (40, 25))])
def test_grid_is_the_most_nearly_square_one(n, want):
    assert samplers.grid(n) == want


def test_a_stratum_never_reaches_into_the_next():
    for n in (3, 7, 10, 49, 1000):
        for i in (0, n // 2, n - 1):
            for bits in (0, 2**64 - 1):
                assert i / n <= samplers.stratum(i, n, np.uint64(bits)) < (i + 1) / n


# --- variance ---

RUNS = size(256, 16)
SIZES = [2**k for k in range(4, size(10, 7) + 1)]


def smooth(u):
    """(u e^u)(v e^v), of integral 1 and variance ((e^2 - 1)/4)^2 - 1."""
    return u[..., 0] * np.exp(u[..., 0]) * u[..., 1] * np.exp(u[..., 1])


VARIANCE = ((math.e**2 - 1.0) / 4.0) ** 2 - 1.0


def means(name, n, integrand=smooth):
    """RUNS means of n points each, from as many pixels."""
    p = points(name, np.tile(np.arange(n), RUNS), pixel=1000 * n + np.repeat(np.arange(RUNS), n), grid=n)
    return integrand(p[:, 0]).reshape(RUNS, n).mean(axis=1)


def upper(variance, runs):
    """The upper end of a one-sided confidence interval of a variance, for normally distributed means."""
    return variance * (runs - 1) / stats.chi2.isf(1.0 - ALPHA, runs - 1)


@pytest.mark.parametrize("name", ["independent", "stratified", "latin", "sobol"])
def test_means_are_unbiased_and_no_worse_than_theory(name):
    n = size(256, 64)
    m = means(name, n)
    assert abs(m.mean() - 1.0) < stats.norm.isf(ALPHA / 2) * math.sqrt(VARIANCE / n / RUNS)
    # Owen 1997: n / (n - 1) sigma^2 / n for a Latin hypercube, e sigma^2 / n for nets
    bound = {"independent": 1.0, "stratified": 1.0, "latin": n / (n - 1), "sobol": math.e}[name] * VARIANCE / n
    lower = m.var(ddof=1) * (RUNS - 1) / stats.chi2.isf(ALPHA, RUNS - 1)
    assert lower < bound
    if name == "independent":
        assert upper(m.var(ddof=1), RUNS) > bound  # and no better: independent is independent


def test_the_variance_of_sobol_falls_like_n_to_the_minus_three():
    """Owen 1997: n^-3 log(n) for a smooth integrand in the plane; the slope in log-log must be below -2.5."""
    log_n = np.log2(SIZES)
    log_v = np.log2([means("sobol", n).var(ddof=1) for n in SIZES])
    error = math.sqrt(2.0 / (RUNS - 1)) / math.log(2.0) / math.sqrt(((log_n - log_n.mean()) ** 2).sum())
    slope = np.polyfit(log_n, log_v, 1)[0]
    if COMPILED:
        assert slope + stats.norm.isf(ALPHA) * error < -2.5, (slope, error)
    else:
        assert slope < -2.0 + 2.0 * error, (slope, error)  # sixteen runs only: clearly better than stratified


LATIN = {  # integrand on the square, exact variance of a Latin hypercube's mean of n points
    # slide "Creating soft shadows": the jitter within each of n intervals is all that is left of 2 u1
    "linear, n^-3": (lambda p: 2.0 * p[:, 0], lambda n: 1.0 / (3.0 * n**3)),
    # an edge along an axis cuts one interval of n: of the share f = n/3 mod 1 of it
    "edge along an axis, n^-2": (lambda p: (p[:, 0] < 1 / 3) * 1.0, lambda n: (n / 3 % 1) * (1 - n / 3 % 1) / n**2),
    "product, n^-1": (lambda p: p[:, 0] * p[:, 1], lambda n: product(n)),
}


def product(n):
    """u1 u2 = 1/4 + a/2 + b/2 + a b, a = c + jitter: a permutation statistic, (sum c^2)^2 / (n - 1), and jitter."""
    middle, jitter = (1.0 - n**-2) / 12.0, n**-2 / 12.0  # the variances of c and of its jitter
    return middle**2 / (n - 1) + 2.0 * middle * jitter / n + jitter**2 / n + 2.0 * jitter / 4.0 / n


@pytest.mark.parametrize("case", LATIN)
def test_the_variance_of_a_latin_hypercube(case):
    """Stein 1987: only what is no sum of functions of one dimension each keeps the order n^-1."""
    integrand, exact = LATIN[case]
    error = stats.norm.isf(ALPHA / 2) * math.sqrt(2.0 / RUNS)  # the means' kurtosis is 3 at most
    for n in (16, size(128, 32)):
        assert means("latin", n, integrand).var(ddof=1) == pytest.approx(exact(n), rel=error), n
