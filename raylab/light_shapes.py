"""Shapes of area lights: `sample(light, x, u)` -> a point y of the light and its density p_y in 1/m^2.

One record for each kind, `Absent` for those that a scene lacks; flat ones know uniform samples in solid angle as well.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from raylab.jit import njit
from raylab.point import curved_point, dist_sqr, facet_point, free_point, triangle_frame
from raylab.record import methods_of, record
from raylab.sampling import PI, one_minus_cos, pdf_cone, sample_cone, sample_disk, sample_sphere, sample_triangle
from raylab.solid_angle import (
    is_far,
    is_flat,
    is_round,
    pdf_disk_angle,
    pdf_rectangle_angle,
    pdf_triangle_angle,
    sample_disk_angle,
    sample_rectangle_angle,
    sample_triangle_angle,
)
from raylab.vec3 import black, dot, normalize, vec3_at
from raylab.view import View

KINDS = ("triangle", "rectangle", "disk", "sphere", "cylinder", "mesh")
TRIANGLE, RECTANGLE, DISK, SPHERE, CYLINDER, MESH = range(len(KINDS))


@njit
def to_area(x, y):
    """p_y / p_w = cos(theta_s) / |x - y|^2, sr/m^2: how a density over directions from x becomes one over points y."""
    d = y - x
    dd = dot(d, d)
    return max(0.0, -dot(d, y.n)) / (dd * math.sqrt(dd))


@record
class Absent(NamedTuple):
    """A kind of light that the scene does not have."""

    kind: int = -1

    def has(self, kind):
        return False

    def sample(self, light, x, u):
        return free_point(black), 0.0

    def pdf(self, light, x, y):
        return 0.0

    def sample_solid_angle(self, light, x, u):
        return free_point(black), 0.0

    def pdf_solid_angle(self, light, x, y):
        return 0.0


class Flat:
    """Uniform in solid angle: with a the vector from x to the corner p, (s, t) is the point at a + s e1 + t e2.

    A kind adds `sample_angle` -> (s, t) and `pdf_angle`, 1/sr, of `raylab.solid_angle`.
    """

    def point(self, light, s, t):
        return facet_point(light.p + light.e1 * s + light.e2 * t, light.n, light.slack, light.tilt)

    def by_area(self, light, a):
        """Is uniform in area the same from here, or all that is known?"""
        return is_far(a, light.e1, light.e2)

    def sample_solid_angle(self, light, x, u):
        a = light.p - x.p
        if self.by_area(light, a):
            return self.sample(light, x, u)
        if is_flat(a, light.e1, light.e2):
            return self.point(light, 0.5, 0.5), 0.0
        s, t = self.sample_angle(light, a, u)
        y = self.point(light, s, t)
        return y, self.pdf_solid_angle(light, x, y)

    def pdf_solid_angle(self, light, x, y):
        a = light.p - x.p
        if self.by_area(light, a):
            return 1.0 / light.area
        if is_flat(a, light.e1, light.e2):
            return 0.0
        return self.pdf_angle(light, a, y - x) * to_area(x, y)


@record
@methods_of(Flat)
class TriangleShape(NamedTuple):
    kind: int = TRIANGLE

    def has(self, kind):
        return kind == TRIANGLE

    def sample(self, light, x, u):
        b1, b2 = sample_triangle(u)
        return self.point(light, b1, b2), 1.0 / light.area

    def sample_angle(self, light, a, u):
        return sample_triangle_angle(a, light.e1, light.e2, u)

    def pdf_angle(self, light, a, d):
        return pdf_triangle_angle(a, light.e1, light.e2)


@record
@methods_of(Flat)
class RectangleShape(NamedTuple):
    """Slide "Area source by Monte Carlo": uniform, p(y) = 1 / A."""

    kind: int = RECTANGLE

    def has(self, kind):
        return kind == RECTANGLE

    def sample(self, light, x, u):
        y = light.p + light.e1 * u[0] + light.e2 * u[1]
        return facet_point(y, light.n, light.slack, light.tilt), 1.0 / light.area

    def sample_angle(self, light, a, u):
        return sample_rectangle_angle(a, light.e1, light.e2, u)

    def pdf_angle(self, light, a, d):
        return pdf_rectangle_angle(a, light.e1, light.e2)


@record
@methods_of(Flat)
class DiskShape(NamedTuple):
    kind: int = DISK

    def has(self, kind):
        return kind == DISK

    def sample(self, light, x, u):
        a, b = sample_disk(u)
        return self.point(light, a, b), 1.0 / light.area

    def point(self, light, s, t):
        return curved_point(light.p + light.e1 * s + light.e2 * t, light.n)

    def by_area(self, light, a):
        return is_far(a, light.e1, light.e2) or not is_round(light.e1, light.e2)

    def sample_angle(self, light, a, u):
        return sample_disk_angle(a, light.e1, light.e2, u)

    def pdf_angle(self, light, a, d):
        return pdf_disk_angle(a, light.e1, light.e2, d)


@record
class SphereShape(NamedTuple):
    """From outside, uniform over the cone of directions that meet the sphere; from inside, uniform in area."""

    kind: int = SPHERE

    def has(self, kind):
        return kind == SPHERE

    def sample(self, light, x, u):
        radius, side = light.e1.x, light.e2.x
        to_centre = light.p - x.p
        d2 = dot(to_centre, to_centre)
        if d2 <= radius * radius * (1.0 + 2.0**-40):
            outwards = sample_sphere(u)
            return curved_point(light.p + outwards * radius, outwards * side), 1.0 / light.area
        d = math.sqrt(d2)
        axis, sin_max = to_centre / d, radius / d
        w = sample_cone(axis, sin_max, u)
        outwards = first_normal(axis, sin_max, w)
        y = curved_point(light.p + outwards * radius, outwards * side)
        cos_y = max(0.0, -dot(outwards, w))
        return y, cos_y / (2.0 * PI * one_minus_cos(sin_max) * dist_sqr(x, y))

    def pdf(self, light, x, y):
        radius = light.e1.x
        to_centre = light.p - x.p
        d2 = dot(to_centre, to_centre)
        if d2 <= radius * radius * (1.0 + 2.0**-40):
            return 1.0 / light.area
        d, w = math.sqrt(d2), normalize(y - x)
        return pdf_cone(to_centre / d, radius / d, w) * max(0.0, -dot(y.n, w)) / dist_sqr(x, y)


@njit
def first_normal(axis, sin_max, w):
    """The outward normal where the ray along w first meets a sphere seen from outside, without cancellation.

    With theta the angle between w and the axis, the normal stands at the angle beta = asin(sin theta / sin_max)
    to -w, in the plane of w and the axis.
    """
    across = axis - w * dot(axis, w)
    sine = across / sin_max
    cosine = math.sqrt(max(0.0, 1.0 - dot(sine, sine)))
    return normalize(w * -cosine - sine)


@record
class CylinderShape(NamedTuple):
    kind: int = CYLINDER

    def has(self, kind):
        return kind == CYLINDER

    def sample(self, light, x, u):
        phi = 2.0 * PI * u[1]
        outwards = light.e1 * math.cos(phi) + light.e2 * math.sin(phi)
        side = light.tilt.x
        return curved_point(light.p + light.n * u[0] + outwards, normalize(outwards) * side), 1.0 / light.area


@record
class MeshShape(NamedTuple):
    """All triangles of the mesh lights: corners (3 m, 3), and the cumulated area shares (m,) within each light."""

    corners: View
    shares: View

    def has(self, kind):
        return kind == MESH

    def sample(self, light, x, u):
        low, high = light.first, light.first + light.triangles - 1
        while low < high:  # the first triangle whose cumulated share is above u1
            middle = (low + high) // 2
            if self.shares[middle] <= u[0]:
                low = middle + 1
            else:
                high = middle
        below = self.shares[low - 1] if low > light.first else 0.0
        u1 = min((u[0] - below) / (self.shares[low] - below), 1.0 - 2.0**-53)
        v0, v1, v2 = (
            vec3_at(self.corners, 3 * low),
            vec3_at(self.corners, 3 * low + 1),
            vec3_at(self.corners, 3 * low + 2),
        )
        b1, b2 = sample_triangle((u1, u[1]))
        n, slack, tilt = triangle_frame(v0, v1, v2)
        return facet_point(v0 + (v1 - v0) * b1 + (v2 - v0) * b2, n, slack, tilt), 1.0 / light.area


class Shapes(NamedTuple):
    """The kinds of area light in a scene, `Absent` where there is none."""

    triangle: Any = Absent()
    rectangle: Any = Absent()
    disk: Any = Absent()
    sphere: Any = Absent()
    cylinder: Any = Absent()
    mesh: Any = Absent()
