"""Shadow rays between a floor and a light: at every scale and place, past a shelf, and at grazing angles."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.geometry import gather
from raylab.jit import njit
from raylab.point import dist_sqr
from raylab.scene import Scene
from raylab.shadow import shadow
from raylab.stress.case import Found, case
from raylab.stress.leaving import GREY, placed
from raylab.stress.usual_tracer import UsualTracer
from raylab.surface import SHADOW_RAYS, round32, triangle_hit
from raylab.vec3 import dot, vec3_at
from raylab.view import View

Array = npt.NDArray[Any]
USUAL = "o + t d in float32; unit direction, from 1e-4 to r - 1e-4"
RULE = "scene recentred and scaled by 2^k; both ends moved off along their normals by a bound; d = y' - x', tfar = 1"
COUNT = 20_000
VISIBLE, BLOCKED, WITHOUT_A_RAY = range(3)


@njit
def connect(scene, points, faces, u, verdict, energy):
    """From points of shape 0, a square, shadow rays to the light: their verdicts, and cos cos' / (r^2 p) if visible."""
    for i in range(len(points)):
        p = vec3_at(points, i)
        o = round32(p + vec3_at(scene.planes, 0) * 0.0625)
        hit = triangle_hit(scene, 0, faces[i], o, round32(p - o))
        for light in scene.lights:
            y, p_y = light.sample(hit.x, (u[i, 0], u[i, 1]))
            before = scene.tally[SHADOW_RAYS]
            if shadow(scene, hit.x, y):
                verdict[i] = BLOCKED if scene.tally[SHADOW_RAYS] > before else WITHOUT_A_RAY
            else:
                r2, across = dist_sqr(hit.x, y), y - hit.x
                energy[i] = dot(across, hit.x.n) * -dot(across, y.n) / (r2 * r2 * p_y)


def connected(scene: Scene, places: Array, u: Array) -> tuple[Array, Array]:
    """(n,) verdicts and (n,) energies."""
    verdict, energy = View(np.zeros(len(places), np.int64)), View(np.zeros(len(places)))
    (floor, *_), _, _ = gather(scene.description.shapes)
    v0, v1, _, v3 = scene.placement.points(floor.vertices)
    points = v0 + places[:, :1] * (v1 - v0) + places[:, 1:] * (v3 - v0)
    faces = np.where(places[:, 0] >= places[:, 1], 0, 1)  # v0 v1 v2 and v0 v2 v3
    connect(scene.data, View(points), View(faces), View(u), verdict, energy)
    return verdict.array, energy.array


def usually_blocked(scene: Scene, places: Array, u: Array, robust: bool = True) -> Array:
    """(n,) the verdict of the usual code; the floor's triangles are the first two, the light's the next."""
    tracer = UsualTracer.of(scene, robust)
    a, b = places[:, 0], places[:, 1]
    first = a >= b  # the floor is v0 v1 v2 and v0 v2 v3
    local = np.where(first[:, None], np.column_stack([a - b, b]), np.column_stack([a, b - a]))
    p, _ = tracer.seen(np.where(first, 0, 1), local, 0.0625 / scene.placement.scale)
    v = tracer.vertices[4:8]
    w = u.astype(np.float32)
    y = v[0] + (v[1] - v[0]) * w[:, :1] + (v[3] - v[0]) * w[:, 1:]
    return tracer.blocked(p, y)


def square(matrix: Array, x: float, z: float, size: float, down: bool, **more: Any) -> d.Rectangle:
    """A square of half size `size` at (x, 0, z), then `matrix`."""
    local = np.diag([size, -size if down else size, -1.0 if down else 1.0, 1.0])
    local[[0, 2], 3] = x, z
    return d.Rectangle(to_world=matrix @ local, **more)


def floor_and_light(matrix: Array, *plates: tuple[float, float, float]) -> Scene:
    """A floor of half size 1, a light of 1/2 at height 1 that faces down, and plates (x, height, half size) between."""
    floor = square(matrix, 0.0, 0.0, 1.0, False, front=GREY)
    light = square(matrix, 0.0, 1.0, 0.5, True, radiance=np.ones(3), front=None)
    between = [square(matrix, *plate, True, front=GREY, back=GREY) for plate in plates]
    return Scene(d.SceneDescription(shapes=(floor, light, *between)))


def random_pairs(seed: int, count: int = COUNT) -> tuple[Array, Array]:
    """Places on the floor and on the light."""
    rng = np.random.default_rng(seed)
    return rng.uniform(0.01, 0.99, (count, 2)), rng.random((count, 2))


@case(
    "A04", "scene times 1e-6, a plate over the whole floor 1e-3 of the scene's size above it", usual=USUAL, rule=RULE,
    truth="all rays are blocked", unit="rays that pass through the plate", limit=60.0,
)  # fmt: skip
def closed_at_a_small_scale() -> Found:
    scene = floor_and_light(placed(1e-6, angle=0.7), (0.0, 1e-3, 2.0))
    pairs = random_pairs(13)
    return Found(int((connected(scene, *pairs)[0] == VISIBLE).sum()), float((~usually_blocked(scene, *pairs)).sum()))


@case(
    "A05", "scene times 1e6, nothing between floor and light", usual=USUAL, rule=RULE, truth="no ray is blocked",
    unit="rays that are blocked",
)  # fmt: skip
def open_at_a_large_scale() -> Found:
    scene = floor_and_light(placed(1e6, angle=0.7))
    pairs = random_pairs(14)
    return Found(int((connected(scene, *pairs)[0] != VISIBLE).sum()), float(usually_blocked(scene, *pairs).sum()))


def grazing(count: int, usual: bool = True) -> Found:
    """A wall light of size 1 at height 3 that faces a floor so small that cosines at the light are within 1e-3."""
    light = np.array([[0.0, 0, -0.5, 0], [0, 0.5, 0, 0], [0.5, 0, 0, 3], [0, 0, 0, 1]])  # in x = 0, facing -x
    floor = np.diag([1.5e-3, 1e-3, 1.0, 1.0])
    floor[0, 3] = -1.5e-3
    shapes = (
        d.Rectangle(to_world=placed(angle=0.7) @ floor, front=GREY),
        d.Rectangle(to_world=placed(angle=0.7) @ light, radiance=np.ones(3), front=None),
    )
    scene = Scene(d.SceneDescription(shapes=shapes))
    rng = np.random.default_rng(17)
    places, u = rng.random((count, 2)), rng.random((count, 2))
    verdict, _ = connected(scene, places, u)
    skipped = int((verdict == WITHOUT_A_RAY).sum())
    blocked = float(usually_blocked(scene, places, u).sum()) if usual else None
    note = f"({count} rays; {skipped} not traced, from so near the light's plane that float32 cannot tell its side)"
    return Found(int((verdict == BLOCKED).sum()), blocked, note=note)


GRAZING: dict[str, Any] = {
    "usual": USUAL, "rule": RULE, "truth": "nothing is in the way", "unit": "rays that are blocked",
}  # fmt: skip


@case("A08", "light of size 1 at distance 3, cosines at the light uniform in (0, 1e-3)", **GRAZING)
def seen_edge_on() -> Found:
    return grazing(5 * COUNT)


@case("A08x", "the same with five million rays", slow=True, limit=120.0, **GRAZING)
def seen_edge_on_at_length() -> Found:
    return grazing(5_000_000)


@case(
    "A09", "a shelf 2^-12 above the floor of a unit scene at 1e4, turned", usual=USUAL, rule=RULE,
    truth="under the shelf all rays are blocked, besides it none; the energy is that of its corners at the origin",
    unit="wrong rays + relative error of the energy", allowed=1e-12,
)  # fmt: skip
def shelf_far_away() -> Found:
    shift = np.array([1.0, 0.7, -0.4]) * 1e4
    return far_away(shift, 19)


def far_away(shift: Array, seed: int) -> Found:
    """The scene with a shelf, moved; against the scene of its rounded corners at the origin."""
    shelf = (-1.0, 2.0**-12, 1.0)
    far = floor_and_light(placed(1.0, shift, 0.7), shelf)
    there, back = moved_back(far, 0.0), moved_back(far, shift)
    here = moved_back(floor_and_light(placed(angle=0.7), shelf), 0.0)
    places, u = random_pairs(seed)
    places = places[np.abs(places[:, 0] - 0.5) > 0.01]  # by the shelf's edge it depends on the light's point
    under, u = places[:, 0] < 0.5, u[: len(places)]
    verdict, energy = connected(there, places, u)
    _, expected = connected(back, places, u)
    _, unrounded = connected(here, places, u)
    wrong = int(((verdict != VISIBLE) != under).sum())
    usual = float((usually_blocked(there, places, u) != under).sum())
    off, step = abs(energy.sum() / unrounded.sum() - 1.0), np.spacing(np.abs(shift).max())
    note = f"({len(places)} rays; {off:.1g} off the scene whose corners are not rounded to steps of {step:.1g})"
    return Found(wrong + abs(energy.sum() / expected.sum() - 1.0), usual, note=note)


SCALES = (2.0**-60, 1e-6, 1e-3, 1.0, 1e3, 1e6, 2.0**60)
VARIANTS = [(scale, 0.0) for scale in SCALES] + [
    (1.0, 1.0),
    (1.0, 1e3),
    (1.0, 1e4),
    (1.0, 1e6),
    (1e-3, 1.0),
    (1e6, 1e9),
]


@case(
    "A28", "a shelf 2^-12 above the floor at 13 scales and places, straight and turned", usual=USUAL, rule=RULE,
    truth="under the shelf all rays are blocked, besides it none; the energy is that of scale 1 at the origin",
    unit="wrong rays + largest relative error of the energy", allowed=1e-8,
)  # fmt: skip
def everywhere() -> Found:
    shelf, wrong, worst, theirs = (-1.0, 2.0**-12, 1.0), 0, 0.0, 0
    places, u = random_pairs(71)
    places = places[np.abs(places[:, 0] - 0.5) > 0.01]
    under, u = places[:, 0] < 0.5, u[: len(places)]
    for angle in (0.0, 0.7):
        expected = connected(floor_and_light(placed(angle=angle), shelf), places, u)[1].sum()
        for scale, offset in VARIANTS:
            scene = floor_and_light(placed(scale, np.array([1.0, 0.7, -0.4]) * offset, angle), shelf)
            verdict, energy = connected(scene, places, u)
            wrong += int(((verdict != VISIBLE) != under).sum())
            worst = max(worst, abs(float(energy.sum() / expected) - 1.0))
            theirs += int((usually_blocked(scene, places, u) != under).sum())
    total = 2 * len(VARIANTS) * len(places)
    return Found(wrong + worst, float(theirs), note=f"({total} rays; usual code {theirs / total:.2g} of them wrong)")


@case(
    "A11", "the same at (1e9, 0.7e9, -0.4e9)", usual=USUAL, rule=RULE, truth="the same",
    unit="wrong rays + relative error of the energy", allowed=1e-8,
)  # fmt: skip
def a_billion_away() -> Found:
    return far_away(np.array([1e9, 0.7e9, -0.4e9]), 29)


def moved_back(scene: Scene, shift: Any) -> Scene:
    """The scene as meshes whose corners are those that float64 has for it, less the shift."""

    def back(mesh: Any) -> d.Mesh:
        s = mesh.shape
        return d.Mesh(vertices=mesh.vertices - shift, faces=mesh.faces, front=s.front, back=s.back, radiance=s.radiance)

    shapes = tuple(map(back, gather(scene.description.shapes)[0]))
    return Scene(replace(scene.description, shapes=shapes))
