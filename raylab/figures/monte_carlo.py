"""Slides "... by Monte Carlo": running means of an estimator, and pictures of its noise."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab.closed_forms import irradiance, phong, variances
from raylab.figures import panels
from raylab.figures.ladders import CORNERS, EXPONENT, K_D, R, lobe, on_the_light
from raylab.figures.registry import figure
from raylab.image import Image
from raylab.study.look import COLOURS, GREY

Array = npt.NDArray[np.float64]
RUNS = 5


def running_means(axes: Any, title: str, g: Array, truth: float) -> None:
    """Means of the first N samples of a few runs (runs, n), and the band of one standard error around the truth."""
    n = np.arange(1, g.shape[1] + 1)
    sigma = float(np.sqrt(np.mean((g - truth) ** 2)))
    axes.fill_between(
        n, np.maximum(0.0, truth - sigma / np.sqrt(n)), truth + sigma / np.sqrt(n), color=COLOURS[0], alpha=0.15, lw=0
    )
    for run in g[:RUNS]:
        axes.plot(n, np.cumsum(run) / n, color=COLOURS[1], linewidth=1.2)
    axes.axhline(truth, color=GREY, linewidth=1.4, linestyle=(0, (6, 4)))
    axes.set_xscale("log")
    axes.set(title=title, xlabel="N samples", ylim=(max(0.0, truth - 1.5 * sigma), truth + 1.5 * sigma))


@figure(
    "mc_area_diffuse",
    "Area source by Monte Carlo (integral, diffuse)",
    """The integral as a mean: g(y) = f(y) / p(y) at points y chosen uniformly on a rectangle of light over a
    Lambertian floor. Five runs; dashed the closed form, the band is one standard error, which falls like 1/√N.""",
)
def mc_area_diffuse(path: Path) -> None:
    with panels.plot(path) as axes:
        running_means(
            axes, "Mean of g(y), Lambertian floor", on_the_light(K_D), float(irradiance.polygon(CORNERS)) * K_D
        )
        axes.set_ylabel("radiance")


@figure(
    "mc_area_brdf",
    "Area source by Monte Carlo (integral, any BRDF)",
    """The same points on the same light over a Phong lobe of exponent 20. The density p(y) = 1/A knows nothing of the
    lobe: most samples bring next to nothing, a few bring much, and the means climb in jumps.""",
)
def mc_area_brdf(path: Path) -> None:
    with panels.plot(path) as axes:
        running_means(axes, "Mean of g(y), Phong lobe", on_the_light(lobe(R)), phong.polygon(CORNERS, EXPONENT, R))
        axes.set_ylabel("radiance")


def noise(image: Image) -> str:
    """The root mean square over pixels and channels of the standard errors."""
    return f"standard error {np.sqrt(np.mean(image.standard_error**2)):.2g}"


@figure(
    "mc_cornell_box",
    "Area source by Monte Carlo (diffuse)",
    """The Cornell box, by its published spectra, direct light only. One shadow ray per sample: four times the samples,
    half the error.""",
)
def mc_cornell_box(path: Path) -> None:
    scene = panels.scene("cornell_box", width=130, height=130)
    shown = []
    for spp in (4, 16, 64):
        image = panels.picture(scene, "area_diffuse", spp=spp, sampler="independent")
        shown.append(panels.Panel(f"{spp} samples", image.mean, noise(image)))
    panels.row(path, shown)


@figure(
    "mc_plates",
    "Area source by Monte Carlo",
    """Four lights of one power over four plates, from rough in front to mirror-like behind; 16 points on each light.
    Small lights are found on all plates; a large light in a smooth plate is almost all noise, since the points do
    not know the lobe.""",
)
def mc_plates(path: Path) -> None:
    scene = panels.scene("veach_plates", width=240, height=180)
    image = panels.picture(scene, "area", spp=16, sampler="independent")
    both = panels.picture(scene, "direct", spp=16, sampler="independent")
    shown = [
        panels.Panel("area: points on the lights", image.mean, "", (160, 68, 52)),
        panels.Panel("direct: and directions of the lobe", both.mean, "", (160, 68, 52)),
    ]
    panels.row(path, shown)


@figure(
    "mc_sky_densities",
    "Diffuse surface in env. by Monte Carlo (integral)",
    """One sample at a time under L(w) = 1 + cos θ: uniform over the hemisphere, and in proportion to cos θ. Both means
    tend to 5/3; the variance of one sample is 61/45 and 1/18.""",
)
def mc_sky_densities(path: Path) -> None:
    u = np.random.default_rng(4).random((200, 4096))
    both = {"uniform": 2.0 * (1.0 + u) * u, "proportional to cos θ": 1.0 + np.sqrt(u)}  # cos θ = u, and √u
    with panels.plots(path, 1, 2, 15.0, 6.0) as axes:
        for part, (name, g) in zip(axes, both.items(), strict=True):
            running_means(part, name, g, 5.0 / 3.0)
            part.set_ylim(0.2, 3.1)
        axes[0].set_ylabel("radiance")


@figure(
    "mc_ball_under_sky",
    "Diffuse surface in env. by Monte Carlo",
    """A ball on a floor under a sky of constant radiance, 16 samples. In proportion to cos θ every sample of a point
    that sees all of the sky has the same value: what noise is left is visibility.""",
)
def mc_ball_under_sky(path: Path) -> None:
    scene = panels.scene("ball_under_sky", width=200, height=134)
    shown = []
    for shade, title in (("env_uniform", "uniform hemisphere"), ("env_cosine", "proportional to cos θ")):
        image = panels.picture(scene, shade, spp=16, sampler="independent")
        shown.append(panels.Panel(title, image.mean, noise(image)))
    panels.row(path, shown)


@figure(
    "mc_lobe_densities",
    "Arbitrary surface in env. by Monte Carlo (integral)",
    """Exact variance of one sample of a Phong lobe under a constant sky, seen along the normal, against its exponent.
    In proportion to the BRDF the variance falls with the exponent; every density that does not know the lobe gets
    worse. Under an image of a sky with a sun it is the other way round: see the pictures of the next slide.""",
)
def mc_lobe_densities(path: Path) -> None:
    n = np.geomspace(1.0, 1e4, 41)
    lines = {
        "uniform hemisphere": [variances.phong_uniform(k) for k in n],
        "proportional to cos θ": [variances.phong_cosine(k) for k in n],
        "proportional to the BRDF": [variances.phong_brdf(k) for k in n],
    }
    with panels.plot(path) as axes:
        axes.set_xscale("log")
        axes.set_yscale("log")
        ends = []
        for colour, (label, values) in zip(COLOURS, lines.items(), strict=False):
            axes.plot(n, values, color=colour)
            ends.append((float(n[-1]), float(values[-1]), label, colour))
        axes.set(title="Variance of one sample, mean 1", xlabel="exponent n", ylabel="variance")
        panels.label_lines(axes, ends)
