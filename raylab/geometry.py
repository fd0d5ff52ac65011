"""From described shapes to arrays: world transforms, the normalised placement, meshes and quadrics for Embree."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import defects, keyframes, quadrics
from raylab import description as d
from raylab.errors import SceneError
from raylab.keyframes import Shutter
from raylab.triangles import directions, proportions

Array = npt.NDArray[np.float64]

CENTRE_BITS = 10  # the centre is a multiple of 2^-10 of the scene's size
QUADRIC_SEGMENTS = 8  # parts of the shutter interval for which Embree holds boxes of what is not a mesh
LARGEST = float(np.finfo(np.float32).max)  # normal or texture coordinate

_SQUARE = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
_SQUARE_UV = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
_SQUARE_FACES = np.array([[0, 1, 2], [0, 2, 3]])


@dataclass
class MeshArrays:
    """A mesh in world coordinates, its degenerate triangles removed."""

    shape: d.Shape
    vertices: Array
    faces: npt.NDArray[np.uint32]
    normals: Array | None
    uv: Array | None
    finest: Array  # (m,) the shortest edge of each triangle
    kind: str = "mesh"
    segments: int = 0  # straight parts of its motion; vertices and normals stand one after the other at each end
    error: float = 0.0  # how far its vertices may stand off their true path


@dataclass
class QuadricArrays:
    """A quadric in world coordinates: `to_world` maps the unit sphere, disk or cylinder to it."""

    shape: d.Shape
    kind: int
    to_world: Array
    local: Array  # the part of to_world below the shape's own


@dataclass(frozen=True)
class Placement:
    """Normalised coordinates: (x - centre) * scale, scale a power of two."""

    centre: Array
    scale: float

    def points(self, x: npt.ArrayLike) -> Array:
        return (np.asarray(x, np.float64) - self.centre) * self.scale

    @classmethod
    def around(cls, boxes: Sequence[tuple[Array, Array]]) -> Placement:
        """The placement that brings all the (lower, upper) boxes into [-1, 1]."""
        if not boxes:
            return cls(np.zeros(3), 1.0)
        lower, upper = np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)
        centre = lower + (upper - lower) / 2
        extent = float(np.max(np.maximum(upper - centre, centre - lower)))
        if extent == 0.0:
            return cls(centre, 1.0)
        step = 2.0 ** (math.frexp(extent)[1] - CENTRE_BITS)  # so that a moved scene is rounded to float32 as before
        centre = np.floor(centre / step + 0.5) * step
        extent = float(np.max(np.maximum(upper - centre, centre - lower)))
        _, exponent = math.frexp(extent)  # extent = m * 2^exponent with 1/2 <= m < 1
        return cls(centre, 2.0**-exponent)


def gather(
    shapes: Sequence[d.Shape], shutter: Shutter = (0.0, 0.0)
) -> tuple[list[MeshArrays], list[QuadricArrays], list[str]]:
    """World-space meshes and quadrics of all shapes, and warnings about what is wrong with them."""
    meshes: list[MeshArrays] = []
    quads: list[QuadricArrays] = []
    warnings: list[str] = []
    for shape in shapes:
        check_matrix(shape)
        with np.errstate(over="ignore", invalid="ignore"):  # what is out of range is refused, here or below
            if isinstance(shape, d.Sphere | d.Disk | d.Cylinder):
                quads.append(quadric(shape))
            elif shape.motion is None:
                meshes.append(world_mesh(shape, warnings))
            else:
                meshes.append(moving_mesh(shape, shutter, warnings))
    return meshes, quads, warnings + defects.coincident(meshes)


def check_matrix(shape: d.Shape) -> None:
    """Raise SceneError unless `to_world` is a finite, invertible affine (4, 4) matrix."""
    m = np.asarray(shape.to_world)
    if m.shape != (4, 4) or not np.all(np.isfinite(m)) or not np.array_equal(m[3], [0, 0, 0, 1]):
        raise SceneError(f"shape {shape.name!r}: to_world must be a finite affine (4, 4) matrix, got\n{m}")
    if np.abs(m).max() > defects.RANGE:
        raise SceneError(f"shape {shape.name!r}: to_world reaches {np.abs(m).max():.3g}, beyond {defects.RANGE:.2g}")
    if np.linalg.cond(m[:3, :3]) > 1e12:
        raise SceneError(f"shape {shape.name!r}: to_world squeezes the shape flat (its matrix is singular)")


def is_mirrored(matrix: Array) -> bool:
    """Is the determinant negative? Its sign is right where its size, the cube of a length, would over- or underflow."""
    return bool(np.linalg.slogdet(matrix[:3, :3])[0] < 0.0)


def quadric(shape: d.Sphere | d.Disk | d.Cylinder) -> QuadricArrays:
    """The affine map from the unit quadric to the shape."""
    if isinstance(shape, d.Disk):
        return QuadricArrays(shape, quadrics.DISK, shape.to_world, np.eye(4))
    if not 0.0 < shape.radius <= defects.RANGE:
        raise SceneError(f"shape {shape.name!r}: radius must be positive and finite, got {shape.radius}")
    local = np.eye(4)
    for name in ("center",) if isinstance(shape, d.Sphere) else ("p0", "p1"):
        if not np.abs(getattr(shape, name)).max() <= defects.RANGE:
            raise SceneError(f"shape {shape.name!r}: {name} must be finite, got {getattr(shape, name)}")
    if isinstance(shape, d.Sphere):
        local[:3, :3] *= shape.radius
        local[:3, 3] = shape.center
        return QuadricArrays(shape, quadrics.SPHERE, shape.to_world @ local, local)
    axis = np.asarray(shape.p1, float) - shape.p0
    height = np.linalg.norm(axis)
    if not (height > 0.0 and np.isfinite(height)):
        raise SceneError(
            f"shape {shape.name!r}: p0 and p1 must be two different finite points, got {shape.p0}, {shape.p1}"
        )
    _, _, basis = np.linalg.svd(axis[None, :])
    across = basis[1:] * shape.radius
    if np.dot(np.cross(basis[1], basis[2]), axis) < 0.0:
        across = across[::-1]
    local[:3, :3] = np.stack([across[0], across[1], axis], axis=1)
    local[:3, 3] = shape.p0
    return QuadricArrays(shape, quadrics.CYLINDER, shape.to_world @ local, local)


def quadric_box(q: QuadricArrays) -> tuple[Array, Array]:
    """The world-space bounding box (lower, upper)."""
    m, centre = q.to_world[:3, :3], q.to_world[:3, 3]
    if q.kind == quadrics.SPHERE:
        reach = np.linalg.norm(m, axis=1)
        return centre - reach, centre + reach
    reach, top = np.linalg.norm(m[:, :2], axis=1), centre + (m[:, 2] if q.kind == quadrics.CYLINDER else 0.0)
    return np.minimum(centre, top) - reach, np.maximum(centre, top) + reach


def box_of(thing: MeshArrays | QuadricArrays) -> tuple[Array, Array]:
    """The bounding box of a mesh over all its time steps, or of a quadric."""
    if isinstance(thing, QuadricArrays):
        return quadric_box(thing)
    vertices = thing.vertices if len(thing.vertices) else np.zeros((1, 3))
    return vertices.min(axis=0), vertices.max(axis=0)


def moving_boxes(q: QuadricArrays, shutter: Shutter) -> Array:
    """(QUADRIC_SEGMENTS + 1, 2, 3): boxes at time steps that, interpolated, contain the quadric at each time."""
    motion = q.shape.motion
    if motion is None:
        return np.array([quadric_box(q)] * (QUADRIC_SEGMENTS + 1))
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) @ q.local[:3, :3].T
    error = keyframes.chord_error(motion, shutter, corners + q.local[:3, 3], QUADRIC_SEGMENTS)
    poses = keyframes.samples(motion, shutter, QUADRIC_SEGMENTS)
    boxes = np.array([quadric_box(replace(q, to_world=m @ q.local)) for m in poses])
    return boxes + np.array([-error, error])[:, None]


def quadric_row(q: QuadricArrays, placement: Placement) -> Array:
    """The row of `raylab.quadrics.Quadric` in normalised coordinates."""
    to_local = np.linalg.inv(q.to_world[:3, :3]) / placement.scale
    side = -1.0 if q.shape.flip_normals else 1.0
    return np.concatenate([[q.kind], placement.points(q.to_world[:3, 3]), to_local.ravel(), [side]])


def world_mesh(shape: d.Shape, warnings: list[str]) -> MeshArrays:
    """A mesh, rectangle or cube in world coordinates."""
    vertices, faces, normals, uv, kind = local_mesh(shape)
    m = shape.to_world
    world = vertices @ m[:3, :3].T + m[:3, 3]
    if not np.all(np.isfinite(world)):
        bad = int(np.flatnonzero(~np.isfinite(world).all(axis=1))[0])
        raise SceneError(f"shape {shape.name!r}: vertex {bad} is not finite: {world[bad]}")
    if normals is not None:
        normals = directions(directions(normals) @ np.linalg.inv(m[:3, :3]))
    # A mirror turns the winding over but not the normals that the shape comes with; faces follow the normals.
    inside_out = is_mirrored(m) and not (isinstance(shape, d.Mesh) and normals is None)
    if shape.flip_normals != inside_out:
        faces = faces[:, ::-1]
    if shape.flip_normals and normals is not None:
        normals = -normals
    thickness, finest = proportions(world, faces)
    kept = defects.kept(shape.name, thickness, warnings)
    if not kept.all():
        faces, finest = faces[kept], finest[kept]
    return MeshArrays(shape, world, np.ascontiguousarray(faces, np.uint32), normals, uv, finest, kind)


def moving_mesh(shape: d.Shape, shutter: Shutter, warnings: list[str]) -> MeshArrays:
    """A mesh at as many time steps as its path needs, one after the other."""
    assert shape.motion is not None
    mesh, points = world_mesh(shape, warnings), local_mesh(shape)[0]
    segments, error = keyframes.segments_needed(shape.motion, shutter, points)
    steps = [
        world_mesh(replace(shape, to_world=m, motion=None), [])
        for m in keyframes.samples(shape.motion, shutter, segments)
    ]
    normals = None if mesh.normals is None else np.concatenate([s.normals for s in steps if s.normals is not None])
    uv = None if mesh.uv is None else np.tile(mesh.uv, (segments + 1, 1))
    vertices = np.concatenate([s.vertices for s in steps])
    return replace(mesh, vertices=vertices, normals=normals, uv=uv, segments=segments, error=error)


def local_mesh(shape: d.Shape) -> tuple[Array, npt.NDArray[Any], Array | None, Array | None, str]:
    """Vertices, faces, normals, uv and kind in local coordinates."""
    if isinstance(shape, d.Rectangle):
        return _SQUARE, _SQUARE_FACES, None, _SQUARE_UV, "rectangle"
    if isinstance(shape, d.Cube):
        return cube()
    if not isinstance(shape, d.Mesh):
        raise SceneError(f"shape {shape.name!r}: expected a shape of raylab.description, got {type(shape).__name__}")
    vertices, faces = np.asarray(shape.vertices, np.float64), np.asarray(shape.faces)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3:
        raise SceneError(
            f"shape {shape.name!r}: expected vertices (n, 3) and faces (m, 3), got {vertices.shape} and {faces.shape}"
        )
    if len(faces) and not (faces.min() >= 0 and faces.max() < len(vertices)):
        raise SceneError(
            f"shape {shape.name!r}: faces refer to vertices {faces.min()} to {faces.max()}, there are {len(vertices)}"
        )
    for name, data, columns in (("normals", shape.normals, 3), ("uv", shape.uv, 2)):
        if data is not None and (np.shape(data) != (len(vertices), columns) or not np.all(np.abs(data) <= LARGEST)):
            raise SceneError(
                f"shape {shape.name!r}: {name} must be finite in float32 and ({len(vertices)}, {columns}), "
                f"got {np.shape(data)}"
            )
    return vertices, faces, shape.normals, shape.uv, "mesh"


# The cube's faces as Mitsuba lays (u, v) over them: axis and side of the face, then the axes of u and v, negative
# where the coordinate falls; axes are counted from 1.
_CUBE = ((1, 2, -3), (-1, 2, 3), (2, -1, -3), (-2, 3, 1), (3, 2, 1), (-3, -2, 1))


def cube() -> tuple[Array, npt.NDArray[Any], None, Array, str]:
    """Six squares around the cube [-1, 1]^3, normals outwards, each with the whole (u, v) square."""

    def axis(signed: int) -> Array:
        return np.sign(signed) * np.eye(3)[abs(signed) - 1]

    corners, faces = [], []
    for k, (side, u, v) in enumerate(_CUBE):
        corners.append(axis(side) + _SQUARE[:, :1] * axis(u) + _SQUARE[:, 1:2] * axis(v))
        outwards = np.cross(axis(u), axis(v)) @ axis(side) > 0.0
        faces.append((_SQUARE_FACES if outwards else _SQUARE_FACES[:, ::-1]) + 4 * k)
    return np.concatenate(corners), np.concatenate(faces), None, np.tile(_SQUARE_UV, (6, 1)), "cube"
