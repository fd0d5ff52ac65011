"""Usual tracer: Embree as it is usually given a scene, in float32 where it stands, with 1e-4 kept off surfaces."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import geometry
from raylab.embree import EmbreeScene, library, trace
from raylab.jit import njit
from raylab.scene import Scene
from raylab.vec3 import vec3_at
from raylab.view import View

Array = npt.NDArray[Any]
EPSILON = 1e-4


@njit
def trace_all(handle, origins, directions, tnear, tfar, found):
    """(geometry, primitive) of the first hit of each ray, or -1."""
    for i in range(len(origins)):
        o, d = vec3_at(origins, i), vec3_at(directions, i)
        found[i, 0], found[i, 1] = trace(handle, o, d, tnear, tfar[i])


class UsualTracer:
    """One mesh; `robust` is Embree's mode that costs a little more."""

    def __init__(self, vertices: Array, faces: Array, robust: bool = True) -> None:
        self.embree = EmbreeScene()
        if not robust:
            library().rtcSetSceneFlags(self.embree.handle, 0)
        memory = np.zeros((len(vertices) + 1, 3), np.float32)  # Embree reads 16 bytes at each vertex of 12
        self.vertices, self.faces = memory[:-1], np.ascontiguousarray(faces, np.uint32)
        self.vertices[:] = vertices
        self.embree.add_mesh(self.vertices, self.faces)
        self.embree.commit()

    @classmethod
    def of(cls, scene: Scene, robust: bool = True) -> UsualTracer:
        """All meshes of a scene in world coordinates."""
        meshes, _, _ = geometry.gather(scene.description.shapes)
        starts = np.cumsum([0, *(len(m.vertices) for m in meshes)])
        faces = [m.faces + np.uint32(start) for m, start in zip(meshes, starts, strict=False)]
        return cls(np.concatenate([m.vertices for m in meshes]), np.concatenate(faces), robust)

    def hits(self, origins: Array, directions: Array, tnear: float = EPSILON, tfar: Any = np.inf) -> Array:
        """(n,) the triangle that each ray meets first, -1 for none."""
        found = View(np.zeros((len(origins), 2), np.int64))
        ends = View(np.broadcast_to(np.asarray(tfar, np.float64), len(origins)).copy())
        rays = (View(np.asarray(v, np.float32)) for v in (origins, directions))
        trace_all(np.uint64(self.embree.handle), *rays, tnear, ends, found)
        return np.where(found.array[:, 0] < 0, -1, found.array[:, 1])

    def seen(self, faces: Array, places: Array, height: float) -> tuple[Array, Array]:
        """Points o + t d, in float32, at the barycentric places of triangles, seen from `height` above; normals."""
        with np.errstate(all="ignore"):
            return self._seen(faces, places, height)

    def _seen(self, faces: Array, places: Array, height: float) -> tuple[Array, Array]:
        v0, v1, v2 = (self.vertices[self.faces[faces, k]] for k in range(3))
        b = places.astype(np.float32)
        target = v0 + (v1 - v0) * b[:, :1] + (v2 - v0) * b[:, 1:]
        n = np.cross(v1 - v0, v2 - v0)
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        o = target + n * np.float32(height)
        d = (target - o) / np.linalg.norm(target - o, axis=1, keepdims=True)
        t = rows_dot(n, v0 - o) / rows_dot(n, d)
        return o + t * d, n

    def leave(self, faces: Array, places: Array, directions: Array, height: float) -> int:
        """How many rays from those points, in local `directions` above the surface, hit something."""
        p, n = self.seen(faces, places, height)
        return int((self.hits(p, about(n, directions)) >= 0).sum())

    def blocked(self, origins: Array, targets: Array) -> Array:
        """(n,) whether something stands between points, by a unit direction and the distance less 1e-4."""
        d = targets - origins
        with np.errstate(all="ignore"):
            distance = np.linalg.norm(d, axis=1, keepdims=True)
            unit = d / distance
        return self.hits(origins, unit, tfar=(distance - np.float32(EPSILON))[:, 0]) >= 0


def rows_dot(a: Array, b: Array) -> Array:
    return (a * b).sum(axis=1, keepdims=True)


def cosine_directions(u: Array) -> Array:
    """(n, 3): directions about +z of cosine sqrt(1 - u0)."""
    r, phi = np.sqrt(u[:, 0]), 2.0 * np.pi * u[:, 1]
    return np.column_stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1.0 - u[:, 0])])


def about(normals: Array, directions: Array) -> Array:
    """Directions about +z turned to be about unit normals; float32."""
    least = np.eye(3, dtype=np.float32)[np.argmin(np.abs(normals), axis=1)]
    s = np.cross(normals, least)
    s /= np.linalg.norm(s, axis=1, keepdims=True)
    t, d = np.cross(normals, s), directions.astype(np.float32)
    made: Array = s * d[:, :1] + t * d[:, 1:2] + normals * d[:, 2:]
    return made


def usual_hit(tracer: UsualTracer, o: Array, d: Array, tnear: float = 0.0) -> tuple[float, float, float]:
    """Embree's own t, u, v of a ray; t is inf where nothing is hit."""
    from raylab.embree import _python_ray
    from raylab.vec3 import Vec3

    words = _python_ray(Vec3(*o), Vec3(*d), tnear, np.inf)
    words[17:21].view(np.int32)[:] = -1
    library().rtcIntersect1(tracer.embree.handle, words.ctypes.data, None)
    if words[18:19].view(np.int32)[0] < 0:
        return np.inf, np.nan, np.nan
    return float(words[8]), float(words[15]), float(words[16])
