"""Stiff scenes: small pictures in which one strategy is stiff, S1 to S12, with the strategies to compare, usual first.

All look straight down at a floor in z = 0. Where a light hangs in between, `near_clip` starts the eye rays below it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.stress.nearness import WHITE, placed
from raylab.stress.stiff_shades import by_brdf, sphere_by_area, uniform_hemisphere

SIDE, EYE = 32, 8.0  # pixels, and the height of the eye
MORE = (1024, 4096, 16384, 65536)  # samples of a picture of one pixel
ONE = np.ones(3)
Shade = str | Callable[..., Any]


@dataclass(frozen=True)
class Stiff:
    """A scene, the strategies and samplers that render it, and why the first is stiff."""

    id: str
    title: str
    theory: str  # the variance, or why there is none
    make: Callable[[], d.SceneDescription]
    shades: tuple[Shade, ...]
    samplers: tuple[str, ...] = ("independent",)
    spp: tuple[int, ...] = (4, 16, 64, 256)
    repeats: int = 12


def floor(material: d.Material = WHITE) -> d.Rectangle:
    return d.Rectangle(to_world=placed(0, 0, 0, 4, 4), front=material)


def down(half: float, start: float = 4.0, side: int = SIDE, x: float = 0.0, **more: Any) -> d.Camera:
    """Sees [x - half, x + half] x [-half, half] of the floor, by rays that start at the height `start`."""
    eye = np.diag([1.0, -1.0, -1.0, 1.0])
    eye[:3, 3] = (x, 0.0, EYE)
    fov = math.degrees(2.0 * math.atan(half / EYE))
    return d.Camera(eye, fov=fov, near_clip=EYE - start, width=side, height=side, **more)


def lit(camera: d.Camera, *shapes: d.Shape, ground: d.Material = WHITE, **more: Any) -> d.SceneDescription:
    return d.SceneDescription(camera=camera, shapes=(floor(ground), *shapes), **more)


def glowing(shape: type[d.Shape], to_world: npt.ArrayLike, radiance: float = 1.0) -> Any:
    return shape(to_world=np.asarray(to_world, float), radiance=radiance * ONE, front=None)


LOBE = d.Phong(np.zeros(3), ONE, 1000.0)
WALL = [[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 1], [0, 0, 0, 1]]  # [-1, 1] x [0, 2] in the plane x = 0


def disk_near() -> d.SceneDescription:
    return lit(down(0.5, start=0.015), glowing(d.Disk, placed(0, 0, 0.03, 1, 1, -1)))


def at_the_foot() -> d.SceneDescription:
    return lit(down(0.25, side=1, x=0.25), glowing(d.Rectangle, WALL))


def sphere_near() -> d.SceneDescription:
    return lit(down(0.1, start=0.015), glowing(d.Sphere, placed(0, 0, 1.03, 1, 1)))


def lobe_in_a_light() -> d.SceneDescription:
    return lit(down(0.5, start=1.0), glowing(d.Rectangle, placed(0, 0, 3, 3, 3, -1)), ground=LOBE)


def tiny_light() -> d.SceneDescription:
    return lit(down(0.5, start=1.0), glowing(d.Disk, placed(0, 0, 2, 0.02, 0.02, -1), 1e3))


def lobe_under_a_sky() -> d.SceneDescription:
    return lit(down(0.5), ground=LOBE, environment=d.ConstantEnvironment(ONE))


def sunny(sun: float) -> Callable[[], d.SceneDescription]:
    def make() -> d.SceneDescription:
        sky = np.ones((16, 32, 3))
        sky[2, 5] = sun
        up = np.eye(4)[[0, 2, 1, 3]] * [[1], [-1], [1], [1]]  # the image's pole, +y, becomes +z
        return lit(down(0.5), environment=d.ImageEnvironment(sky, to_world=up, filter="nearest"))

    return make


def point_over_a_pixel() -> d.SceneDescription:
    return lit(down(0.5, side=1), lights=(d.PointLight(np.array([0.0, 0.0, 0.02]), ONE),))


def one_of_many() -> d.SceneDescription:
    lamps = [glowing(d.Rectangle, placed(0.2 * i, 0, 1, 1e-2, 1e-2, -1), 1e4 if i == 0 else 1e-8) for i in range(-8, 8)]
    return lit(down(0.5, start=0.5), *lamps)


def highlight() -> d.SceneDescription:
    eye = down(0.4, start=7.0, aperture_radius=0.5, focus_distance=EYE)
    return lit(eye, glowing(d.Disk, placed(0, 0, 4, 0.01, 0.01), 1e3), glowing(d.Disk, placed(3, 0, 4, 1, 1, -1)))


def half_below() -> d.SceneDescription:
    return lit(down(0.25), glowing(d.Sphere, placed(3, 0, 0, 1, 1)))


TABLE = (
    Stiff("S01", "a disk of radius R = 1, h = 0.03 above the floor",
          "By area g = pi R^2 h^2 / (h^2 + rho^2)^2 below the middle, E g^2 = pi^2 R^2 h^4 / 3 (h^-6 - "
          "(h^2 + R^2)^-3): relative variance R^2 / (3 h^2) = 370. By solid angle at most 1/3.",
          disk_near, ("area", "area_solid_angle", "mis_balance")),
    Stiff("S02", "a wall light that stands on the floor, and a pixel of 1/2 x 1/2 at its foot",
          "By area E g^2 = pi A / (24 e^2) at the distance e from the foot, and over a pixel with the foot in it the "
          "integral of de / e^2 diverges: no variance. With y, z in units of e and e = s sqrt(A / t), P(g > t) = "
          "C t^(-3/2): the error falls as N^(-1/3). By solid angle g <= Omega <= pi; combined with the BRDF "
          "f / (p + q) <= f / q: bounded.",
          at_the_foot, ("area", "area_solid_angle", "mis_balance"), spp=MORE, repeats=64),
    Stiff("S03", "a sphere of radius 1, d = 0.03 above the floor",
          "By area relative variance 4 R^2 / (3 d^2) = 1500 below the middle (5/3 from afar: half of the sphere faces "
          "away). Uniform in its cone at most 1/3.",
          sphere_near, (sphere_by_area, "area", "mis_balance")),
    Stiff("S04", "a lobe of exponent n = 1000 within a large light",
          "By light E g^2 = Omega (n + 1)^2 / (2 pi (2 n + 1)): relative variance about Omega n / (4 pi). By BRDF next "
          "to none; combined below 0.14 for all lights and lobes (figure light_or_brdf).",
          lobe_in_a_light, ("area", by_brdf, "mis_balance", "mis_power")),
    Stiff("S05", "a light that fills p = 1e-4 of the cosine-weighted hemisphere, over a diffuse floor",
          "By BRDF hit or miss: relative variance (1 - p) / p = 1e4. By light about 0.",
          tiny_light, (by_brdf, "area", "mis_balance")),
    Stiff("S06+S08", "a lobe of exponent n = 1000 under a constant sky",
          "Uniform over the hemisphere (n + 1)^2 / (2 n + 1) - 1, about n / 2, by the sky's own samples over the "
          "sphere about n; in proportion to the BRDF 0, but for the cosine that Phong's lobe leaves out.",
          lobe_under_a_sky, (uniform_hemisphere, "env_brightness", "env_brdf", "mis_balance")),
    Stiff("S07", "a sky with a sun of 1e4 : 1, over a diffuse floor",
          "A sum over the texels: 189 by cosine, 0.045 by brightness; with a dim sun the order is reversed (S07x). "
          "Combined at most the better one's and 1/2 (Veach 1997, theorem 9.2, one sample of each).",
          sunny(1e4), ("env_cosine", "env_brightness", "mis_balance")),
    Stiff("S07x", "the same sky with a sun of 2 : 1", "A sum over the texels: 0.005 by cosine, 1.7 by brightness.",
          sunny(2.0), ("env_brightness", "env_cosine", "mis_balance")),
    Stiff("S09", "a point light h = 0.02 above the middle of a pixel of area P = 1",
          "E g^2 = pi I^2 / (2 h^2) over the pixel: relative variance P / (8 pi h^2) = 100. Strata and nets of the "
          "pixel cure it.",
          point_over_a_pixel, ("point_light",), ("independent", "stratified", "sobol"), MORE, repeats=64),
    Stiff("S10", "16 lights, one of which has all the power", "Each as often as the others: M - 1 = 15. By power 0.",
          one_of_many, ("one_light_uniform", "one_light_power", "area")),
    Stiff("S11", "a highlight that p = 0.0016 of the lens see",
          "Hit or miss, (1 - p) / p = 600. No strategy of raylab samples a light through the lens, and strata only "
          "help where they are smaller than the highlight, N p > 1: it takes more samples.",
          highlight, ("direct",), ("independent", "stratified", "sobol")),
    Stiff("S12", "a sphere light of which one half is below the horizon",
          "Half of the samples of its cone are worth nothing: relative variance 1.77; by area more.",
          half_below, (sphere_by_area, "area", "mis_balance")),
)  # fmt: skip
