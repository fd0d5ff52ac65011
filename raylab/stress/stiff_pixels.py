"""Stiff pixels: a point light that nearly touches the floor, a highlight that little of the lens sees, a small sun."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.jit import njit
from raylab.probe import Pixel, Probe
from raylab.render import render
from raylab.sampling import sample_disk
from raylab.scene import Scene
from raylab.stress.case import Found, case
from raylab.stress.lamps import squares
from raylab.stress.nearness import FEW, WHITE, placed, seen
from raylab.stress.oracle import gauss
from raylab.stress.stiff_estimators import MANY, UNIT, largest, relative
from raylab.stress.stiff_lobes import BEYOND, VEACH

Array = npt.NDArray[np.float64]
ROWS, COLUMNS = 16, 32  # texels of the sky
PICTURES, GRID = 64, 32  # pictures in strata, and the cells along a side of each of their four streams


def of_texels(sky: Array) -> tuple[float, dict[str, float]]:
    """Irradiance of an upward floor, and relative variances by cosine, by brightness, and of one sample of each.

    In each row quadrature over c = cos(theta), which is uniform in solid angle; f = L c, p = L / sum, q = c / pi.
    """
    t, w = gauss(32)
    edges = np.cos(np.linspace(0.0, math.pi, ROWS + 1))[: ROWS // 2 + 1].clip(0.0)
    c = (edges[1:, None] + (edges[:-1] - edges[1:])[:, None] * t)[:, None, :]
    weight = ((edges[:-1] - edges[1:])[:, None] * w)[:, None, :] * (2.0 * math.pi / COLUMNS)
    L = sky[: ROWS // 2, :, None]
    size = -np.diff(np.cos(np.linspace(0.0, math.pi, ROWS + 1)))[:, None] * (2.0 * math.pi / COLUMNS)
    f, p, q = L * c, L / float((sky * size).sum()) + 0.0 * c, c / math.pi + 0.0 * L

    def integral(values: Array) -> float:
        return float((values * weight).sum())

    mean = integral(f)
    both = integral(f * f / (p + q)) - integral(p * f / (p + q)) ** 2 - integral(q * f / (p + q)) ** 2
    alone = {name: integral(f * f / r) / mean**2 - 1.0 for name, r in (("env_cosine", q), ("env_brightness", p))}
    return mean, alone | {"mis_balance": both / mean**2}


@case(
    "S07", "a sky of 32 x 16 texels with a sun of 1e4 : 1 and of 2 : 1, over a diffuse floor",
    usual="cosine-proportional; by brightness: neither is the better one for both",
    rule="one sample of each, by the balance heuristic: at most 1/2", truth="quadrature over the texels", unit=BEYOND,
    allowed=VEACH, limit=90.0,
)  # fmt: skip
def sun_or_not() -> Found:
    error: list[float] = []
    usual: list[float] = []
    told = []
    floor = d.Rectangle(to_world=np.diag([4.0, 4.0, 4.0, 1.0])[[0, 2, 1, 3]] * [[1], [1], [-1], [1]], front=WHITE)
    for sun in (1e4, 2.0):
        sky = np.ones((ROWS, COLUMNS))
        sky[2, 5] = sun
        mean, truths = of_texels(sky)
        image = d.ImageEnvironment(np.repeat(sky[..., None], 3, axis=2), filter="nearest")
        scene = Scene(d.SceneDescription(shapes=(floor,), environment=image))
        best = min(truths["env_cosine"], truths["env_brightness"])
        for name, truth in truths.items():
            g = math.pi * seen(scene, name, (0.0, 0.0, 0.0), (0.1, 1.0, 0.2), 4 * FEW)
            (error if name == "mis_balance" else usual).append(relative(g, mean, truth) - best)
        told.append(" and ".join(f"{truth:.3g}" for truth in truths.values()))
    return Found(largest(error), largest(usual), note=f"Relative variances: {'; '.join(told)}")


@case(
    "S09", "a point light 0.05 and 0.02 above the middle of a pixel of 1 x 1",
    usual="rays at random: P / (8 pi h^2)",
    rule="one ray in each cell of a grid of 32 x 32", truth="quadrature over the pixel; in a square of side a the "
    "variance is at most a^2 / pi^2 times the mean |gradient|^2 (Poincare), which here is 3 / (16 pi h^4)",
    unit="N times the relative variance of a mean of N, over Poincare's bound; 64 pictures know it to 4.5 x 18 %",
    allowed=1.0 + 4.5 * math.sqrt(2.0 / (PICTURES - 1)), limit=90.0,
)  # fmt: skip
def point_over_a_pixel() -> Found:
    error, usual, told = [], [], []
    eye = np.diag([1.0, -1.0, -1.0, 1.0])
    eye[2, 3] = 8.0
    camera = d.Camera(eye, fov=math.degrees(2.0 * math.atan(1.0 / 16.0)), width=1, height=1)
    floor = d.Rectangle(to_world=placed(0, 0, 0, 4, 4), front=WHITE)
    for h in (0.05, 0.02):
        light = d.PointLight(position=np.array([0.0, 0.0, h]), intensity=np.ones(3))
        scene = Scene(d.SceneDescription(camera=camera, shapes=(floor,), lights=(light,)))
        t, wt = gauss(200, 0.0, math.asinh(0.5 / h))  # x = h sinh t
        x, w = h * np.sinh(t), wt * h * np.cosh(t)
        rr = h * h + x[:, None] ** 2 + x**2
        mean, second = (4.0 * float(w @ f @ w) for f in (h / rr**1.5, h * h / rr**3))
        truth, bound = second / mean**2 - 1.0, 3.0 / (16.0 * math.pi**3 * h**4 * GRID**2)
        g = math.pi * Probe(scene, "point_light", Pixel(0, 0)).sample(6, MANY)[:, 0]
        usual.append(relative(g, mean, truth) / bound)
        n = 4 * GRID**2  # four streams, each with a grid of its own
        strata = [render(scene, "point_light", sampler="stratified", spp=n, seed=k, threads=1) for k in range(PICTURES)]
        found = n * float(np.var([math.pi * image.mean[0, 0, 0] / mean for image in strata], ddof=1))
        error.append(found / bound)
        told.append(f"{truth:.3g} and {found:.2g}")
    return Found(largest(error), largest(usual), note=f"Relative variances: {'; '.join(told)}")


@njit
def _on_lens(u, x):
    for i in range(len(u)):
        x[i, 0], x[i, 1] = sample_disk((u[i, 0], u[i, 1]))


@case(
    "S11", "a highlight that 1e-2 and 1e-3 of the lens see", usual="points of the lens: (1 - p) / p",
    rule="the same: no better one is built in; intervals of Wilson (G09)", truth="the binomial law", unit=UNIT,
    allowed=(1.0 - 1e-3) / 1e-3 * 1.2,
)  # fmt: skip
def seen_through_a_lens() -> Found:
    x = np.empty((MANY, 2))
    _on_lens(squares(MANY), x)
    return Found(largest([relative(((x**2).sum(axis=1) < p).astype(float), p, (1.0 - p) / p) for p in (1e-2, 1e-3)]))
