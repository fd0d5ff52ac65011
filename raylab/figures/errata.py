"""What comes out when the slides are copied as they stand: docs/errata.md.

Each shade here returns the right answer and wrong ones as the three channels of one picture, so that all of them see
the same samples. Nothing here is used by a renderer.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.figures import panels
from raylab.figures.glossy import stage
from raylab.figures.registry import figure
from raylab.glossy import light_from
from raylab.jit import njit
from raylab.point import dist_sqr, free_point
from raylab.scene import Scene
from raylab.shadow import shadow, shadow_toward
from raylab.vec3 import Vec3, black, dot, normalize

Array = npt.NDArray[np.float64]
WIDTH, HEIGHT = 200, 140
SPP = 64
UNIT = 0.125  # one unit of length of `ball_in_the_air` in the coordinates of kernels


# --- the slides, copied ---


@njit
def cosines(x, V, brdf, N, scene, rng):
    """Slide "Area source by Monte Carlo": the product of two cosines as on the code slide, with |.| as on the formula
    slide, and clamped."""
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        L = normalize(y - x)
        signed = dot(L, N) * dot(-L, y.n)
        clamped = max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n))
        f = light.radiance.x * brdf.eval(V, L).x / dist_sqr(x, y) / p_y
        result += Vec3(signed, abs(signed), clamped) * f
    return result


@njit
def normals(x, V, brdf, N, scene, rng):
    """Slide "Area source by Monte Carlo": the normal at y, and one `light.normal` (down) for all of a ball of light."""
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            f = light.radiance.x * brdf.eval(V, L).x * max(0.0, dot(L, N)) / dist_sqr(x, y) / p_y
            result += Vec3(max(0.0, dot(-L, y.n)), max(0.0, L.z), 0.0) * f
    return result


@njit
def directions(x, V, brdf, N, scene, rng):
    """Slide "Arbitrary surface in env. by Monte Carlo": as it should be; with unclamped cosines where `shadow` knows of
    blockers only; and with the direction w taken for a point, x + w."""
    w, p_w = scene.environment.sample(N, rng.square())
    f = scene.environment.eval(w).x * brdf.eval(V, w).x * dot(w, N) / p_w
    if dot(w, N) <= 0.0:
        return Vec3(0.0, f, 0.0)
    blocked = shadow_toward(scene, x, w)
    near = shadow(scene, x, free_point(x.p + w * UNIT))
    return Vec3(0.0 if blocked else f, 0.0 if blocked else f, 0.0 if near else f)


@njit
def without_view(x, V, brdf, N, scene, rng):
    """Slide "Arbitrary surface in env. by Monte Carlo": brdf.sample(V, N), and brdf.sample(N), whose lobe can only be
    around N."""
    u = rng.square()
    w, p_w = brdf.sample(V, N, u)
    right = light_from(scene, x, w, N).y * brdf.eval(V, w).y * max(0.0, dot(w, N)) / p_w
    w, p_w = brdf.sample(N, N, u)
    wrong = light_from(scene, x, w, N).y * brdf.eval(V, w).y * max(0.0, dot(w, N)) / p_w
    return Vec3(right, wrong, 0.0)


# --- scenes ---

GREY = d.Diffuse(np.full(3, 0.5))
FLOOR = d.Rectangle(to_world=np.diag([6.0, 6.0, 1.0, 1.0]), front=GREY)


def seen(shapes: tuple[d.Shape, ...], environment: d.Environment | None = None, height: float = 0.3) -> Scene:
    """A floor and other things, seen from the side and above."""
    matrix = panels.look_at((0.0, -7.0, 5.0), (0.0, 0.0, height))
    camera = d.Camera(to_world=matrix, fov=38.0, width=WIDTH, height=HEIGHT)
    return Scene(d.SceneDescription(camera=camera, shapes=(FLOOR, *shapes), environment=environment))


def upright_lamp() -> Scene:
    """A lamp on edge that shines to the right."""
    matrix = np.array([[0.0, 0.0, 1.0, 0.0], [1.2, 0.0, 0.0, 0.0], [0.0, 0.6, 0.0, 0.65], [0.0, 0.0, 0.0, 1.0]])
    return seen((d.Rectangle(to_world=matrix, radiance=np.full(3, 3.0), front=None),))


def ball_of_light() -> Scene:
    return seen((d.Sphere(center=np.array([0.0, 0.0, 1.5]), radius=0.5, radiance=np.full(3, 4.0), front=None),))


def ball_in_the_air(radiance: float = 1.0, slope: float = 0.5) -> Scene:
    """A grey ball above a floor, under L(w) = radiance + slope w_z from all directions, those from below as well."""
    gradient = np.tile(np.array([0.0, 0.0, slope]), (3, 1))
    ball = d.Sphere(center=np.array([0.0, 0.0, 2.0]), radius=0.9, front=GREY)
    return seen((ball,), d.GradientEnvironment(np.full(3, radiance), gradient), 1.0)


# --- figures ---


def grey(values: Array) -> Array:
    """Radiance as grey, negative radiance as blue."""
    shown = np.repeat(np.abs(values)[..., None], 3, axis=-1)
    shown[values < 0.0] *= np.array([0.1, 0.3, 1.0])
    return shown


def of(image: Array, channel: int) -> str:
    return f"mean radiance {np.nanmean(image[..., channel]):.3f}"


@figure(
    "errata_cosines",
    "Area source by Monte Carlo (diffuse)",
    """A lamp on edge that shines to the right only. Copied from the code slide, dot(L, N) * dot(-L, light.normal) is
    negative behind the lamp (blue: negative light). With |n · w| as on the formula slides the lamp shines on both
    sides. Clamped at zero it is right.""",
)
def errata_cosines(path: Path) -> None:
    image = panels.picture(upright_lamp(), cosines, spp=SPP, sampler="sobol").mean
    titles = ("dot(L, N) * dot(-L, n)", "|n_x · w| |n_y · w|", "max(0, .) around both")
    panels.row(path, [panels.Panel(t, grey(image[..., i]), of(image, i)) for i, t in enumerate(titles)])


@figure(
    "errata_light_normal",
    "Area source by Monte Carlo",
    """A ball of light has another normal at each point. With one normal for all of it, downwards, all of its lower
    side shines down with full strength: the floor below is up to 1.92 times too bright.""",
)
def errata_light_normal(path: Path) -> None:
    image = panels.picture(ball_of_light(), normals, spp=SPP, sampler="sobol").mean
    titles = ("y.n, the normal at y", "one light.normal")
    panels.row(path, [panels.Panel(t, grey(image[..., i]), of(image, i)) for i, t in enumerate(titles)])


@figure(
    "errata_directions",
    "Arbitrary surface in env. by Monte Carlo",
    """A ball in the air under a sky that shines from below as well. With the slide's unclamped dot(w, N), what is
    below the horizon is subtracted: the floor loses half of its light, and the under side of the ball turns
    negative (blue). With a direction handed to the shadow test of points, only what is nearer than x + w casts a
    shadow: none on the floor. With a reflectance in place of k_d everything is π times too bright.""",
)
def errata_directions(path: Path) -> None:
    image = panels.picture(ball_in_the_air(), directions, spp=SPP, sampler="sobol").mean
    image = np.concatenate([image, math.pi * image[..., :1]], axis=-1) * 0.6
    titles = ("as it should be", "cosine not clamped", "shadow(x, x + w)", "k_d = reflectance")
    shown = [panels.Panel(t, grey(image[..., i]), of(image / 0.6, i)) for i, t in enumerate(titles)]
    panels.row(path, shown, columns=2)


@figure(
    "errata_without_view",
    "Arbitrary surface in env. by Monte Carlo (integral)",
    """The slide's brdf.sample(N) does not know V, so its lobe can only be around the normal. It still is a density,
    and the picture is right on average; but where the true lobe is, it hardly ever looks, and the variance is
    infinite. 64 samples each, exponent 20.""",
)
def errata_without_view(path: Path) -> None:
    image = 2.0 * panels.picture(stage(6.0, 20.0), without_view, spp=SPP, sampler="independent").mean
    titles = ("brdf.sample(V, N)", "brdf.sample(N)")
    panels.row(path, [panels.Panel(t, grey(image[..., i])) for i, t in enumerate(titles)])


@figure(
    "errata_captions",
    "Arbitrary surface in env. by Monte Carlo",
    """The last two boxes of code, named by what their code calls. On the slide the captions are the other way round:
    the box above “sampling by BRDF” calls environment.sample. 16 samples of a sky with a small sun.""",
)
def errata_captions(path: Path) -> None:
    scene = panels.scene("hdr_sky", width=200, height=134)
    shown = []
    for shade, title in (("env_brightness", "environment.sample"), ("env_brdf", "brdf.sample")):
        image = panels.picture(scene, shade, spp=16, sampler="independent")
        noise = math.sqrt(np.mean(image.standard_error**2))
        shown.append(panels.Panel(title, image.mean, f"{shade}: standard error {noise:.2g}"))
    panels.row(path, shown)
