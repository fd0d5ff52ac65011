"""Trials under skies: constant, a gradient, an image; diffuse, a lobe, and both."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from mutants.trial import N1, L, Trial, affine, far_dark, frame, leaving, unit
from raylab import description as d
from raylab.closed_forms import irradiance, phong

NS, SLOPE, LEVEL = unit(0.48, 0.6, 0.64), np.array([0.36, -0.24, 0.6]), 1.1


def hemisphere(n: Any, f: Callable[[Any], Any], z_order: int = 24, turns: int = 64) -> float:
    """The integral of f(w) over the hemisphere around n: exact for polynomials of degree 24."""
    x, weight = np.polynomial.legendre.leggauss(z_order)
    z, phi = 0.5 * (x + 1.0), 2.0 * np.pi * np.arange(turns) / turns
    r = np.sqrt(1.0 - z * z)
    local = np.stack(np.broadcast_arrays(r[:, None] * np.cos(phi), r[:, None] * np.sin(phi), z[:, None]), axis=-1)
    return float((f(local @ frame(n)) * (0.5 * weight)[:, None]).sum() * 2.0 * np.pi / turns)


def sky(shade: str) -> Trial:
    """Slide "Diffuse surface in env. by Monte Carlo": L(w) = a + b . w, the same in each channel but for its colour."""
    environment = d.GradientEnvironment(LEVEL * L, L[:, None] * SLOPE)
    truth = float(irradiance.gradient_sky(LEVEL, SLOPE, NS))
    largest = LEVEL + float(np.linalg.norm(SLOPE))
    pdfs = {  # 1 / p, and the largest of cos / p
        "env_uniform": (lambda w: 2.0 * np.pi + 0.0 * (w @ NS), 2.0 * math.pi * largest),
        "env_cosine": (lambda w: np.pi / (w @ NS), math.pi * largest),
        "env_brdf": (lambda w: np.pi / (w @ NS), math.pi * largest),
        "env_brightness": (lambda w: 4.0 * np.pi * LEVEL / (LEVEL + w @ SLOPE), 4.0 * math.pi * LEVEL),
    }
    inverse, high = pdfs[shade]
    second = hemisphere(NS, lambda w: ((LEVEL + w @ SLOPE) * (w @ NS)) ** 2 * inverse(w))
    return Trial(
        shade, leaving(truth), high / truth, far_dark(), NS, environment=environment, variance=second / truth**2 - 1.0
    )


def blocked_sky(shade: str = "env_cosine") -> Trial:
    """A constant sky behind a black ball."""
    radius, distance, to = 1.0, 1.9, unit(0.3, 0.2, 0.9)
    truth = float(irradiance.sphere_before_sky(radius, distance, float(to @ N1)))
    ball = d.Sphere(center=distance * to, radius=radius, front=None)
    high = {"env_cosine": math.pi, "env_uniform": 2.0 * math.pi}[shade]
    sky = d.ConstantEnvironment(L)
    return Trial(shade, leaving(truth), high / truth, (ball,), N1, environment=sky, atoms=shade == "env_cosine")


def image_sky(filter: str = "nearest") -> Trial:
    """An image sampled by its brightness: dark below 60 degrees, so that E is a sum over texels."""
    height, width = 16, 32
    rng = np.random.default_rng(5)
    values = rng.uniform(0.2, 2.0, (height, width))
    values[4, 7], values[2, 20] = 40.0, 15.0
    values[5:] = 0.0
    tilt = unit(0.25, -0.2, 1.0)
    v, omega = irradiance.texels(height, width)
    # Mitsuba's image: row 0 at local +y; longitude from -z towards +x. Local +y is world +z here.
    to_world = affine(np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), (0, 0, 0))
    truth = float((values * (v @ tilt)).sum())
    high = float((values * omega).sum()) / truth
    pixels = (values[..., None] * L).astype(np.float64)
    environment = d.ImageEnvironment(pixels, to_world, filter)
    return Trial("env_brightness", leaving(truth), high, far_dark(), tilt, environment=environment)


def image_breaks() -> dict[str, Any]:
    """Where the texels of `image_sky` have their edges, about its pole."""
    rows, columns = np.cos(np.pi * np.arange(1, 16) / 16), np.pi * (np.arange(1, 32) / 16 - 1.0)
    return {"axis": (0.0, 0.0, 1.0), "rows": tuple(rows), "columns": tuple(columns)}


def lobe_sky() -> Trial:
    """A lobe seen aslant under a constant sky, sampled by itself: k_s (n + 2) / (n + 1) at most."""
    n, cosine = 10, 0.3
    k_s = np.array([0.8, 0.6, 0.9])
    truth = k_s * L * phong.constant_sky(n, cosine)
    s, _, up = frame(N1)
    view = cosine * up + math.sqrt(1.0 - cosine**2) * s
    material = d.Phong(np.zeros(3), k_s, float(n))
    high = (n + 2.0) / (n + 1.0) / phong.constant_sky(n, cosine)
    return Trial("env_brdf", truth, high, far_dark(), N1, material, d.ConstantEnvironment(L), view=view)


def mixture_sky() -> Trial:
    """Diffuse and lobe, seen along the normal, under a gradient about it."""
    n, a, b = 10, 1.1, 0.5
    k_d, k_s = np.full(3, 0.4), np.full(3, 0.5)
    one = 0.4 * (a + 2.0 * b / 3.0) + 0.5 * phong.gradient_sky(n, a, b)
    environment = d.GradientEnvironment(a * L, L[:, None] * (b * N1))
    high = max(0.4 / (4 / 9), 0.5 / (5 / 9) * (n + 2.0) / (n + 1.0)) * (a + b) / one
    return Trial("env_brdf", one * L, high, far_dark(), N1, d.Phong(k_d, k_s, float(n)), environment, view=N1)
