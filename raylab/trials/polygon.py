"""Polygons that trials are made of, in space and by how much light one sample of them can give."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from raylab import description as d
from raylab.trials.trial import Array, affine, unit


def polygon(corners: Array, radiance: Array | None) -> d.Shape:
    """A light (or, without radiance, a black screen); it shines to where its corners run counterclockwise."""
    if len(corners) == 4:
        a, b = (corners[1] - corners[0]) / 2.0, (corners[3] - corners[0]) / 2.0
        linear = np.stack([a, b, np.cross(a, b)], axis=1)
        return d.Rectangle(to_world=affine(linear, corners.mean(axis=0)), radiance=radiance, front=None)
    faces = np.array([[0, i, i + 1] for i in range(1, len(corners) - 1)])
    return d.Mesh(vertices=corners, faces=faces, radiance=radiance, front=None)


def facing(rng: np.random.Generator, elevation: float, azimuth: float, distance: float, tilt: float) -> Array:
    """Rows a, b, centre: unit axes of a plane whose normal a x b points to x but for a tilt of up to `tilt` degrees."""
    centre = distance * unit(elevation, azimuth)
    n = -centre / distance + math.tan(math.radians(tilt)) * rng.uniform(-0.5, 0.5, 3)
    n /= np.linalg.norm(n)
    a = np.cross(n, rng.normal(size=3))
    a /= np.linalg.norm(a)
    return np.stack([a, np.cross(n, a), centre])


def corners_in(plane: Array, points: Sequence[tuple[float, float]]) -> Array:
    """Points given by coordinates (s, t) in a plane from `facing`."""
    return np.array([plane[2] + s * plane[0] + t * plane[1] for s, t in points])


def box(s: float, t: float) -> list[tuple[float, float]]:
    return [(-s, -t), (s, -t), (s, t), (-s, t)]


def steepness(corners: Array) -> float:
    """A h / r_min^3 of a convex polygon that faces the origin; 0 if it faces away."""
    a, b = corners[1] - corners[0], corners[2] - corners[0]
    n = np.cross(a, b)
    n /= np.linalg.norm(n)
    h = float(n @ corners[0])
    return 0.0 if h >= 0.0 else area_of(corners) * -h / _nearest(corners, n * h, n) ** 3


def _edges(corners: Array) -> list[tuple[Array, Array]]:
    return list(zip(corners, np.roll(corners, -1, axis=0), strict=True))


def _nearest(corners: Array, foot: Array, n: Array) -> float:
    """The distance of the origin, whose foot on the plane is given, from a convex polygon."""
    if all(np.cross(q - p, foot - p) @ n >= 0.0 for p, q in _edges(corners)):
        return float(np.linalg.norm(foot))
    return min(_to_segment(p, q) for p, q in _edges(corners))


def _to_segment(p: Array, q: Array) -> float:
    t = np.clip(-(p @ (q - p)) / ((q - p) @ (q - p)), 0.0, 1.0)
    return float(np.linalg.norm(p + t * (q - p)))


def area_of(corners: Array) -> float:
    return 0.5 * float(sum(np.linalg.norm(np.cross(p - corners[0], q - corners[0])) for p, q in _edges(corners)))
