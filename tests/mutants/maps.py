"""Samplers against their densities: each map of `raylab.sampling` and what its inverse makes of it.

J: pdf(T(u)) |dT/du| = 1 by central differences. P: the inverse of a sample is uniform in the square; cells of equal
probability, and one for what is not a direction at all.
"""

from __future__ import annotations

import math
import secrets
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from mutants.trials import unit
from raylab import sampling as s
from raylab.jit import njit
from raylab.stats import Counts
from raylab.vec3 import Vec3
from raylab.view import View

N = Vec3(*unit(0.48, -0.6, 0.64))
ACROSS, DOWN = 8, 16
STEP = 1e-5
# central differences: STEP^2 / 6 times third derivatives, which grow as u^(-5/2) at the ends, and rounding 1e-16 / STEP
J_TOLERANCE = 1e-4


class Map(NamedTuple):
    sample: Callable[..., Any]  # u -> array of 2 or 3 numbers
    pdf: Callable[..., float]
    invert: Callable[..., Any]
    fill: Any  # compiled: (seed, out (n, 2)) -> the inverses of n samples


def _direction(sample: Any, pdf: Any, invert: Any) -> Map:
    """sample(u), pdf(w) and invert(w) are compiled functions of directions."""

    @njit
    def fill(squares, out):
        for i in range(len(out)):
            w = sample((squares[i, 0], squares[i, 1]))
            a, b = invert(w)
            off = abs(w.x * w.x + w.y * w.y + w.z * w.z - 1.0) > 1e-9
            out[i, 0], out[i, 1] = (-1.0 if off else a), b

    return Map(sample, pdf, invert, fill)


def maps() -> dict[str, Callable[[], Map]]:
    n, sine = 20.0, 0.55

    def hemisphere() -> Map:
        return _direction(
            njit(lambda u: s.sample_hemisphere(N, u)), lambda w: s.pdf_hemisphere(N, w),
            njit(lambda w: s.invert_hemisphere(N, w)),
        )  # fmt: skip

    def cosine() -> Map:
        return _direction(
            njit(lambda u: s.sample_cos_hemisphere(N, u)), lambda w: s.pdf_cos_hemisphere(N, w),
            njit(lambda w: s.invert_cos_hemisphere(N, w)),
        )  # fmt: skip

    def sphere() -> Map:
        return _direction(njit(lambda u: s.sample_sphere(u)), s.pdf_sphere, njit(lambda w: s.invert_sphere(w)))

    def lobe() -> Map:
        return _direction(
            njit(lambda u: s.sample_phong_lobe(N, n, u)), lambda w: s.pdf_phong_lobe(N, n, w),
            njit(lambda w: s.invert_phong_lobe(N, n, w)),
        )  # fmt: skip

    def cone() -> Map:
        return _direction(
            njit(lambda u: s.sample_cone(N, sine, u)), lambda w: s.pdf_cone(N, sine, w),
            njit(lambda w: s.invert_cone(N, sine, w)),
        )  # fmt: skip

    def plane(sample: Any, pdf: Any, invert: Any) -> Map:
        return _direction(
            njit(lambda u: _flat(sample(u))), lambda w: pdf(w.x, w.y), njit(lambda w: invert(w.x, w.y))
        )._replace(fill=_plane_fill(sample, invert))

    return {
        "map hemisphere": hemisphere, "map cosine": cosine, "map sphere": sphere, "map Phong": lobe, "map cone": cone,
        "map disk": lambda: plane(s.sample_disk, s.pdf_disk, s.invert_disk),
        "map concentric": lambda: plane(s.sample_concentric_disk, s.pdf_concentric_disk, s.invert_concentric_disk),
        "map triangle": lambda: plane(s.sample_triangle, s.pdf_triangle, s.invert_triangle),
    }  # fmt: skip


@njit
def _flat(p):
    return Vec3(p[0], p[1], 0.0)


def _plane_fill(sample: Any, invert: Any) -> Any:
    @njit
    def fill(squares, out):
        for i in range(len(out)):
            x, y = sample((squares[i, 0], squares[i, 1]))
            out[i, 0], out[i, 1] = invert(x, y)

    return fill


def jacobian(m: Map, points: int = 200) -> float:
    """The largest |pdf(T(u)) |dT/du| - 1| over random u."""
    worst, rng = 0.0, np.random.default_rng()
    for u, v in rng.uniform(0.02, 0.98, (points, 2)):
        w = m.sample((u, v))
        du, dv = (
            (np.array([*m.sample((u + a, v + b))]) - np.array([*m.sample((u - a, v - b))])) / (2.0 * STEP)
            for a, b in ((STEP, 0.0), (0.0, STEP))
        )
        worst = max(worst, abs(m.pdf(w) * float(np.linalg.norm(np.cross(du, dv))) - 1.0))
    return worst


def counts(m: Map, cap: int, alpha: float) -> tuple[str, int]:
    """("FAIL" or "PASS", samples): inverses of samples counted in ACROSS x DOWN cells; PASS is silence at the cap."""
    tally, taken, block = Counts(np.full(ACROSS * DOWN, 1.0 / (ACROSS * DOWN))), 0, 64
    rng = np.random.default_rng(secrets.randbits(64))
    while taken < cap:
        out = np.empty((block, 2))
        m.fill(View(rng.random((block, 2))), View(out))
        inside = (out >= 0.0).all(axis=1) & (out <= 1.0).all(axis=1)
        a, b = (
            np.minimum((np.nan_to_num(out[:, k]) * size).astype(int), size - 1) for k, size in ((0, ACROSS), (1, DOWN))
        )
        tally.add(np.where(inside, a * DOWN + b, -1))
        taken += block
        if tally.log_evidence() > -math.log(alpha):
            return "FAIL", taken
        block = min(max(64, taken // 4), 1 << 17, max(cap - taken, 1))
    return "PASS", taken
