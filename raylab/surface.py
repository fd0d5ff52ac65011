"""Where a ray meets the scene: Embree names the primitive, position and normals are recomputed in float64."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from raylab.embree import trace
from raylab.jit import njit
from raylab.motion import moving_frame
from raylab.point import Point, curved_point, facet_point, free_point
from raylab.record import record
from raylab.vec3 import Vec3, black, cross, dot, length, vec3_at
from raylab.view import View

# Columns of SceneData.shapes.
FIRST_FACE, FIRST_VERTEX, FRONT, BACK, LIGHT, SMOOTH, HAS_UV, SHAPE_COLUMNS = range(8)
# What SceneData.tally counts, per thread.
SHADOW_RAYS, INVALID_RAYS, DEGENERATE_SAMPLES, TALLIES = range(4)


@record
class SceneData(NamedTuple):
    """A scene as kernels see it, in normalised coordinates: all content within [-1, 1]."""

    embree: np.uint64
    shapes: View  # (n, SHAPE_COLUMNS) int64: meshes first, then quadrics
    vertices: View  # (n, 3) float32
    faces: View  # (n, 3) uint32, numbered within their mesh
    planes: View  # (n, 8) float64, `raylab.point.plane_table` of the faces
    quadrics: Any  # Quadrics or NoQuadrics
    normals: Any  # SmoothNormals or FlatNormals
    coordinates: Any  # Coordinates or NoCoordinates
    materials: Any  # DiffuseMaterials or PhongMaterials
    emission: Any  # Emission or NoEmission
    lights: Any  # Table of AreaLight or NoLight
    points: Any  # Table of PointLight or NoLight
    suns: Any  # Table of DirectionalLight or NoLight
    environment: Any
    max_depth: int  # rays in a row, for `raylab.basic`
    choice: Any  # FewLights or ManyLights: which of the area lights to sample
    motion: Any  # Static or Moving
    tally: View  # (TALLIES,) int64


@record
class Hit(NamedTuple):
    """The point x, the shading normal N on the side the ray came from, which side that is, and where on the shape."""

    found: bool
    x: Point
    N: Vec3
    front: bool
    shape: int
    uv: tuple[float, float]


@njit
def round32(v):
    """v rounded to float32, as Embree sees it."""
    return Vec3(np.float32(v.x), np.float32(v.y), np.float32(v.z))


@njit
def direction32(w):
    """w as Embree sees it; its answers are wrong for lengths below 1e-18 and above 1e30, so such a w is made a unit."""
    ww = dot(w, w)
    if 2.0**-100 < ww < 2.0**100 or ww == 0.0:
        return round32(w)
    return round32(w * (1.0 / math.sqrt(ww)))  # NaN and infinities stay invalid


@njit
def is_valid_ray(o, d):
    """Embree takes a thousand times longer over a ray with a NaN, and silently misses with others."""
    reach = size32(d)
    return reach > 0.0 and size32(o) + reach < math.inf  # false for every NaN and infinity


@njit
def size32(v):
    """|x| + |y| + |z| in float32: what is not finite shows, and nothing else underflows or needs a conversion."""
    return abs(np.float32(v.x)) + abs(np.float32(v.y)) + abs(np.float32(v.z))


@njit
def no_hit():
    return Hit(False, free_point(black), black, False, -1, (0.0, 0.0))


@njit
def intersect(scene, o, d, tnear, tfar):
    """The first hit of the ray o + t d, tnear <= t <= tfar; o and d hold float32 values. Invalid rays are counted."""
    if not (is_valid_ray(o, d) and 0.0 <= tnear < tfar):
        scene.tally[INVALID_RAYS] += 1
        return no_hit()
    geometry, primitive = trace(scene.embree, o, d, tnear, tfar, scene.motion.time())
    return no_hit() if geometry < 0 else hit_of(scene, geometry, primitive, o, d, tnear)


@njit
def hit_of(scene, geometry, primitive, o, d, tnear):
    """The hit of a ray with the primitive that it is known to meet first."""
    if scene.quadrics.has(geometry):
        return scene.quadrics.hit(geometry, primitive, o, d, tnear)
    return triangle_hit(scene, geometry, primitive, o, d)


@njit
def triangle_hit(scene, shape, primitive, o, d):
    """Plane intersection t = n . (v0 - o) / n . d in float64, and what the vertices carry there."""
    face = scene.shapes[shape, FIRST_FACE] + primitive
    n, offset, slack, tilt = facet(scene, shape, face)
    p = o + d * ((offset - dot(n, o)) / dot(n, d))
    N, uv = n, (0.0, 0.0)
    if scene.normals.present() or scene.coordinates.present():
        first = scene.shapes[shape, FIRST_VERTEX]
        i0, i1, i2 = first + scene.faces[face, 0], first + scene.faces[face, 1], first + scene.faces[face, 2]
        v0, v1, v2 = corners(scene, shape, i0, i1, i2)
        b = barycentrics(v0, v1, v2, p)
        if scene.shapes[shape, SMOOTH] != 0:
            N = scene.normals.at(scene.motion, shape, i0, i1, i2, b, n)
        uv = scene.coordinates.at(i0, i1, i2, b, scene.shapes[shape, HAS_UV])
    front = dot(N, d) < 0.0
    N = N if front else -N
    n = n if dot(n, N) >= 0.0 else -n
    return Hit(True, facet_point(p, n, slack, tilt), N, front, shape, uv)


@njit
def facet(scene, shape, face):
    """Unit normal n, n . v0, and the offset terms of a triangle: from the plane table, or made for its time."""
    if scene.motion.moves(shape):
        first = scene.shapes[shape, FIRST_VERTEX]
        i0, i1, i2 = first + scene.faces[face, 0], first + scene.faces[face, 1], first + scene.faces[face, 2]
        v0, v1, v2 = corners(scene, shape, i0, i1, i2)
        n, slack, tilt = moving_frame(v0, v1, v2)
        return n, dot(n, v0), slack, tilt
    tilt = Vec3(scene.planes[face, 5], scene.planes[face, 6], scene.planes[face, 7])
    return vec3_at(scene.planes, face), scene.planes[face, 3], scene.planes[face, 4], tilt


@njit
def corners(scene, shape, i0, i1, i2):
    """Three vertices where they stand now."""
    motion, vertices = scene.motion, scene.vertices
    return motion.vertex(vertices, shape, i0), motion.vertex(vertices, shape, i1), motion.vertex(vertices, shape, i2)


@njit
def barycentrics(v0, v1, v2, p):
    """(b0, b1, b2) of p in the triangle, as ratios of areas."""
    n = cross(v1 - v0, v2 - v0)
    nn = dot(n, n)
    b1, b2 = dot(cross(p - v0, v2 - v0), n) / nn, dot(cross(v1 - v0, p - v0), n) / nn
    return Vec3(1.0 - b1 - b2, b1, b2)


# --- quadrics ---


@record
class NoQuadrics(NamedTuple):
    tag: int = 0

    def has(self, geometry):
        return False

    def hit(self, geometry, primitive, o, d, tnear):
        return no_hit()


@record
class Quadrics(NamedTuple):
    """All quadrics, one Embree geometry, number `geometry`; shape numbers follow those of the meshes."""

    table: Any
    geometry: int

    def has(self, geometry):
        return geometry == self.geometry

    def hit(self, geometry, primitive, o, d, tnear):
        quadric = self.table[primitive]
        t = quadric.distance(o, d, tnear, math.inf)
        p = quadric.snap(o + d * t)
        n = quadric.normal(p)
        front = dot(n, d) < 0.0
        n = n if front else -n
        return Hit(True, curved_point(p, n), n, front, self.geometry + primitive, quadric.surface_uv(p))


# --- what vertices carry ---


@record
class FlatNormals(NamedTuple):
    tag: int = 0

    def present(self):
        return False

    def at(self, motion, shape, i0, i1, i2, b, n):
        return n


@record
class SmoothNormals(NamedTuple):
    """Vertex normals (n, 3) float32, interpolated; where they cancel, the normal of the facet stands in."""

    normals: View

    def present(self):
        return True

    def at(self, motion, shape, i0, i1, i2, b, n):
        N = motion.vertex(self.normals, shape, i0) * b.x + motion.vertex(self.normals, shape, i1) * b.y
        N += motion.vertex(self.normals, shape, i2) * b.z
        size = length(N)
        return N / size if size > 0.0 else n


@record
class NoCoordinates(NamedTuple):
    tag: int = 0

    def present(self):
        return False

    def at(self, i0, i1, i2, b, has_uv):
        return 0.0, 0.0


@record
class Coordinates(NamedTuple):
    """Texture coordinates (n, 2) float32 of the vertices; a mesh without any gives barycentric ones, as Mitsuba."""

    uv: View

    def present(self):
        return True

    def at(self, i0, i1, i2, b, has_uv):
        if has_uv == 0:
            return b.y, b.z
        u = self.uv[i0, 0] * b.x + self.uv[i1, 0] * b.y + self.uv[i2, 0] * b.z
        v = self.uv[i0, 1] * b.x + self.uv[i1, 1] * b.y + self.uv[i2, 1] * b.z
        return u, v


@record
class NoEmission(NamedTuple):
    tag: int = 0

    def of_shape(self, shape):
        return black


@record
class Emission(NamedTuple):
    """Radiance (n, 3) that each shape emits on its front."""

    radiance: View

    def of_shape(self, shape):
        return vec3_at(self.radiance, shape)
