"""Rectangles as lights: how large they look from afar, from nearby, edge-on and in their own plane."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from raylab import description as d
from raylab.closed_forms import irradiance
from raylab.lights import DiskShape, RectangleShape, TriangleShape
from raylab.point import free_point
from raylab.solid_angle import rectangle_angle, triangle_angle
from raylab.stress.case import Found, case
from raylab.stress.lamps import Lamp
from raylab.stress.oracle import exact, rectangle_solid_angle, worst
from raylab.stress.single import single, vector
from raylab.vec3 import Vec3


def rectangle(x: float, y: float, z: float, width: float, height: float) -> tuple[Vec3, Vec3, Vec3]:
    """Corner and edges of [x, x + width] x [y, y + height] at the height z."""
    return Vec3(x, y, z), Vec3(width, 0.0, 0.0), Vec3(0.0, height, 0.0)


def urena_angle(a: Any, e1: Any, e2: Any) -> float:
    """Urena, Fajardo, King 2013: the sum of the angles between the side planes less 2 pi."""
    x0, y0, z = a.x, a.y, a.z
    x1, y1 = x0 + e1.x, y0 + e2.y
    with np.errstate(invalid="ignore", divide="ignore"):
        n = np.array([-y0, x1, y1, -x0]) / np.hypot(np.array([y0, x1, y1, x0]), z)
        return float(np.arccos(np.clip(-n * np.roll(n, -1), -1.0, 1.0)).sum() - 2.0 * math.pi)


@case(
    "B06", "rectangle of size 2^-14 and 2^-27 at (1/4, 1/8, 1)", usual="Urena's sum of four angles - 2 pi",
    rule="two triangles of unnormalised vectors below 0.1 sr", truth="two triangles with 60 digits",
    unit="relative error of the solid angle", allowed=1e-14,
)  # fmt: skip
def far_rectangles() -> Found:
    return compared([rectangle(0.25, 0.125, 1.0, s, s) for s in (2.0**-14, 2.0**-27)], urena_angle)


@case(
    "B07", "[-1, 1]^2 seen from 2^-30 and 2^-52 below its centre", usual="two triangles",
    rule="the sum of atan(x y / (z r)) over the corners, from 0.1 sr on", truth="two triangles with 60 digits",
    unit="relative error of the solid angle", allowed=4e-16,
)  # fmt: skip
def touching_rectangle() -> Found:
    def two_triangles(a: Vec3, e1: Vec3, e2: Vec3) -> float:
        return triangle_angle(a, e1, e2) + triangle_angle(a + e1 + e2, -e1, -e2)

    return compared([rectangle(-1.0, -1.0, z, 2.0, 2.0) for z in (2.0**-30, 2.0**-52)], two_triangles)


@case(
    "B08", "[-1, 1] x [1, 2] seen edge-on, 2^-20 and 2^-40 off its plane", usual="Urena's sum of four angles - 2 pi",
    rule="two triangles below 0.1 sr", truth="two triangles with 60 digits",
    unit="relative error of the solid angle", allowed=1e-13,
)  # fmt: skip
def rectangle_edge_on() -> Found:
    return compared([rectangle(-1.0, 1.0, z, 2.0, 1.0) for z in (2.0**-20, 2.0**-40)], urena_angle)


def compared(seen: list[tuple[Vec3, Vec3, Vec3]], usual: Any) -> Found:
    """Solid angles of rectangles by raylab, by other code and in float32."""
    truths = [rectangle_solid_angle(*v) for v in seen]
    in_float32 = [single(rectangle_angle)(*map(vector, v)) for v in seen]
    return Found(
        worst([rectangle_angle(*v) for v in seen], truths), worst([usual(*v) for v in seen], truths),
        worst(in_float32, truths),
    )  # fmt: skip


@case(
    "B09", "a rectangle, a triangle and a disk seen from their plane: from the line of an edge, a corner, inside",
    usual="Urena's sum of four angles - 2 pi (the rectangle)",
    rule="a density of 0 within 4 units of 2^-53 of the plane", truth="no solid angle",
    unit="densities and angles that are not 0", allowed=0.0,
)  # fmt: skip
def in_the_plane() -> Found:
    wrong = usual = 0
    places = [(0.0, 3.0), (1.0, 3.0), (1.0, 1.0), (0.0, 0.0), (-1.0, -1.0), (0.25, -0.5), (3.0, 3.0)]
    shapes: tuple[Any, ...] = (RectangleShape(), TriangleShape(), DiskShape())
    for shape in shapes:
        for x, y in places:
            light = flat_light(shape, x, y)
            found, p = shape.sample_solid_angle(light, free_point(Vec3(0.0, 0.0, 0.0)), (0.3, 0.6))
            q = shape.pdf_solid_angle(light, free_point(Vec3(0.0, 0.0, 0.0)), found)
            wrong += not (p == 0.0 and q == 0.0 and math.isfinite(found.p.x + found.p.y))
            usual += shape.kind == RectangleShape().kind and urena_angle(light.p, light.e1, light.e2) != 0.0
    return Found(wrong, usual)


def flat_light(shape: Any, x: float, y: float) -> Any:
    """A light in the plane z = 0 over [-1, 1]^2, seen from (x, y, 0), which is the origin."""
    edge = 1.0 if isinstance(shape, DiskShape) else 2.0
    p = Vec3(-x, -y, 0.0) if isinstance(shape, DiskShape) else Vec3(-1.0 - x, -1.0 - y, 0.0)
    light = Lamp(d.Rectangle, np.eye(4)).light
    return light._replace(p=p, e1=Vec3(edge, 0.0, 0.0), e2=Vec3(0.0, edge, 0.0), area=4.0)


@case(
    "B12", "irradiance of a rectangle of size 2^-7, 2^-14 and 2^-27 at (1/4, 1/8, 1), the truth of other tests",
    usual="Lambert's sum over the edges", rule="closed_forms.irradiance.polygon", truth="Lambert's sum with 60 digits",
    unit="relative error of the irradiance", allowed=1e-10,
)  # fmt: skip
def irradiance_of_far_rectangles() -> Found:
    ours, usual, truths = [], [], []
    for size in (2.0**-7, 2.0**-14, 2.0**-27):
        corners = np.array([(0.25, 0.125, 1.0)] * 4) + size * np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
        ours.append(float(irradiance.polygon(corners)))
        usual.append(lambert(corners, np.float64, math))
        truths.append(lambert(corners, exact().mpf, exact()))
    return Found(worst(ours, truths), worst(usual, truths))


def lambert(corners: Any, number: Any, m: Any) -> Any:
    """1/2 |sum Theta_i Gamma_i . n|, n = z, in any arithmetic."""
    total = number(0)
    for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        p, q = [number(x) for x in p], [number(x) for x in q]
        pq, pp, qq = (sum(x * y for x, y in zip(a, b, strict=True)) for a, b in ((p, q), (p, p), (q, q)))
        n = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
        total += m.acos(pq / m.sqrt(pp * qq)) * n[2] / m.sqrt(sum(x * x for x in n))
    return abs(total) / 2
