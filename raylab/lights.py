"""Light sources: `radiance`, and `light.sample(x, u)` -> a point y on the light and its density p_y in 1/m^2.

`for light in scene.lights` runs over area lights of all shapes. One record serves them all: what its vectors mean
depends on `kind`, and the kinds that a scene lacks are `Absent`, so that nothing of them is compiled.
A light emits on the side of its normal only.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from raylab.jit import njit
from raylab.point import Point, curved_point, dist_sqr, facet_point, free_point, triangle_frame
from raylab.record import record
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
from raylab.vec3 import Vec3, black, dot, normalize, vec3_at
from raylab.view import View

KINDS = ("triangle", "rectangle", "disk", "sphere", "cylinder", "mesh")
TRIANGLE, RECTANGLE, DISK, SPHERE, CYLINDER, MESH = range(len(KINDS))
ROW = 23  # columns of a light's row: kind, radiance 3, p 3, e1 3, e2 3, n 3, area, slack, tilt 3, first, triangles


@record
class AreaLight(NamedTuple):
    """A light of radiance `radiance` (W/(m^2 sr)) and area `area`.

    triangle, rectangle: corner p, edges e1, e2, normal n. disk: centre p, half axes e1, e2, normal n.
    sphere: centre p, radius e1.x, side e2.x (+1: outwards). cylinder: foot p, axis n, half axes e1, e2, side below.
    mesh: triangles first .. first + triangles - 1 of `shapes.mesh`.
    """

    kind: int
    radiance: Vec3
    p: Vec3
    e1: Vec3
    e2: Vec3
    n: Vec3
    area: float
    slack: float
    tilt: Vec3
    first: int
    triangles: int
    shapes: Any  # the Shapes of the scene

    @staticmethod
    def of(rows, i, shapes):
        return AreaLight(
            int(rows[i, 0]), vec3_from(rows, i, 1), vec3_from(rows, i, 4), vec3_from(rows, i, 7),
            vec3_from(rows, i, 10), vec3_from(rows, i, 13), rows[i, 16], rows[i, 17], vec3_from(rows, i, 18),
            int(rows[i, 21]), int(rows[i, 22]), shapes,
        )  # fmt: skip

    def sample(self, x, u):
        shapes = self.shapes
        if shapes.triangle.has(self.kind):
            return shapes.triangle.sample(self, x, u)
        if shapes.rectangle.has(self.kind):
            return shapes.rectangle.sample(self, x, u)
        if shapes.disk.has(self.kind):
            return shapes.disk.sample(self, x, u)
        if shapes.sphere.has(self.kind):
            return shapes.sphere.sample(self, x, u)
        if shapes.cylinder.has(self.kind):
            return shapes.cylinder.sample(self, x, u)
        return shapes.mesh.sample(self, x, u)

    def pdf(self, x, y):
        """The density p_y, 1/m^2, with which `sample(x, u)` would have found the point y of this light."""
        if self.shapes.sphere.has(self.kind):
            return self.shapes.sphere.pdf(self, x, y)
        return 1.0 / self.area

    def sample_solid_angle(self, x, u):
        """Uniform in solid angle: p_y = cos(theta_s) / (|x - y|^2 Omega), 1/m^2; a cylinder or mesh by area."""
        shapes = self.shapes
        if shapes.triangle.has(self.kind):
            return shapes.triangle.sample_solid_angle(self, x, u)
        if shapes.rectangle.has(self.kind):
            return shapes.rectangle.sample_solid_angle(self, x, u)
        if shapes.disk.has(self.kind):
            return shapes.disk.sample_solid_angle(self, x, u)
        return self.sample(x, u)

    def pdf_solid_angle(self, x, y):
        """The density p_y, 1/m^2, with which `sample_solid_angle(x, u)` would have found y."""
        shapes = self.shapes
        if shapes.triangle.has(self.kind):
            return shapes.triangle.pdf_solid_angle(self, x, y)
        if shapes.rectangle.has(self.kind):
            return shapes.rectangle.pdf_solid_angle(self, x, y)
        if shapes.disk.has(self.kind):
            return shapes.disk.pdf_solid_angle(self, x, y)
        return self.pdf(x, y)


@njit
def to_area(x, y):
    """p_y / p_w = cos(theta_s) / |x - y|^2, sr/m^2: how a density over directions from x becomes one over points y."""
    d = y - x
    dd = dot(d, d)
    return max(0.0, -dot(d, y.n)) / (dd * math.sqrt(dd))


@njit
def vec3_from(rows, i, j):
    """Columns j, j + 1, j + 2 of row i."""
    return Vec3(rows[i, j], rows[i, j + 1], rows[i, j + 2])


@record
class NoLight(NamedTuple):
    """What the lights would be of a scene that has none of a kind: a loop over them is compiled to nothing."""

    radiance: Vec3
    I: Vec3  # noqa: E741
    y: Point
    w: Vec3

    @staticmethod
    def of(rows, i, shapes):
        return NoLight(black, black, free_point(black), black)

    def sample(self, x, u):
        return self.y, 0.0

    def pdf(self, x, y):
        return 0.0

    def sample_solid_angle(self, x, u):
        return self.y, 0.0

    def pdf_solid_angle(self, x, y):
        return 0.0


NoLight.EMPTY = True  # type: ignore[attr-defined]


# --- the shapes ---


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


@record
class TriangleShape(NamedTuple):
    kind: int = TRIANGLE

    def has(self, kind):
        return kind == TRIANGLE

    def sample(self, light, x, u):
        b1, b2 = sample_triangle(u)
        y = light.p + light.e1 * b1 + light.e2 * b2
        return facet_point(y, light.n, light.slack, light.tilt), 1.0 / light.area

    def sample_solid_angle(self, light, x, u):
        a = light.p - x.p
        if is_far(a, light.e1, light.e2):
            return self.sample(light, x, u)
        s, t = sample_triangle_angle(a, light.e1, light.e2, u)
        y = facet_point(light.p + light.e1 * s + light.e2 * t, light.n, light.slack, light.tilt)
        return y, self.pdf_solid_angle(light, x, y)

    def pdf_solid_angle(self, light, x, y):
        a = light.p - x.p
        if is_far(a, light.e1, light.e2):
            return 1.0 / light.area
        if is_flat(a, light.e1, light.e2):
            return 0.0
        return pdf_triangle_angle(a, light.e1, light.e2) * to_area(x, y)


@record
class RectangleShape(NamedTuple):
    """Slide "Area source by Monte Carlo": uniform, p(y) = 1 / A."""

    kind: int = RECTANGLE

    def has(self, kind):
        return kind == RECTANGLE

    def sample(self, light, x, u):
        y = light.p + light.e1 * u[0] + light.e2 * u[1]
        return facet_point(y, light.n, light.slack, light.tilt), 1.0 / light.area

    def sample_solid_angle(self, light, x, u):
        a = light.p - x.p
        if is_far(a, light.e1, light.e2):
            return self.sample(light, x, u)
        s, t = sample_rectangle_angle(a, light.e1, light.e2, u)
        y = facet_point(light.p + light.e1 * s + light.e2 * t, light.n, light.slack, light.tilt)
        return y, self.pdf_solid_angle(light, x, y)

    def pdf_solid_angle(self, light, x, y):
        a = light.p - x.p
        if is_far(a, light.e1, light.e2):
            return 1.0 / light.area
        if is_flat(a, light.e1, light.e2):
            return 0.0
        return pdf_rectangle_angle(a, light.e1, light.e2) * to_area(x, y)


@record
class DiskShape(NamedTuple):
    kind: int = DISK

    def has(self, kind):
        return kind == DISK

    def sample(self, light, x, u):
        a, b = sample_disk(u)
        return curved_point(light.p + light.e1 * a + light.e2 * b, light.n), 1.0 / light.area

    def sample_solid_angle(self, light, x, u):
        a = light.p - x.p
        if is_far(a, light.e1, light.e2) or not is_round(light.e1, light.e2):
            return self.sample(light, x, u)
        if is_flat(a, light.e1, light.e2):
            return curved_point(light.p, light.n), 0.0
        s, t = sample_disk_angle(a, light.e1, light.e2, u)
        y = curved_point(light.p + light.e1 * s + light.e2 * t, light.n)
        return y, self.pdf_solid_angle(light, x, y)

    def pdf_solid_angle(self, light, x, y):
        a = light.p - x.p
        if is_far(a, light.e1, light.e2) or not is_round(light.e1, light.e2):
            return 1.0 / light.area
        if is_flat(a, light.e1, light.e2):
            return 0.0
        return pdf_disk_angle(a, light.e1, light.e2, y - x) * to_area(x, y)


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


# --- lights without area: step 1 of each "Illumination as integration" slide ---


@record
class PointLight(NamedTuple):
    """Radiant intensity `I`, W/sr, from the point `y`."""

    I: Vec3  # noqa: E741 (the slide's name)
    y: Point

    @staticmethod
    def of(rows, i, store):
        return PointLight(vec3_from(rows, i, 0), free_point(vec3_from(rows, i, 3)))


@record
class DirectionalLight(NamedTuple):
    """Irradiance `I`, W/m^2, on a surface that faces the unit direction `w` to the light."""

    I: Vec3  # noqa: E741 (the slide's name)
    w: Vec3

    @staticmethod
    def of(rows, i, store):
        return DirectionalLight(vec3_from(rows, i, 0), vec3_from(rows, i, 3))
