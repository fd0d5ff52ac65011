"""Scene: a description, checked once and turned into what kernels need.

Kernels work in normalised coordinates: the centre of all content at the origin, and scaled by a power of two so that
everything lies within [-1, 1]. Then the rounding of Embree's float32 does not depend on where a scene stands and in
what unit it was drawn; scaling by a power of two changes no bit of the picture. What Embree does not need, the planes
of triangles and the corners of lights, is not rounded to float32. Radiance has no length in it; the
intensity of a point light, W/sr, is scaled with the square. Lights are sorted by place (`raylab.order`), so that it
does not matter in which order they are described.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import defects, keyframes, quadrics
from raylab import description as d
from raylab.clockwork import moving_rows, set_in_motion
from raylab.embree import EmbreeScene
from raylab.emitters import AreaLights, colour, point_table, sun_table
from raylab.errors import SceneError
from raylab.geometry import MeshArrays, Placement, QuadricArrays, box_of, gather, moving_boxes, quadric_box, quadric_row
from raylab.light_choice import make_choice
from raylab.motion import Static
from raylab.order import order
from raylab.palette import Palette
from raylab.point import plane_table
from raylab.record import Table
from raylab.sensor import has_lens, make_camera
from raylab.sky import make_environment
from raylab.surface import (
    SHAPE_COLUMNS,
    TALLIES,
    Coordinates,
    Emission,
    FlatNormals,
    NoCoordinates,
    NoEmission,
    NoQuadrics,
    Quadrics,
    SceneData,
    SmoothNormals,
)
from raylab.triangles import CHUNK
from raylab.view import View


class Scene:
    """A scene ready to be rendered.

    Attributes: `description`, `data` (what kernels read, normalised), `camera`, `placement`, `warnings`, `features`
    (the names of the optional parts that this scene has; kernels are compiled without the others).
    """

    def __init__(self, description: d.SceneDescription) -> None:
        self.description = description
        still = keyframes.at_rest(description)
        self.shutter = (still.camera.shutter_open, still.camera.shutter_close)
        meshes, quads, left_out = gather(still.shapes, self.shutter)
        boxes = [(m.vertices.min(axis=0), m.vertices.max(axis=0)) for m in meshes if len(m.faces)]
        round_boxes = []
        for q in quads:
            around = np.array([quadric_box(q)]) if q.shape.motion is None else moving_boxes(q, self.shutter)
            round_boxes.append((around[:, 0].min(axis=0), around[:, 1].max(axis=0)))
        defects.check_range(boxes + round_boxes)
        self.placement = Placement.around(boxes + round_boxes)
        others = [(q.shape.name, *box) for q, box in zip(quads, round_boxes, strict=True)]
        fine = defects.of_size(self.placement.centre, self.placement.scale, meshes, others)
        self.warnings = [*description.warnings, *left_out, *fine]
        self.motion_error = max((m.error for m in meshes), default=0.0)
        self.triangles = sum(len(m.faces) for m in meshes)
        builder = _Builder(self.placement, meshes, quads, self.shutter)
        self.embree = builder.embree
        self.data = builder.data(still)
        self.camera: Any = make_camera(still.camera, self.placement, self.data.motion)
        self.features = features(self, builder)

    def __repr__(self) -> str:
        return f"<Scene {self.description.name!r}: {len(self.description.shapes)} shapes, {self.triangles} triangles>"


class _Builder:
    """Fills the arrays of a SceneData and the Embree scene."""

    def __init__(
        self, placement: Placement, meshes: list[MeshArrays], quads: list[QuadricArrays], shutter: keyframes.Shutter
    ) -> None:
        self.placement, self.meshes, self.quads, self.shutter = placement, meshes, quads, shutter
        self.clock = View(np.zeros(1))
        self.palette, self.area_lights, self.embree = Palette(), AreaLights(), EmbreeScene()
        self.vertices = self._vertices()
        self.faces = np.concatenate([m.faces for m in meshes]) if meshes else np.zeros((1, 3), np.uint32)
        self.rows = np.stack([quadric_row(q, placement) for q in quads]) if quads else np.zeros((0, 14))
        self.shapes = self._shapes()
        if self._quads_move():
            self.rows = moving_rows(quads, self.rows, shutter, placement)
        self._build_embree()

    def _vertices(self) -> npt.NDArray[np.float32]:
        """All normalised vertices, and one more row: Embree reads 16 bytes at each vertex of 12."""
        total = sum(len(m.vertices) for m in self.meshes)
        vertices, start = np.zeros((total + 1, 3), np.float32), 0
        for m in self.meshes:
            with np.errstate(over="ignore"):  # where no triangle was kept, vertices may be anywhere
                vertices[start : start + len(m.vertices)] = self.placement.points(m.vertices)
            start += len(m.vertices)
        return vertices

    def _planes(self) -> npt.NDArray[np.float64]:
        """The plane table of all faces, in float64, some at a time to bound the memory."""
        planes, first = np.zeros((len(self.faces), 8)), 0
        for m in self.meshes:
            own = self.placement.points(m.vertices)
            for start in range(0, len(m.faces), CHUNK):
                some = m.faces[start : start + CHUNK]
                planes[first + start : first + start + len(some)] = plane_table(own[some])
            first += len(m.faces)
        return planes

    def _lights(self) -> dict[int, int]:
        """The light of each shape that has one; they are numbered in the order of their places."""
        things: list[MeshArrays | QuadricArrays] = [*self.meshes, *self.quads]
        lit = [i for i, thing in enumerate(things) if thing.shape.radiance is not None]
        corners = [self.placement.points(box_of(things[i])) for i in lit]
        places = [np.concatenate([lower + upper, lower]) for lower, upper in corners]
        return {lit[k]: self._add_light(lit[k]) for k in order(places, [things[i].shape for i in lit])}

    def _add_light(self, i: int) -> int:
        if i < len(self.meshes):
            m = self.meshes[i]
            return self.area_lights.add_mesh(m.shape, m.kind, self.placement.points(m.vertices), m.faces)
        i -= len(self.meshes)
        return self.area_lights.add_quadric(self.quads[i].shape, self.rows[i])

    def _shapes(self) -> npt.NDArray[np.int64]:
        lights = self._lights()
        table, first_face, first_vertex = [], 0, 0
        for i, m in enumerate(self.meshes):
            smooth, has_uv = int(m.normals is not None), int(m.uv is not None)
            table.append([first_face, first_vertex, *self._sides(m.shape), lights.get(i, -1), smooth, has_uv])
            first_face, first_vertex = first_face + len(m.faces), first_vertex + len(m.vertices)
        for i, q in enumerate(self.quads, len(self.meshes)):
            table.append([0, 0, *self._sides(q.shape), lights.get(i, -1), 0, 1])
        return np.array(table, np.int64).reshape(-1, SHAPE_COLUMNS)

    def _sides(self, shape: d.Shape) -> tuple[int, int]:
        return self.palette.number(shape.front), self.palette.number(shape.back)

    def _build_embree(self) -> None:
        first_face, first_vertex = 0, 0
        for m in self.meshes:
            own = self.vertices[first_vertex : first_vertex + len(m.vertices)]
            self.embree.add_mesh(own, self.faces[first_face : first_face + len(m.faces)], m.segments)
            first_face, first_vertex = first_face + len(m.faces), first_vertex + len(m.vertices)
        if self.quads:
            boxes = np.array([[quadric_box(q)] for q in self.quads])
            if self._quads_move():
                boxes = np.array([moving_boxes(q, self.shutter) for q in self.quads])
            corners = self.placement.points(boxes).swapaxes(0, 1)  # (steps, n, 2, 3)
            self.embree.add_quadrics(self.rows, corners.reshape(*corners.shape[:2], 6))
        self.embree.commit()

    def _quads_move(self) -> bool:
        return any(q.shape.motion is not None for q in self.quads)

    def data(self, description: d.SceneDescription) -> SceneData:
        """What kernels read; with a clock, if anything moves while the shutter is open."""
        data = self._still_data(description)
        moving = any(m.segments for m in self.meshes) or self._quads_move() or description.camera.motion is not None
        return data._replace(motion=set_in_motion(data, self.meshes, self.quads, self.clock)) if moving else data

    def _quadrics(self) -> Any:
        if not self.quads:
            return NoQuadrics()
        if self._quads_move():
            return Quadrics(Table(quadrics.MovingQuadric, self.rows, self.clock), len(self.meshes))
        return Quadrics(Table(quadrics.Quadric, self.rows), len(self.meshes))

    def _still_data(self, description: d.SceneDescription) -> SceneData:
        return SceneData(
            embree=np.uint64(self.embree.handle),
            shapes=View(self.shapes if len(self.shapes) else np.zeros((1, SHAPE_COLUMNS), np.int64)),
            vertices=View(self.vertices),
            faces=View(self.faces),
            planes=View(self._planes()),
            quadrics=self._quadrics(),
            normals=self._normals(),
            coordinates=self._coordinates(),
            materials=self.palette.materials(),
            emission=self._emission(),
            lights=self.area_lights.table(),
            points=point_table(description.lights, self.placement),
            suns=sun_table(description.lights),
            environment=make_environment(description.environment),
            max_depth=depth(description.max_depth),
            choice=make_choice(self.area_lights.power()),
            motion=Static(),
            tally=View(np.zeros(TALLIES, np.int64)),
        )

    def _normals(self) -> Any:
        if all(m.normals is None for m in self.meshes):
            return FlatNormals()
        parts = [np.zeros((len(m.vertices), 3)) if m.normals is None else m.normals for m in self.meshes]
        return SmoothNormals(View(np.concatenate(parts).astype(np.float32)))

    def _coordinates(self) -> Any:
        if not self.palette.textured:
            return NoCoordinates()
        parts = [np.zeros((len(m.vertices), 2)) if m.uv is None else m.uv for m in self.meshes]
        return Coordinates(View(np.concatenate([*parts, np.zeros((1, 2))]).astype(np.float32)))

    def _emission(self) -> Any:
        shapes = [m.shape for m in self.meshes] + [q.shape for q in self.quads]
        if all(shape.radiance is None for shape in shapes):
            return NoEmission()
        black = np.zeros(3)
        return Emission(View(np.stack([black if s.radiance is None else colour(s.radiance, s.name) for s in shapes])))


def depth(rays: int) -> int:
    """`max_depth`, checked."""
    if not (isinstance(rays, int) and 1 <= rays <= d.DEEPEST):
        raise SceneError(f"max_depth must be a whole number from 1 to {d.DEEPEST}, got {rays}")
    return rays


FEATURES = (
    "area lights", "point lights", "directional lights", "environment", "glossy BRDF", "mirrors and glass",
    "textures", "smooth normals", "spheres, disks and cylinders", "lens", "motion",
)  # fmt: skip


def features(scene: Scene, builder: _Builder) -> frozenset[str]:
    """Which of FEATURES the kernel of this scene contains."""
    data = scene.data
    present = {
        "area lights": len(data.lights) > 0,
        "point lights": len(data.points) > 0,
        "directional lights": len(data.suns) > 0,
        "environment": data.environment.present(),
        "glossy BRDF": data.materials.glossy(),
        "mirrors and glass": data.materials.smooth(),
        "textures": builder.palette.textured,
        "smooth normals": data.normals.present(),
        "spheres, disks and cylinders": bool(builder.quads),
        "lens": has_lens(scene.description.camera),
        "motion": not isinstance(data.motion, Static),
    }
    return frozenset(name for name, there in present.items() if there)
