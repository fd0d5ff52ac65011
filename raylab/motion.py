"""Slide "Motion blur": time as a variable throughout the system.

`scene.motion` is `Static`, whose time is the constant 0 and of which nothing is compiled, or `Moving`: each thread has
a clock, set to the time of an eye ray before its sample is traced and shaded. Everything that depends on time reads
the clock, so that shade() stays what the slides say. Time runs from 0, the shutter opens, to 1, it closes, in float32,
so that Embree and the float64 code mean the same instant.

Meshes move in straight parts of equal duration, 2^k of them, so that float32 loses nothing in finding the part.
Spheres, disks and cylinders move exactly (`raylab.pose`).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from raylab.jit import njit
from raylab.lanes import TIME
from raylab.lights import MESH, RECTANGLE
from raylab.point import ULPS, triangle_frame
from raylab.pose import pose_at
from raylab.quadrics import CYLINDER, DISK, FIRST_PIECE, PIECES, SPHERE
from raylab.record import Table, record
from raylab.sampling import PI
from raylab.vec3 import cross, length, vec3_at
from raylab.view import View

# Columns of Moving.steps, a row for each shape; and of MovingLights.table, a row for each light that moves.
SEGMENTS, STEP, STEP_COLUMNS = range(3)
LIGHT, KIND, SHAPE, FIRST_VERTEX, FIRST_FACE, QUADRIC, I0, I1, I2, LIGHT_COLUMNS = range(10)
ON_QUADRIC = -1  # KIND of the light of a sphere, disk or cylinder
# Columns of a light's row in `raylab.lights`.
_P, _E1, _E2, _N, _AREA, _SLACK, _TILT, _FIRST, _TRIANGLES = 4, 7, 10, 13, 16, 17, 18, 21, 22


@record
class Static(NamedTuple):
    """Nothing moves: no time is drawn."""

    tag: int = 0

    def time(self):
        return 0.0

    def draw(self, rng):
        return 0.0

    def draw_lanes(self, lanes):
        pass

    def set(self, time):
        pass

    def moves(self, shape):
        return False

    def vertex(self, vertices, shape, i):
        return vec3_at(vertices, i)


@record
class Moving(NamedTuple):
    """The thread's clock, and how the shapes move."""

    clock: View  # (1,) float64 in [0, 1]
    steps: View  # (shapes, STEP_COLUMNS) int64: straight parts (0: stands still), and vertices of a time step
    vertices: View  # those of the scene, float32
    faces: View
    lights: Any  # MovingLights or StillLights

    def time(self):
        return self.clock[0]

    def draw(self, rng):
        """Slide: "generate rays with times distributed over shutter interval"."""
        return np.float64(np.float32(rng.number()))

    def draw_lanes(self, lanes):
        """The same for each lane of a packet."""
        lanes.number(TIME)

    def set(self, time):
        """Bring the lights to where they stand at a time."""
        self.clock[0] = time
        self.lights.set(self, time)

    def moves(self, shape):
        return self.steps[shape, SEGMENTS] > 0

    def vertex(self, vertices, shape, i):
        """Vertex i (or its normal), counted in the first time step, at the time of the clock; exact in float64."""
        segments = self.steps[shape, SEGMENTS]
        if segments == 0:
            return vec3_at(vertices, i)
        scaled = self.clock[0] * segments
        part = min(int(scaled), segments - 1)
        before = i + part * self.steps[shape, STEP]
        v0, v1 = vec3_at(vertices, before), vec3_at(vertices, before + self.steps[shape, STEP])
        return v0 + (v1 - v0) * (scaled - part)


@njit
def moving_frame(v0, v1, v2):
    """`triangle_frame` with the rounding of Embree's own interpolation: 3 units of 2^-24 for coordinates up to 1."""
    n, slack, tilt = triangle_frame(v0, v1, v2)
    return n, slack + (abs(n.x) + abs(n.y) + abs(n.z)) * ULPS, tilt


# --- lights that move: their rows are brought up to date for each sample ---


@record
class StillLights(NamedTuple):
    tag: int = 0

    def set(self, motion, time):
        pass


@record
class MovingLights(NamedTuple):
    """The lights that move, and what of them changes: rows, corners and shares of `raylab.lights`."""

    table: View  # (n, LIGHT_COLUMNS) int64
    rows: View  # the thread's own, as are the next two
    corners: View
    shares: View
    quadrics: View  # rows of moving quadrics, and their pieces

    def set(self, motion, time):
        for k in range(len(self.table)):
            if self.table[k, KIND] == ON_QUADRIC:
                place_quadric(self, k, time)
            elif self.table[k, KIND] == MESH:
                place_mesh(self, k, motion)
            else:
                place_flat(self, k, motion)


@njit
def put(rows, i, j, v):
    """Write a vector into columns j, j + 1, j + 2 of row i."""
    rows[i, j], rows[i, j + 1], rows[i, j + 2] = v.x, v.y, v.z


@njit
def place_quadric(lights, k, time):
    """A sphere: centre, radius. A disk: centre, half axes, normal. A cylinder: foot, half axes, axis."""
    light, i, rows, quadrics = lights.table[k, LIGHT], lights.table[k, QUADRIC], lights.rows, lights.quadrics
    pose = pose_at(quadrics, int(quadrics[i, FIRST_PIECE]), int(quadrics[i, PIECES]), time)
    kind, side, radius = int(quadrics[i, 0]), quadrics[i, 13], length(pose.x)
    put(rows, light, _P, pose.p)
    if kind == SPHERE:
        rows[light, _E1] = radius
        rows[light, _AREA] = 4.0 * PI * radius * radius
        return
    put(rows, light, _E1, pose.x)
    put(rows, light, _E2, pose.y)
    if kind == DISK:
        normal = pose.inverse_rows()[2]
        put(rows, light, _N, normal * (side / length(normal)))
        rows[light, _AREA] = PI * length(cross(pose.x, pose.y))
    if kind == CYLINDER:
        put(rows, light, _N, pose.z)
        rows[light, _AREA] = 2.0 * PI * radius * length(pose.z)


@njit
def place_flat(lights, k, motion):
    """A triangle or rectangle: corner, edges, normal, area and offset terms."""
    table, rows = lights.table, lights.rows
    light, shape, first = table[k, LIGHT], table[k, SHAPE], table[k, FIRST_VERTEX]
    v0 = motion.vertex(motion.vertices, shape, first + table[k, I0])
    v1 = motion.vertex(motion.vertices, shape, first + table[k, I1])
    v2 = motion.vertex(motion.vertices, shape, first + table[k, I2])
    n, slack, tilt = moving_frame(v0, v1, v2)
    put(rows, light, _P, v0)
    put(rows, light, _E1, v1 - v0)
    put(rows, light, _E2, v2 - v0)
    put(rows, light, _N, n)
    put(rows, light, _TILT, tilt)
    share = 1.0 if table[k, KIND] == RECTANGLE else 0.5
    rows[light, _AREA], rows[light, _SLACK] = share * length(cross(v1 - v0, v2 - v0)), slack


@njit
def place_mesh(lights, k, motion):
    """All triangles of a mesh light: corners, shares and area."""
    table, rows = lights.table, lights.rows
    light, shape, first = table[k, LIGHT], table[k, SHAPE], table[k, FIRST_VERTEX]
    start, count, area = int(rows[light, _FIRST]), int(rows[light, _TRIANGLES]), 0.0
    for i in range(count):
        face = table[k, FIRST_FACE] + i
        v0 = motion.vertex(motion.vertices, shape, first + motion.faces[face, 0])
        v1 = motion.vertex(motion.vertices, shape, first + motion.faces[face, 1])
        v2 = motion.vertex(motion.vertices, shape, first + motion.faces[face, 2])
        put(lights.corners, 3 * (start + i), 0, v0)
        put(lights.corners, 3 * (start + i) + 1, 0, v1)
        put(lights.corners, 3 * (start + i) + 2, 0, v2)
        area += 0.5 * length(cross(v1 - v0, v2 - v0))
        lights.shares[start + i] = area
    for i in range(count - 1):
        lights.shares[start + i] = lights.shares[start + i] / area
    lights.shares[start + count - 1] = 1.0
    rows[light, _AREA] = area


# --- each thread has its own clock ---


def own_copy(data: Any) -> Any:
    """The scene with a clock, and lights that move, of its own; what is static is shared."""
    if isinstance(data.motion, Static):
        return data
    motion = data.motion._replace(clock=View(np.zeros(1)))
    if isinstance(motion.lights, MovingLights):
        lights, store = data.lights, data.lights.store
        rows, corners, shares = (
            View(v.array.copy()) for v in (lights.rows, motion.lights.corners, motion.lights.shares)
        )
        if hasattr(store.mesh, "corners"):
            store = store._replace(mesh=store.mesh._replace(corners=corners, shares=shares))
        table = Table(lights.cls, rows.array, store)
        moving = motion.lights._replace(rows=table.rows, corners=corners, shares=shares)
        motion, data = motion._replace(lights=moving), data._replace(lights=table)
    if hasattr(data.quadrics, "table") and isinstance(data.quadrics.table.store, View):
        quadrics = data.quadrics
        table = Table(quadrics.table.cls, quadrics.table.rows.array, motion.clock)
        data = data._replace(quadrics=quadrics._replace(table=table))
    return data._replace(motion=motion)
