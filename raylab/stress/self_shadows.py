"""Rays that would meet the surface they start on: in float32, at any size, at any place, on slivers, at edges."""

from __future__ import annotations

import math

import numpy as np

from raylab import description as d
from raylab.embree import TNEAR, blocked, trace
from raylab.scene import Scene
from raylab.stress.case import Found, case
from raylab.stress.leaving import GREY, Rays, false_hits, mesh, placed, rotation, triangle, usual_false_hits
from raylab.vec3 import Vec3

USUAL = "o + t d in float32, tnear = 1e-4"
RULE = "p in float64, moved off along n by a bound on all roundings; scene recentred and scaled by 2^k"
NOTHING = "nothing else is there, so every hit is a false one"
COUNT = 20_000


def compared(scenes: list[Scene], count: int, seed: int = 11, usual: bool = True) -> Found:
    """False hits over some scenes of one mesh."""
    ours = theirs = 0
    for i, scene in enumerate(scenes):
        rays = Rays.spread(seed + i, count, len(scene.data.faces))
        ours += false_hits(scene, rays)
        theirs += usual_false_hits(scene, rays) if usual else 0
    total = count * len(scenes)
    note = f"({total} rays{f'; usual code {theirs / total:.2g} of them' if usual else ''})"
    return Found(ours, theirs if usual else None, note=note)


@case(
    "A01", "floor z = 0, ray from (0.1, 0.2, 0) straight up, robust mode", usual="tnear = 0",
    rule="tnear = 2^-100, besides the offset", truth="no hit", unit="hits of the own floor",
)  # fmt: skip
def up_from_the_floor() -> Found:
    scene = Scene(d.SceneDescription(shapes=(d.Rectangle(front=GREY),)))
    handle = scene.embree.handle
    o, up = Vec3(0.1, 0.2, 0.0), Vec3(0.0, 0.0, 1.0)
    ours = [trace(handle, o, up, TNEAR, math.inf)[0] >= 0, blocked(handle, o, up, math.inf)]
    return Found(sum(ours), float(trace(handle, o, up, 0.0, math.inf)[0] >= 0))


@case(
    "A02", "a rotated triangle of size 1 at the origin", usual=USUAL, rule=RULE, truth=NOTHING, unit="false hits",
    limit=60.0,
)  # fmt: skip
def one_triangle() -> Found:
    return compared([triangle()], 5 * COUNT)


@case(
    "A02x", "a rotated triangle of size 1 at the origin, ten million rays", usual=USUAL, rule=RULE, truth=NOTHING,
    unit="false hits", slow=True, limit=120.0,
)  # fmt: skip
def one_triangle_at_length() -> Found:
    return compared([triangle()], 10_000_000)


@case("A03", "the same triangle at 1e4 and 1e6", usual=USUAL, rule=RULE, truth=NOTHING, unit="false hits")
def far_from_the_origin() -> Found:
    return compared([triangle(offset=1e4), triangle(offset=1e6)], 2 * COUNT)


SLIVERS = (1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5)


@case(
    "A06", "triangles of height over base 1 to 1e-5, cosines down to 1e-7", usual=USUAL,
    rule=RULE + "; the bound has a term for Embree's own normal", truth=NOTHING, unit="false hits",
)  # fmt: skip
def slivers() -> Found:
    return compared([triangle(aspect) for aspect in SLIVERS], COUNT)


@case(
    "A06x", "triangles of height over base 1 to 1e-5 at five sizes and places, ten million rays", usual=USUAL,
    rule=RULE + "; the bound has a term for Embree's own normal", truth=NOTHING, unit="false hits", slow=True,
    limit=240.0,
)  # fmt: skip
def slivers_everywhere() -> Found:
    places = [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e4), (1e-3, 1e3)]
    return compared([triangle(a, *place) for a in SLIVERS for place in places], 10_000_000 // 30 + 1)


@case(
    "A07", "rotated floor of half size 1e4 and 1e6, points within 1 of its centre, detail of 0.005 below it",
    usual=USUAL, rule=RULE + ", of the whole triangle; a warning where detail is smaller than the offset",
    truth=NOTHING + "; both scenes warn", unit="false hits + missing warnings",
)  # fmt: skip
def large_floors() -> Found:
    ours = theirs = missing = 0
    for i, half in enumerate((1e4, 1e6)):
        detail = placed(0.0025, rotation(0.7) @ [0.0, 0.0, -3.0], 0.7)
        shapes = (d.Rectangle(to_world=placed(half, angle=0.7), front=GREY), d.Cube(to_world=detail, front=GREY))
        scene = Scene(d.SceneDescription(shapes=shapes))
        rays = Rays.spread(31 + i, 2 * COUNT, 2)
        near = np.random.default_rng(i).uniform(-0.5, 0.5, (2 * COUNT, 2)) / half
        first = rays.faces == 0  # (v0, v1, v2) and (v0, v2, v3): the centre is in the middle of v0 v2
        b1 = np.where(first, np.abs(near[:, 0]), 0.5 + near[:, 1])
        b2 = np.where(first, 0.5 + near[:, 1], np.abs(near[:, 0]))
        rays = rays._replace(places=np.column_stack([b1, b2]))
        ours, theirs = ours + false_hits(scene, rays), theirs + usual_false_hits(scene, rays)
        missing += not any("smaller" in warning for warning in scene.warnings)
    return Found(ours + missing, theirs, note=f"(80000 rays; usual code {theirs / 8e4:.2g} of them)")


def solids() -> dict[str, Scene]:
    """Convex bodies: no ray that leaves them meets them again."""
    import trimesh

    box, round_one = trimesh.creation.box(), trimesh.creation.cylinder(radius=0.5, height=1.0, sections=512)
    turned = placed(angle=0.7)
    long = turned @ np.diag([1.0, 1.0, 100.0, 1.0])
    bodies = {"box": (box, None), "cylinder": (round_one, None), "turned box": (box, turned), "long box": (box, long)}
    return {name: mesh(np.asarray(b.vertices), np.asarray(b.faces), m) for name, (b, m) in bodies.items()}


def by_area(scene: Scene, seed: int, count: int, least: float) -> Rays:
    """Points spread evenly over the surface."""
    corners = scene.data.vertices.array[scene.data.faces.array].astype(np.float64)
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    faces = np.random.default_rng(seed + 2000).choice(len(areas), count, p=areas / areas.sum())
    return Rays.spread(seed, count, 1, least)._replace(faces=faces)


def near_edges(scene: Scene, seed: int, count: int) -> Rays:
    """30 % of the points within 1e-12 to 1 of an edge, cosines down to 1e-6."""
    rays, rng = by_area(scene, seed, count, 1e-6), np.random.default_rng(seed + 1000)
    b = np.column_stack([1.0 - rays.places.sum(axis=1), rays.places])
    close = np.arange(count) < 0.3 * count
    corner = rng.integers(0, 3, count)
    to_edge = np.where(close, 10.0 ** rng.uniform(-12, 0, count), b[np.arange(count), corner])
    rest = 1.0 - b[np.arange(count), corner]
    b *= ((1.0 - to_edge) / rest)[:, None]
    b[np.arange(count), corner] = to_edge
    return rays._replace(places=b[:, 1:])


def edges_of_solids(count: int, usual: bool = True) -> Found:
    worst = theirs = 0.0
    evenly = 0
    for i, scene in enumerate(solids().values()):
        rays = near_edges(scene, 41 + i, count)
        worst = max(worst, false_hits(scene, rays) / count)
        theirs = max(theirs, usual_false_hits(scene, rays) / count if usual else 0.0)
        evenly += false_hits(scene, by_area(scene, 51 + i, count, 1e-3))
    note = f"(and {evenly} of {4 * count} false hits from points that are spread evenly, of which none is allowed)"
    return Found(math.nan if evenly else worst, theirs if usual else None, note=note)


EDGES = {
    "usual": USUAL, "rule": RULE + "; the bound has the longest edge in it", "truth": "the solids are convex",
    "unit": "share of false hits", "allowed": 5e-4,
}  # fmt: skip


@case("A26", "convex solids, points by area, 30 % of them within 1e-12 to 1 of an edge, cosines down to 1e-6", **EDGES)  # type: ignore[arg-type]
def at_edges() -> Found:
    return edges_of_solids(COUNT)


@case("A26x", "the same with a million rays from each solid", slow=True, limit=120.0, **EDGES)  # type: ignore[arg-type]
def at_edges_at_length() -> Found:
    return edges_of_solids(1_000_000)
