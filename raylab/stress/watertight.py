"""Watertight: closed bodies that let no ray out through an edge, and hits on a box that is very wide and low."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.scene import Scene
from raylab.stress.case import Found, case
from raylab.stress.leaving import GREY, mesh
from raylab.stress.meshes import meet, met
from raylab.stress.odd_rays import ball
from raylab.stress.usual_tracer import UsualTracer, usual_hit
from raylab.view import View

Array = npt.NDArray[Any]
COUNT = 100_000
VERTICES = 0.005  # of the rays aimed at a vertex exactly may get out


@case(
    "A22", "a box 5.89e11 and 5.89e12 wide and 1.2e5 high, seen from 1e12 above", usual="fast mode, o + t d",
    rule="robust mode, the point in float64", truth="the top is at z = 120000", unit="error of z", allowed=1.0,
)  # fmt: skip
def wide_boxes() -> Found:
    ours = theirs = 0.0
    rng = np.random.default_rng(5)
    for width in (5.89e11, 5.89e12):
        matrix = np.diag([width / 2, width / 2, 6e4, 1.0])
        matrix[2, 3] = 6e4
        scene = Scene(d.SceneDescription(shapes=(d.Cube(to_world=matrix, front=GREY),)))
        slope = np.column_stack([rng.uniform(-1, 1, (COUNT, 2)), np.full(COUNT, -1.0)]).astype(np.float32)
        top = np.column_stack([rng.uniform(-0.49, 0.49, (COUNT, 2)) * width, np.full(COUNT, 120_000.0)])
        origins = (top - 1e12 * slope).astype(np.float32)
        z = met(scene, origins.astype(np.float64), slope)[:, 2]
        ours = max(ours, float(np.where(np.isnan(z), np.inf, np.abs(z - 120_000.0)).max()))
        tracer = UsualTracer.of(scene, robust=False)
        for o, w in zip(origins[:2000].astype(np.float64), slope.astype(np.float64), strict=False):
            theirs = max(theirs, abs(o[2] + usual_hit(tracer, o, w)[0] * w[2] - 120_000.0))
    return Found(ours, theirs)


def aimed(vertices: Array, faces: Array, at: str, count: int, seed: int) -> tuple[Array, Array]:
    """Origins within half the radius of the middle, and directions to random points of faces, edges or vertices."""
    rng = np.random.default_rng(seed)
    corners = vertices[faces[rng.integers(0, len(faces), count)]].astype(np.float64)
    b = rng.dirichlet([1.0, 1.0, 1.0], count)
    if at == "edges":
        b[:, 2] = 0.0
        b /= b.sum(axis=1, keepdims=True)
    if at == "vertices":
        b[:] = [1.0, 0.0, 0.0]
    targets = np.einsum("nk,nki->ni", b, corners)
    middle = (vertices.max(axis=0).astype(np.float64) + vertices.min(axis=0)) / 2
    radius = float(np.ptp(vertices[:, 0])) / 2
    origins = (middle + rng.uniform(-0.28, 0.28, (count, 3)) * radius).astype(np.float32).astype(np.float64)
    return origins, targets - origins


def leaks(counts: dict[str, int], subdivisions: int = 4, usual: bool = True) -> Found:
    """Rays from inside a ball that meet nothing, for raylab and for Embree's fast mode."""
    ours = dict.fromkeys(counts, 0)
    theirs = 0
    vertices, faces = ball(subdivisions)
    for shift in (0.0, 1e5):
        scene = mesh(vertices + shift, faces)
        fast = UsualTracer(vertices + shift, faces, robust=False)
        for k, (at, count) in enumerate(counts.items()):
            for part in range(0, count, 1_000_000):
                some, seed = min(count - part, 1_000_000), 100 * k + part // 1_000_000
                points = View(np.zeros((some, 3)))
                rays = aimed(scene.data.vertices.array[: len(vertices)], faces, at, some, seed)
                meet(scene.data, *map(View, rays), points)
                ours[at] += int(np.isnan(points.array[:, 0]).sum())
            if usual:
                rays = aimed(fast.vertices, faces, at, min(count, 1_000_000), k)
                theirs += int((fast.hits(*rays, tnear=0.0) < 0).sum())
    beyond = max(0.0, ours["vertices"] - VERTICES * 2 * counts["vertices"])
    note = ", ".join(f"{ours[at]} of {2 * n} rays at {at}" for at, n in counts.items())
    return Found(ours["faces"] + ours["edges"] + beyond, float(theirs) if usual else None, note=f"({note} got out)")


LEAKS: dict[str, Any] = {
    "usual": "fast mode", "rule": "robust mode", "truth": "the ball is closed",
    "unit": "rays that get out (at vertices: beyond 0.5 % of them)",
}  # fmt: skip


@case("A25", "a ball of 5120 triangles at 0 and 1e5, rays from inside at faces, edges and vertices", **LEAKS)
def closed_ball() -> Found:
    return leaks({"faces": 100_000, "edges": 100_000, "vertices": 100_000})


@case(
    "A25x", "the same with ten million rays at faces, a million at edges and vertices", slow=True, limit=240.0, **LEAKS
)
def closed_ball_at_length() -> Found:
    return leaks({"faces": 5_000_000, "edges": 500_000, "vertices": 500_000})
