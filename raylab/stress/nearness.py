"""Nearness: lights that are edge-on, touch, lie in the plane of the surface or on it, or are all of these far away."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab import shade
from raylab.errors import SceneError
from raylab.jit import interpreted
from raylab.lights import to_area
from raylab.point import free_point
from raylab.probe import Place, Probe
from raylab.scene import Scene
from raylab.stress.case import U53, Found, case
from raylab.stress.lamps import UP, squares
from raylab.stress.oracle import exact
from raylab.vec3 import Vec3

Array = npt.NDArray[np.float64]
WHITE = d.Diffuse(np.ones(3))
FEW = 20_000


def placed(x: float, y: float, z: float, a: float, b: float, c: float = 1.0) -> Array:
    """The square [-1, 1]^2 stretched to half sizes a and b (c < 0: face down), then moved."""
    m = np.diag([a, b, c, 1.0])
    m[:3, 3] = (x, y, z)
    return m


def over_a_floor(light: npt.ArrayLike, world: npt.ArrayLike | None = None) -> Scene:
    """A white floor [-4, 4]^2 at z = 0 and a rectangle of radiance 1, both put somewhere by `world`."""
    world = np.eye(4) if world is None else np.asarray(world, float)
    floor = d.Rectangle(to_world=world @ placed(0, 0, 0, 4, 4), front=WHITE)
    lamp = d.Rectangle(to_world=world @ np.asarray(light, float), radiance=np.ones(3), front=None)
    return Scene(d.SceneDescription(shapes=(floor, lamp)))


def seen(
    scene: Scene, strategy: str, point: npt.ArrayLike, view: npt.ArrayLike = (0.1, 0.2, 1.0), n: int = FEW
) -> Array:
    """n samples at a point of the surface of a scene, one channel."""
    return Probe(scene, strategy, Place.at(scene, point, view)).sample(6, n)[:, 0]


@case(
    "B13", "a light edge-on, tilted by 90 degrees -+ 1e-8, 1e-12, 1e-16", usual="dot(-L, n_y), not clamped",
    rule="max(0, -d . n) / |d|^3", truth="max(0, cos) of the same floats, 60 digits",
    unit="error of cos(theta_s) / r^2, in 1 / r^2", allowed=4 * U53,
)  # fmt: skip
def edge_on() -> Found:
    m = exact()
    error = usual = 0.0
    for direction in squares(20):
        y = Vec3(float(direction[0]), float(direction[1]), 1.2)
        along = np.array(tuple(y)) / np.linalg.norm(tuple(y))
        across = np.cross(along, (0.0, 0.0, 1.0)) / np.linalg.norm(np.cross(along, (0.0, 0.0, 1.0)))
        for tilt in (1e-8, 1e-12, 1e-16, -1e-8, -1e-12, -1e-16):
            n = Vec3(*(across * math.cos(tilt) - along * math.sin(tilt)))
            d_n = -sum(m.mpf(a) * m.mpf(b) for a, b in zip(y, n, strict=True))
            r = m.sqrt(sum(m.mpf(a) ** 2 for a in y))
            truth = max(m.mpf(0), d_n / r)
            ours = to_area(free_point(Vec3(0.0, 0.0, 0.0)), free_point(y)._replace(n=n))
            error = max(error, float(abs(ours * r * r - truth))) if ours >= 0.0 else math.nan
            usual = max(usual, float(abs(m.mpf(float(-along @ np.array(tuple(n)))) - truth)))
    return Found(error, usual)


SCALES = (2.0**-498, 2.0**498)  # 1.2e-150 and 8.2e149
BEYOND = (1e-162, 1e-160, 1e155, 1e160)


@case(
    "B14", "floor and lamp in a scene of size 2^-498 and 2^498 (8e149); at 1e-162 and 1e155",
    usual="d / |d| and 1 / |d|^2 of the world's lengths",
    rule="the scene is scaled to [-1, 1] by a power of two first; beyond 2^500 it is refused",
    truth="the same scene at size 1, bit by bit", unit="samples of 40,000 that differ, refusals missing",
    allowed=0.0, limit=60.0,
)  # fmt: skip
def of_any_size() -> Found:
    light = placed(0.25, 0.5, 1.0, 0.5, 0.5, -1.0)
    expected = seen(over_a_floor(light), "area", (0.0, 0.0, 0.0))
    wrong = 0
    for size in SCALES:
        scene = over_a_floor(light, np.diag([size, size, size, 1.0]))
        wrong += int((seen(scene, "area", (0.0, 0.0, 0.0)) != expected).sum())
    wrong += sum(not refused(size) for size in BEYOND)
    usual = sum(int((~np.isclose(world_lengths(size), world_lengths(1.0))).sum()) for size in (*SCALES, *BEYOND))
    return Found(wrong, usual)


def refused(size: float) -> bool:
    """Is a scene of this size refused, with a sentence about its size?"""
    try:
        over_a_floor(placed(0.25, 0.5, 1.0, 0.5, 0.5, -1.0), np.diag([size, size, size, 1.0]))
    except SceneError as refusal:
        return "large; at least" in str(refusal) or "reaches" in str(refusal)
    return False


def world_lengths(size: float) -> Array:
    """The slide in the lengths of the world: A cos cos / r^2 for points of a square above."""
    y = size * np.column_stack([squares(FEW), np.ones(FEW)])
    with np.errstate(all="ignore"):
        rr = (y * y).sum(axis=1)
        w = y / np.sqrt(rr)[:, None]
        g: Array = (size * size) * w[:, 2] * w[:, 2] / rr
    return g


@case(
    "B15", "the irradiance of a lamp in a scene of size 1e-150 and 8e149; at 1e-160 and 1e160, of infinite area",
    usual="A cos cos / r^2 of the world's lengths",
    rule="the scene is scaled to [-1, 1] by a power of two first; beyond 2^500 it is refused",
    truth="the same scene at size 1", unit="relative error of the mean, NaN if it is not refused", allowed=1e-14,
)  # fmt: skip
def of_infinite_area() -> Found:
    light = placed(0.25, 0.5, 1.0, 0.5, 0.5, -1.0)
    expected, world = (v.mean() for v in (seen(over_a_floor(light), "area", (0.0, 0.0, 0.0)), world_lengths(1.0)))
    error = usual = 0.0
    for size in SCALES:
        mean = seen(over_a_floor(light, np.diag([size, size, size, 1.0])), "area", (0.0, 0.0, 0.0)).mean()
        error = max(error, abs(float(mean / expected) - 1.0))
    for size in (1e-160, 1e160):
        error = error if refused(size) else math.nan
        usual = max(abs(float(world_lengths(size).mean() / world) - 1.0), usual)  # a NaN, should it be one
    return Found(error, usual)


class Here:
    """A light that is found where it is looked for."""

    radiance = Vec3(1.0, 1.0, 1.0)

    def sample(self, x: Any, u: Any) -> tuple[Any, float]:
        return x, 1.0


@case(
    "B16", "a sample of a light that is the shaded point itself", usual="cos cos / |x - y|^2 = 0 / 0",
    rule="what does not rise above the surface is in its shadow, before anything is divided", truth="no light",
    unit="radiance", allowed=0.0,
)  # fmt: skip
def the_same_point() -> Found:
    x = free_point(Vec3(0.25, 0.5, 0.0))._replace(n=UP)
    scene = SimpleNamespace(lights=[Here()])
    rng = SimpleNamespace(square=lambda: (0.5, 0.5))
    with interpreted():
        ours = shade.area_diffuse(x, Vec3(1.0, 1.0, 1.0), UP, scene, rng)
    w = np.array(tuple(x.p)) - np.array(tuple(x.p))
    with np.errstate(invalid="ignore"):
        usual = float(w[2] * w[2] / (w @ w) ** 2)
    return Found(max(map(abs, ours)), usual)


def turned(offset: float) -> Array:
    """A rotation that leaves nothing aligned, and a translation."""
    m = np.eye(4)
    q, _ = np.linalg.qr(np.array([[1.0, 0.3, -0.2], [0.4, 1.0, 0.7], [-0.1, 0.6, 1.0]]))
    m[:3, :3] = q * np.sign(np.linalg.det(q))
    m[:3, 3] = (offset, 0.7 * offset, -0.4 * offset)
    return m


@case(
    "B17", "a lamp in the plane of the floor, at the origin and 1e6 away, level and rotated, and a point of the lamp",
    usual="|cos| |cos| / r^2, as on the slide \"Area source by Monte Carlo\"",
    rule="in shadow within the rounding of float32 of either plane", truth="no light",
    unit="samples of 120,000 that are not 0", allowed=0.0, limit=60.0,
)  # fmt: skip
def in_the_same_plane() -> Found:
    wrong = usual = 0
    for world in (np.eye(4), turned(0.0), turned(1e6)):
        scene = over_a_floor(placed(1.0, 0.5, 0.0, 0.5, 0.5), world)
        point, view = (world @ (-1.0, 0.25, 0.0, 1.0))[:3], world[:3, :3] @ (0.1, 0.2, 1.0)
        for strategy in ("area", "area_solid_angle"):
            wrong += int((seen(scene, strategy, point, view) != 0.0).sum())
        y = (np.column_stack([0.5 + squares(2 * FEW), np.zeros(2 * FEW), np.ones(2 * FEW)]) @ world.T)[:, :3]
        w, n = y - point, world[:3, 2]
        usual += int(((np.abs(w @ n) * np.abs(w @ n) / (w * w).sum(axis=1) ** 2) != 0.0).sum())
    return Found(wrong, usual)


@case(
    "B18", "a lamp above the floor that faces up, and one below the floor that faces down",
    usual="the slide's cosines, not clamped", rule="max(0, .) of both cosines", truth="no light",
    unit="largest radiance of a white floor, times pi", allowed=0.0,
)  # fmt: skip
def facing_away() -> Found:
    above, below = placed(0, 0, 1, 1, 1), placed(0, 0, -1, 1, 1, -1)
    ours = max(float(np.abs(seen(over_a_floor(light), "area", (0.0, 0.0, 0.0))).max()) for light in (above, below))
    w = np.column_stack([2.0 * squares(FEW) - 1.0, np.ones(FEW)])
    usual = float((4.0 * w[:, 2] * -w[:, 2] / (w * w).sum(axis=1) ** 2).mean())
    return Found(math.pi * ours, abs(usual))
