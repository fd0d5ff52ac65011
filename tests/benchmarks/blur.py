"""What a lens and motion cost: scenes plain, through an aperture, and while something moves, in turns.

    python tests/benchmarks/blur.py [lens|motion]

Each ratio is taken in several fresh processes, since where a process happens to lie in memory changes it by some
percent: the geometric mean, and in brackets each of them.
"""

from __future__ import annotations

import multiprocessing
import statistics
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from throughput import soft_shadow_scene

import raylab
from raylab import description as d
from raylab.render import render
from raylab.scene import Scene

ROUNDS = 15  # short pictures taken in turns: the speed of a shared machine changes within a second
PROCESSES = 5
SPP = 16
SCENES = Path(__file__).resolve().parents[2] / "reference_scenes"


def with_lens(scene: Scene, blades: int = 0) -> Scene:
    """The scene through a thin lens, focused on its middle, a hundredth of the distance wide."""
    camera = scene.description.camera
    distance = float(np.linalg.norm(np.asarray(camera.to_world)[:3, 3] - scene.placement.centre))
    lens = replace(camera, aperture_radius=distance / 100.0, focus_distance=distance, aperture_blades=blades)
    return Scene(replace(scene.description, camera=lens))


def with_motion(scene: Scene, shape: int, move: tuple[float, float, float]) -> Scene:
    """The scene while one of its shapes moves and the shutter is open."""
    shapes, there = list(scene.description.shapes), np.eye(4)
    there[:3, 3] = move
    shapes[shape] = replace(shapes[shape], motion=d.Animation(np.array([0.0, 1.0]), np.stack([np.eye(4), there])))
    camera = replace(scene.description.camera, shutter_close=1.0)
    return Scene(replace(scene.description, camera=camera, shapes=tuple(shapes)))


def pinhole(scene: Scene) -> Scene:
    return Scene(replace(scene.description, camera=replace(scene.description.camera, aperture_radius=0.0)))


def frozen(scene: Scene) -> Scene:
    """The scene at the instant at which the shutter opens."""
    camera = scene.description.camera
    return Scene(replace(scene.description, camera=replace(camera, shutter_close=camera.shutter_open)))


def ratio(plain: Scene, blurred: Scene) -> float:
    """Median over ROUNDS of the time of `blurred` over the time of `plain`; the first round warms up."""
    ratios = []
    for _ in range(ROUNDS + 1):
        times = [render(s, spp=SPP, threads=1).report["seconds"]["render"] for s in (plain, blurred)]
        ratios.append(times[1] / times[0])
    return statistics.median(ratios[1:])


def lens_scenes() -> dict[str, Callable[[], tuple[Scene, Scene]]]:
    """Pinhole and lens, by what is said of them."""

    def own() -> tuple[Scene, Scene]:
        scene = raylab.load(SCENES / "depth_of_field" / "scene.xml")
        return pinhole(scene), scene

    def cornell() -> tuple[Scene, Scene]:
        scene = raylab.load(SCENES / "cornell_box" / "scene.xml")
        return scene, with_lens(scene)

    def ball(blades: int = 0) -> tuple[Scene, Scene]:
        scene = soft_shadow_scene(256)
        return scene, with_lens(scene, blades)

    return {
        "its own scene": own, "the Cornell box": cornell, "a ball of 82 k triangles": ball,
        "that ball, six blades": partial(ball, 6),
    }  # fmt: skip


def motion_scenes() -> dict[str, Callable[[], tuple[Scene, Scene]]]:
    """Static and moving."""

    def own() -> tuple[Scene, Scene]:
        scene = raylab.load(SCENES / "motion_blur" / "scene.xml")
        return frozen(scene), scene

    def cornell() -> tuple[Scene, Scene]:
        scene = raylab.load(SCENES / "cornell_box" / "scene.xml")
        return scene, with_motion(scene, -2, (20.0, 0.0, 10.0))

    def ball() -> tuple[Scene, Scene]:
        scene = soft_shadow_scene(256)
        return scene, with_motion(scene, 1, (0.2, 0.0, 0.0))

    return {"its own scene": own, "the Cornell box, a box moves": cornell, "a ball of 82 k triangles moves": ball}


KINDS = {
    "lens": ("depth of field", "the pinhole", lens_scenes),
    "motion": ("motion blur", "the static render", motion_scenes),
}  # fmt: skip


def measure(kind: str, name: str) -> float:
    return ratio(*KINDS[kind][2]()[name]())


def main(kinds: Sequence[str] = tuple(KINDS)) -> None:
    for kind in kinds:
        what, base, scenes = KINDS[kind]
        for name in scenes():
            with ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), max_tasks_per_child=1) as fresh:
                found = list(fresh.map(measure, [kind] * PROCESSES, [name] * PROCESSES))
            each = ", ".join(f"{one:.2f}" for one in found)
            print(f"{what}, {name}: {statistics.geometric_mean(found):.3f} times {base} ({each})", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:] or tuple(KINDS))
