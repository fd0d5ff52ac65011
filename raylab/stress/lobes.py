"""Lobes: as narrow as a mirror, and sampled or seen where they vanish."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from raylab.brdf import Phong
from raylab.jit import njit
from raylab.mis import balance, power
from raylab.sampling import cos_power, pdf_phong_lobe, sample_phong_lobe
from raylab.stress.case import Found, case
from raylab.stress.lamps import UP, squares
from raylab.stress.oracle import exact, worst
from raylab.stress.single import single, vector
from raylab.vec3 import Vec3, black, dot

EXPONENTS = (1e3, 1e5, 1e7)
WHITE = Vec3(1.0, 1.0, 1.0)
MIRROR = 1e7


def slanted() -> tuple[Any, Any]:
    """A unit vector that is no axis, and one across."""
    r = np.array([1.0, 2.0, 2.0]) / 3.0
    return r, np.array([2.0, 1.0, -2.0]) / 3.0


@case(
    "C01", "Phong's lobe of exponent 1e3, 1e5 and 1e7 at the angle 1 / sqrt(n)", usual="(R . w)^n",
    rule="exp(n / 2 log1p(-sin^2)), the sine from R x (w - R)", truth="(1 - |R x w|^2)^(n / 2) with 60 digits",
    unit="relative error of the lobe", allowed=1e-13,
)  # fmt: skip
def narrow_lobes() -> Found:
    r, across = slanted()
    lobes = [(r, n, r * math.cos(n**-0.5) + across * math.sin(n**-0.5)) for n in EXPONENTS]
    truths = [true_lobe(*lobe) for lobe in lobes]
    rounded = [(vector(r), np.float32(n), vector(w)) for r, n, w in lobes]
    return Found(
        worst([cos_power(Vec3(*r), n, Vec3(*w)) for r, n, w in lobes], truths),
        worst([float(r @ w) ** n for r, n, w in lobes], truths),
        worst([single(cos_power)(*lobe) for lobe in rounded], [true_lobe(*lobe) for lobe in rounded]),
    )


def true_lobe(r: Any, n: Any, w: Any) -> Any:
    """cos^n of the angle between two vectors of about unit length."""
    m = exact()
    p, q = ([m.mpf(float(x)) for x in v] for v in (r, w))
    pq, pp, qq = (sum(a * b for a, b in zip(v, u, strict=True)) for v, u in ((p, q), (p, p), (q, q)))
    return m.sqrt(pq * pq / (pp * qq)) ** float(n)


@case(
    "C02", "a sample of Phong's lobe of exponent 1e7, 100 values of u1", usual="cos = u^(1 / (n + 1)), sqrt(1 - cos^2)",
    rule="x = -expm1(log1p(-u) / (n + 1)), sin = sqrt(x (2 - x))", truth="the same with 60 digits",
    unit="relative error of the sine to R", allowed=1e-14,
)  # fmt: skip
def samples_of_a_narrow_lobe() -> Found:
    m = exact()
    us = [float(u) for u in squares(100)[:, 0]]
    cosines = [(1 - m.mpf(u)) ** (1 / m.mpf(MIRROR + 1.0)) for u in us]
    truths = [m.sqrt(1 - c * c) for c in cosines]
    usual = [math.sqrt(1.0 - ((1.0 - u) ** (1.0 / (MIRROR + 1.0))) ** 2) for u in us]
    lobe, zero = single(sample_phong_lobe), np.float32(0.0)
    in_float32 = [lobe(vector(UP), np.float32(MIRROR), (np.float32(u), zero)).x for u in us]
    ours = [sample_phong_lobe(UP, MIRROR, (u, 0.0)).x for u in us]
    return Found(worst(ours, truths), worst(usual, truths), worst(in_float32, truths))


@njit
def _estimate(brdf, V, N, u):
    """p and f cos / p of a sample."""
    w, p = brdf.sample(V, N, u)
    return p, brdf.eval(V, w).x * max(0.0, dot(w, N)) / p


@case(
    "C03", "samples of Phong's lobe for u1 in {0, 2^-53, 1 - 2^-53}, exponents 1 to 1e7",
    usual="cos = u^(1 / (n + 1)), f / p", rule="1 - u in (0, 1], a density of at least 2^-1000",
    truth="f / p is finite", unit="samples that are not finite or have p <= 0", allowed=0.0,
)  # fmt: skip
def ends_of_the_unit_interval() -> Found:
    wrong = usual = 0
    for n in (1.0, 30.0, *EXPONENTS):
        for k_d in (0.0, 0.1):
            brdf = Phong(WHITE * k_d, WHITE * 0.5, n, UP)
            for u in (0.0, 2.0**-53, 1.0 - 2.0**-53):
                p, g = _estimate(brdf, Vec3(0.6, 0.0, 0.8), UP, (u, 0.25))
                wrong += not (p > 0.0 and math.isfinite(p) and math.isfinite(g))
                with np.errstate(all="ignore"):
                    f = np.power(np.float64(u) ** (1.0 / (n + 1.0)), n)
                    usual += not math.isfinite(f / f)
    return Found(wrong, usual)


@case(
    "C04", "Phong's lobe of exponent 1e7, 60 degrees off its middle", usual="f / p where both underflow",
    rule="no light there, and the weight 0", truth="cos^n = 10^-3010300", unit="values that are not 0", allowed=0.0,
)  # fmt: skip
def where_the_lobe_vanishes() -> Found:
    w = Vec3(math.sqrt(0.75), 0.0, 0.5)
    p = pdf_phong_lobe(UP, MIRROR, w)
    f = Phong(black, WHITE, MIRROR, UP).eval(UP, w).x
    zeros = (cos_power(UP, MIRROR, w), f, p, balance(p, 1.0), power(p, 1.0), balance(p, 0.0), power(p, 0.0))
    with np.errstate(invalid="ignore"):
        lobe = np.float64(0.5) ** MIRROR
        usual = float(lobe / lobe)
    return Found(sum(value != 0.0 for value in zeros), float(usual != 0.0))
