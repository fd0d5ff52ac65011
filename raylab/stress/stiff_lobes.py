"""Stiff lobes: a narrow BRDF in a wide light, a small light in a wide BRDF, and the same under a sky."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from raylab.figures.after_lecture import relative_variances
from raylab.jit import njit
from raylab.mis import balance
from raylab.sampling import (
    pdf_cone,
    pdf_phong_lobe,
    sample_cone,
    sample_hemisphere,
    sample_phong_lobe,
    sample_sphere,
)
from raylab.stress.case import Found, case
from raylab.stress.lamps import UP, squares
from raylab.stress.stiff_estimators import MANY, UNIT, hits, largest, relative

Array = npt.NDArray[np.float64]
BEYOND = "relative variance beyond that of the better technique alone (NaN if one is not what theory says)"
VEACH = 0.5  # one sample of each by the balance heuristic: at most E^2 / 2 beyond (Veach 1997, theorem 9.2)


@njit
def _lobe(n, sin_max, u, v, by_light, by_brdf, both):
    """A Phong lobe within a round light around its middle, f = p_brdf there: by light, by BRDF, one of each."""
    for i in range(len(u)):
        w = sample_cone(UP, sin_max, (u[i, 0], u[i, 1]))
        p, q = pdf_cone(UP, sin_max, w), pdf_phong_lobe(UP, n, w)
        by_light[i] = q / p
        both[i] = q / p * balance(p, q)
        w = sample_phong_lobe(UP, n, (v[i, 0], v[i, 1]))
        p, q = pdf_cone(UP, sin_max, w), pdf_phong_lobe(UP, n, w)
        by_brdf[i] = 1.0 if p > 0.0 else 0.0
        both[i] += by_brdf[i] * balance(q, p)


def lobe(n: float, half_angle: float) -> tuple[float, Array, Array, Array]:
    """The mean, and samples by light, by BRDF and by both."""
    g = [np.empty(MANY) for _ in range(3)]
    _lobe(n, math.sin(half_angle), squares(MANY), squares(MANY, 7), *g)
    most = 2.0 * math.sin(half_angle / 2.0) ** 2
    return -math.expm1((n + 1.0) * math.log1p(-most)), g[0], g[1], g[2]


@case(
    "S04", "a lobe of exponent 100 and 1000 in a light of half angle 1", usual="points on the light: Omega n / (4 pi)",
    rule="combined with the BRDF by the balance heuristic: at most 1/2", truth="quadrature", unit=BEYOND, allowed=VEACH,
)  # fmt: skip
def narrow_lobe() -> Found:
    error, usual, told = [], [], []
    for n in (100.0, 1000.0):
        by_light, by_brdf, both = relative_variances(n, 1.0)
        mean, g, _, h = lobe(n, 1.0)
        error.append(relative(h, mean, both) - min(by_light, by_brdf))
        usual.append(relative(g, mean, by_light) - min(by_light, by_brdf))
        told.append(f"{by_light:.3g} and {both:.2g}")
    return Found(largest(error), largest(usual), note=f"Relative variances: {'; '.join(told)}")


@case(
    "S05", "a round light of half angle 0.05 and 0.01 over a diffuse surface, and in a lobe of exponent 100",
    usual="directions of the BRDF: (1 - p) / p", rule="combined with points on the light: at most 1/2",
    truth="closed form, quadrature", unit=BEYOND, allowed=VEACH,
)  # fmt: skip
def tiny_light() -> Found:
    error, usual, told = [], [], []
    for half_angle in (0.05, 0.01):
        p, hit = math.sin(half_angle) ** 2, np.empty(MANY)
        hits(squares(MANY), math.cos(half_angle), hit)
        by_light, by_brdf, both = relative_variances(100.0, half_angle)
        mean, _, g, h = lobe(100.0, half_angle)
        error.append(relative(h, mean, both) - min(by_light, by_brdf))
        usual.append(relative(g, mean, by_brdf) - min(by_light, by_brdf))
        usual.append(relative(hit, p, (1.0 - p) / p))
        told.append(f"{by_brdf:.3g} and {both:.2g}")
    return Found(largest(error), largest(usual), note=f"In the lobe: {'; '.join(told)}")


@njit
def _everywhere(n, u, half, whole, own):
    for i in range(len(u)):
        w = sample_hemisphere(UP, (u[i, 0], u[i, 1]))
        half[i] = pdf_phong_lobe(UP, n, w) * 2.0 * math.pi
        w = sample_sphere((u[i, 0], u[i, 1]))
        whole[i] = pdf_phong_lobe(UP, n, w) * 4.0 * math.pi
        w = sample_phong_lobe(UP, n, (u[i, 0], u[i, 1]))
        own[i] = (n + 1.0) / (2.0 * math.pi) * max(0.0, w.z) ** n / pdf_phong_lobe(UP, n, w)


def under_a_sky(n: float) -> tuple[float, float, float]:
    """Relative variance of a lobe under a constant sky by the hemisphere, by the sphere and by the lobe."""
    half, whole, own = np.empty(MANY), np.empty(MANY), np.empty(MANY)
    _everywhere(n, squares(MANY), half, whole, own)
    square = (n + 1.0) ** 2 / (2.0 * n + 1.0)
    return relative(half, 1.0, square - 1.0), relative(whole, 1.0, 2.0 * square - 1.0), relative(own, 1.0, 0.0)


@case(
    "S06", "a lobe of exponent 100 and 1000 under a constant sky", usual="uniform over the hemisphere: about n / 2",
    rule="in proportion to the BRDF: 0", truth="(n + 1)^2 / (2 n + 1) - 1; rounding", unit=UNIT, allowed=2.0**-70,
)  # fmt: skip
def uniform_hemisphere() -> Found:
    found = [under_a_sky(n) for n in (100.0, 1000.0)]
    return Found(largest([own for _, _, own in found]), largest([half for half, _, _ in found]))


@case(
    "S08", "the same lobes, by a constant sky's own samples", usual="uniform over the sphere: about n",
    rule="in proportion to the BRDF: 0", truth="2 (n + 1)^2 / (2 n + 1) - 1; rounding", unit=UNIT, allowed=2.0**-70,
)  # fmt: skip
def uniform_sphere() -> Found:
    found = [under_a_sky(n) for n in (100.0, 1000.0)]
    return Found(largest([own for _, _, own in found]), largest([whole for _, whole, _ in found]))
