"""Eye rays: through a random point of each pixel's filter, from a pinhole.

A sample of a pixel is drawn from the pixel filter itself (importance sampling), so it counts fully and for this
pixel alone: pixels stay independent, and the standard error of each is its own.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from raylab.description import Filter
from raylab.embree import TNEAR
from raylab.jit import njit
from raylab.record import record
from raylab.surface import round32
from raylab.vec3 import Vec3, length
from raylab.view import View


@record
class BoxFilter(NamedTuple):
    """Constant within `radius` pixels of the centre."""

    radius: float

    def sample(self, u):
        return self.radius * (2.0 * u[0] - 1.0), self.radius * (2.0 * u[1] - 1.0)


@record
class TentFilter(NamedTuple):
    """Proportional to (1 - |x| / radius) (1 - |y| / radius)."""

    radius: float

    def sample(self, u):
        return self.radius * tent(u[0]), self.radius * tent(u[1])


@njit
def tent(u):
    """x in [-1, 1] with density 1 - |x|."""
    return math.sqrt(2.0 * u) - 1.0 if u < 0.5 else 1.0 - math.sqrt(2.0 * (1.0 - u))


@record
class TableFilter(NamedTuple):
    """A separable filter by its inverted distribution function, tabulated at equal steps and linear between."""

    inverse: View

    def sample(self, u):
        return lookup(self.inverse, u[0]), lookup(self.inverse, u[1])


@njit
def lookup(table, u):
    x = u * (len(table) - 1)
    i = min(int(x), len(table) - 2)
    return table[i] + (table[i + 1] - table[i]) * (x - i)


def gaussian_filter(radius: float, stddev: float, steps: int = 4096) -> TableFilter:
    """exp(-x^2 / 2 s^2) - exp(-radius^2 / 2 s^2) within the radius, as in Mitsuba 3; `steps` equal shares of it."""
    x = np.linspace(-radius, radius, 16 * steps + 1)
    density = np.exp(-(x**2) / (2 * stddev**2)) - np.exp(-(radius**2) / (2 * stddev**2))
    cdf = np.concatenate([[0.0], np.cumsum(density[1:] + density[:-1])])
    return TableFilter(View(np.interp(np.linspace(0.0, 1.0, steps + 1), cdf / cdf[-1], x)))


def make_filter(description: Filter) -> Any:
    """The record that samples the described filter."""
    if description.kind == "box":
        return BoxFilter(description.radius)
    if description.kind == "tent":
        return TentFilter(description.radius)
    return gaussian_filter(description.radius, description.stddev)


@record
class Pinhole(NamedTuple):
    """Slide "Cause of focusing effects": a point aperture, always in focus.

    The pixel position (px, py) has the direction corner + across px + down py, whose depth along the axis is 1.
    """

    origin: Vec3
    corner: Vec3
    across: Vec3
    down: Vec3
    near: float
    far: float
    skip: float  # how far a distant camera may advance before anything can be hit
    filter: Any

    def ray(self, column, row, rng):
        dx, dy = self.filter.sample(rng.square())
        d = self.corner + self.across * (column + 0.5 + dx) + self.down * (row + 0.5 + dy)
        start = self.near
        if self.skip > 0.0:
            start = max(start, self.skip / length(d))
        return round32(self.origin + d * start), round32(d), max(TNEAR, self.far - start)
