"""Shapes with their materials and what they emit, in local coordinates as Mitsuba 3 defines them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from raylab.description import Array, Cube, Cylinder, Diffuse, Disk, Mesh, Rectangle, Shape, Sphere
from raylab.errors import UserError
from raylab.io.xml_bsdfs import BSDFS
from raylab.io.xml_context import Context
from raylab.io.xml_emitters import EMITTERS, SHAPE_EMITTERS
from raylab.io.xml_node import Node
from raylab.io.xml_transform import similarity_error

ROUND = 1e-6  # how far a transform may be from keeping a sphere round; Mitsuba 3 warns beyond it


def _common(node: Node, context: Context) -> dict[str, Any]:
    """The arguments that all shapes have: name, materials, radiance, transform."""
    node.number("silhouette_sampling_weight", 1.0)  # only Mitsuba's derivatives use it
    bsdf, emitter = node.child("bsdf"), node.child("emitter")
    if emitter is not None and emitter.type in EMITTERS:
        raise emitter.error("only an area light can be inside a shape; move this emitter out of it")
    if bsdf is not None:
        front, back = context.read(bsdf, BSDFS)
    else:
        front, back = (None if emitter else Diffuse()), None
    to_world, motion = node.placing("to_world")
    return {
        "name": node.id,
        "front": front,
        "back": back,
        "radiance": None if emitter is None else context.read(emitter, SHAPE_EMITTERS),
        "to_world": to_world,
        "motion": motion,
        "flip_normals": node.boolean("flip_normals", False),
    }


def poses(common: dict[str, Any]) -> Array:
    """(n, 4, 4): the matrices of all keyframes, or to_world alone."""
    return common["to_world"][None] if common["motion"] is None else np.asarray(common["motion"].matrices)


def _rectangle(node: Node, context: Context) -> Rectangle:
    node.boolean("face_normals", False)  # it is flat either way
    return Rectangle(**_common(node, context))


def _cube(node: Node, context: Context) -> Cube:
    node.boolean("face_normals", False)
    return Cube(**_common(node, context))


def _disk(node: Node, context: Context) -> Disk:
    return Disk(**_common(node, context))


def _sphere(node: Node, context: Context) -> Sphere:
    """A mirroring transform turns the normals of a sphere inside out, as in Mitsuba 3."""
    common = _common(node, context)
    if any(similarity_error(matrix) > ROUND for matrix in poses(common)):
        raise node.error("to_world must scale a sphere equally along all axes, without shear", "to_world")
    if np.linalg.slogdet(common["to_world"][:3, :3]).sign < 0:
        common["flip_normals"] = not common["flip_normals"]
    return Sphere(center=node.point("center", np.zeros(3)), radius=node.number("radius", 1.0, above=0), **common)


def _cylinder(node: Node, context: Context) -> Cylinder:
    common = _common(node, context)
    p0, p1 = node.point("p0", np.zeros(3)), node.point("p1", np.array([0.0, 0.0, 1.0]))
    if np.array_equal(p0, p1):
        raise node.error("p0 and p1 of a cylinder must not be the same point", "p1")
    if any(_section_error(matrix, p1 - p0) > ROUND for matrix in poses(common)):
        raise node.error("to_world must keep a cylinder round and upright", "to_world")
    return Cylinder(p0=p0, p1=p1, radius=node.number("radius", 1.0, above=0), **common)


def _section_error(to_world: Array, axis: Array) -> float:
    """`similarity_error` across the `axis` of a cylinder."""
    frame = np.eye(4)
    frame[:3, :3] = np.linalg.svd(axis[None] / np.abs(axis).max())[2][[1, 2, 0]].T
    return similarity_error(to_world @ frame, axes=2)


def _mesh(node: Node, context: Context, flip_tex_coords: bool) -> Mesh:
    """With smooth normals unless `face_normals`: of the file, else computed in world space as Mitsuba 3."""
    from raylab.io.mesh_file import read_mesh
    from raylab.triangles import directions, vertex_normals

    common = _common(node, context)
    path = context.file(node)
    try:
        vertices, faces, normals, uv = read_mesh(path)
    except UserError as error:
        raise node.error(str(error), "filename") from None
    if node.boolean("flip_tex_coords", flip_tex_coords) and uv is not None:
        uv = np.column_stack([uv[:, 0], 1.0 - uv[:, 1]])
    if node.boolean("face_normals", False):
        normals = None
    elif normals is None:
        linear = common["to_world"][:3, :3] / np.abs(common["to_world"][:3, :3]).max()
        normals = directions(vertex_normals(vertices @ linear.T, faces) @ linear)  # back to local: n = A^T n_world
    return Mesh(vertices=vertices, faces=faces, normals=normals, uv=uv, **common)


def _obj(node: Node, context: Context) -> Mesh:
    return _mesh(node, context, flip_tex_coords=True)


def _ply(node: Node, context: Context) -> Mesh:
    return _mesh(node, context, flip_tex_coords=False)


SHAPES: dict[str, Callable[[Node, Context], Shape]] = {
    "rectangle": _rectangle,
    "cube": _cube,
    "disk": _disk,
    "sphere": _sphere,
    "cylinder": _cylinder,
    "obj": _obj,
    "ply": _ply,
}
