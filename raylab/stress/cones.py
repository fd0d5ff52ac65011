"""Spheres as lights: far away, from nearby, from their surface and from inside."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from raylab import description as d
from raylab.sampling import PI, one_minus_cos, sample_cone
from raylab.stress.case import U53, Found, case
from raylab.stress.lamps import SAMPLES, UP, Lamp, cap_variance, off, squares
from raylab.stress.oracle import exact, worst
from raylab.stress.single import single, vector

SINES = (1e-3, 1e-4, 1e-6, 2.0**-20, 1e-8)


def versine(s: float) -> Any:
    """1 - cos of the angle with the sine s."""
    return 1 - exact().sqrt(1 - exact().mpf(s) ** 2)


@case(
    "B01", "sphere light, R / D = 1e-3, 1e-4, 1e-6, 2^-20, 1e-8", usual="2 pi (1 - cos)",
    rule="2 pi s^2 / (1 + sqrt(1 - s^2))", truth="2 pi (1 - cos) with 60 digits",
    unit="relative error of the solid angle", allowed=4 * U53,
)  # fmt: skip
def far_spheres() -> Found:
    truths = [2 * exact().pi * versine(s) for s in SINES]
    ours = [2.0 * PI * one_minus_cos(s) for s in SINES]
    usual = [2.0 * math.pi * (1.0 - math.sqrt(1.0 - s * s)) for s in SINES]
    in_float32 = [2.0 * math.pi * float(single(one_minus_cos)(np.float32(s))) for s in SINES]
    return Found(worst(ours, truths), worst(usual, truths), worst(in_float32, truths))


@case(
    "B02", "a direction in the cone of half angle 1e-6 and 1e-8, 100 values of u1", usual="sqrt(1 - cos^2)",
    rule="x = u s^2 / (1 + sqrt(1 - s^2)), sin = sqrt(x (2 - x))", truth="the same with 60 digits",
    unit="relative error of the sine to the axis", allowed=1e-15,
)  # fmt: skip
def narrow_cones() -> Found:
    m = exact()
    places = [(s, float(u)) for s in (1e-6, 1e-8) for u in (0.3, *squares(99)[:, 0])]
    x = [versine(s) * m.mpf(u) for s, u in places]
    truths = [m.sqrt(v * (2 - v)) for v in x]
    ours = [sample_cone(UP, s, (u, 0.0)).x for s, u in places]
    usual = [math.sqrt(max(0.0, 1.0 - (1.0 - u * (1.0 - math.sqrt(1.0 - s * s))) ** 2)) for s, u in places]
    narrow = single(sample_cone)
    in_float32 = [narrow(vector(UP), np.float32(s), (np.float32(u), np.float32(0.0))).x for s, u in places]
    return Found(worst(ours, truths), worst(usual, truths), worst(in_float32, truths))


@case(
    "B03", "a sphere light of radius R seen from R (1 + 1e-8), R and R (1 - 1e-12)", usual="cos = sqrt(1 - (R/r)^2)",
    rule="cone of the sine R / r outside; inside the front of the light does not show", truth="pi (R/r)^2 and 0",
    unit="exact standard errors of the mean of 1e5 (off for any light within)", allowed=4.5,
)  # fmt: skip
def at_the_surface_of_a_sphere() -> Found:
    lamp = Lamp(d.Sphere, np.eye(4))
    error, distances = 0.0, (1.0 + 1e-8, 1.0, 1.0 - 1e-12)
    for r in distances:
        g = lamp.irradiances((0.0, 0.0, -r))
        c = math.sqrt(1.0 - r**-2) if r > 1.0 else 0.0
        seen = off(g, math.pi / r**2, cap_variance(c)) if r > 1.0 else math.inf if g.any() else 0.0
        error = math.nan if np.isnan(g).any() or math.isnan(error) else max(error, seen)
    with np.errstate(invalid="ignore"):
        cosines = np.sqrt(1.0 - (1.0 / np.array(distances)) ** 2)
    return Found(error, 0.0 if np.isfinite(cosines).all() else math.nan)


@case(
    "B04", "1e-3 above a sphere light of radius 1", usual="points uniform on the sphere: relative variance 4 / (3 d^2)",
    rule="directions uniform in the cone: relative variance 0.28", truth="pi (R/r)^2",
    unit="exact standard errors of raylab's mean of 1e5", allowed=4.5,
)  # fmt: skip
def near_a_sphere() -> Found:
    r = 1.0 + 1e-3
    variance = cap_variance(math.sqrt(1.0 - r**-2))
    u = squares(SAMPLES)
    z, phi = 1.0 - 2.0 * u[:, 0], 2.0 * math.pi * u[:, 1]
    n = np.stack([np.sqrt(1.0 - z * z) * np.cos(phi), np.sqrt(1.0 - z * z) * np.sin(phi), z], axis=1)
    toward = n + np.array([0.0, 0.0, r])
    rr = (toward**2).sum(axis=1)
    g = 4.0 * math.pi * np.maximum(0.0, -(toward * n).sum(axis=1)) * np.maximum(0.0, toward[:, 2]) / rr**2
    ours = Lamp(d.Sphere, np.eye(4)).irradiances((0.0, 0.0, -r))
    return Found(off(ours, math.pi / r**2, variance), off(g, math.pi / r**2, variance))
