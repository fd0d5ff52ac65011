"""Environments to test, and what their methods give in a kernel."""

from __future__ import annotations

import math

import numpy as np
from helpers import squares, unit
from scipy.spatial.transform import Rotation

from raylab import description as d
from raylab.jit import njit
from raylab.sky import make_environment
from raylab.vec3 import Vec3

PI = math.pi
N = unit(0.2, -0.4, 0.6)
LAST = 1.0 - 2.0**-53
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
TURN = np.eye(4)
TURN[:3, :3] = Rotation.from_rotvec([0.3, -1.1, 0.7]).as_matrix()
KINDS = ["nearest", "bilinear"]


def image(height=5, width=8, seed=0):
    """Texels exact in float32, of very different brightness, colourful."""
    return (np.random.default_rng(seed).random((height, width, 3)) ** 4 * 10).astype(np.float32).astype(float)


def make(pixels, kind="nearest", to_world=TURN, **more):
    return make_environment(d.ImageEnvironment(pixels=pixels, filter=kind, to_world=to_world, **more))


@njit
def sample_all(sky, squares, out):
    for i in range(len(squares)):
        w, p = sky.sample(N, (squares[i, 0], squares[i, 1]))
        L = sky.eval(w)
        out[i, 0], out[i, 1], out[i, 2] = w.x, w.y, w.z
        out[i, 3], out[i, 4], out[i, 5], out[i, 6], out[i, 7] = p, sky.pdf(N, w), L.x, L.y, L.z


@njit
def look_all(sky, directions, out):
    for i in range(len(directions)):
        w = Vec3(directions[i, 0], directions[i, 1], directions[i, 2])
        L = sky.eval(w)
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = L.x, L.y, L.z, sky.pdf(N, w)


def sample(sky, u):
    """Directions (n, 3), the p that came with them, pdf of them, radiance (n, 3)."""
    out = np.empty((len(u), 8))
    sample_all(sky, np.asarray(u, float), out)
    return out[:, :3], out[:, 3], out[:, 4], out[:, 5:]


def look(sky, directions):
    """Radiance (n, 3) and pdf (n,)."""
    out = np.empty((len(directions), 4))
    look_all(sky, np.ascontiguousarray(directions, float), out)
    return out[:, :3], out[:, 3]


def directions(z, turns, to_world=TURN):
    """World directions at the height z = cos(theta) and at a fraction of a turn from -z towards +x."""
    r, phi = np.sqrt((1 - z) * (1 + z)), 2 * PI * turns
    return np.stack([r * np.sin(phi), z, -r * np.cos(phi)], axis=-1) @ to_world[:3, :3].T


def edges(rows):
    return np.cos(np.pi * np.arange(rows + 1) / rows)


def two_worlds(sky):
    """What the methods give for 20 samples, in plain Python and in a kernel."""
    u = squares(20, seed=8)
    w, p, pdf, L = sample(sky, u)
    plain = []
    for square in u:
        v, q = sky.sample(N, square)
        plain.append([*v, q, sky.pdf(N, v), *sky.eval(v)])
    return plain, np.column_stack([w, p, pdf, L])
