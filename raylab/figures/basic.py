"""Slides "Basic ray tracing" and "Discontinuities in basic RT": each discontinuity beside the method that cures it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from raylab import description as d
from raylab.figures import panels
from raylab.figures.registry import figure
from raylab.scene import Scene

SLIDE = "Discontinuities in basic RT"
WIDTH, HEIGHT, SCALE = 150, 100, 3
GAUSSIAN = d.Filter("gaussian", radius=2.0, stddev=0.5)
GREY = d.Diffuse(np.full(3, 0.6))
CHECKS = d.Diffuse(
    d.Bitmap(
        np.array([[[0.5, 0.05, 0.04], [0.85, 0.75, 0.3]], [[0.85, 0.75, 0.3], [0.5, 0.05, 0.04]]]),
        filter="nearest",
        to_uv=np.diag([6.0, 6.0, 1.0]),
    )
)
GLASS = d.Dielectric()


def placed(x: float, y: float, z: float, *size: float) -> panels.Array:
    """Scaled, then moved to (x, y, z)."""
    matrix = np.diag([*size, 1.0])
    matrix[:3, 3] = (x, y, z)
    return matrix


def world(*shapes: d.Shape, floor: d.Material = CHECKS, lights: tuple[d.Light, ...] = (), **camera: Any) -> Scene:
    """Shapes on a floor under a blue sky; the arguments that are left over are the camera's."""
    ground = d.Rectangle(to_world=placed(0, 2, 0, 6, 6, 1), front=floor, back=floor)
    to_world = panels.look_at((0.5, -6.5, 2.2), (0.1, 0.0, 0.75))
    eye = d.Camera(**{"to_world": to_world, "fov": 34.0, "width": WIDTH, "height": HEIGHT, **camera})
    sky = d.ConstantEnvironment(np.array([0.14, 0.30, 0.55]))
    return Scene(d.SceneDescription(camera=eye, shapes=(ground, *shapes), lights=lights, environment=sky))


def ball(x: float, y: float, radius: float, front: d.Material, back: d.Material | None = None) -> d.Sphere:
    return d.Sphere(center=np.array([x, y, radius]), radius=radius, front=front, back=back)


BALLS = (
    ball(-1.0, 0.3, 0.9, d.Conductor(specular_reflectance=np.array([0.85, 0.9, 0.95]))),
    ball(0.9, -0.6, 0.6, GLASS, GLASS.inside),
    ball(1.5, 1.6, 0.8, d.Diffuse(np.array([0.1, 0.4, 0.15]))),
)
SUN = d.PointLight(np.array([-3.0, -4.0, 6.0]), np.array([110.0, 105.0, 95.0]))


def pair(path: Path, *two: panels.Panel) -> None:
    panels.row(path, two, scale=SCALE)


@figure(
    "basic_depth",
    "Basic ray tracing",
    """One shadow ray for every point light, one reflection ray, possibly one refraction ray, per intersection, and so
    on. `max_depth` is the number of rays in a row, the shadow ray included: with two, mirrors see only the sky; with
    four, one can look through glass.""",
)
def basic_depth(path: Path) -> None:
    scene = panels.scene("mirror_balls", width=150, height=100)
    shown = []
    for rays, note in (
        (2, "eye ray, shadow ray"),
        (3, "one mirror"),
        (4, "through a ball"),
        (8, "through the bubble"),
    ):
        cut = Scene(replace(scene.description, max_depth=rays))
        shown.append(panels.Panel(f"{rays} rays in a row", panels.picture(cut, "basic", spp=4, seed=1).mean, note))
    panels.row(path, shown, columns=2, scale=SCALE)


@figure(
    "basic_image",
    "Basic ray traced image",
    """Mirror, glass and gold over a checkerboard, in the spirit of Whitted 1980: one ray through the centre of each
    pixel, every shadow hard, every mirror perfect, every edge a staircase.""",
)
def basic_image(path: Path) -> None:
    image = panels.picture(panels.scene("mirror_balls"), "basic", sampler="centre")
    panels.row(path, [panels.Panel("one ray for each pixel", image.mean)], scale=2)


@figure(
    "discontinuity_edges",
    SLIDE,
    """Silhouettes and edges of shadows are staircases where one ray stands for a pixel. Cure: jittered samples and a
    real pixel filter.""",
)
def discontinuity_edges(path: Path) -> None:
    scene = world(*BALLS, lights=(SUN,), filter=GAUSSIAN)
    one, many = panels.picture(scene, "basic", sampler="centre"), panels.picture(scene, "basic", spp=16, seed=1)
    pair(
        path,
        panels.Panel("one ray through the centre", one.mean, "edges are either here or there", zoom=(36, 58, 24)),
        panels.Panel("16 jittered samples", many.mean, "drawn from a Gaussian filter", zoom=(36, 58, 24)),
    )


@figure(
    "discontinuity_shadows",
    SLIDE,
    """The same lamp: as a point in its middle, which is either seen or not, and as the area that it is. Cure: sample
    the light.""",
)
def discontinuity_shadows(path: Path) -> None:
    lamp = d.Rectangle(to_world=placed(-2.0, -1.5, 4.0, 0.8, -0.8, -1.0), radiance=np.full(3, 22.0), front=None)
    red = d.Diffuse(np.array([0.5, 0.1, 0.06]))
    things = (ball(-1.0, 0.4, 0.8, red), ball(1.0, 0.0, 0.5, GREY), lamp)
    scene = world(*things, floor=GREY, filter=GAUSSIAN)
    hard, soft = panels.picture(scene, "basic", spp=16, seed=1), panels.picture(scene, "area", spp=64, seed=1)
    pair(
        path,
        panels.Panel("a point in its middle", hard.mean, "hard shadows"),
        panels.Panel("the area of the lamp", soft.mean, "a penumbra that widens with the distance"),
    )


@figure(
    "discontinuity_mirrors",
    SLIDE,
    """A floor of polished copper shows every lamp as sharp as it is; on a rough one (GGX, roughness 0.15) the image
    blurs with the distance to what is reflected. Cure: sample the lobe.""",
)
def discontinuity_mirrors(path: Path) -> None:
    eta, k = np.array([0.2, 0.92, 1.1]), np.array([3.9, 2.45, 2.14])
    colours = np.array([[0.9, 0.85, 0.75], [0.15, 0.5, 0.95], [0.95, 0.4, 0.1]])
    bars = tuple(
        d.Rectangle(to_world=placed(x, 1.5, 0.9, 0.25, 1, 0.9) @ UPRIGHT, radiance=colour, front=None)
        for x, colour in zip((-1.5, 0.1, 1.7), colours, strict=True)
    )
    smooth = world(*bars, floor=d.Conductor(eta, k), filter=GAUSSIAN)
    rough = world(
        *bars, floor=d.RoughConductor(eta=eta, k=k, alpha_u=0.15, alpha_v=0.15, distribution="ggx"), filter=GAUSSIAN
    )
    pair(
        path,
        panels.Panel("a perfect mirror", panels.picture(smooth, "basic", spp=16, seed=1).mean, "either this or that"),
        panels.Panel("a rough metal", panels.picture(rough, spp=64, seed=1).mean, "sharp only where they touch"),
    )


UPRIGHT = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])  # normal z to -y


@figure(
    "discontinuity_focus",
    SLIDE,
    """Through a pinhole everything is in focus. Cure: sample a lens; the ball of glass in front and the green one
    behind lie before and behind its focus plane.""",
)
def discontinuity_focus(path: Path) -> None:
    sharp = world(*BALLS, lights=(SUN,), filter=GAUSSIAN)
    lens = world(*BALLS, lights=(SUN,), filter=GAUSSIAN, aperture_radius=0.25, focus_distance=6.1)
    pair(
        path,
        panels.Panel("a point aperture", panels.picture(sharp, "basic", spp=16, seed=1).mean, "perfect focus"),
        panels.Panel("a lens", panels.picture(lens, "basic", spp=64, seed=1).mean, "sharp at the depth of the mirror"),
    )


@figure(
    "discontinuity_time",
    SLIDE,
    """At one moment the ball stands still. Cure: each eye ray has a time while the shutter is open; the shadow and the
    image in the mirror move with the ball.""",
)
def discontinuity_time(path: Path) -> None:
    way = d.Animation(np.array([0.0, 1.0]), np.stack([placed(x, -0.9, 0.5, 1, 1, 1) for x in (0.2, 1.4)]))
    moving = d.Sphere(radius=0.5, front=d.Diffuse(np.array([0.8, 0.5, 0.05])), motion=way)
    frozen = world(BALLS[0], moving, lights=(SUN,), filter=GAUSSIAN, shutter_open=0.5, shutter_close=0.5)
    blurred = world(BALLS[0], moving, lights=(SUN,), filter=GAUSSIAN, shutter_open=0.0, shutter_close=1.0)
    pair(
        path,
        panels.Panel("one moment", panels.picture(frozen, "basic", spp=16, seed=1).mean, "frozen time"),
        panels.Panel("an open shutter", panels.picture(blurred, "basic", spp=64, seed=1).mean, "times drawn at random"),
    )
