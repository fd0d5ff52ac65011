"""Slides "Illumination as integration": the error of step 3 against n, beside Monte Carlo's against N."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt

from raylab import ladders
from raylab.closed_forms import irradiance, phong
from raylab.figures import panels
from raylab.figures.registry import figure

Array = npt.NDArray[np.float64]
X, N = np.zeros(3), np.array([0.0, 0.0, 1.0])
P, E1, E2 = np.array([-1.0, -0.5, 1.0]), np.array([0.0, 1.0, 0.0]), np.array([2.0, 0.0, 0.0])
CORNERS = np.array([P, P + E1, P + E1 + E2, P + E2])
K_D = 1.0 / np.pi
R, EXPONENT = np.array([0.36, 0.48, 0.8]), 20
REPEATS, MOST = 200, 4096
M = np.array([1, 2, 4, 8, 16, 32, 64])
SUN, HALF_ANGLE, PLACES = np.array([0.48, 0.6, 0.64]), 0.3, 100


def lobe(r: Array) -> Callable[[Array], Array]:
    return lambda w: phong.lobe(EXPONENT, 1.0) * np.maximum(0.0, w @ r) ** EXPONENT


def monte_carlo(g: Array, truth: float) -> tuple[Array, list[float]]:
    """N and the relative root mean square error of the mean of N samples, from samples g (repeats, MOST)."""
    means = np.cumsum(g, axis=1) / np.arange(1, g.shape[1] + 1)
    return M**2, [float(np.sqrt(np.mean((means[:, n - 1] / truth - 1.0) ** 2))) for n in M**2]


def on_the_light(f_r: ladders.Function) -> Array:
    """Samples g(y) = f(y) / p(y), y uniform on the light: step 2 with the area of all of it."""
    u = np.random.default_rng(0).random((REPEATS, MOST, 2))
    y = P + u[..., :1] * E1 + u[..., 1:] * E2
    return ladders.small_area_source(X, N, y, -N, 2.0, 1.0, f_r)


def in_the_hemisphere(L_i: ladders.Function, f_r: ladders.Function) -> Array:
    """Samples g(w) = f(w) / p(w), w uniform in the hemisphere: step 2 with the solid angle of all of it."""
    u = np.random.default_rng(1).random((REPEATS, MOST, 2))
    z, phi = u[..., 0], 2.0 * np.pi * u[..., 1]
    r = np.sqrt(1.0 - z * z)
    w = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)
    return ladders.small_solid_angle(N, w, 2.0 * np.pi, L_i, f_r)


def draw(path: Path, title: str, n: str, lines: list[panels.Line]) -> None:
    with panels.plot(path) as axes:
        axes.set(title=title, xlabel=f"n {n}, or N samples", ylabel="relative error")
        panels.power_laws(axes, lines, [-0.5, -1.0])


def over_the_light(path: Path, title: str, f_r: ladders.Function, truth: float) -> None:
    step3 = [abs(ladders.area_sources(X, N, *ladders.area_parts(P, E1, E2, m), 1.0, f_r) / truth - 1.0) for m in M]
    lines = [
        panels.Line("step 3: sum of n", M**2, step3, fit_from=64),
        panels.Line("Monte Carlo", *monte_carlo(on_the_light(f_r), truth)),
    ]
    draw(path, title, "small area sources", lines)


@figure(
    "ladder_area_diffuse",
    "Illumination as integration (Lambertian, over the light)",
    """Step 3, a bunch of n small area sources, tends to step 4, the integral, like 1/n: in two dimensions the parts
    have the side h = 1/√n, and the middle of a part is exact up to h². Monte Carlo's error falls like 1/√N only.
    Both against Lambert's closed form.""",
)
def ladder_area_diffuse(path: Path) -> None:
    over_the_light(
        path, "A rectangle 2 by 1 at height 1, Lambertian floor", K_D, float(irradiance.polygon(CORNERS)) * K_D
    )


@figure(
    "ladder_area_brdf",
    "Illumination as integration (any BRDF, over the light)",
    """The same light over a Phong lobe of exponent 20. The sum must have parts smaller than the lobe before its order
    shows; then it is 1/n again. Against Arvo's closed form.""",
)
def ladder_area_brdf(path: Path) -> None:
    truth = phong.polygon(CORNERS, EXPONENT, R)
    over_the_light(path, "A rectangle 2 by 1 at height 1, Phong lobe n = 20", lobe(R), truth)


def sun_places() -> Array:
    """Directions (PLACES, 3) to a sun that is all above the horizon."""
    rng = np.random.default_rng(2)
    z, phi = rng.uniform(0.4, 0.9, PLACES), rng.uniform(0.0, 2.0 * np.pi, PLACES)
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)


def sun_error(m: int) -> float:
    """Relative root mean square error of step 3 over places of a sun with a sharp edge."""
    w, dsigma = ladders.direction_parts(N, m)

    def relative(axis: Array) -> float:
        sun = lambda w: 1.0 * (w @ axis > np.cos(HALF_ANGLE))  # noqa: E731
        return ladders.solid_angles(N, w, dsigma, sun, K_D) / (K_D * irradiance.cap_sky(HALF_ANGLE) * axis[2]) - 1.0

    return float(np.sqrt(np.mean([relative(axis) ** 2 for axis in sun_places()])))


@figure(
    "ladder_directions_diffuse",
    "Illumination as integration (Lambertian, over directions)",
    """Step 3 with n equal solid angles. Under a smooth sky the error is 1/n; where the sky jumps, at the edge of a sun
    of half angle 0.3 (root mean square over 100 places), the parts along the edge are wrong and it is n^(-3/4).
    Monte Carlo under the smooth sky, uniform over the hemisphere: 1/√N, whatever the sky.""",
)
def ladder_directions_diffuse(path: Path) -> None:
    b = np.array([0.3, -0.2, 0.5])
    truth = K_D * float(irradiance.gradient_sky(1.1, b))
    sky = lambda w: 1.1 + w @ b  # noqa: E731
    step3 = [abs(ladders.solid_angles(N, *ladders.direction_parts(N, m), sky, K_D) / truth - 1.0) for m in M[:-1]]
    lines = [
        panels.Line("step 3, smooth sky", 4 * M[:-1] ** 2, step3, fit_from=64),
        panels.Line("Monte Carlo", *monte_carlo(in_the_hemisphere(sky, K_D), truth)),
        panels.Line("step 3, a sun", 4 * M[1:-1] ** 2, [sun_error(int(m)) for m in M[1:-1]], fit_from=64),
    ]
    draw(path, "A Lambertian surface under the sky", "small solid angles", lines)


@figure(
    "ladder_directions_brdf",
    "Illumination as integration (any BRDF, over directions)",
    """A Phong lobe of exponent 20, its mirror direction 53° from the normal, under a constant sky; the closed form is
    the M(v) of the slides. Few solid angles miss the lobe; once it is resolved, the error is 1/n. For Monte Carlo,
    uniform over the hemisphere, the narrow lobe only means more variance.""",
)
def ladder_directions_brdf(path: Path) -> None:
    f_r, truth = lobe(np.array([0.8, 0.0, 0.6])), phong.constant_sky(EXPONENT, 0.6)
    step3 = [abs(ladders.solid_angles(N, *ladders.direction_parts(N, m), 1.0, f_r) / truth - 1.0) for m in M[:-1]]
    lines = [
        panels.Line("step 3: sum of n", 4 * M[:-1] ** 2, step3, fit_from=256),
        panels.Line("Monte Carlo", *monte_carlo(in_the_hemisphere(1.0, f_r), truth)),
    ]
    draw(path, "A Phong lobe under a constant sky", "small solid angles", lines)
