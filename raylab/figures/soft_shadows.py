"""Slides "Soft shadows" and "Creating soft shadows": light sizes, points on the light, area against solid angle."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
import numpy.typing as npt

from raylab import samplers
from raylab.closed_forms import irradiance, variances
from raylab.figures import panels
from raylab.figures.registry import figure
from raylab.jit import njit

Array = npt.NDArray[np.float64]
NAMES = {
    "independent": "independent",
    "stratified": "jittered",
    "latin": "Latin hypercube",
    "sobol": "Owen-scrambled Sobol'",
}
SHORT = {"independent": "independent", "stratified": "jittered", "latin": "Latin", "sobol": "Sobol'"}
COUNTS, REPEATS = (4, 16, 64, 256, 1024), 400


@njit
def fill(sampler, count, out):
    """The first squares of `count` samples of as many pixels as out (n, 2) has room for."""
    for i in range(len(out)):
        u = sampler.stream(i // count, 0, i % count).square()
        out[i, 0], out[i, 1] = u[0], u[1]


def points(name: str, count: int, repeats: int) -> Array:
    """(repeats, count, 2)"""
    out = np.empty((repeats * count, 2))
    fill(samplers.make(name, 0, count), count, out)
    return out.reshape(repeats, count, 2)


def on_a_rectangle(u: Array) -> Array:
    """Slide: g(y), y uniform on a rectangle 2 by 1 at height 1 over a floor."""
    y = np.stack([2.0 * u[..., 0] - 1.0, u[..., 1] - 0.5], axis=-1)
    return 2.0 / np.pi / (1.0 + (y * y).sum(axis=-1)) ** 2


def in_the_penumbra(u: Array) -> Array:
    """The same light behind a slanted edge."""
    return on_a_rectangle(u) * (2.0 * u[..., 0] + u[..., 1] < 1.3)


@functools.cache
def drawn() -> dict[tuple[str, int], Array]:
    return {(name, n): points(name, n, REPEATS) for name in NAMES for n in COUNTS}


@figure(
    "soft_shadow_points",
    "Creating soft shadows",
    """"Start with uniform in the square": sixteen points by four samplers, and the soft shadow of a square lamp that
    they give, sixteen shadow rays in each pixel (two sets of eight but for independent ones, to know the error).
    Jittered points fall one into each cell; those of a Latin hypercube one into each of sixteen columns and rows,
    enough where a small lamp is seen in full; Sobol' points do both.""",
)
def soft_shadow_points(path: Path) -> None:
    scene = panels.scene("soft_shadows", width=150, height=112)
    reference = panels.picture(scene, "area_diffuse", spp=1024, sampler="sobol").mean
    shown = []
    for name, title in NAMES.items():
        square = np.full((112, 112, 3), 0.9)
        square[::28], square[:, ::28] = 0.55, 0.55
        for u, v in points(name, 16, 3)[2]:
            y, x = int(v * 110), int(u * 110)
            square[max(y - 2, 0) : y + 3, max(x - 2, 0) : x + 3] = (0.8, 0.05, 0.05)
        shown.append(panels.Panel(title, np.pad(square, ((0, 0), (19, 19), (0, 0)), constant_values=1.0)))
    for name in NAMES:
        image = panels.picture(scene, "area_diffuse", spp=16, sampler=name, seed=3).mean
        error = np.sqrt(np.mean((image - reference) ** 2)) / np.mean(reference)
        shown.append(panels.Panel("", image, f"relative RMSE {error:.3f}", (58, 56, 24)))
    panels.row(path, shown, columns=4)


@figure(
    "soft_shadow_variance",
    "Creating soft shadows",
    """Variance of the mean of N points on a rectangular lamp, over 400 repeats. Left: all of it is seen, the integrand
    is smooth; theory has -1, -2 and, for Sobol', almost -3; the Latin hypercube takes away what is a sum of functions
    of one dimension each, and falls like independent points from there. Right: a slanted edge hides a part; -3/2 at
    best.""",
)
def soft_shadow_variance(path: Path) -> None:
    cases = {
        "all of the lamp is seen": on_a_rectangle,
        "a slanted edge before it": in_the_penumbra,
    }
    with panels.plots(path, 1, 2, 17.0, 6.6) as axes:
        for part, (title, g) in zip(axes, cases.items(), strict=True):
            lines = [
                panels.Line(SHORT[name], COUNTS, [float(np.var(g(drawn()[name, n]).mean(axis=1))) for n in COUNTS])
                for name in NAMES
            ]
            part.set(title=title, xlabel="N samples", ylabel="variance" if part is axes[0] else "")
            panels.power_laws(part, lines, [-1.0])


# --- the cause of soft shadows ---


@figure(
    "soft_shadow_sizes",
    "Cause of soft shadows (area lights)",
    """The same power from lamps of half edge 0.02, 0.5 and 1.5: the penumbra grows with the lamp, since more of the
    floor sees only a part of it.""",
)
def soft_shadow_sizes(path: Path) -> None:
    shown = []
    for size in (0.02, 0.5, 1.5):
        scene = panels.scene("soft_shadows", width=190, height=142, size=size, radiance=20.0 / size**2)
        image = panels.picture(scene, "area_diffuse", spp=64, sampler="sobol")
        shown.append(panels.Panel(f"half edge {size:g}", image.mean))
    panels.row(path, shown)


@figure(
    "hard_shadow",
    "Cause of soft shadows (point lights)",
    """A point light is either seen or not: its shadows have hard edges, however many samples are taken.""",
)
def hard_shadow(path: Path) -> None:
    scene = panels.scene("basic_ray_tracing", width=300, height=200)
    image = panels.picture(scene, "point_light", spp=16, sampler="sobol")
    panels.row(path, [panels.Panel("point lights, 16 samples", image.mean)])


@figure(
    "soft_shadow",
    "Soft shadows",
    """The slide's subject: one square lamp, 64 Owen-scrambled points of it in each pixel.""",
)
def soft_shadow(path: Path) -> None:
    scene = panels.scene("soft_shadows", width=320, height=240)
    panels.row(path, [panels.Panel("64 shadow rays in each pixel", panels.picture(scene, "area_diffuse", spp=64).mean)])


# --- area against solid angle ---

HEIGHTS = np.geomspace(0.03, 10.0, 24)


def by_area_and_angle(height: float) -> tuple[float, float]:
    """Exact relative variances over the middle of a disk of radius 1."""
    mean = irradiance.disk_coaxial(1.0, height) / np.pi
    angle = float(np.arctan2(1.0, height))
    return variances.area_disk(1.0, height) / mean**2, variances.cone_cap(angle) / mean**2


@njit
def estimates(light, x, n, angle, u, out):
    """pi L_r of `area` or of `area_solid_angle` for k_d = 1 / pi, at each u (n, 2)."""
    for i in range(len(u)):
        y, p = light.sample_solid_angle(x, (u[i, 0], u[i, 1])) if angle else light.sample(x, (u[i, 0], u[i, 1]))
        d = y - x
        r2 = d.x * d.x + d.y * d.y + d.z * d.z
        out[i] = d.z * d.z / (r2 * r2) / p


def measured(height: float, angle: bool) -> float:
    """The relative variance of 20,000 samples under the disk."""
    from raylab import description as d
    from raylab.emitters import AreaLights
    from raylab.geometry import Placement, quadric, quadric_row
    from raylab.point import free_point
    from raylab.vec3 import Vec3

    disk = d.Disk(radiance=np.ones(3), to_world=np.diag([1.0, -1.0, -1.0, 1.0]))
    lamps = AreaLights()
    lamps.add_quadric(disk, quadric_row(quadric(disk), Placement(np.zeros(3), 1.0)))
    out = np.empty(20_000)
    u = np.random.default_rng(5).random((len(out), 2))
    estimates(lamps.table()[0], free_point(Vec3(0.0, 0.0, -height)), Vec3(0.0, 0.0, 1.0), angle, u, out)
    return float(np.var(out) / np.mean(out) ** 2)


@figure(
    "area_or_solid_angle",
    "Area source by Monte Carlo",
    """Relative variance of one sample under the middle of a disk of radius 1, by area and uniform in solid angle.
    Lines: closed forms; dots: 20,000 samples each. Close to the lamp the area's variance grows like 1/(3h²), while the
    solid angle's tends to 1/3: at a height of a thirtieth of the radius, 1000 samples by area are worth one. Far away
    both vanish: then a point of the area is cheaper.""",
)
def area_or_solid_angle(path: Path) -> None:
    from raylab.study.look import COLOURS

    theory = np.array([by_area_and_angle(h) for h in HEIGHTS])
    with panels.plot(path) as axes:
        axes.set(title="A disk of radius 1 seen from below its middle", xlabel="distance h", ylabel="relative variance")
        axes.set_xscale("log")
        axes.set_yscale("log")
        for k, name in enumerate(("area", "solid angle")):
            axes.plot(HEIGHTS, theory[:, k], color=COLOURS[k], label=name)
            dots = HEIGHTS[1::4]
            axes.plot(dots, [measured(h, k == 1) for h in dots], "o", color=COLOURS[k])
        axes.legend(loc="upper right", frameon=False)
