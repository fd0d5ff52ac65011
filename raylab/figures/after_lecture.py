"""After the last slide: by light or by BRDF? Variances of both and of their combination, for a lamp and for a sky."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.figures import panels
from raylab.figures.registry import figure
from raylab.scene import Scene
from raylab.study.look import COLOURS

Array = npt.NDArray[np.float64]
QUESTION, MANY = "After the last slide (by light or by BRDF?)", "After the last slide (many lights)"


# --- a lamp and a lobe, both around one direction ---

EXPONENTS, HALF_ANGLES = np.geomspace(1.0, 1e6, 37), np.geomspace(1e-3, 1.5, 33)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)


def relative_variances(n: float, half_angle: float) -> tuple[float, float, float]:
    """Of one sample by light, by BRDF, and of one of each by the balance heuristic; f = p_brdf within the lamp.

    All depends on t = 1 - cos alone: Gauss-Legendre in intervals whose ends grow by a factor of two.
    """
    most = 2.0 * np.sin(half_angle / 2.0) ** 2
    ends = np.concatenate([[0.0], most * 2.0 ** np.arange(-40.0, 1.0)])
    half = np.diff(ends)[:, None] / 2.0
    t = (ends[:-1, None] + half * (1.0 + NODES)).ravel()
    weights = 2.0 * np.pi * (half * WEIGHTS).ravel()
    p_light = 1.0 / (2.0 * np.pi * most)
    p_brdf = (n + 1.0) / (2.0 * np.pi) * np.exp(n * np.log1p(-np.minimum(t, 1.0 - 1e-16)))
    f = p_brdf
    mean = float(weights @ f)
    by_light = float(weights @ (f * f / p_light)) / mean**2 - 1.0
    by_brdf = 1.0 / mean - 1.0
    both = 0.0
    for p, q in ((p_light + 0.0 * t, p_brdf), (p_brdf, p_light + 0.0 * t)):
        part = p / (p + q) * f
        both += float(weights @ (part * part / np.maximum(p, 1e-300))) - float(weights @ part) ** 2
    return max(by_light, 0.0), max(by_brdf, 0.0), max(both / mean**2, 0.0)


@figure(
    "light_or_brdf",
    QUESTION,
    """The question with which the lecture ends, answered by quadrature: relative variance of one sample, for a lobe of
    exponent n around the middle of a round lamp. By light: bad where the lobe is the smaller. By BRDF: bad where the
    lamp is the smaller. One sample of each, weighed by the balance heuristic: below 0.14 everywhere. The dashed line is
    where lobe and lamp are of a size.""",
)
def light_or_brdf(path: Path) -> None:
    from matplotlib.colors import LogNorm

    all_ = np.array([[relative_variances(n, a) for a in HALF_ANGLES] for n in EXPONENTS])
    with panels.plots(path, 1, 3, 14.5, 4.9) as axes:
        for k, (part, title) in enumerate(zip(axes, ("by light", "by BRDF", "MIS: one of each"), strict=True)):
            shown = part.pcolormesh(
                np.degrees(HALF_ANGLES), EXPONENTS, np.clip(all_[:, :, k], 1e-4, 1e6),
                norm=LogNorm(1e-4, 1e6), cmap="inferno", shading="gouraud",
            )  # fmt: skip
            part.plot(np.degrees(np.sqrt(2.0 / EXPONENTS)), EXPONENTS, color="0.85", linestyle=(0, (5, 4)))
            part.set(xscale="log", yscale="log", xlabel="half angle of the lamp, degrees")
            part.set(xlim=np.degrees(HALF_ANGLES[[0, -1]]), ylim=EXPONENTS[[0, -1]])
            part.set_title(f"{title}, at most {all_[:, :, k].max():.2g}")
        axes[0].set_ylabel("exponent of the lobe")
        axes[2].figure.colorbar(shown, ax=axes[2], label="relative variance")


# --- a sky ---

SURFACES = {"diffuse": None, "lobe, n = 20": 20.0, "lobe, n = 1000": 1000.0}
STRATEGIES = ("uniform", "cosine", "BRDF", "brightness", "MIS", "MIS,\ncompensated")


@functools.cache
def sky() -> tuple[Array, Array, Array, Array]:
    """Directions (h, w, 3) to the texels of the reference sky, their solid angles, luminances and radiances."""
    described = panels.scene("hdr_sky", width=8, height=8).description
    assert isinstance(described.environment, d.ImageEnvironment)
    pixels = np.asarray(described.environment.pixels, np.float64)
    height, width = pixels.shape[:2]
    theta = np.pi * (np.arange(height) + 0.5) / height
    phi = 2.0 * np.pi * (np.arange(width) + 0.5) / width
    z = np.repeat(np.cos(theta)[:, None], width, axis=1)
    r = np.sin(theta)[:, None]
    w = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)
    rows = -np.diff(np.cos(np.linspace(0.0, np.pi, height + 1)))
    size = np.repeat(2.0 * np.pi / width * rows[:, None], width, axis=1)
    return w, size, pixels @ [0.2126, 0.7152, 0.0722], pixels


def strategies_of(n: float | None) -> list[float]:
    """Relative variance of one sample (of one of each: MIS) on a horizontal surface, seen at 45 degrees."""
    w, size, L, _ = sky()
    cosine = np.maximum(0.0, w[..., 2])
    up = (cosine > 0.0) / (2.0 * np.pi)
    R = np.array([-np.sqrt(0.5), 0.0, np.sqrt(0.5)])
    lobe = np.maximum(0.0, w @ R) ** (n or 0.0)
    p_brdf = cosine / np.pi if n is None else (n + 1.0) / (2.0 * np.pi) * lobe
    f = L * (cosine / np.pi if n is None else (n + 2.0) / (2.0 * np.pi) * lobe * cosine)
    mean = float((f * size).sum())

    def one(p: Array, g: Array) -> float:
        """E (g / p)^2 - (E g / p)^2, in units of the mean squared."""
        second = np.divide(g * g, p, out=np.zeros_like(g), where=p > 0.0)
        return (float((second * size).sum()) - float((g * size).sum()) ** 2) / mean**2

    bright = L / (L * size).sum()
    above = np.maximum(0.0, L - (L * size).sum() / (4.0 * np.pi))
    above /= (above * size).sum()

    def both(p: Array) -> float:
        share = p / np.maximum(p + p_brdf, 1e-300)
        return one(p, share * f) + one(p_brdf, (1.0 - share) * f)

    return [one(p, f) for p in (up, cosine / np.pi, p_brdf, bright)] + [both(bright), both(above)]


@figure(
    "sky_strategies",
    QUESTION,
    """The lecture's four ways to sample an environment, and their combination, side by side: relative variance of one
    sample (of two for MIS, one of each) under the reference sky with its sun, in the open, by quadrature over its
    texels. On a diffuse floor uniform, cosine and BRDF sampling miss the sun; where the lobe looks away from the sun,
    brightness misses the lobe; the combination misses neither. Compensated (Karlik et al. 2019), the sky's own
    samples leave what is below the mean to the BRDF's: a hundred times less variance on the floor.""",
)
def sky_strategies(path: Path) -> None:
    with panels.plots(path, 1, 3, 19.0, 6.0) as axes:
        for part, (name, n) in zip(axes, SURFACES.items(), strict=True):
            values = strategies_of(n)
            bars = part.bar(range(len(values)), values, color=[*COLOURS[:4], "0.25", "0.5"])
            part.bar_label(bars, [f"{v:.2g}" for v in values], padding=3, fontsize=12)
            part.set_xticks(range(len(values)), STRATEGIES, rotation=40, ha="right", fontsize=12)
            part.set(yscale="log", title=name, ylim=(0.3 * min(values), 4.0 * max(values)))
        axes[0].set_ylabel("relative variance")


@figure(
    "sky_pictures",
    QUESTION,
    """The reference scene under that sky, 16 samples in each pixel: by brightness the polished surfaces are noise, by
    BRDF all that the sun lights is; combined, neither.""",
)
def sky_pictures(path: Path) -> None:
    scene = panels.scene("hdr_sky", width=180, height=120)
    shown = []
    for shade, title in (("env_brightness", "by brightness"), ("env_brdf", "by BRDF"), ("mis_balance", "MIS")):
        image = panels.picture(scene, shade, spp=16, sampler="independent", seed=2)
        error = np.sqrt(np.mean(image.standard_error**2)) / np.mean(image.mean)
        shown.append(panels.Panel(title, image.mean, f"relative standard error {error:.2g}"))
    panels.row(path, shown)


# --- many lights ---


def garden(n: int) -> Scene:
    """n little lamps of very different power over a floor."""
    rng = np.random.default_rng(1)
    places = rng.uniform((-3.0, -3.0, 0.8), (3.0, 3.0, 2.0), (n, 3))
    colours = rng.uniform(0.2, 1.0, (n, 3)) * rng.pareto(1.6, (n, 1))
    colours *= 30_000.0 / colours.mean(axis=1).sum()  # a radiance of some 0.4 on the floor
    floor = d.Rectangle(to_world=np.diag([4.0, 4.0, 1.0, 1.0]), front=d.Diffuse(np.full(3, 0.6)))
    lamps = tuple(
        d.Sphere(center=p, radius=0.015, radiance=c, front=None) for p, c in zip(places, colours, strict=True)
    )
    camera = d.Camera(to_world=panels.look_at((0, -6, 4), (0, -0.3, 0.0)), fov=45.0, width=190, height=142)
    return Scene(d.SceneDescription(camera=camera, shapes=(floor, *lamps), hide_emitters=True))


@figure(
    "many_lights",
    MANY,
    """A thousand lamps of very different power, unlit dots to the camera; one for each of 64 samples: chosen
    uniformly, or in proportion to its power by an alias table.
    Each choice takes as long for a hundred thousand lamps.""",
)
def many_lights(path: Path) -> None:
    scene, shown = garden(1000), []
    for shade, title in (("one_light_uniform", "chosen uniformly"), ("one_light_power", "chosen by power")):
        image = panels.picture(scene, shade, spp=64, sampler="independent")
        error = np.sqrt(np.mean(image.standard_error**2)) / np.mean(image.mean)
        shown.append(panels.Panel(title, image.mean, f"relative standard error {error:.2g}"))
    panels.row(path, shown)
