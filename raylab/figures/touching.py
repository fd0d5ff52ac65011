"""After the last slide: a light that stands on the floor, whose samples by area have no variance, and its cures."""

from __future__ import annotations

import math
import time
from pathlib import Path

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.closed_forms import irradiance
from raylab.figures import panels
from raylab.figures.after_lecture import QUESTION
from raylab.figures.registry import figure
from raylab.probe import Pixel, Place, Probe
from raylab.scene import Scene
from raylab.study.look import COLOURS, GREY

Array = npt.NDArray[np.float64]
TOTAL = 1 << 20  # samples of each strategy
CAMERA = d.Camera(  # looks down at the floor [0, 1/2] x [-1/4, 1/4] before the light; one pixel
    np.array([[1, 0, 0, 0.25], [0, -1, 0, 0], [0, 0, -1, 8], [0, 0, 0, 1]], float),
    fov=math.degrees(2.0 * math.atan(1.0 / 32.0)), width=1, height=1,
)  # fmt: skip
CORNERS = np.array([(0.0, -1.0, 0.0), (0.0, 1.0, 0.0), (0.0, 1.0, 2.0), (0.0, -1.0, 2.0)])
STRATEGIES = {"area": "area", "area_solid_angle": "solid angle", "mis_balance": "area and BRDF (MIS)"}
NEAR = 1e-3  # distance of a point from the foot


def on_the_floor() -> Scene:
    """A wall light [-1, 1] x [0, 2] that stands on a white floor."""
    white = d.Diffuse(np.ones(3))
    floor = d.Rectangle(to_world=np.diag([4.0, 4.0, 1.0, 1.0]), front=white)
    wall = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 1], [0, 0, 0, 1]], float)
    return Scene(
        d.SceneDescription(camera=CAMERA, shapes=(floor, d.Rectangle(to_world=wall, radiance=np.ones(3), front=None)))
    )


def truth_at(points: Array) -> Array:
    """Radiance of the floor, E / pi, by Lambert's formula."""
    return np.asarray(irradiance.polygon(CORNERS, points, np.broadcast_to((0.0, 0.0, 1.0), points.shape))) / np.pi


def truth_of_the_pixel() -> float:
    """Its mean over the pixel, by Gauss-Legendre with x = u^2 / 2, which has more points at the foot."""
    u, w = np.polynomial.legendre.leggauss(64)
    u, w = 0.5 + 0.5 * u, 0.5 * w
    x, y = np.meshgrid(0.5 * u * u, 0.5 * u - 0.25, indexing="ij")
    points = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    return float(truth_at(points) @ np.outer(2.0 * u * w, w).ravel())


def coverage(values: Array, truth: float, n: int) -> float:
    """How many of the intervals mean +- 1.96 standard errors of n samples each hold the truth."""
    blocks = values[: len(values) // n * n].reshape(-1, n)
    return float(np.mean(np.abs(blocks.mean(axis=1) - truth) <= 1.96 * blocks.std(axis=1, ddof=1) / math.sqrt(n)))


@figure(
    "touching_light",
    QUESTION,
    """A light that stands on the floor, in the pixel at its foot. Points by area: f / p has the tail index 3/2 and no
    variance, the median error falls as N^(-1/3), and of the intervals mean ± 1.96 standard errors too few
    hold the truth; at a point 1/1000 before the light (dashed) hardly any. Points by solid angle, or points by
    area combined with the BRDF, are bounded: N^(-1/2), and the intervals hold. Right: the error against run time, on
    one thread.""",
)
def touching_light(path: Path) -> None:
    scene, truth = on_the_floor(), truth_of_the_pixel()
    counts = [4**k for k in range(2, 8)]
    point = Place.at(scene, (NEAR, 0.0, 0.0), (1.0, 0.0, 1.0))
    with panels.plots(path, 1, 3, 22.0, 6.4) as (errors, covered, times):
        for (shade, label), colour in zip(STRATEGIES.items(), COLOURS, strict=False):
            probe = Probe(scene, shade, Pixel(0, 0), threads=1)
            probe.sample(1, 16)  # compiled
            start = time.perf_counter()
            g = probe.sample(1, TOTAL)[:, 0]
            seconds = (time.perf_counter() - start) / TOTAL
            median = [float(np.median(np.abs(g.reshape(-1, n).mean(axis=1) / truth - 1.0))) for n in counts]
            text = f"{label} ({panels.slope(counts, median):.2f})".replace("-", panels.MINUS)
            errors.plot(counts, median, color=colour, marker="o", label=text)
            times.plot([n * seconds for n in counts], median, color=colour, marker="o", label=label)
            covered.plot(counts, [100.0 * coverage(g, truth, n) for n in counts], color=colour, marker="o", label=label)
            if shade == "area":
                near = Probe(scene, shade, point, threads=1).sample(1, TOTAL)[:, 0]
                held = [100.0 * coverage(near, float(truth_at(np.array([[NEAR, 0.0, 0.0]]))[0]), n) for n in counts]
                covered.plot(counts, held, color=colour, marker="o", linestyle=(0, (4, 2)), label="area, at a point")
        covered.axhline(95.0, color=GREY, linewidth=1.4, linestyle=(0, (6, 4)))
        errors.set(
            xscale="log", yscale="log", title="Median error (slope)", xlabel="N samples", ylabel="relative error"
        )
        covered.set(xscale="log", title="95 % intervals that hold", xlabel="N samples", ylabel="%", ylim=(0, 100))
        times.set(xscale="log", yscale="log", title="Error against run time", xlabel="seconds")
        for part in (errors, covered, times):
            part.legend(fontsize=13)
