"""Slides "Illumination as integration": the error of step 3 against n, beside Monte Carlo's against N."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from raylab.closed_forms import irradiance
from raylab.figures import panels
from raylab.figures.registry import figure
from raylab.quadrature import parallelogram_source, small_area_source

P, E1, E2 = np.array([-1.0, -0.5, 1.0]), np.array([0.0, 1.0, 0.0]), np.array([2.0, 0.0, 0.0])
X, N = np.zeros(3), np.array([0.0, 0.0, 1.0])


@figure(
    "ladder_area_diffuse",
    "Illumination as integration (Lambertian, over the light)",
    """Step 3, a bunch of n small area sources, tends to step 4, the integral, like 1/n: the light is smooth and has two
    dimensions. Monte Carlo with N points chosen uniformly on the light falls like the root of N only, but asks for
    no smoothness.""",
)
def ladder_area_diffuse(path: Path) -> None:
    truth = irradiance.polygon([P, P + E1, P + E1 + E2, P + E2]) / np.pi
    m = np.array([1, 2, 4, 8, 16, 32, 64])
    step3 = [abs(parallelogram_source(X, N, P, E1, E2, 1.0, 1.0 / np.pi, int(k)) / truth - 1.0) for k in m]
    u = np.random.default_rng(0).random((200, 4096, 2))
    y = P + u[..., :1] * E1 + u[..., 1:] * E2
    g = small_area_source(X, N, y, (0.0, 0.0, -1.0), 2.0, 1.0, 1.0 / np.pi)
    means = np.cumsum(g, axis=1) / np.arange(1, 4097)
    random = [np.sqrt(np.mean((means[:, k * k - 1] / truth - 1.0) ** 2)) for k in m]
    with panels.plot(path) as axes:
        axes.set(
            title="A rectangle over a Lambertian floor", xlabel="n small sources, or N samples", ylabel="relative error"
        )
        panels.power_laws(
            axes, [panels.Line("step 3", m**2, step3), panels.Line("Monte Carlo", m**2, random)], [-0.5, -1.0]
        )
