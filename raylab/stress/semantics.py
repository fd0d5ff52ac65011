"""Semantics: what Python and numba make of NaN, of division by zero, of roots and integers out of range."""

from __future__ import annotations

import importlib
import math
import pkgutil
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numba
import numpy as np

import raylab
from raylab import description as d
from raylab.fresnel import dielectric
from raylab.jit import OPTIONS, Compiled, njit
from raylab.materials import BILINEAR, NEAREST, Textures
from raylab.sampling import (
    sample_concentric_disk,
    sample_cone,
    sample_cos_hemisphere,
    sample_disk,
    sample_hemisphere,
    sample_phong_lobe,
    sample_sphere,
)
from raylab.sky import make_environment
from raylab.stress.case import Found, case
from raylab.stress.meshes import mesh, met
from raylab.stress.odd_rays import ball
from raylab.vec3 import Vec3, is_finite
from raylab.view import View

NAN, INF = math.nan, math.inf
ULP = 2.0**-52
KINDS: tuple[Any, ...] = ("nearest", "bilinear")


def compilers() -> Iterator[tuple[str, dict[str, Any]]]:
    """Name and options of each compiled function in the modules of the package."""
    for module in pkgutil.iter_modules(raylab.__path__):
        if module.ispkg or module.name == "pytest_plugin":
            continue
        for name, value in vars(importlib.import_module(f"raylab.{module.name}")).items():
            if isinstance(value, Compiled):
                yield f"{module.name}.{name}", value._outer.targetoptions
                yield f"{module.name}.{name}, inside", value.inner.targetoptions
            elif hasattr(value, "targetoptions"):
                yield f"{module.name}.{name}", value.targetoptions


def _is_nan(x):
    return np.isnan(x)


def _differs_from_itself(x):
    return x != x


def _is_not_finite(x):
    return not math.isfinite(x)


GUARDS: tuple[Callable[..., Any], ...] = (_is_nan, _differs_from_itself, _is_not_finite)


@case(
    "I01", "tests for NaN in compiled code", usual="njit with fastmath", rule="no fastmath, anywhere",
    truth="NaN is found, by isnan, by x != x and by isfinite", unit="tests deleted + functions with fastmath",
)  # fmt: skip
def guards() -> Found:
    options = dict(compilers())
    fast = [name for name, chosen in options.items() if chosen.get("fastmath")]
    deleted = sum(not njit(guard)(NAN) for guard in GUARDS) + is_finite(Vec3(0.0, NAN, 0.0))
    fastmath: dict[str, Any] = {"fastmath": True}
    usual = sum(not numba.njit(**fastmath)(guard)(NAN) for guard in GUARDS)
    return Found(
        deleted + len(fast) + bool(OPTIONS["fastmath"]), float(usual), note=f"({len(options)} functions looked at)"
    )


def _divide(a, b):
    return a / b


@case(
    "I02", "1 / 0, -1 / 0, 0 / 0, on one thread and on two", usual="njit: ZeroDivisionError, or inf with parallel=True",
    rule='error_model="numpy"', truth="inf, -inf, NaN", unit="answers that differ",
)  # fmt: skip
def division_by_zero() -> Found:
    divide, raising = njit(_divide), numba.njit(_divide)
    expected = np.array([INF, -INF, NAN])
    with ThreadPoolExecutor(2) as pool:
        ours = sum(
            not np.array_equal(list(run(divide, (1.0, -1.0, 0.0), (0.0, 0.0, 0.0))), expected, equal_nan=True)
            for run in (map, pool.map)
        )
    theirs = 0
    for a in (1.0, -1.0, 0.0):
        try:
            raising(a, 0.0)
        except ZeroDivisionError:
            theirs += 1
    return Found(ours, theirs)


def _clamped(x):
    return max(0.0, x), max(x, 0.0), x if x > 0.0 else 0.0


@case(
    "I03", "max(0, NaN), max(NaN, 0)", usual="np.maximum", rule="max as Python has it; what stays NaN is counted",
    truth="Python: 0 and NaN", unit="answers that differ",
)  # fmt: skip
def maximum() -> Found:
    ours = theirs = 0
    for x in (NAN, INF, -INF, 1.0, -1.0, 0.0, -0.0):
        expected = _clamped(x)
        ours += not np.array_equal(njit(_clamped)(x), expected, equal_nan=True)
        usual = (float(np.maximum(0.0, x)), float(np.maximum(x, 0.0)), x if x > 0.0 else 0.0)
        theirs += not np.array_equal(usual, expected, equal_nan=True)
    return Found(ours, theirs)


@njit
def every_sample(N, u, v):
    """The maps from the unit square at one point of it; NaN in one spoils their sum."""
    p = (u, v)
    a, b, c = sample_hemisphere(N, p), sample_cos_hemisphere(N, p), sample_sphere(p)
    e, f = sample_cone(N, 1.0, p), sample_cone(N, 2.0**-26, p)
    g, h = sample_phong_lobe(N, 1e7, p), sample_phong_lobe(N, 0.0, p)
    (x, y), (s, t) = sample_disk(p), sample_concentric_disk(p)
    total = a + b + c + e + f + g + h
    return total.x, total.y, total.z, x, y, s, t


@njit
def sky_at(sky, w):
    return sky.eval(w)


@njit
def sky_density(sky, w):
    return sky.pdf(w, w)


@njit
def texture_at(textures, u, v):
    return textures.colour(0, (u, v), Vec3(0.0, 0.0, 0.0))


def _root_and_angle(x, z):
    return math.sqrt(x), math.acos(z)


@case(
    "I04", "square roots of -1e-17 and arc cosines of 1 + 1e-15: the corners of the unit square, poles, grazing angles",
    usual="sqrt(1 - x^2 - y^2), acos(z)", rule="products that cannot be negative, atan2, clamped arguments",
    truth="every number is finite", unit="numbers that are not finite",
)  # fmt: skip
def roots_out_of_range() -> Found:
    bad = 0
    ends = (0.0, 2.0**-53, 0.5, 1.0 - 2.0**-53)
    normals = (Vec3(0.0, 0.0, 1.0), Vec3(0.0, 0.0, -1.0), Vec3(1.0, 0.0, 0.0), Vec3(0.006, 0.008, -math.sqrt(0.9999)))
    for N in normals:
        for u in ends:
            for v in ends:
                bad += not all(map(np.isfinite, every_sample(N, u, v)))
    for eta in (1.0, 1.0 + ULP, 1.5, 1 / 1.5):
        for c in (0.0, 5e-324, 2.0**-53, math.sqrt(1.0 - 1 / 2.25), 1.0, 1.0 + ULP):
            bad += not all(map(math.isfinite, dielectric(c, eta)))
    sky = make_environment(d.ImageEnvironment(np.ones((4, 8, 3))))
    for y in (1.0, -1.0, 1.0 + ULP, -1.0 - ULP):
        bad += not math.isfinite(sky_at(sky, Vec3(0.0, y, 0.0)).x + sky_density(sky, Vec3(0.0, y, 0.0)))
    usual = numba.njit(_root_and_angle)(-1e-17, 1.0 + 1e-15)
    return Found(bad, float(sum(map(math.isnan, usual))))


def _texel(x, n):
    return min(int(x * n), n - 1)


@case(
    "I05", "texture coordinates and directions that are NaN, infinite or 1e300", usual="min(int(x n), n - 1)",
    rule="the range is looked at before int(); the answer is NaN, which is counted", truth="NaN, not a texel",
    unit="numbers made up, or places outside the image",
)  # fmt: skip
def integers_out_of_range() -> Found:
    wrong = theirs = 0
    for filter in (NEAREST, BILINEAR):
        sheets, maps = View(np.array([[0, 4, 4, filter, 0]])), View(np.array([[1.0, 0, 0, 0, 1, 0]]))
        textures = Textures(sheets, maps, View(np.ones((16, 3))))
        for x in (NAN, INF, -INF, 1e300, -1e300):
            wrong += not math.isnan(texture_at(textures, x, 0.5).x)
            wrong += not math.isnan(texture_at(textures, 0.5, x).x)
    for kind in KINDS:
        sky = make_environment(d.ImageEnvironment(np.ones((4, 8, 3)), filter=kind))
        for w in (Vec3(NAN, 0.0, 1.0), Vec3(INF, 0.0, 0.0), Vec3(0.0, -INF, 0.0), Vec3(NAN, NAN, NAN)):
            wrong += not math.isnan(sky_at(sky, w).x)
            wrong += not math.isnan(sky_density(sky, w))
    for x in (NAN, INF, -INF, 1e300, -1e300):
        theirs += not 0 <= numba.njit(_texel)(x, 4) < 4
    return Found(wrong, theirs)


def _halved(x):
    return x * 0.5, x * 1.0, x + x


@case(
    "I06", "the smallest numbers after Embree has built and traced, on three threads", rule="nothing to do",
    truth="5e-324 survives", unit="numbers flushed to zero",
)  # fmt: skip
def small_numbers() -> Found:
    halved, lost = njit(_halved), 0
    scene = mesh(*ball(4))

    def trace_and_look(seed: int) -> int:
        rng = np.random.default_rng(seed)
        met(scene, rng.normal(size=(1000, 3)) * 2.0, rng.normal(size=(1000, 3)))
        return sum(value != expected for value, expected in zip(halved(1e-323), (5e-324, 1e-323, 2e-323), strict=True))

    with ThreadPoolExecutor(2) as pool:
        lost += sum(pool.map(trace_and_look, range(2)))
    return Found(lost + trace_and_look(3) + (np.float64(5e-324) * 1.0 == 0.0))
