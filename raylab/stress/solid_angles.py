"""Solid angles of lights that are far, near, or seen edge-on."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from raylab.solid_angle import triangle_angle
from raylab.stress.case import Found, case
from raylab.stress.oracle import triangle_solid_angle, worst
from raylab.stress.single import single, vector
from raylab.vec3 import Vec3

SIZES = (1e-4, 1e-6, 1e-8)


def small_triangle(size: float) -> tuple[Any, Any, Any]:
    """Corner and edges of a triangle at distance 1."""
    return Vec3(0.25, 0.125, 1.0), Vec3(size, 0.0, 0.0), Vec3(0.25 * size, size, 0.0)


@case(
    "B05", "triangle of size 1e-4, 1e-6, 1e-8 at distance 1", usual="sum of the angles - pi, by acos",
    rule="2 atan2(a . (e1 x e2), ...) of unnormalised vectors", truth="the same formula with 60 digits",
    unit="relative error of the solid angle", allowed=1e-14,
)  # fmt: skip
def far_triangles() -> Found:
    truths = [triangle_solid_angle(*small_triangle(s)) for s in SIZES]
    ours = [triangle_angle(*small_triangle(s)) for s in SIZES]
    usual = [excess(*(np.array(tuple(v)) for v in small_triangle(s))) for s in SIZES]
    in_float32 = [single(triangle_angle)(*map(vector, small_triangle(s))) for s in SIZES]
    return Found(worst(ours, truths), worst(usual, truths), worst(in_float32, truths))


def excess(a: Any, e1: Any, e2: Any) -> Any:
    """Girard: the sum of the angles less pi."""
    corners = [v / np.linalg.norm(v) for v in (a, a + e1, a + e2)]
    total = -math.pi
    for i in range(3):
        p, q, r = corners[i], corners[i - 1], corners[i - 2]
        m, n = np.cross(p, q), np.cross(p, r)
        total += np.arccos(np.clip(m @ n / np.sqrt(m @ m * (n @ n)), -1, 1))
    return total
