"""Leaving: rays that start on a triangle and have nothing to meet; every hit of theirs is a false one."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.jit import njit
from raylab.point import triangle_frame
from raylab.sampling import sample_cos_hemisphere
from raylab.scene import Scene
from raylab.shadow import shadow_toward
from raylab.stress.usual_tracer import UsualTracer, cosine_directions
from raylab.surface import round32, triangle_hit
from raylab.vec3 import vec3_at
from raylab.view import View

Array = npt.NDArray[Any]
GREY = d.Diffuse(np.full(3, 0.5))


def rotation(angle: float) -> Array:
    """A rotation about an axis that no triangle is aligned with."""
    k = np.array([0.36, 0.48, 0.8])
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    turned: Array = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return turned


def placed(scale: float = 1.0, offset: Any = 0.0, angle: float = 0.0) -> Array:
    """(4, 4): turned, scaled, moved."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation(angle) * scale
    matrix[:3, 3] = offset
    return matrix


def triangle(aspect: float = 1.0, scale: float = 1.0, offset: float = 0.0, angle: float = 0.7) -> Scene:
    """A scene of one triangle of the given size, height over base, at offset (1, 0.7, -0.4)."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0.3, aspect, 0]])
    matrix = placed(scale, np.array([1.0, 0.7, -0.4]) * offset, angle)
    return mesh(corners, np.array([[0, 1, 2]]), matrix)


def mesh(vertices: Array, faces: Array, to_world: Array | None = None) -> Scene:
    """A scene of one mesh."""
    shape = d.Mesh(vertices=vertices, faces=faces, to_world=np.eye(4) if to_world is None else to_world)
    return Scene(d.SceneDescription(shapes=(shape,)))


class Rays(NamedTuple):
    """Where rays start, as triangle and barycentrics (b1, b2), and two numbers that say whereto."""

    faces: Array
    places: Array
    directions: Array

    @classmethod
    def spread(cls, seed: int, count: int, faces: int = 1, least: float = 1e-7) -> Rays:
        """Uniform over triangles; the cosines' logarithms are uniform down to that of `least`."""
        rng = np.random.default_rng(seed)
        b = rng.random((count, 2))
        b = np.where(b.sum(axis=1, keepdims=True) > 1.0, 1.0 - b, b)
        u = rng.random((count, 2))
        u[:, 0] = 1.0 - 10.0 ** rng.uniform(2.0 * math.log10(least), 0, count)
        return cls(rng.integers(0, faces, count), b, u)


@njit
def leave(scene, faces, places, directions, hits):
    """From points of triangles of shape 0, rays over the hemisphere: which of them hit something."""
    for i in range(len(faces)):
        face = faces[i]
        v0 = vec3_at(scene.vertices, scene.faces[face, 0])
        v1, v2 = vec3_at(scene.vertices, scene.faces[face, 1]), vec3_at(scene.vertices, scene.faces[face, 2])
        n, _, _ = triangle_frame(v0, v1, v2)
        p = v0 + (v1 - v0) * places[i, 0] + (v2 - v0) * places[i, 1]
        o = round32(p + n * 0.5)
        hit = triangle_hit(scene, 0, face, o, round32(p - o))
        w = sample_cos_hemisphere(hit.x.n, (directions[i, 0], directions[i, 1]))
        hits[i] = 1 if shadow_toward(scene, hit.x, w) else 0


def false_hits(scene: Scene, rays: Rays) -> int:
    """How many of raylab's rays hit something."""
    hits = View(np.zeros(len(rays.faces), np.int64))
    leave(scene.data, *map(View, rays), hits)
    return int(hits.array.sum())


def usual_false_hits(scene: Scene, rays: Rays) -> int:
    """How many rays of the usual code do; it sees the points from half the scene's size away, as raylab's does."""
    directions = cosine_directions(rays.directions)
    return UsualTracer.of(scene).leave(rays.faces, rays.places, directions, 0.5 / scene.placement.scale)
