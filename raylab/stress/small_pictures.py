"""Small pictures: a little scene of dyadic coordinates, at any power of two."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.render import render
from raylab.scene import Scene
from raylab.stress.case import Found, case
from raylab.stress.leaving import GREY, placed
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
