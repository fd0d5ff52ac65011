"""Point: a place on a surface, and what a shadow ray must know of it.

Embree answers in float32. How far a ray must start (or end) off the surface so that the surface itself is not hit is
bounded by the rounding of the ray, of the triangle and of Embree's test (docs/precision.md):

    delta = 4 * 2^-24 * (B + longest edge),   B = sum_i |n_i| (|y_i| + r_i + |y_i - x_i|) + sum_i r_i C_i / |e1 x e2|

for a point y seen from x. With E the extents of the triangle, r_i <= E_i + |y_i - x_i|, C_i <= 2 E_j E_k, and the
longest edge is at most sum_i E_i, so
delta <= slack + tilt . |y - x|, where `slack` and `tilt` belong to y alone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from raylab.jit import njit
from raylab.record import record
from raylab.vec3 import Vec3, absolute, black, cross, dot, length

ULPS = 4.0 * 2.0**-24  # experiments needed 1 to 1.5 units of 2^-24; the factor is a margin of safety


@record
class Point(NamedTuple):
    """Position p, unit normal n of the surface there, and the terms of the offset bound."""

    p: Vec3
    n: Vec3
    slack: float
    tilt: Vec3

    def __sub__(self, other):
        return self.p - other.p


@njit
def dist_sqr(a, b):
    """|a - b|^2"""
    d = a - b
    return dot(d, d)


@njit
def facet_terms(n, extents, inverse_area):
    """The parts of slack and tilt that are the same all over a triangle; `extents` are those of its bounding box,
    `inverse_area` is 1 / |e1 x e2|."""
    sliver = 2.0 * inverse_area
    c = Vec3(extents.y * extents.z * sliver, extents.z * extents.x * sliver, extents.x * extents.y * sliver)
    slack = dot(absolute(n), extents) + dot(c, extents) + extents.x + extents.y + extents.z
    return slack * ULPS, (absolute(n) * 2.0 + c) * ULPS


@njit
def facet_point(p, n, slack, tilt):
    """A point of a triangle with the given `facet_terms`."""
    return Point(p, n, slack + dot(absolute(n), absolute(p)) * ULPS, tilt)


@njit
def curved_point(p, n):
    """A point of a sphere, disk or cylinder, which is intersected in float64: only the ray itself is rounded."""
    return Point(p, n, (dot(absolute(n), absolute(p)) + 2.0**-20) * ULPS, absolute(n) * ULPS)


@njit
def free_point(p):
    """A point on no surface: a point light."""
    return Point(p, black, 0.0, black)


@njit
def triangle_frame(v0, v1, v2):
    """Unit normal and `facet_terms` of a triangle."""
    n = cross(v1 - v0, v2 - v0)
    inverse_area = 1.0 / length(n)
    n = n * inverse_area
    extents = Vec3(
        max(v0.x, v1.x, v2.x) - min(v0.x, v1.x, v2.x),
        max(v0.y, v1.y, v2.y) - min(v0.y, v1.y, v2.y),
        max(v0.z, v1.z, v2.z) - min(v0.z, v1.z, v2.z),
    )
    slack, tilt = facet_terms(n, extents, inverse_area)
    return n, slack, tilt


def plane_table(corners: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """For triangles (m, 3, 3): unit normal n, n . v0, and the `facet_terms` slack and tilt, (m, 8).

    Eight numbers, one line of the processor's cache, are all that a hit point needs. What is so small that its
    area is 0 has no normal either.
    """
    n = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    double_area = np.linalg.norm(n, axis=1, keepdims=True)
    inverse_area = np.divide(1.0, double_area, out=np.zeros_like(double_area), where=double_area > 0.0)
    n *= inverse_area
    extents = np.ptp(corners, axis=1)
    c = np.roll(extents, -1, axis=1) * np.roll(extents, -2, axis=1) * (2.0 * inverse_area)
    slack = ((np.abs(n) + c + 1.0) * extents).sum(axis=1) * ULPS
    offset = np.einsum("mi,mi->m", n, corners[:, 0])
    return np.column_stack([n, offset, slack, (2.0 * np.abs(n) + c) * ULPS])
