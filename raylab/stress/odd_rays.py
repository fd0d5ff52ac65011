"""Odd rays: not numbers, no direction, one of any length, no end; where rays lie in memory; the caller's arrays."""

from __future__ import annotations

import importlib
import math
import time
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.direct import follow
from raylab.embree import TNEAR, _python_ray
from raylab.jit import njit
from raylab.packet import LANES, new_packet
from raylab.scene import Scene
from raylab.shadow import is_blocked, shadow_toward
from raylab.stress.case import Found, case
from raylab.stress.lamps import squares
from raylab.stress.leaving import GREY, mesh
from raylab.stress.small_pictures import little_scene, picture
from raylab.stress.usual_tracer import UsualTracer, trace_all, usual_hit
from raylab.surface import INVALID_RAYS, intersect, round32
from raylab.vec3 import Vec3, vec3_at
from raylab.view import View

Array = npt.NDArray[Any]
NAN, INF = math.nan, math.inf


def ball(subdivisions: int) -> tuple[Array, Array]:
    """Vertices and faces of an icosphere of radius 1."""
    import trimesh

    made = trimesh.creation.icosphere(subdivisions)
    return np.asarray(made.vertices), np.asarray(made.faces)


@njit
def shoot(scene, rays, found):
    """Rays (ox, oy, oz, dx, dy, dz, tnear, tfar) through raylab's own doors; 1 where something is met."""
    for i in range(len(rays)):
        o, w = vec3_at(rays, i), Vec3(rays[i, 3], rays[i, 4], rays[i, 5])
        found[i, 0] = 1 if intersect(scene, o, w, rays[i, 6], rays[i, 7]).found else 0
        found[i, 1] = 1 if is_blocked(scene, o, w, rays[i, 7]) else 0


def invalid_rays() -> Array:
    """A good ray with each of its eight numbers spoiled by NaN, and by infinity where that means nothing."""
    good = np.array([0.1, 0.2, 3.0, 0.0, 0.0, -1.0, 0.0, INF])
    spoiled = []
    for k in range(8):
        for value in (NAN, INF, -INF):
            if (k, value) == (7, INF):
                continue
            ray = good.copy()
            ray[k] = value
            spoiled.append(ray)
    return np.array(spoiled)


@case(
    "A12", "NaN or infinity in origin, direction, tnear or tfar; 81920 triangles",
    usual="handed to Embree; occluded if tfar < 0 afterwards", rule="not traced, counted, lets no light through",
    truth="each is counted once, and none takes 5 us", unit="rays not counted, found, or slow", limit=60.0,
)  # fmt: skip
def not_numbers() -> Found:
    vertices, faces = ball(6)
    scene = mesh(vertices, faces)
    rays = invalid_rays()
    found = View(np.zeros((len(rays), 2), np.int64))
    before = scene.data.tally[INVALID_RAYS]
    shoot(scene.data, View(rays), found)
    spoils_both = rays[:, 6] == 0.0  # a shadow ray has no tnear
    counted = scene.data.tally[INVALID_RAYS] - before
    missing = len(rays) + int(spoils_both.sum()) - counted
    seen = int(found.array[:, 0].sum()) + int((found.array[spoils_both, 1] == 0).sum())
    many = View(np.repeat(rays, 200, axis=0))
    room = View(np.zeros((len(many), 2), np.int64))
    start = time.perf_counter()
    shoot(scene.data, many, room)
    each = (time.perf_counter() - start) / (2 * len(many))
    tracer = UsualTracer(vertices, faces)
    tracer.hits(rays[-1:, :3], rays[-1:, 3:6])  # compiles
    start = time.perf_counter()
    nans = np.array([ray for ray in rays if np.isnan(ray[:6]).any()])
    tracer.hits(nans[:, :3], nans[:, 3:6], 0.0)
    usual = (time.perf_counter() - start) / len(nans)
    note = f"({each * 1e6:.2g} us each; a ray with a NaN takes Embree {usual * 1e6:.0f} us)"
    return Found(missing + seen + (each > 5e-6), float(len(nans) if usual > 5e-6 else 0), note=note)


@njit
def look(scene, directions, found):
    """From the floor below the middle: what `follow` and `shadow_toward` make of directions, and where."""
    for i in range(len(directions)):
        start = intersect(scene, Vec3(0.03125, 0.0625, 0.0), Vec3(0.0, 0.0, -1.0), 0.0, math.inf)
        w = vec3_at(directions, i)
        hit = follow(scene, start.x, w)
        found[i, 0] = 1.0 if hit.found else 0.0
        found[i, 1], found[i, 2], found[i, 3] = hit.x.p.x, hit.x.p.y, hit.x.p.z
        found[i, 4] = 1.0 if shadow_toward(scene, start.x, w) else 0.0


def followed(lengths: list[float]) -> tuple[Array, Array, int]:
    """Answers to rays from a floor through a ceiling, in a direction of several lengths; where it hits; counts."""
    ceiling = np.diag([1.0, -1.0, -1.0, 1.0])
    ceiling[2, 3] = 3.5
    shapes = (d.Rectangle(front=GREY), d.Rectangle(to_world=ceiling, front=GREY))
    scene = Scene(d.SceneDescription(shapes=shapes))
    unit = np.array([0.25, -0.5, 1.75]) / np.linalg.norm([0.25, -0.5, 1.75])
    found = View(np.zeros((len(lengths), 5)))
    before = scene.data.tally[INVALID_RAYS]
    look(scene.data, View(np.array([unit * length for length in lengths])), found)
    floor = scene.placement.points([0.0, 0.0, 0.0])[2]
    start = np.array([0.03125, 0.0625, floor])
    top = scene.placement.points([0.0, 0.0, 3.5])[2]
    return found.array, start + unit * ((top - floor) / unit[2]), scene.data.tally[INVALID_RAYS] - before


@case(
    "A13", "direction (0, 0, 0)", usual="d / |d|", rule="not traced, counted, lets no light through",
    truth="counted once by `follow`; for a shadow ray it lies in the horizon", unit="answers that differ, and NaN",
)  # fmt: skip
def no_direction() -> Found:
    found, _, counted = followed([0.0])
    with np.errstate(all="ignore"):
        usual = np.zeros(3) / np.linalg.norm(np.zeros(3))
    wrong = abs(counted - 1) + (found[0, 0] != 0.0) + (found[0, 4] != 1.0) + np.isnan(found).any()
    return Found(float(wrong), float(np.isnan(usual).any()))


def of_length(lengths: list[float]) -> Found:
    """Where raylab's rays meet the ceiling, against Embree's own t with a direction of that length."""
    found, expected, counted = followed(lengths)
    errors = np.abs(found[:, 1:4] - expected).max(axis=1)
    ours = float(np.where((found[:, 0] == 1.0) & (found[:, 4] == 1.0), errors, np.inf).max())
    tracer = UsualTracer(np.array([[-4.0, -4, 1], [8, -4, 1], [-4, 8, 1]]), np.array([[0, 1, 2]]))
    worst = 0.0
    for length in lengths:
        _, u, v = usual_hit(tracer, np.zeros(3), np.array([0.125, 0.25, 1.0]) * length)
        error = max(abs(u - 4.125 / 12), abs(v - 4.25 / 12))
        worst = max(worst, np.inf if math.isnan(error) else error)
    return Found(ours if counted == 0 else math.nan, worst)


LENGTHS: dict[str, Any] = {
    "usual": "handed to Embree, u and v taken from it",
    "rule": "lengths beyond 2^50 are made 1; the point is recomputed in float64", "truth": "the plane's equation",
    "unit": "error of the point in a scene of size 1", "allowed": 1e-6,
}  # fmt: skip


@case("A14", "direction of length 1e-18, 1e-19, 1e-40", **LENGTHS)
def short_directions() -> Found:
    return of_length([1e-18, 1e-19, 1e-40])


@case("A15", "direction of length 1e30, 1e38", **LENGTHS)
def long_directions() -> Found:
    return of_length([1e30, 1e38])


@case(
    "A23", "RTCRay at an address that is no multiple of 16", usual="rows of 84 bytes, the sum of an RTCRayHit's fields",
    rule="aligned on the stack, in Python and in packets", truth="Embree loads 16 bytes at a time",
    unit="rays that are not aligned",
)  # fmt: skip
def alignment() -> Found:
    kept = [_python_ray(Vec3(0, 0, 0), Vec3(0, 0, 1), 0.0, 1.0) for _ in range(1000)]
    packets = [new_packet().words.array for _ in range(1000)]
    wrong = sum(ray.ctypes.data % 16 != 0 for ray in kept)
    wrong += sum(p.ctypes.data % (4 * LANES) != 0 for p in packets)
    tracer = UsualTracer(*ball(1))  # which has compiled trace_all
    tracer.hits(np.zeros((1, 3)), np.ones((1, 3)))
    for code in trace_all._outer.inspect_llvm().values():
        rays = [line for line in code.splitlines() if "alloca [24 x float]" in line]
        wrong += sum("align 16" not in line for line in rays) + (not rays)
    rows = np.zeros((1000, 21), np.float32)
    return Found(wrong, float(sum(row.ctypes.data % 16 != 0 for row in rows)))


@case(
    "A24", "arrays given to the tracer; geometry changed after the first ray", usual="embreex",
    rule="arrays are copied, a scene is what it was made of", truth="nothing is overwritten, nothing half-changed",
    unit="arrays overwritten + changes neither seen nor refused", limit=60.0,
)  # fmt: skip
def arrays_of_the_caller() -> Found:
    vertices, faces = ball(2)
    before = vertices.copy(), faces.copy()
    scene = mesh(vertices, faces)
    found = View(np.zeros((1, 2), np.int64))
    ray = View(np.array([[0.1, 0.2, 3.0, 0.0, 0.0, -1.0, 0.0, INF]]))
    shoot(scene.data, ray, found)
    overwritten = not (np.array_equal(vertices, before[0]) and np.array_equal(faces, before[1]))
    vertices += 100.0
    shoot(scene.data, ray, found)
    half_changed = found[0, 0] != 1
    first = little_scene(1.0, 0.0)
    same = np.array_equal(picture(first), picture(first))
    return Found(overwritten + half_changed + (not same), embreex_faults())


def embreex_faults() -> float:
    """`dists` is overwritten by the answer, and a mesh added after the first run is ignored."""
    core = importlib.import_module("embreex.rtcore_scene")
    construction = importlib.import_module("embreex.mesh_construction")
    triangle = np.array([[[-1.0, -1, 0], [1, -1, 0], [0, 1, 0]]], np.float32)
    scene = core.EmbreeScene()
    kept = [construction.TriangleMesh(scene, triangle + np.array([0, 0, 5], np.float32))]
    o, w = np.zeros((1, 3), np.float32), np.array([[0, 0, 1]], np.float32)
    limits = np.full(1, 100.0, np.float32)
    scene.run(o, w, dists=limits, query="DISTANCE")
    kept.append(construction.TriangleMesh(scene, triangle + np.array([0, 0, 2], np.float32)))
    distance = scene.run(o, w, query="DISTANCE")[0]
    return float((limits[0] != 100.0) + (distance != 2.0))


@case(
    "D10", "10,000 rays that miss everything, to infinity", usual="distance < inf, where the default tfar is 1e37",
    rule="tfar is infinite, and a miss is told by the number of the shape", truth="no hit", unit="rays that hit",
    allowed=0.0,
)  # fmt: skip
def into_the_sky() -> Found:
    scene = Scene(d.SceneDescription(shapes=(d.Rectangle(front=GREY),)))
    u = squares(10_000)
    return Found(_above(scene.data, u), float(np.isfinite(np.float32(1e37))) * len(u))


@njit
def _above(scene, u):
    """Of rays upwards from a point above everything."""
    hits = 0
    for i in range(len(u)):
        w = Vec3(u[i, 0] - 0.5, u[i, 1] - 0.5, 1.0)
        hits += intersect(scene, Vec3(0.0, 0.0, 0.5), round32(w), TNEAR, INF).found
    return hits
