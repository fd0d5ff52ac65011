"""Meshes as they are loaded: far too small, far too large, without area, coincident, empty, or not a mesh at all."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.embree import EmbreeScene
from raylab.errors import SceneError
from raylab.jit import njit
from raylab.render import render
from raylab.scene import Scene
from raylab.stress.case import Found, case
from raylab.stress.leaving import GREY, mesh
from raylab.stress.odd_rays import ball
from raylab.stress.small_pictures import little_scene
from raylab.stress.usual_tracer import UsualTracer, usual_hit
from raylab.surface import intersect, round32
from raylab.vec3 import vec3_at
from raylab.view import View

Array = npt.NDArray[Any]
ONE = np.array([[0, 1, 2]])
CORNER = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])


@njit
def meet(scene, origins, directions, points):
    """Where rays in normalised coordinates first meet something; NaN where nothing is."""
    for i in range(len(origins)):
        hit = intersect(scene, round32(vec3_at(origins, i)), round32(vec3_at(directions, i)), 0.0, math.inf)
        p = hit.x.p
        points[i, 0], points[i, 1], points[i, 2] = (p.x, p.y, p.z) if hit.found else (math.nan, math.nan, math.nan)


def met(scene: Scene, origins: Array, directions: Array) -> Array:
    """(n, 3): the same for world coordinates."""
    points = View(np.zeros((len(origins), 3)))
    meet(scene.data, View(scene.placement.points(origins)), View(np.asarray(directions, np.float64)), points)
    world: Array = points.array / scene.placement.scale + scene.placement.centre
    return world


def refused(make: Callable[[], object], words: str) -> bool:
    """Whether it is refused by a sentence with these words in it."""
    try:
        make()
    except SceneError as error:
        return re.search(words, str(error)) is not None
    return False


def or_infinite(error: float) -> float:
    return math.inf if math.isnan(error) else error


DOWN = np.array([[0.0, 0.0, -1.0]])


@case(
    "A16", "a triangle of size 1e-9, 3e-10, 1e-15, 1e-20, all there is", usual="Embree's u and v",
    rule="scaled to 1; u and v in float64", truth="u = v = 1/4", unit="error of u or v", allowed=1e-6,
)  # fmt: skip
def tiny_triangles() -> Found:
    ours = theirs = 0.0
    for size in (1e-9, 3e-10, 1e-15, 1e-20):
        above = np.array([0.25, 0.25, 1.0]) * size
        p = met(mesh(CORNER * size, ONE), above[None], DOWN)[0] / size
        ours = max(ours, or_infinite(float(np.abs(p[:2] - 0.25).max())))
        _, u, v = usual_hit(UsualTracer(CORNER * size, ONE), above, DOWN[0])
        theirs = max(theirs, or_infinite(max(abs(u - 0.25), abs(v - 0.25))))
    return Found(ours, theirs)


@case(
    "A17", "a triangle of size 1e12, 1e13, 1.9e18, all there is", usual="Embree's t", rule="scaled to 1; t in float64",
    truth="t = size", unit="relative error of t", allowed=1e-6,
)  # fmt: skip
def huge_triangles() -> Found:
    ours = theirs = 0.0
    for size in (1e12, 1e13, 1.9e18):
        above = np.array([0.25, 0.25, 1.0]) * size
        p = met(mesh(CORNER * size, ONE), above[None], DOWN)[0]
        ours = max(ours, or_infinite(float(np.linalg.norm(p - above)) / size - 1.0))
        t, _, _ = usual_hit(UsualTracer(CORNER * size, ONE), above, DOWN[0])
        theirs = max(theirs, abs(t / size - 1.0))
    return Found(ours, theirs)


# collinear up to rounding, with a corner twice, a point, 1e-7 times as high as long
WITHOUT_AREA = np.array([
    [[0, 0, 0], [0.1, 0.2, 0.3], [0.3, 0.6, 0.9]], [[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 0, 0], [1, 0, 0], [1, 0, 0]],
    [[1, 1, 1]] * 3, [[0, 0, 0], [1, 0, 0], [0.5, 1e-7, 0]],
])  # fmt: skip


@case(
    "A18", "five triangles without area in a ball; corners that are NaN or infinite", usual="handed to Embree",
    rule="left out, counted and listed where 2 A <= 2^-20 longest edge^2; refused where not finite",
    truth="all are named", unit="faults not named",
)  # fmt: skip
def without_area() -> Found:
    vertices, faces = ball(2)
    planted = len(WITHOUT_AREA)
    bad = len(vertices) + np.arange(3 * planted).reshape(-1, 3)
    whole = np.concatenate([vertices, WITHOUT_AREA.reshape(-1, 3)])
    scene = mesh(whole, np.concatenate([faces[:7], bad, faces[7:]]))
    listed = ", ".join(str(7 + k) for k in range(planted))
    named = any(f"{planted} degenerate triangles of {len(faces) + planted}" in w and f"(number {listed})" in w
                for w in scene.warnings)  # fmt: skip
    missing = (0 if named else planted) + abs(scene.triangles - len(faces))
    for value in (math.nan, math.inf, -math.inf):
        spoiled = CORNER + np.array([[0.0], [value], [0.0]])
        missing += not refused(partial(mesh, spoiled, ONE), "vertex 1 is not finite")
    phantom = UsualTracer(WITHOUT_AREA[0], ONE)
    rng = np.random.default_rng(3)
    origins = rng.normal(size=(100_000, 3))
    hits = int((phantom.hits(origins, rng.uniform(0, 1, (100_000, 1)) * [0.3, 0.6, 0.9] - origins) >= 0).sum())
    return Found(missing, planted + 3.0, note=f"(in Embree {hits} of 100000 rays hit a line)")


@case(
    "A19", "index 77 in a mesh of 3 vertices; -1; faces of 4 corners", usual="handed to Embree, which reads on",
    rule="refused with the range that is there", truth="SceneError", unit="refusals missing",
)  # fmt: skip
def indices_out_of_range() -> Found:
    ours = [
        not refused(lambda: mesh(CORNER, np.array([[0, 1, 77]])), "vertices 0 to 77, there are 3"),
        not refused(lambda: mesh(CORNER, np.array([[0, 1, -1]])), "vertices -1 to 1, there are 3"),
        not refused(lambda: mesh(CORNER, np.array([[0, 1, 2, 2]])), r"faces \(m, 3\)"),
    ]
    memory, theirs = np.zeros((100, 3), np.float32), EmbreeScene()
    theirs.add_mesh(memory[:3], np.array([[0, 1, 77]], np.uint32))
    theirs.commit()  # raises if Embree reports an error
    return Found(sum(ours), 1.0)


@case(
    "A20", "no shape at all; a mesh of no triangles", usual="centre and size of the box (inf, -inf)",
    rule="centre 0, size 1", truth="nothing is met, the picture is black", unit="scenes that are wrong", limit=60.0,
)  # fmt: skip
def empty_scenes() -> Found:
    eye = little_scene(1.0, 0.0).description.camera
    nothing = d.SceneDescription(camera=eye)
    wrong = 0
    for described in (nothing, replace(nothing, shapes=(d.Mesh(vertices=CORNER, faces=ONE[:0]),))):
        scene = Scene(described)
        wrong += not np.isnan(met(scene, np.array([[0.0, 0.0, 1.0]]), DOWN)).all()
        wrong += not np.array_equal(render(scene, "direct", spp=2, seed=3).mean, np.zeros((eye.height, eye.width, 3)))
    lower, upper = np.full(3, math.inf), np.full(3, -math.inf)
    with np.errstate(all="ignore"):
        usual = np.isnan((lower + upper) / 2).any()
    return Found(wrong, 2.0 * usual)


@case(
    "A21", "1000 and 100000 triangles in one place", usual="handed to Embree", rule="a warning that counts them",
    truth="t = 1; the duplicates are counted", unit="wrong hits + missing warnings",
)  # fmt: skip
def coincident_triangles() -> Found:
    wrong, each = 0, 0.0
    for count in (1000, 100_000):
        scene = mesh(np.tile(CORNER, (count, 1)), np.arange(3 * count).reshape(-1, 3))
        origins, down = np.tile([0.25, 0.25, 1.0], (20, 1)), np.tile(DOWN, (20, 1))
        met(scene, origins[:1], down[:1])
        start = time.perf_counter()
        points = met(scene, origins, down)
        each = (time.perf_counter() - start) / 20
        wrong += int((points[:, 2] != 0.0).sum())
        wrong += not any(f"{count - 1} duplicate triangles of {count}" in w for w in scene.warnings)
    return Found(wrong, 2.0, note=f"({each * 1e6:.0f} us a ray at last)")


@case(
    "A27", "an object of size 1 at the rim of a scene of size 1e6", usual="no warning",
    rule="a warning where an edge is below 2^-18 of the scene", truth="mesh and ball are named, the rest is not",
    unit="warnings missing or wrong",
)  # fmt: skip
def tiny_in_huge() -> Found:
    rim = np.eye(4)
    rim[:3, 3] = 5e5
    vertices, faces = ball(2)
    shapes = (
        d.Rectangle(name="ground", to_world=np.diag([5e5, 5e5, 1.0, 1.0]), front=GREY),
        d.Mesh(name="object", vertices=vertices / 2, faces=faces, to_world=rim),
        d.Sphere(name="ball", radius=0.5, to_world=rim),
    )
    scene = Scene(d.SceneDescription(shapes=shapes))
    said = [re.match(r"shape '(\w+)'.* smaller than 2\^-18", warning) for warning in scene.warnings]
    names = {found.group(1) for found in said if found}
    seen = scene.data.vertices.array[4 : 4 + len(vertices)].astype(np.float64) / scene.placement.scale
    error = np.abs(seen + scene.placement.centre - (vertices / 2 + 5e5)).max()
    wrong = len(names ^ {"object", "ball"}) + (len(said) - len(names))
    return Found(wrong, 2.0, note=f"(corners are moved by {error:.2g}, which nothing can cure but splitting the scene)")
