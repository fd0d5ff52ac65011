"""Boundaries: Fresnel's formulas at grazing angles, between media that are all but equal, at the critical angle."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from raylab.fresnel import dielectric
from raylab.stress.case import Found, case
from raylab.stress.oracle import exact, relative, worst
from raylab.stress.single import single


def true_reflectance(c: float, eta: float) -> Any:
    """R of two amplitudes, c and eta as floats."""
    m = exact()
    ci, n = m.mpf(c), m.mpf(eta)
    ct = m.sqrt(1 - (1 - ci**2) / n**2)
    r_s, r_p = (ci - n * ct) / (ci + n * ct), (n * ci - ct) / (n * ci + ct)
    return (r_s**2 + r_p**2) / 2


def usual_reflectance(c: float, eta: float) -> float:
    """The same in float64, with total reflection where the sine is not below 1."""
    sine = math.sqrt(max(0.0, 1.0 - c * c)) / eta
    if sine >= 1.0:
        return 1.0
    ct = math.sqrt(max(0.0, 1.0 - sine * sine))
    r_s, r_p = (c - eta * ct) / (c + eta * ct), (eta * c - ct) / (eta * c + ct)
    return (r_s * r_s + r_p * r_p) / 2.0


@case(
    "C07", "what glass of index 1.5 lets pass at cos = 1e-3, 1e-8, 1e-12", usual="T = 1 - R",
    rule="T = 2 eta c_i c_t (1 / (c_i + eta c_t)^2 + 1 / (eta c_i + c_t)^2)", truth="1 - R with 60 digits",
    unit="relative error of T", allowed=1e-14,
)  # fmt: skip
def grazing() -> Found:
    cosines = (1e-3, 1e-8, 1e-12)
    truths = [1 - true_reflectance(c, 1.5) for c in cosines]
    in_float32 = [single(dielectric)(np.float32(c), np.float32(1.5))[1] for c in cosines]
    return Found(
        worst([dielectric(c, 1.5)[1] for c in cosines], truths),
        worst([1.0 - usual_reflectance(c, 1.5) for c in cosines], truths), worst(in_float32, truths),
    )  # fmt: skip


@case(
    "C08", "a boundary of index 1 + 1e-9 at cos = 0.5", usual="(c_i - eta c_t) / (c_i + eta c_t)",
    rule="-(eta^2 - 1) / (c_i + eta c_t)^2", truth="R = 2.5e-18 with 60 digits", unit="error of R", allowed=1e-24,
)  # fmt: skip
def nearly_the_same() -> Found:
    eta = 1.0 + 1e-9
    truth = true_reflectance(0.5, eta)
    errors = [float(abs(f(0.5, eta) - truth)) for f in (lambda c, n: dielectric(c, n)[0], usual_reflectance)]
    return Found(errors[0], errors[1], note=f"relative error {relative(dielectric(0.5, eta)[0], truth):.1g}")


@case(
    "C09", "no boundary at all (eta = 1) at cos = 0 to 1, and the critical angle (1 -+ 1e-12)",
    usual="total reflection where sin_t >= 1", rule="R = 0 where eta = 1, 1 where eta^2 - 1 + c^2 <= 0",
    truth="R = 0, and R in [0, 1]", unit="values that cannot be", allowed=0.0,
)  # fmt: skip
def no_boundary() -> Found:
    critical = math.sqrt(1.0 - 1.5**-2)  # cos of the angle from which light comes out of glass

    def impossible(reflectance: Any) -> int:
        values = [reflectance(c, 1.0) for c in (0.0, 1e-300, 1e-9, 0.5, 1.0)]
        edge = [reflectance(critical * (1.0 + t), 1.0 / 1.5) for t in (-1e-12, -1e-16, 0.0, 1e-16, 1e-12)]
        return sum(v != 0.0 for v in values) + sum(not 0.0 <= v <= 1.0 for v in edge) + (edge[0] != 1.0)

    return Found(impossible(lambda c, n: dielectric(c, n)[0]), impossible(usual_reflectance))


@case(
    "C10", "from glass to air at 60 degrees: total reflection", usual="cos_t = sqrt(1 - sin_t^2), a NaN",
    rule="R = 1 where eta^2 - 1 + c^2 <= 0", truth="R = 1, T = 0", unit="error of R and T", allowed=0.0,
)  # fmt: skip
def total_reflection() -> Found:
    R, T, _ = dielectric(0.5, 1.0 / 1.5)
    with np.errstate(invalid="ignore"):
        c_t = float(np.sqrt(np.float64(1.0 - 0.75 * 2.25)))
    r_s = (0.5 - c_t / 1.5) / (0.5 + c_t / 1.5)
    return Found(abs(R - 1.0) + abs(T), abs(r_s * r_s - 1.0))
