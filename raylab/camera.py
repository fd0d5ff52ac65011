"""Eye rays: through a random point of each pixel's filter, from a pinhole or from a random point of an aperture.

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
from raylab.pose import pose_at
from raylab.record import record
from raylab.sampling import sample_concentric_disk, sample_triangle
from raylab.surface import round32
from raylab.vec3 import Vec3, dot, length
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

    def at(self, pose):
        """The camera at the local origin, moved to a pose."""
        return Pinhole(
            pose.p, turned(pose, self.corner), turned(pose, self.across), turned(pose, self.down),
            self.near, self.far, max(0.0, length(pose.p) - 2.0), self.filter,
        )  # fmt: skip


@njit
def turned(pose, v):
    """A vector of the camera's own coordinates in the world."""
    return pose.x * v.x + pose.y * v.y + pose.z * v.z


# --- apertures ---


@record
class DiskAperture(NamedTuple):
    """A round opening of the given radius."""

    radius: float

    def sample(self, u):
        x, y = sample_concentric_disk(u)
        return self.radius * x, self.radius * y


@record
class PolygonAperture(NamedTuple):
    """A convex opening: triangles of equal area from the centre to `corners` (n + 1, 2), the last as the first."""

    corners: View

    def sample(self, u):
        sectors = len(self.corners) - 1
        k = min(int(u[0] * sectors), sectors - 1)
        b1, b2 = sample_triangle((u[0] * sectors - k, u[1]))
        x = b1 * self.corners[k, 0] + b2 * self.corners[k + 1, 0]
        return x, b1 * self.corners[k, 1] + b2 * self.corners[k + 1, 1]


def make_aperture(radius: float, blades: int, rotation: float) -> Any:
    """A disk, or the regular polygon of the same area, which keeps the amount of blur; `rotation` in degrees."""
    if blades == 0:
        return DiskAperture(radius)
    to_corner = radius * math.sqrt(2.0 * math.pi / (blades * math.sin(2.0 * math.pi / blades)))
    turn = math.radians(rotation) + 2.0 * math.pi / blades * np.arange(blades + 1)
    return PolygonAperture(View(to_corner * np.column_stack([np.cos(turn), np.sin(turn)])))


@record
class ThinLens(NamedTuple):
    """Slide "Depth of field": eye rays start at random points on the aperture, toward a point on the focus plane.

    With `toward` of depth 1 from the lens centre, the focus point is f toward and the aperture point a, so the ray is
    (f toward - a) / f = toward - a / f: `power` = 1 / f may be 0, focus at infinity.
    """

    origin: Vec3
    corner: Vec3
    across: Vec3
    down: Vec3
    near: float
    far: float
    left: Vec3
    up: Vec3
    aperture: Any
    power: float
    filter: Any

    def ray(self, column, row, rng):
        dx, dy = self.filter.sample(rng.square())
        toward = self.corner + self.across * (column + 0.5 + dx) + self.down * (row + 0.5 + dy)
        x, y = self.aperture.sample(rng.square())
        a = self.left * x + self.up * y
        d = toward - a * self.power
        o = self.origin + a
        start = self.near
        if dot(o, o) > 4.0:  # nothing can be hit before, see Pinhole.skip
            start = max(start, (length(o) - 2.0) / length(d))
        return round32(o + d * start), round32(d), max(TNEAR, self.far - start)

    def at(self, pose):
        """The camera at the local origin, moved to a pose."""
        return ThinLens(
            pose.p, turned(pose, self.corner), turned(pose, self.across), turned(pose, self.down), self.near, self.far,
            turned(pose, self.left), turned(pose, self.up), self.aperture, self.power, self.filter,
        )  # fmt: skip


@record
class MovingCamera(NamedTuple):
    """A camera that moves while the shutter is open: each eye ray is that of the camera where it stands at its time."""

    still: Any  # Pinhole or ThinLens at the origin, looking along +z
    pieces: View  # rows of `raylab.pose`
    clock: View

    def ray(self, column, row, rng):
        pose = pose_at(self.pieces, 0, len(self.pieces), self.clock[0])
        return self.still.at(pose).ray(column, row, rng)
