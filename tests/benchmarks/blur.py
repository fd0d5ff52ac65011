"""What a lens and motion cost: three scenes, plain, through an aperture, and while something moves, in turns.

python tests/benchmarks/blur.py
"""

from __future__ import annotations

import statistics
from dataclasses import replace
from pathlib import Path

import numpy as np
from throughput import soft_shadow_scene

import raylab
from raylab import description as d
from raylab.render import render
from raylab.scene import Scene

ROUNDS = 25  # short pictures taken in turns: the speed of a shared machine changes within a second
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


def main() -> None:
    ball = soft_shadow_scene(256)
    cornell, lens, motion = (
        raylab.load(SCENES / name / "scene.xml") for name in ("cornell_box", "depth_of_field", "motion_blur")
    )
    for name, plain, blurred in (
        ("its own scene", pinhole(lens), lens),
        ("the Cornell box", cornell, with_lens(cornell)),
        ("a ball of 82 k triangles", ball, with_lens(ball)),
        ("that ball, six blades", ball, with_lens(ball, 6)),
    ):
        print(f"depth of field, {name}: {ratio(plain, blurred):.2f} times the pinhole", flush=True)
    for name, plain, blurred in (
        ("its own scene", frozen(motion), motion),
        ("the Cornell box, a box moves", cornell, with_motion(cornell, -2, (20.0, 0.0, 10.0))),
        ("a ball of 82 k triangles moves", ball, with_motion(ball, 1, (0.2, 0.0, 0.0))),
    ):
        print(f"motion blur, {name}: {ratio(plain, blurred):.2f} times the static render", flush=True)


if __name__ == "__main__":
    main()
