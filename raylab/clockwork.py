"""From moving shapes to `scene.motion`, and to the table of quadrics that move."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import keyframes, lights, motion
from raylab.emitters import is_reversed
from raylab.geometry import MeshArrays, Placement, QuadricArrays
from raylab.keyframes import Shutter
from raylab.motion import I0, I2, KIND, LIGHT_COLUMNS, ON_QUADRIC, QUADRIC, STEP_COLUMNS
from raylab.quadrics import ALL_ROWS, FIRST_PIECE, MOVING_COLUMNS, PIECES
from raylab.surface import FIRST_FACE, FIRST_VERTEX, LIGHT, SceneData
from raylab.view import View

Array = npt.NDArray[np.float64]


def moving_rows(quads: Sequence[QuadricArrays], rows: Array, shutter: Shutter, placement: Placement) -> Array:
    """(n, MOVING_COLUMNS): the rows of the quadrics, then the pieces of those that move."""
    table = np.zeros((len(rows), MOVING_COLUMNS))
    table[:, : rows.shape[1]] = rows
    parts, total = [table], len(rows)
    for i, q in enumerate(quads):
        if q.shape.motion is not None:
            pieces = keyframes.table(q.shape.motion, shutter, q.local, placement.centre, placement.scale)
            table[i, FIRST_PIECE], table[i, PIECES] = total, len(pieces)
            total += len(pieces)
            parts.append(pieces)
    table[:, ALL_ROWS] = total
    return np.concatenate(parts)


def set_in_motion(data: SceneData, meshes: Sequence[MeshArrays], quads: Sequence[QuadricArrays], clock: View) -> Any:
    """`scene.motion` for shapes of which some move."""
    steps = np.zeros((len(meshes) + len(quads) + 1, STEP_COLUMNS), np.int64)
    for i, m in enumerate(meshes):
        steps[i] = m.segments, len(m.vertices) // (m.segments + 1)
    moving = motion.Moving(clock, View(steps), data.vertices, data.faces, motion.StillLights())
    shapes: list[MeshArrays | QuadricArrays] = [*meshes, *quads]
    table = [
        _light_row(data, i, shape)
        for i, shape in enumerate(shapes)
        if shape.shape.motion is not None and shape.shape.radiance is not None
    ]
    if not table:
        return moving
    mesh = data.lights.store.mesh
    if not isinstance(mesh, lights.MeshShape):
        mesh = lights.MeshShape(View(np.zeros((3, 3))), View(np.zeros(1)))
    rows = data.quadrics.table.rows if quads else View(np.zeros((1, MOVING_COLUMNS)))
    return moving._replace(
        lights=motion.MovingLights(View(np.array(table)), data.lights.rows, mesh.corners, mesh.shares, rows)
    )


def _light_row(data: SceneData, i: int, shape: MeshArrays | QuadricArrays) -> npt.NDArray[np.int64]:
    """The row of `MovingLights.table` for the light on shape i; quadrics follow the meshes."""
    row = np.zeros(LIGHT_COLUMNS, np.int64)
    light = data.shapes[i, LIGHT]
    row[:5] = light, data.lights.rows[light, 0], i, data.shapes[i, FIRST_VERTEX], data.shapes[i, FIRST_FACE]
    if isinstance(shape, QuadricArrays):
        row[KIND], row[QUADRIC] = ON_QUADRIC, i - data.quadrics.geometry
    elif row[KIND] == lights.RECTANGLE:
        row[I0 : I2 + 1] = (0, 3, 1) if is_reversed(shape.faces) else (0, 1, 3)
    elif row[KIND] == lights.TRIANGLE:
        row[I0 : I2 + 1] = shape.faces[0]
    return row
