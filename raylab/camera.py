"""Eye rays: through a random point of each pixel's filter, from a pinhole or from a random point of an aperture.

A sample of a pixel is drawn from the pixel filter itself (importance sampling), so it counts fully and for this
pixel alone: pixels stay independent, and the standard error of each is its own.

A ray is made in two steps: `camera.draw(rng)` draws the random points, `camera.ray(...)` is plain arithmetic with
them, which the compiler does for several rays at a time.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from raylab.description import Filter
from raylab.embree import TNEAR
from raylab.jit import njit
from raylab.lanes import FILM, LANES, LENS
from raylab.pose import pose_at
from raylab.record import record
from raylab.sampling import sample_concentric_disk, sin_cos_turns
from raylab.surface import round32
from raylab.vec3 import Vec3, cross, dot, length, normalize
from raylab.view import View

CENTRE = (0.5, 0.5)


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
    start: float  # depths between which something can be hit, see `first_depth`
    far: float
    filter: Any

    def draw(self, rng):
        """A point for the pixel filter, and none for the aperture."""
        return rng.square(), CENTRE

    def draw_lanes(self, lanes):
        """The same for each lane of a packet."""
        lanes.squares(FILM, 1)

    def ray(self, column, row, film, lens, time):
        """Origin, direction and length of the eye ray through the random points `film` and `lens`."""
        dx, dy = self.filter.sample(film)
        d = self.corner + self.across * (column + 0.5 + dx) + self.down * (row + 0.5 + dy)
        return round32(self.origin + d * self.start), round32(d), max(TNEAR, self.far - self.start)

    def at(self, pose):
        """The camera at the local origin, moved to a pose."""
        return Pinhole(
            pose.p, turned(pose, self.corner), turned(pose, self.across), turned(pose, self.down),
            first_depth(self.start, pose.p, pose.x, pose.y, pose.z), self.far, self.filter,
        )  # fmt: skip


@njit
def turned(pose, v):
    """A vector of the camera's own coordinates in the world."""
    return pose.x * v.x + pose.y * v.y + pose.z * v.z


@njit
def first_depth(near, origin, left, up, forward):
    """The depth at which eye rays begin: what is in front of it lies in no scene, all of which is within 2 of 0.

    Along every ray the depth grows by 1 with t, and all points of an aperture have depth 0. So a distant camera's rays
    begin beside the scene, where float32 is fine.
    """
    n = normalize(cross(left, up))
    return max(near, (-2.0 - dot(origin, n) * math.copysign(1.0, dot(forward, n))) / abs(dot(forward, n)))


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
    """A regular opening: triangles from its centre, with corners at `radius`, the first one `first` turns from x."""

    radius: float
    sectors: float
    first: float
    cosine: float  # of the angle of a sector
    sine: float

    def sample(self, u):
        wide = u[0] * self.sectors
        sector = np.floor(wide)
        u1, u2 = wide - sector, u[1]
        half = 0.5 * min(u1, u2)  # Heitz 2019, "A low-distortion map between triangle and square"
        b1, b2 = (half, u2 - half) if u2 > u1 else (u1 - half, half)
        x, y = self.radius * (b1 + b2 * self.cosine), self.radius * b2 * self.sine
        sine, cosine = sin_cos_turns(self.first + sector / self.sectors)
        return cosine * x - sine * y, sine * x + cosine * y


def make_aperture(radius: float, blades: int, rotation: float) -> Any:
    """A disk, or the regular polygon of the same area, which keeps the amount of blur; `rotation` in degrees."""
    if blades == 0:
        return DiskAperture(radius)
    angle = 2.0 * math.pi / blades
    to_corner = radius * math.sqrt(angle / math.sin(angle))
    return PolygonAperture(to_corner, float(blades), rotation / 360.0, math.cos(angle), math.sin(angle))


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
    start: float
    far: float
    wide: bool  # an aperture wider than the scene: each ray has a depth of its own at which it begins
    left: Vec3
    up: Vec3
    aperture: Any
    power: float
    filter: Any

    def draw(self, rng):
        """A point for the pixel filter and a point of the aperture."""
        return rng.square(), self.aperture.sample(rng.square())

    def draw_lanes(self, lanes):
        lanes.squares(FILM, 2)  # the second of them in row LENS
        for i in range(LANES):
            lanes.packet.keep_point(LENS, i, self.aperture.sample(lanes.packet.point(LENS, i)))

    def ray(self, column, row, film, lens, time):
        dx, dy = self.filter.sample(film)
        toward = self.corner + self.across * (column + 0.5 + dx) + self.down * (row + 0.5 + dy)
        a = self.left * lens[0] + self.up * lens[1]
        d = toward - a * self.power
        o, start = self.origin + a, self.start
        if self.wide:
            start = max(start, (length(o) - 2.0) / length(d))
        return round32(o + d * start), round32(d), max(TNEAR, self.far - start)

    def at(self, pose):
        """The camera at the local origin, moved to a pose."""
        return ThinLens(
            pose.p, turned(pose, self.corner), turned(pose, self.across), turned(pose, self.down),
            first_depth(self.start, pose.p, pose.x, pose.y, pose.z), self.far, self.wide,
            turned(pose, self.left), turned(pose, self.up), self.aperture, self.power, self.filter,
        )  # fmt: skip


@record
class MovingCamera(NamedTuple):
    """A camera that moves while the shutter is open: each eye ray is that of the camera where it stands at its time."""

    still: Any  # Pinhole or ThinLens at the origin, looking along +z
    pieces: View  # rows of `raylab.pose`

    def draw(self, rng):
        return self.still.draw(rng)

    def draw_lanes(self, lanes):
        self.still.draw_lanes(lanes)

    def ray(self, column, row, film, lens, time):
        pose = pose_at(self.pieces, 0, len(self.pieces), time)
        return self.still.at(pose).ray(column, row, film, lens, time)
