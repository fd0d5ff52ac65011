"""Reflection: the energy of a lobe, and a lobe that is nearly a mirror before a lamp."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from raylab import description as d
from raylab.brdf import Phong, reflect
from raylab.closed_forms import phong
from raylab.jit import njit
from raylab.scene import Scene
from raylab.stress.case import Found, case
from raylab.stress.lamps import SAMPLES, UP, off, squares
from raylab.stress.lobes import MIRROR, WHITE
from raylab.stress.nearness import placed, seen
from raylab.stress.oracle import exact, gauss, worst
from raylab.vec3 import Vec3, black


@njit
def _lobe(brdf, V, w, f):
    """f_r towards each direction."""
    for i in range(len(f)):
        f[i] = brdf.eval(V, Vec3(w[i, 0], w[i, 1], w[i, 2])).x


def albedo(brdf: Any, V: Vec3) -> float:
    """What a lobe reflects of a constant sky: Gauss' rule for f cos in the angles (alpha, phi) around R, phi up to
    where the circle around R meets the horizon of z."""
    R = np.array(tuple(reflect(V, UP)))
    S = math.hypot(R[0], R[1])
    A = np.array([-R[0], -R[1], S * S / R[2]]) / math.hypot(S, S * S / R[2]) if S > 0.0 else np.array([1.0, 0.0, 0.0])
    directions, weights = [], []
    for start, end in ((0.0, math.asin(R[2])), (math.asin(R[2]), math.pi / 2.0)):
        alphas, along = gauss(100, start, end)
        c = np.cos(alphas) * R[2] / np.maximum(np.sin(alphas) * S, 1e-300)
        top = np.arccos(-np.minimum(c, 1.0))
        phi, around = gauss(40, 0.0, 1.0)
        a, p = alphas[:, None], phi * top[:, None]
        parts = (np.cos(a), np.sin(a) * np.cos(p), np.sin(a) * np.sin(p))
        directions.append(sum(part[..., None] * v for part, v in zip(parts, (R, A, np.cross(R, A)), strict=True)))
        weights.append(2.0 * (along * np.sin(alphas) * top)[:, None] * around)
    w = np.concatenate(directions).reshape(-1, 3)
    f = np.empty(len(w))
    _lobe(brdf, V, w, f)
    return float((np.concatenate(weights).ravel() * f * np.maximum(0.0, w[:, 2])).sum())


def true_albedo(n: int, degrees: int) -> Any:
    """(n + 2) / (2 pi) times the integral of cos^n alpha sin alpha 2 (cos alpha C top + sin alpha S sin top)."""
    m = exact()
    theta = m.pi * degrees / 180
    C, S = m.cos(theta), m.sin(theta)

    def ring(alpha: Any) -> Any:
        c = m.cos(alpha) * C
        s = m.sin(alpha) * S
        top = m.pi if c >= s else m.acos(-c / s)
        return m.cos(alpha) ** n * m.sin(alpha) * 2 * (c * top + s * m.sin(top))

    with m.workdps(20):
        return (n + 2) / (2 * m.pi) * m.quad(ring, sorted({m.mpf(0), m.pi / 40, m.pi / 10, m.pi / 2 - theta, m.pi / 2}))


@case(
    "C05", "what the lobe of exponent 100 reflects of a constant sky seen at 0, 60, 85 and 90 degrees",
    usual="(n + 2) / (2 pi) makes it 1", rule="half of the lobe lies below the horizon at 90 degrees",
    truth="0.0398 to 1, quadrature with 20 digits",
    unit="relative error of f_r's integral and of the closed form, NaN above 1",
    allowed=1e-3,
)  # fmt: skip
def energy_of_a_lobe() -> Found:
    ours, usual, truths = [], [], []
    for degrees in (0, 60, 85, 90):
        C = math.cos(math.radians(degrees))
        truth, closed = true_albedo(100, degrees), phong.constant_sky(100, C)
        V = Vec3(math.sqrt(1.0 - C * C), 0.0, C)
        ours += [v if v <= 1.0 + 1e-12 else math.nan for v in (albedo(Phong(black, WHITE, 100.0, UP), V), closed)]
        usual += [1.0, 1.0]
        truths += [truth, truth]
    return Found(worst(ours, truths), worst(usual, truths))


SIDE = math.sqrt(math.sin(0.25) / (1.0 - math.sin(0.25)))  # half side of a square of 1 sr at distance 1


def combined_variance(n: float, density: float) -> float:
    """Of f / (p_light + p_lobe) from one sample of each, around a mirror direction in the middle of a light whose
    samples have the given density, 1/sr, there: sum over both of the mean square less the squared mean."""
    t, weight = gauss(400, 0.0, 60.0)  # t = n theta^2 / 2
    cosine = np.exp(-t / n)
    ring = 2.0 * math.pi * weight * cosine / n  # of solid angle, cos theta = exp(-t / n)
    f = (n + 2.0) / (2.0 * math.pi) * np.exp(-t) * cosine
    p = (n + 1.0) / (2.0 * math.pi) * np.exp(-t)
    light = density / cosine**3
    g = f / (light + p)
    return float(sum((g * g * q * ring).sum() - (g * q * ring).sum() ** 2 for q in (light, p)))


@case(
    "C06", "a lobe of exponent 1e7 that mirrors a lamp of 1 sr", usual="samples of the lamp: relative variance 1e6",
    rule="samples of both, balanced: relative variance 3e-6", truth="1 - 1e-7", allowed=4.5,
    unit="exact standard errors of raylab's mean of 1e5", limit=60.0,
)  # fmt: skip
def nearly_a_mirror() -> Found:
    shiny = d.Phong(np.zeros(3), np.ones(3), MIRROR)
    lamp = d.Rectangle(to_world=placed(0, 0, 1, SIDE, SIDE, -1), radiance=np.ones(3), front=None)
    scene = Scene(d.SceneDescription(shapes=(d.Rectangle(to_world=placed(0, 0, 0, 4, 4), front=shiny), lamp)))
    variance = combined_variance(MIRROR, 1.0 / (4.0 * SIDE * SIDE))
    ours = seen(scene, "direct", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), SAMPLES)
    rr = 1.0 + (SIDE * SIDE * (2.0 * squares(SAMPLES) - 1.0) ** 2).sum(axis=1)
    usual = 4.0 * SIDE * SIDE * (MIRROR + 2.0) / (2.0 * math.pi) * np.exp(-0.5 * MIRROR * np.log(rr)) / rr**2
    return Found(off(ours, 1.0, variance), off(usual, 1.0, variance), note=f"relative variance {variance:.1g}")
