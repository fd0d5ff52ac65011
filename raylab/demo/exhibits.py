"""What the demo shows: for each slide the pictures and the experiment that belong to it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from raylab.description import Bitmap, Diffuse, Phong, SceneDescription

Change = Callable[[SceneDescription], SceneDescription]


@dataclass(frozen=True)
class Picture:
    """One render; `parameters` are values of $names in the scene file."""

    title: str
    scene: str
    shade: str
    spp: int
    sampler: str = "independent"
    parameters: tuple[tuple[str, Any], ...] = ()


@dataclass(frozen=True)
class Experiment:
    """A study: error against run time on a small picture of one scene."""

    scene: str
    shades: tuple[str, ...]
    spp: tuple[int, ...]
    samplers: tuple[str, ...] = ("independent",)
    parameters: tuple[tuple[str, Any], ...] = ()
    repeats: int = 10
    change: Change | None = None


@dataclass(frozen=True)
class Exhibit:
    """A part of the page. With `compared`, pictures are compared with a reference and their errors are shown."""

    slide: str
    title: str
    text: str
    pictures: tuple[Picture, ...]
    compared: bool = False
    experiment: Experiment | None = None
    change: Change | None = None


def matte(scene: SceneDescription) -> SceneDescription:
    """The scene with every glossy surface made diffuse, so that all four ways to sample a sky can be compared."""

    def dull(material: Any) -> Any:
        if not isinstance(material, Phong) or isinstance(material.diffuse_reflectance, Bitmap):
            return material
        return Diffuse(material.diffuse_reflectance + material.specular_reflectance)

    shapes = tuple(dataclasses.replace(s, front=dull(s.front), back=dull(s.back)) for s in scene.shapes)
    return dataclasses.replace(scene, shapes=shapes)


def hidden(scene: SceneDescription) -> SceneDescription:
    """The scene with lights that the camera does not see, so that their edges do not hide the noise of shading."""
    return dataclasses.replace(scene, hide_emitters=True)


def _light(title: str, size: float) -> Picture:
    power = (("size", size), ("radiance", 12.5 / size**2), *SMALL)
    return Picture(title, "soft_shadows", "area_diffuse", 64, "sobol", power)


SMALL = (("width", 360), ("height", 240))
SQUARE = (("width", 320), ("height", 320))
PLATES = (("width", 320), ("height", 240))
TINY = (("width", 96), ("height", 64))

EXHIBITS = (
    Exhibit(
        "Basic ray tracing",
        "One sample for everything",
        "Point lights and parallel light: one shadow ray for every light, and every shadow edge is perfectly sharp. "
        "With one eye ray for each pixel the silhouettes are ragged; sixteen mend them, but no number of samples makes "
        "these shadows soft.",
        (
            Picture("One sample for each pixel", "basic_ray_tracing", "direct", 1, "independent", SMALL),
            Picture("Sixteen samples", "basic_ray_tracing", "direct", 16, "independent", SMALL),
        ),
    ),
    Exhibit(
        "Cause of soft shadows (area lights)",
        "Area lights cast soft shadows",
        "A square light of growing size and constant power. The larger it is, the more points see a part of it only: "
        "the penumbra widens, and it is widest far from the object that casts the shadow.",
        (
            _light("Light 0.1 wide", 0.05),
            _light("Light 1 wide", 0.5),
            _light("Light 4 wide", 2.0),
        ),
    ),
    Exhibit(
        "Area source by Monte Carlo (diffuse)",
        "Four times the samples, half the error",
        "The Cornell box, by its published spectra. Each sample is one point on the light and one shadow ray; the "
        "standard error falls like one over the root of their number, which is slow.",
        tuple(Picture(f"{n} samples", "cornell_box", "area_diffuse", n, "independent", SQUARE) for n in (4, 16, 64)),
        compared=True,
    ),
    Exhibit(
        "Creating soft shadows",
        "Choosing samples: start with uniform in square",
        "The same shade() and the same number of shadow rays; only the points in the unit square differ. "
        "Independent points clump. One point in each cell of a grid does not, and an Owen-scrambled Sobol' sequence is "
        "stratified in all grids of a power of two at once.",
        (
            Picture("Independent", "soft_shadows", "area_diffuse", 16, "independent", SMALL),
            Picture("Stratified", "soft_shadows", "area_diffuse", 16, "stratified", SMALL),
            Picture("Sobol'", "soft_shadows", "area_diffuse", 16, "sobol", SMALL),
        ),
        compared=True,
        experiment=Experiment(
            "soft_shadows", ("area_diffuse",), (4, 16, 64, 256), ("independent", "stratified", "sobol"), TINY
        ),
    ),
    Exhibit(
        "Diffuse surface in env. by Monte Carlo",
        "A better probability density: proportional to cos θ",
        "Under a sky of constant radiance a point that sees all of it gets the same value from every cosine sample: "
        "no noise at all. With uniform directions the cosine itself is the noise. What remains is visibility.",
        (
            Picture("Uniform hemisphere", "ball_under_sky", "env_uniform", 16, "independent", SMALL),
            Picture("Proportional to cos θ", "ball_under_sky", "env_cosine", 16, "independent", SMALL),
        ),
        compared=True,
    ),
    Exhibit(
        "Illumination as integration (Lambertian, over directions)",
        "Four ways to sample one sky",
        "A clear sky with a sun 100 000 times brighter, and every surface made diffuse, so that all four densities "
        "apply. Only the one that knows where the sun is finds it: the others hit it once in many thousand samples, "
        "and their pictures look darker than they are on average.",
        (
            Picture("Uniform hemisphere", "hdr_sky", "env_uniform", 32, "independent", SMALL),
            Picture("Proportional to cos θ", "hdr_sky", "env_cosine", 32, "independent", SMALL),
            Picture("By BRDF", "hdr_sky", "env_brdf", 32, "independent", SMALL),
            Picture("By brightness", "hdr_sky", "env_brightness", 32, "independent", SMALL),
        ),
        compared=True,
        experiment=Experiment(
            "hdr_sky", ("env_uniform", "env_cosine", "env_brdf", "env_brightness"), (4, 16, 64), parameters=TINY
        ),
        change=matte,
    ),
    Exhibit(
        "Arbitrary surface in env. by Monte Carlo",
        "By BRDF or by brightness: it depends on the surface",
        "The same sky over glossy surfaces. Sampling by BRDF is right for the mirror-like ball and misses the sun on "
        "diffuse ground; sampling by brightness is the other way round. The default, direct, takes both samples and "
        "weighs them by the balance heuristic.",
        (
            Picture("By BRDF", "hdr_sky", "env_brdf", 32, "independent", SMALL),
            Picture("By brightness", "hdr_sky", "env_brightness", 32, "independent", SMALL),
            Picture("Both: direct", "hdr_sky", "direct", 32, "independent", SMALL),
        ),
        compared=True,
    ),
    Exhibit(
        "Area source by Monte Carlo",
        "Large lights in smooth plates",
        "Four lights of one power over four plates, from rough in front to mirror-like behind. Points chosen on the "
        "light serve small lights and rough plates; a large light in a smooth plate needs directions from the BRDF.",
        (
            Picture("Points on the light: area", "veach_plates", "area", 16, "independent", PLATES),
            Picture("Both: direct", "veach_plates", "direct", 16, "independent", PLATES),
        ),
        compared=True,
        experiment=Experiment("veach_plates", ("area", "direct"), (4, 16, 64), parameters=TINY, change=hidden),
    ),
    Exhibit(
        "Soft shadows",
        "More scenes",
        "Direct light only, as in the lecture: what no light reaches in one step stays black.",
        (
            Picture("A still life", "still_life", "direct", 64, "sobol", SMALL),
            Picture("A straight edge: its shadow has a closed form", "edge_occluder", "direct", 64, "sobol", SMALL),
            Picture("A light that sets", "light_below_horizon", "direct", 64, "sobol", SMALL),
        ),
    ),
)
