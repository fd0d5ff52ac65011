"""raylab's compiled maps as functions of arrays, for `raylab.stats`."""

from __future__ import annotations

from functools import cache

import numpy as np

from raylab.jit import njit
from raylab.samplers import make
from raylab.vec3 import Vec3


def directions(sample, *given):
    """`sample(*given, u) -> w` as u (n, 2) -> (n, 3)."""
    return lambda u: _filled(_fill_directions(sample), given, u, 3)


def directions_and_pdf(sample, *given):
    """`sample(*given, u) -> w, p` as u (n, 2) -> (n, 3), (n,)."""

    def many(u):
        out = _filled(_fill_directions_and_pdf(sample), given, u, 4)
        return out[:, :3], out[:, 3]

    return many


def pairs(sample, *given):
    """`sample(*given, u) -> x, y` as u (n, 2) -> (n, 2)."""
    return lambda u: _filled(_fill_pairs(sample), given, u, 2)


def density(pdf, *given):
    """`pdf(*given, w) -> p` as (n, 3) -> (n,)."""
    return lambda w: _filled(_fill_density(pdf), given, w, 1)[:, 0]


def density_2d(pdf, *given):
    """`pdf(*given, x, y) -> p` as (n, 2) -> (n,)."""
    return lambda x: _filled(_fill_density_2d(pdf), given, x, 1)[:, 0]


@cache
def _fill_directions(sample):
    @njit
    def fill(given, u, out):
        for i in range(len(u)):
            w = sample(*given, (u[i, 0], u[i, 1]))
            out[i, 0], out[i, 1], out[i, 2] = w.x, w.y, w.z

    return fill


@cache
def _fill_directions_and_pdf(sample):
    @njit
    def fill(given, u, out):
        for i in range(len(u)):
            w, p = sample(*given, (u[i, 0], u[i, 1]))
            out[i, 0], out[i, 1], out[i, 2], out[i, 3] = w.x, w.y, w.z, p

    return fill


@cache
def _fill_pairs(sample):
    @njit
    def fill(given, u, out):
        for i in range(len(u)):
            out[i, 0], out[i, 1] = sample(*given, (u[i, 0], u[i, 1]))

    return fill


@cache
def _fill_density(pdf):
    @njit
    def fill(given, w, out):
        for i in range(len(w)):
            out[i, 0] = pdf(*given, Vec3(w[i, 0], w[i, 1], w[i, 2]))

    return fill


@cache
def _fill_density_2d(pdf):
    @njit
    def fill(given, x, out):
        for i in range(len(x)):
            out[i, 0] = pdf(*given, x[i, 0], x[i, 1])

    return fill


def _filled(fill, given, values, columns):
    out = np.zeros((len(values), columns))
    fill(given, np.ascontiguousarray(values, np.float64), out)
    return out


def random_points(name, seed, replicates, n):
    """Points (replicates, n, 2) of the sampler `name`: independent streams of n samples each."""
    sampler, out = make(name, seed, n), np.empty((replicates, n, 2))
    _fill_points(sampler, out)
    return out


@njit
def _fill_points(sampler, out):
    for r in range(out.shape[0]):
        for i in range(out.shape[1]):
            u, v = sampler.stream(r, 0, i).square()
            out[r, i, 0] = u
            out[r, i, 1] = v
