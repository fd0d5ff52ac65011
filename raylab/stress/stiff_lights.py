"""Stiff lights: those whose samples scatter wildly, or stop to be what they are said to be, unless drawn with care."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.jit import njit
from raylab.solid_angle import sample_rectangle_angle, urena
from raylab.stats.tails import why_not_trusted
from raylab.stress.case import Found, case
from raylab.stress.lamps import SAMPLES, Lamp, cap_variance, off, squares
from raylab.stress.nearness import over_a_floor, placed, seen
from raylab.stress.oracle import exact, gauss, rectangle_solid_angle
from raylab.stress.single import single, vector
from raylab.vec3 import Vec3, dot

Array = npt.NDArray[np.float64]
SAME = 2.69  # sqrt(n) times Kolmogorov's distance, reached by chance once in a million times


@njit
def _angles_across(light, x, u, s):
    """Where along its first edge the points of a light fall."""
    for i in range(len(s)):
        y, _ = light.sample_solid_angle(x, (u[i, 0], u[i, 1]))
        s[i] = dot(y.p - light.p, light.e1) / dot(light.e1, light.e1)


@njit
def _urena_across(x0, x1, y0, y1, z, u, s):
    for i in range(len(s)):
        s[i], _ = urena(x0, x1, y0, y1, -z, (u[i, 0], u[i, 1]))


def distance(s: Any, size: float) -> float:
    """sqrt(n) sup |F_n - F| of points along the edge of the rectangle [1/4, 1/4 + size] x [1/8, 1/8 + size] at z = 1,
    F the share of its solid angle, as a polynomial through 17 points; a NaN is a NaN."""
    if not np.isfinite(s).all():
        return math.nan
    m, corner = exact(), (0.25, 0.125, 1.0)
    nodes = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 17))
    parts = [rectangle_solid_angle(corner, (m.mpf(size) * m.mpf(t), 0, 0), (0, size, 0)) for t in nodes]
    fit = np.polynomial.Polynomial.fit(nodes, [float(p / parts[-1]) for p in parts], 16, domain=[0, 1])
    s = np.sort(np.asarray(s, float))
    steps = np.arange(len(s) + 1) / len(s)
    truth = fit(s)
    return float(max(np.abs(truth - steps[1:]).max(), np.abs(truth - steps[:-1]).max()) * math.sqrt(len(s)))


@case(
    "B10", "2e5 points of a rectangle of size 1e-1, 1e-5 and 1e-7 at distance 1", usual="Urena's map at every size",
    rule="uniform in area below 2^-10 of the distance, two triangles below 2^-18 sr, Urena's map above",
    truth="uniform in solid angle: share of the angle on either side of a point, 60 digits",
    unit="sqrt(n) times Kolmogorov's distance", allowed=SAME, limit=60.0,
)  # fmt: skip
def uniform_in_angle() -> Found:
    u = squares(2 * SAMPLES)
    ours = usual = in_float32 = 0.0
    for size in (1e-1, 1e-5, 1e-7):
        s = np.empty(len(u))
        lamp = Lamp(d.Rectangle, placed(0.25 + size / 2, 0.125 + size / 2, 1.0, size / 2, size / 2))
        _angles_across(lamp.light, lamp.seen_from((0.0, 0.0, 0.0)), u, s)
        ours = worse(ours, distance(s, size))
        _urena_across(0.25, 0.25 + size, 0.125, 0.125 + size, 1.0, u, s)
        usual = worse(usual, distance(s, size))
        light = [vector(v) for v in ((0.25, 0.125, 1.0), (size, 0.0, 0.0), (0.0, size, 0.0))]
        few = [single(sample_rectangle_angle)(*light, (np.float32(a), np.float32(b)))[0] for a, b in u[:1000]]
        in_float32 = worse(in_float32, distance(few, size))
    return Found(ours, usual, in_float32, note="float32: the second rule at all sizes, 1000 points")


def worse(a: float, b: float) -> float:
    return math.nan if math.isnan(a) or math.isnan(b) else max(a, b)


@case(
    "B11", "a rectangle of 2e-4 sr that is wide but edge-on: [-.5, .5] x [.05, 2] at z = 1.4e-5",
    usual="points uniform in area, said to be uniform in solid angle, below 1e-3 sr",
    rule="the angle by which it is seen decides, not the solid angle; an area sample has p = 1 / A",
    truth="quadrature over the rectangle", unit="exact standard errors of raylab's mean of 1e5", allowed=4.5,
)  # fmt: skip
def wide_but_edge_on() -> Found:
    z = 1.4e-5
    x, wx = gauss(64, -0.5, 0.5)
    y, wy = gauss(200, 0.05, 2.0)
    rr = x[:, None] ** 2 + y**2 + z * z
    density = np.outer(wx, wy) * z / (rr * np.sqrt(rr))  # of solid angle
    cosine = y / np.sqrt(rr)
    solid_angle, mean = density.sum(), (density * cosine).sum()
    variance = solid_angle * (density * cosine**2).sum() / mean**2 - 1.0
    lamp = Lamp(d.Rectangle, placed(0.0, 1.025, z, 0.5, 0.975, -1.0))
    g = lamp.irradiances((0.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), by_angle=True)
    u = squares(SAMPLES)
    px, py = u[:, 0] - 0.5, 0.05 + 1.95 * u[:, 1]
    usual = solid_angle * py / np.sqrt(px**2 + py**2 + z * z)
    return Found(off(g, mean, variance), off(usual, mean, variance))


@case(
    "B19", "a disk of radius 1 from 1e-1, 1e-2 and 1e-3 above its centre",
    usual="points uniform in area: relative variance 1 / (3 h^2)", rule="uniform in solid angle: at most 1/3",
    truth="pi / (1 + h^2), and the variance in closed form",
    unit="largest of the error of the mean over 4.5 exact standard errors, of the variance over 10 %", allowed=1.0,
)  # fmt: skip
def near_a_disk() -> Found:
    ours = usual = 0.0
    lamp = Lamp(d.Disk, np.eye(4))
    for h in (1e-1, 1e-2, 1e-3):
        truth, variance = math.pi / (1.0 + h * h), cap_variance(h / math.hypot(1.0, h))
        for by_angle in (True, False):
            g = lamp.irradiances((0.0, 0.0, h), Vec3(0.0, 0.0, -1.0), by_angle)
            spread = g.var() / truth**2 / variance - 1.0
            share = max(off(g, truth, variance) / 4.5, abs(spread) / 0.1)
            ours, usual = (max(ours, share), usual) if by_angle else (ours, max(usual, share))
    return Found(ours, usual)


def touching(epsilon: float) -> tuple[float, float]:
    """Irradiance at epsilon from the foot of a wall light [-1, 1] x [0, 2], and the relative variance of uniform
    samples in solid angle: the integral over y is known, that over z is a sum with z = epsilon sinh t."""
    t, weight = gauss(200, 0.0, math.asinh(2.0 / epsilon))
    z = epsilon * np.sinh(t)
    weight = weight * epsilon * np.cosh(t)
    a2 = epsilon**2 + z**2
    over_y = (3.0 * a2 + 2.0) * 2.0 / (3.0 * a2**2 * (a2 + 1.0) ** 1.5)  # integral of (a^2 + y^2)^(-5/2)
    solid_angle = float(rectangle_solid_angle((epsilon, -1, 0), (0, 2, 0), (0, 0, 2)))
    r = math.hypot(epsilon, 2.0)
    mean = math.atan(1.0 / epsilon) - epsilon / r * math.atan(1.0 / r)
    return mean, solid_angle * float((weight * epsilon * z**2 * over_y).sum()) / mean**2 - 1.0


@case(
    "B20", "a wall light that touches the floor, from 2^-3, 2^-7 and 2^-10 of its foot",
    usual="points uniform in area: relative variance pi / (12 eps^2), infinite over a pixel with the foot in it",
    rule="uniform in solid angle; the mean of points by area is called not trusted", truth="closed form, quadrature",
    unit="exact standard errors of raylab's mean of 1e5 (NaN if not told)", allowed=4.5, limit=60.0,
)  # fmt: skip
def touching_the_floor() -> Found:
    wall = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 1], [0, 0, 0, 1]], float)
    scene = over_a_floor(wall)
    ours = usual = 0.0
    for epsilon in (2.0**-3, 2.0**-7, 2.0**-10):
        mean, variance = touching(epsilon)
        by_angle = math.pi * seen(scene, "area_solid_angle", (epsilon, 0.0, 0.0), (1.0, 0.0, 1.0), SAMPLES)
        by_area = math.pi * seen(scene, "area", (epsilon, 0.0, 0.0), (1.0, 0.0, 1.0), SAMPLES)
        ours, usual = worse(ours, off(by_angle, mean, variance)), worse(usual, off(by_area, mean, variance))
        if why_not_trusted(by_angle) or (epsilon < 2.0**-5 and not why_not_trusted(by_area)):
            ours = math.nan
    return Found(ours, usual)
