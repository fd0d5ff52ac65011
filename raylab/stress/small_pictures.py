"""Small pictures: a little scene of dyadic coordinates, at any power of two; one by any number of threads."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.render import render
from raylab.scene import Scene
from raylab.stress.case import Found, case
from raylab.stress.leaving import GREY, placed
from raylab.stress.nearness import over_a_floor
from raylab.stress.nearness import placed as square
from raylab.stress.shadow_rays import USUAL, floor_and_light, random_pairs, usually_blocked

Array = npt.NDArray[Any]


def little_scene(scale: float, shift: float, width: int = 12) -> Scene:
    """A floor, a cube on it and a light, of dyadic coordinates, seen by a camera."""

    def world(*rows: Any) -> Array:
        whole = np.diag([scale, scale, scale, 1.0])
        whole[:3, 3] = shift * scale
        moved: Array = whole @ np.array([*rows, [0, 0, 0, 1]], float)
        return moved

    eye = world([-1, 0, 0, 0], [0, 0, 1, -4], [0, 1, 0, 1])
    eye[:3, :3] /= scale
    camera = d.Camera(to_world=eye, fov=50.0, near_clip=0.125 * scale, far_clip=64 * scale, width=width, height=width)
    floor = d.Rectangle(to_world=world([4, 0, 0, 0], [0, 4, 0, 0], [0, 0, 1, 0]), front=GREY, back=GREY)
    cube = d.Cube(to_world=world([0.5, 0, 0, 0.5], [0, 0.5, 0, 0.5], [0, 0, 0.5, 0.5]), front=GREY)
    lamp = world([1, 0, 0, -1], [0, -1, 0, -1], [0, 0, -1, 3])
    light = d.Rectangle(to_world=lamp, radiance=np.full(3, 4.0), front=None)
    return Scene(d.SceneDescription(camera=camera, shapes=(floor, cube, light)))


def picture(scene: Scene) -> Array:
    return render(scene, "area", spp=2, seed=3, threads=1).mean


@case(
    "A10", "scene times 2^k, k = -60 to 60", usual=USUAL, rule="scaling by 2^k is exact", truth="the picture of k = 0",
    unit="scales at which a bit changes (usual code: the verdict of a shadow ray)", limit=60.0,
)  # fmt: skip
def powers_of_two() -> Found:
    plain, pairs = picture(little_scene(1.0, 0.0)), random_pairs(23, 500)
    still = usually_blocked(floor_and_light(np.eye(4)), *pairs)
    ours = theirs = 0
    for k in range(-60, 61):
        ours += not np.array_equal(picture(little_scene(2.0**k, 0.0)), plain)
        theirs += not np.array_equal(usually_blocked(floor_and_light(placed(2.0**k)), *pairs), still)
    if not plain.max() > 0.1:
        raise AssertionError("the picture is black")
    return Found(ours, theirs)


@case(
    "F10", "a picture by one thread and by two, in bands of 1, 3 and 16 rows", usual="one generator, tile after tile",
    rule="numbers depend on seed, pixel, stream, sample and dimension alone", truth="the same picture, bit by bit",
    unit="pixels of 256 that differ", allowed=0.0, limit=60.0,
)  # fmt: skip
def threads_and_tiles() -> Found:
    eye = np.diag([1.0, -1.0, -1.0, 1.0])  # at the height 2, looking down
    eye[2, 3] = 2.0
    shapes = over_a_floor(square(0, 0, 3, 1, 1, -1)).description.shapes
    scene = Scene(d.SceneDescription(camera=d.Camera(eye, width=16, height=16), shapes=shapes))
    pictures = [render(scene, "area", spp=4, threads=t, band_rows=b).mean for t, b in ((1, 16), (2, 1), (2, 3))]
    rng, tiles = np.random.default_rng, np.arange(256).reshape(16, 16)
    usual = int((rng(1).random(256)[tiles] != rng(1).random(256)[tiles.T]).sum())
    return Found(sum(int((p != pictures[0]).any(axis=2).sum()) for p in pictures[1:]), usual)
