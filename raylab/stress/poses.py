"""Poses over time: frozen and reversed shutters, times beyond the keyframes, small turns, mirrors and stretches."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.geometry import gather
from raylab.keyframes import Piece, matrix_at, rotation_about
from raylab.lens import shutter_time
from raylab.scene import Scene
from raylab.stress.cameras import unit
from raylab.stress.case import U53, Found, case
from raylab.stress.leaving import placed
from raylab.stress.meshes import refused
from raylab.stress.odd_rays import ball
from raylab.stress.oracle import exact
from raylab.stress.small_pictures import little_scene, picture

Array = npt.NDArray[Any]


def sliding(opened: float, closed: float) -> Scene:
    """The little scene with a cube that slides and turns from time 0 to 1."""
    still = little_scene(1.0, 0.0).description
    floor, cube, light = still.shapes
    end = placed(0.5, [-1.0, 0.5, 0.5], 0.7)
    moving = replace(cube, motion=d.Animation(np.array([0.0, 1.0]), np.array([cube.to_world, end])))
    eye = replace(still.camera, shutter_open=opened, shutter_close=closed)
    return Scene(replace(still, camera=eye, shapes=(floor, moving, light)))


def standing(time: float) -> Scene:
    """The same with the cube where it stands at a time, and no motion."""
    described = sliding(0.0, 0.0).description
    floor, cube, light = described.shapes
    assert cube.motion is not None
    still = replace(cube, to_world=matrix_at(cube.motion, time), motion=None)
    return Scene(replace(described, shapes=(floor, still, light)))


@case(
    "E06", "shutter that opens and closes at 0.1", usual="(1 - u) t0 + u t1",
    rule="t0 + u (t1 - t0), and nothing moves", truth="the still picture, and 0.1 for every u",
    unit="values that differ", limit=60.0,
)  # fmt: skip
def frozen_shutter() -> Found:
    numbers = [k / 1000 for k in range(1000)]
    ours = sum(shutter_time(0.1, 0.1, u) != 0.1 for u in numbers)
    ours += int((picture(sliding(0.1, 0.1)) != picture(standing(0.1))).sum())
    return Found(ours, float(sum((1.0 - u) * 0.1 + u * 0.1 != 0.1 for u in numbers)))


@case(
    "E07", "shutter from 1 to 0, from NaN, to infinity", usual="anything goes", rule="refused, with what is expected",
    truth="SceneError", unit="refusals missing",
)  # fmt: skip
def reversed_shutter() -> Found:
    times = ((1.0, 0.0), (math.nan, 1.0), (0.0, math.nan), (0.0, math.inf))
    return Found(sum(not refused(partial(sliding, *pair), "finite shutter_open <= shutter_close") for pair in times))


@case(
    "E08", "times before the first and after the last keyframe", usual="a + t (b - a)", rule="the end's own pose",
    truth="the first or last keyframe, bit for bit", unit="poses and pictures that differ", limit=60.0,
)  # fmt: skip
def beyond_the_keyframes() -> Found:
    motion = sliding(0.0, 0.0).description.shapes[1].motion
    assert motion is not None
    first, last = motion.matrices
    ours = theirs = 0
    for time, end in ((-0.5, first), (0.0, first), (1.0, last), (2.0, last), (10.0, last)):
        ours += not np.array_equal(matrix_at(motion, time), end)
        theirs += not np.array_equal(first + time * (last - first), end)
    for opened, closed, time in ((2.0, 3.0, 1.0), (-3.0, -0.5, 0.0)):
        ours += not np.array_equal(picture(sliding(opened, closed)), picture(standing(time)))
    return Found(ours, theirs)


def turned(base: Array, axis: Array, angle: float) -> tuple[Array, Array]:
    """Two keyframes, an angle apart."""
    first, last = np.eye(4), np.eye(4)
    first[:3, :3], last[:3, :3] = base, base @ rotation_about(axis, angle)
    return first, last


@case(
    "E09", "keyframes 1e-8 apart, the same, and half a turn apart", usual="acos((trace - 1) / 2)",
    rule="the antisymmetric part decides where the angle is small", truth="mpmath, of the matrices as they are rounded",
    unit="relative error of the angle", allowed=1e-8,
)  # fmt: skip
def small_turns() -> Found:
    m = exact()
    rng = np.random.default_rng(4)
    ours = theirs = 0.0
    for k in range(40):
        base = np.eye(3) if k < 10 else rotation_about(unit(rng.normal(size=3)), rng.uniform(0, 3))
        first, last = turned(base, unit(rng.normal(size=3)), 1e-8)
        a, b = (m.matrix(x[:3, :3].tolist()) for x in (first, last))
        r = a.T * b
        truth = m.asin(m.sqrt((r[2, 1] - r[1, 2]) ** 2 + (r[0, 2] - r[2, 0]) ** 2 + (r[1, 0] - r[0, 1]) ** 2) / 2)
        ours = max(ours, abs(float(Piece.between(0.0, 1.0, first, last).angle / truth - 1)))
        usual = math.acos(min(1.0, max(-1.0, (float(np.trace(first[:3, :3].T @ last[:3, :3])) - 1.0) / 2.0)))
        theirs = max(theirs, abs(float(usual / truth - 1)))
        half = Piece.between(0.0, 1.0, *turned(base, unit(rng.normal(size=3)), math.pi)).angle
        same = Piece.between(0.0, 1.0, first, first).angle
        ours = max(ours, abs(half / math.pi - 1.0), same)
    return Found(ours, theirs)


@case(
    "E11", "scale 0; mirrored and unequal scales", usual="n -> M n, faces as they are",
    rule="n -> M^-T n, normalised; faces turned over where the determinant is negative; 0 refused",
    truth="n.n = 1, along M^-T n, faces and normals on one side",
    unit="normals and faces that are wrong + refusals missing",
)  # fmt: skip
def mirrors_and_stretches() -> Found:
    vertices, faces = ball(2)
    unit_normals = vertices / np.linalg.norm(vertices, axis=1, keepdims=True)
    ours = theirs = 0
    for scales in ((-2.0, 0.5, 3.0), (1e-3, 1.0, 1e3), (-1.0, -1.0, -1.0), (1.0, 2.0, -4.0)):
        m = placed(angle=0.7) @ np.diag([*scales, 1.0])
        true = unit_normals @ np.linalg.inv(m[:3, :3])
        true /= np.linalg.norm(true, axis=1, keepdims=True)
        (made,), _, _ = gather((d.Mesh(vertices=vertices, faces=faces, normals=unit_normals, to_world=m),))
        assert made.normals is not None
        ours += wrong(made.vertices, made.faces, made.normals, true)
        usual = unit_normals @ m[:3, :3].T
        theirs += wrong(made.vertices, faces, usual / np.linalg.norm(usual, axis=1, keepdims=True), true)
    flat: Callable[[], object] = partial(gather, (d.Cube(to_world=np.diag([1.0, 0.0, 1.0, 1.0])),))
    return Found(ours + (not refused(flat, "singular")), theirs)


def wrong(vertices: Array, faces: Array, normals: Array, true: Array) -> int:
    """How many normals are not unit or point elsewhere, and how many faces have their normals behind them."""
    v = vertices[faces]
    front = np.cross(v[:, 1] - v[:, 0], v[:, 2] - v[:, 0])
    bent = (np.abs((normals**2).sum(axis=1) - 1.0) > 8 * U53) | (np.abs(normals - true).max(axis=1) > 1e3 * U53)
    behind = np.einsum("ni,ni->n", front, true[faces[:, 0]]) <= 0.0
    return int(bent.sum() + behind.sum())
