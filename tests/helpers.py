"""What several test files share: sizes, points, vectors, quadrature and the chi-square test."""

from __future__ import annotations

import gc
import sys
from itertools import pairwise

import numpy as np
from numba import config
from scipy import stats

from raylab.vec3 import Vec3

COMPILED = not config.DISABLE_JIT
U53 = 2.0**-53  # half the spacing of float64 below 1: the rounding unit
ALPHA = 1e-6  # false-alarm probability of each statistical test; seeds are fixed, so a red test stays red


def size(n, plain):
    """The number of repetitions: `n`, or `plain` without the compiler, which takes a hundred times longer."""
    return n if COMPILED else plain


def array(v):
    """A Vec3 (or a point's tuple of numbers) as an array."""
    return np.array([*v])


def unit(x, y, z):
    """(x, y, z) / |(x, y, z)|, by numpy."""
    return Vec3(*(np.array([x, y, z]) / np.linalg.norm([x, y, z])))


def squares(n, seed=0):
    """n random points of the unit square, as pairs of Python floats."""
    return [(float(u), float(v)) for u, v in np.random.default_rng(seed).random((n, 2))]


def gauss(n, low=0.0, high=1.0):
    """Nodes and weights of the n-point Gauss-Legendre rule on [low, high]: exact up to degree 2 n - 1."""
    x, w = np.polynomial.legendre.leggauss(n)
    return low + (high - low) * (x + 1.0) / 2.0, w * (high - low) / 2.0


def composite(n, edges):
    """The n-point rule in each interval between neighbouring edges: all nodes, all weights."""
    nodes, weights = zip(*(gauss(n, low, high) for low, high in pairwise(edges)), strict=True)
    return np.concatenate(nodes), np.concatenate(weights)


def around(n, x, y, z):
    """x a + y b + z n for an orthonormal a, b, n of our own making (numpy, by Gram-Schmidt)."""
    n = np.asarray([*n])
    a = np.eye(3)[np.argmin(np.abs(n))]
    a = a - n * (a @ n)
    a /= np.linalg.norm(a)
    return Vec3(*(x * a + y * np.cross(n, a) + z * n))


def chi_square_p(counts, expected, least=100.0):
    """The p-value of counts whose expectations, which add up to the number of samples, are known.

    Cells that expect fewer than `least` are merged: below, the tail of chi-square is off by orders of magnitude.
    A count where nothing is expected, or expectations that do not add up, give 0.
    """
    counts, expected = np.ravel(counts).astype(float), np.ravel(expected).astype(float)
    if np.any(counts[expected <= 0.0] > 0.0) or abs(expected.sum() - counts.sum()) > 1e-6 * counts.sum():
        return 0.0
    small = expected < least
    if small.any():
        counts = np.append(counts[~small], counts[small].sum())
        expected = np.append(expected[~small], expected[small].sum())
    if expected[-1] == 0.0:
        counts, expected = counts[:-1], expected[:-1]
    assert len(counts) > 2, "too few samples for a test"
    return stats.chi2.sf(((counts - expected) ** 2 / expected).sum(), len(counts) - 1)


def held(*objects):
    """The references to each object, and how many pieces of memory Python holds, when all garbage is collected."""
    gc.collect()
    return np.array([sys.getrefcount(o) for o in objects] + [sys.getallocatedblocks()])


def same_bits(a, b):
    """Are two lists of floats the same, bit for bit? A NaN equals any NaN."""
    a, b = np.asarray(a, np.float64), np.asarray(b, np.float64)
    return np.array_equal(np.where(np.isnan(a), 7.0, a).view(np.int64), np.where(np.isnan(b), 7.0, b).view(np.int64))


def eye_ray(camera, column, row, rng, time=0.0):
    """An eye ray of a pixel, made of what `rng` draws."""
    film, lens = camera.draw(rng)
    return camera.ray(column, row, film, lens, time)
