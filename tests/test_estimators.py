"""Slides "Diffuse surface ..." and "Arbitrary surface in env. by Monte Carlo", "Creating glossy reflections": means
and variances of the estimators, sample by sample, against closed forms.

Each row of the tables is one sample f(w) / p(w), drawn through raylab's own maps of the square. The mean lies within
four exact standard errors, the variance within its own 99 % confidence interval, whose width is the exact fourth
moment's: se^2 = (E (X - m)^4 - var^2) / n. The fourth moment is an integral over the law of X, by quadrature.
Numbers V1 to V11 and F1 to F5 are those of the project's list of closed forms.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
from helpers import COMPILED, unit
from scipy import integrate, stats

from raylab import samplers
from raylab.brdf import Phong, reflect
from raylab.closed_forms import phong, variances
from raylab.environment import sample_linear
from raylab.jit import njit
from raylab.sampling import (
    PI,
    lift,
    pdf_cone,
    pdf_cos_hemisphere,
    pdf_hemisphere,
    sample_cone,
    sample_cos_hemisphere,
    sample_disk,
    sample_hemisphere,
)
from raylab.vec3 import Vec3, black, cross, dot

pytestmark = pytest.mark.compiled(reason="a million samples each")
SAMPLES, SIGMAS = 1_000_000, 4.0
N = unit(0.2, -0.4, 0.6)
WHITE = Vec3(1, 1, 1)
CAP = math.radians(20.0)


def draw(estimate: Any, seed: int, n: int = SAMPLES) -> np.ndarray:
    """n samples of an estimator of the unit square."""

    @njit
    def fill(u, out):
        for i in range(len(u)):
            out[i] = estimate((u[i, 0], u[i, 1]))

    out = np.empty(n)
    fill(np.random.default_rng(seed).random((n, 2)), out)
    return out


def check_mean(x: np.ndarray, mean: float, variance: float) -> None:
    assert abs(x.mean() - mean) <= SIGMAS * math.sqrt(variance / len(x)), f"{x.mean()}, exact {mean}"


# --- V1 to V10: var X ---


@njit
def uniform_constant(u):
    w = sample_hemisphere(N, u)
    return max(0.0, dot(w, N)) / PI / pdf_hemisphere(N, w)


@njit
def uniform_gradient(u):
    w = sample_hemisphere(N, u)
    return (1.0 + dot(w, N)) * max(0.0, dot(w, N)) / PI / pdf_hemisphere(N, w)


@njit
def cosine_gradient(u):
    w = sample_cos_hemisphere(N, u)
    return (1.0 + dot(w, N)) * max(0.0, dot(w, N)) / PI / pdf_cos_hemisphere(N, w)


@njit
def brightness_gradient(u):
    """p(w) = L(w) / M over the hemisphere, L = 1 + z, M = 3 pi."""
    z = sample_linear(1.0, 2.0, u[0])
    w = lift(N, z, math.sqrt((1.0 - z) * (1.0 + z)), u[1])
    return (1.0 + dot(w, N)) * dot(w, N) / PI / ((1.0 + dot(w, N)) / (3.0 * PI))


@njit
def disk_by_area(u):
    """A disk of radius 3 at height 1."""
    x, y = sample_disk(u)
    r2 = 9.0 * (x * x + y * y) + 1.0
    return 1.0 / PI / (r2 * r2) * (9.0 * PI)


@njit
def uniform_cap(u):
    w = sample_hemisphere(N, u)
    return dot(w, N) / PI / pdf_hemisphere(N, w) if dot(w, N) > math.cos(CAP) else 0.0


@njit
def cosine_cap(u):
    w = sample_cos_hemisphere(N, u)
    return dot(w, N) / PI / pdf_cos_hemisphere(N, w) if dot(w, N) > math.cos(CAP) else 0.0


@njit
def cone_cap(u):
    w = sample_cone(N, math.sin(CAP), u)
    return dot(w, N) / PI / pdf_cone(N, math.sin(CAP), w)


@njit
def lobe_by_itself(u):
    w, p = Phong(black, WHITE, 20.0, N).sample(N, N, u)
    return Phong(black, WHITE, 20.0, N).eval(N, w).x * max(0.0, dot(w, N)) / p


@njit
def lobe_uniform(u):
    w = sample_hemisphere(N, u)
    return Phong(black, WHITE, 20.0, N).eval(N, w).x * max(0.0, dot(w, N)) / pdf_hemisphere(N, w)


@njit
def lobe_cosine(u):
    w = sample_cos_hemisphere(N, u)
    return Phong(black, WHITE, 20.0, N).eval(N, w).x * max(0.0, dot(w, N)) / pdf_cos_hemisphere(N, w)


class Row(NamedTuple):
    """An estimator, its exact mean and variance, and its law: X(t) with t of density p(t) on [low, high]."""

    estimate: Any
    mean: float
    variance: float
    x: Callable[[float], float]
    density: Callable[[float], float]
    low: float = 0.0
    high: float = 1.0


RIM = math.cos(CAP)
TABLE = {
    "V1 uniform, constant sky": Row(
        uniform_constant, 1.0, variances.env_uniform_gradient(1.0, 0.0), lambda c: 2 * c, lambda c: 1.0),
    "V2 uniform, gradient": Row(
        uniform_gradient, 5 / 3, variances.env_uniform_gradient(1.0, 1.0), lambda c: 2 * c * (1 + c), lambda c: 1.0),
    "V3 cosine, gradient": Row(
        cosine_gradient, 5 / 3, variances.env_cosine_gradient(1.0), lambda c: 1 + c, lambda c: 2 * c),
    "V4 brightness, gradient": Row(
        brightness_gradient, 5 / 3, variances.env_brightness_gradient(1.0, 1.0),
        lambda c: 3 * c, lambda c: (1 + c) / 1.5),
    "V5 disk by area": Row(
        disk_by_area, 0.9, variances.area_disk(3.0, 1.0), lambda q: 9 / (1 + 9 * q) ** 2, lambda q: 1.0),
    "V6 cap, uniform": Row(
        uniform_cap, math.sin(CAP) ** 2, variances.env_uniform_cap(CAP),
        lambda c: 2 * c * (c > RIM), lambda c: 1.0),
    "V7 cap, cosine": Row(
        cosine_cap, math.sin(CAP) ** 2, variances.env_cosine_cap(CAP), lambda c: float(c > RIM), lambda c: 2 * c),
    "V8 cap by its cone": Row(
        cone_cap, math.sin(CAP) ** 2, variances.cone_cap(CAP),
        lambda c: 2 * (1 - RIM) * c, lambda c: 1 / (1 - RIM), RIM),
    "V9 lobe by itself": Row(
        lobe_by_itself, 1.0, variances.phong_brdf(20), lambda c: 22 / 21 * c, lambda c: 21 * c**20),
    "V10 lobe, uniform": Row(
        lobe_uniform, 1.0, variances.phong_uniform(20), lambda c: 22 * c**21, lambda c: 1.0),
    "V10b lobe, cosine": Row(
        lobe_cosine, 1.0, variances.phong_cosine(20), lambda c: 11 * c**20, lambda c: 2 * c),
}  # fmt: skip


def moment(row: Row, power: int) -> float:
    """E (X - mean)^power by quadrature over the law."""

    def integrand(t: float) -> float:
        return (row.x(t) - row.mean) ** power * row.density(t)

    kinks = [RIM] if row.low < RIM else None
    return integrate.quad(integrand, row.low, row.high, points=kinks, epsabs=0.0, epsrel=1e-10, limit=200)[0]


@pytest.mark.parametrize("name", TABLE)
def test_mean_and_variance(name):
    row = TABLE[name]
    assert moment(row, 2) == pytest.approx(row.variance, rel=1e-9)  # the law belongs to the closed form
    x = draw(row.estimate, seed=list(TABLE).index(name))
    check_mean(x, row.mean, row.variance)
    error = math.sqrt((moment(row, 4) - row.variance**2) / len(x))
    assert abs(x.var() - row.variance) <= stats.norm.isf(0.005) * error, f"{x.var()}, exact {row.variance} +- {error}"


def test_mean_and_variance_of_jittered_samples():
    """V11, slide "Creating soft shadows": 8 x 8 jittered samples of V1, each mean with variance 1 / (3 N^2)."""
    n, repeats = 64, 20_000
    sampler = samplers.make("stratified", 0, n)

    @njit
    def means(sampler, out):
        for pixel in range(len(out)):
            total = 0.0
            for sample in range(n):
                total += uniform_constant(sampler.stream(pixel, 0, sample).square())
            out[pixel] = total / n

    x = np.empty(repeats)
    means(sampler, x)
    variance = 1.0 / (3.0 * n**2)
    check_mean(x, 1.0, variance)
    kurtosis = 3.0 - 1.2 / n  # of a sum of n independent uniform numbers
    error = variance * math.sqrt((kurtosis - 1.0) / repeats)
    assert abs(x.var() - variance) <= stats.norm.isf(0.005) * error


# --- F1 to F5: E X of a Phong lobe sampled by itself ---

TRIANGLE = np.array([(-0.3, -0.5, 0.6), (0.9, -0.1, 1.1), (0.1, 0.8, 0.7)])
UP, MIRROR = Vec3(0, 0, 1), Vec3(0.36, 0.48, 0.8)
A, B, C = (Vec3(*corner) for corner in TRIANGLE)


def view_of(normal, mirror):
    """The V whose mirror direction is `mirror`."""
    return reflect(mirror, normal)


@njit
def in_triangle(w):
    return dot(cross(A, B), w) > 0.0 and dot(cross(B, C), w) > 0.0 and dot(cross(C, A), w) > 0.0


def reflected(n, normal, mirror, what):
    """The estimator f(w) cos / p(w) of a lobe, times the light: 1, 1.1 + 0.5 z or the triangle; `tau` has no cosine."""
    V, exponent = view_of(normal, mirror), float(n)

    @njit
    def estimate(u):
        brdf = Phong(black, WHITE, exponent, normal)
        w, p = brdf.sample(V, normal, u)
        cosine = dot(w, normal)
        if cosine <= 0.0:
            return 0.0
        if what == "tau":
            return brdf.eval(V, w).x * (2.0 * PI / (exponent + 2.0)) / p
        L = 1.0
        if what == "gradient":
            L = 1.1 + 0.5 * cosine
        elif what == "triangle":
            L = 1.0 if in_triangle(w) else 0.0
        return L * brdf.eval(V, w).x * cosine / p

    return estimate


def lune_second_moment(n, cosine):
    """(n + 1)/(2 pi) times the integral of (R . w)^n (N . w)^2 over N . w > 0, R . w > 0, ring by ring around R."""
    sine = math.sqrt(1 - cosine**2)

    def ring(c):
        a, b = cosine * c, sine * math.sqrt(1 - c * c)
        end = math.acos(max(-1.0, min(1.0, -a / b))) if b > 0 else math.pi
        turn = 2 * ((a * a + b * b / 2) * end + 2 * a * b * math.sin(end) + b * b / 4 * math.sin(2 * end))
        return (n + 1) / (2 * math.pi) * c**n * turn

    return integrate.quad(ring, 0.0, 1.0, points=[sine], epsrel=1e-9, limit=200)[0]


def triangle_second_moment(n):
    """(n + 1)/(2 pi) times the integral of (R . w)^n z^2 over the triangle seen from the origin."""
    e1, e2 = TRIANGLE[1] - TRIANGLE[0], TRIANGLE[2] - TRIANGLE[0]
    normal = np.cross(e1, e2)

    def integrand(t, s):
        y = TRIANGLE[0] + s * e1 + t * e2
        r = np.linalg.norm(y)
        return (
            (n + 1)
            / (2 * math.pi)
            * max(0.0, y @ [0.36, 0.48, 0.8] / r) ** n
            * (y[2] / r) ** 2
            * abs(y @ normal)
            / r**3
        )

    return integrate.dblquad(integrand, 0.0, 1.0, 0.0, lambda s: 1.0 - s, epsrel=1e-8)[0]


TILTED = Vec3(0.8, 0.0, 0.6)  # a mirror direction with N . R = 0.6


def lobes() -> dict[str, tuple[Any, float, float]]:
    """Estimator, exact mean and exact variance."""
    found: dict[str, tuple[Any, float, float]] = {}
    for n in (1, 10, 50):
        found[f"F1 n={n}"] = reflected(n, N, N, "sky"), 1.0, variances.phong_brdf(n)
    for n in (2, 5, 20):
        tau, scale = phong.lune_moments(n, 0.6)[0], 2 * math.pi / (n + 1)  # hit or miss
        found[f"F2 n={n}"] = reflected(n, UP, TILTED, "tau"), tau, tau * (scale - tau)
    for n in (2, 10, 20):
        mean = phong.constant_sky(n, 0.6)
        second = ((n + 2) / (n + 1)) ** 2 * lune_second_moment(n, 0.6)
        found[f"F3 n={n}"] = reflected(n, UP, TILTED, "sky"), mean, second - mean**2
    n, a, b = 10, 1.1, 0.5
    second = (n + 2) ** 2 / (n + 1) * (a * a / (n + 3) + 2 * a * b / (n + 4) + b * b / (n + 5))
    mean = phong.gradient_sky(n, a, b)
    found["F4 n=10"] = reflected(n, N, N, "gradient"), mean, second - mean**2
    for n in (1, 2, 7, 20):
        mean = phong.polygon(TRIANGLE, n, [*MIRROR])
        second = ((n + 2) / (n + 1)) ** 2 * triangle_second_moment(n)
        found[f"F5 n={n}"] = reflected(n, UP, MIRROR, "triangle"), mean, second - mean**2
    return found


LOBES = lobes() if COMPILED else {}


@pytest.mark.parametrize("name", LOBES)
def test_a_phong_lobe_is_matched_exactly(name):
    estimate, mean, variance = LOBES[name]
    check_mean(draw(estimate, seed=100 + list(LOBES).index(name)), mean, variance)
