"""Lamps: one light of a scene by itself, and what its samples say of the irradiance at a point."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.jit import njit
from raylab.lights import to_area
from raylab.point import free_point
from raylab.scene import Scene
from raylab.vec3 import Vec3, dot, normalize

Array = npt.NDArray[np.float64]
SAMPLES = 100_000
UP = Vec3(0.0, 0.0, 1.0)


class Lamp:
    """A light of radiance 1, alone in its scene."""

    def __init__(self, shape: type[d.Shape], to_world: npt.ArrayLike, **more: Any) -> None:
        lit = shape(to_world=np.asarray(to_world, float), radiance=np.ones(3), front=None, **more)
        self.scene = Scene(d.SceneDescription(shapes=(lit,)))
        self.light = self.scene.data.lights[0]

    def seen_from(self, x: npt.ArrayLike) -> Any:
        """The point x of the world, on no surface."""
        return free_point(Vec3(*self.scene.placement.points(np.asarray(x, float))))

    def irradiances(self, x: npt.ArrayLike, N: Vec3 = UP, by_angle: bool = False, n: int = SAMPLES) -> Array:
        """Samples g = cos(theta_r) cos(theta_s) / (r^2 p) of the irradiance (slide "Area source by Monte Carlo")."""
        g = np.empty(n)
        (_by_angle if by_angle else _by_sample)(self.light, self.seen_from(x), N, squares(n), g)
        return g


@njit
def _by_sample(light, x, N, u, g):
    for i in range(len(g)):
        y, p = light.sample(x, (u[i, 0], u[i, 1]))
        g[i] = max(0.0, dot(normalize(y - x), N)) * to_area(x, y) / p


@njit
def _by_angle(light, x, N, u, g):
    for i in range(len(g)):
        y, p = light.sample_solid_angle(x, (u[i, 0], u[i, 1]))
        g[i] = max(0.0, dot(normalize(y - x), N)) * to_area(x, y) / p


def squares(n: int, seed: int = 6) -> Array:
    """n points of the unit square."""
    return np.random.default_rng(seed).random((n, 2))


def off(values: Array, mean: float, relative_variance: float) -> float:
    """How far the mean of samples is from the truth, in standard errors that are exact."""
    return float(abs(values.mean() / mean - 1.0) / math.sqrt(relative_variance / len(values)))


def cap_variance(c: float) -> float:
    """Relative variance of cos(theta) over the cap cos(theta) > c: 4 (1 - c) (1 - c^3) / (3 (1 - c^2)^2) - 1."""
    return 4.0 * (1.0 + c + c * c) / (3.0 * (1.0 + c) ** 2) - 1.0
