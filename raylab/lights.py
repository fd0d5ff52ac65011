"""Light sources: `radiance`, and `light.sample(x, u)` -> a point y on the light and its density p_y in 1/m^2.

`for light in scene.lights` runs over area lights of all shapes. One record serves them all: what its vectors mean
depends on `kind`, and the kinds that a scene lacks are `Absent`, so that nothing of them is compiled.
A light emits on the side of its normal only.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from raylab.jit import njit
from raylab.light_shapes import (  # noqa: F401 (they are part of what stands here)
    CYLINDER,
    DISK,
    KINDS,
    MESH,
    RECTANGLE,
    SPHERE,
    TRIANGLE,
    Absent,
    CylinderShape,
    DiskShape,
    MeshShape,
    RectangleShape,
    Shapes,
    SphereShape,
    TriangleShape,
    to_area,
)
from raylab.point import Point, free_point
from raylab.record import record
from raylab.vec3 import Vec3, black

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
