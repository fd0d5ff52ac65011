"""What a lens and motion cost: the same scene through a pinhole, an aperture, and while its ball moves, in turns.

python tests/benchmarks/blur.py
"""

from __future__ import annotations

import statistics
from dataclasses import replace

import numpy as np
from throughput import soft_shadow_scene

from raylab import description as d
from raylab.render import render
from raylab.scene import Scene

ROUNDS = 5


def with_lens(scene: Scene, blades: int = 0) -> Scene:
    """The scene through a thin lens, focused on its middle, a hundredth of the distance wide."""
    eye = scene.description.camera
    lens = replace(eye, aperture_radius=0.05, focus_distance=5.0, aperture_blades=blades)
    return Scene(replace(scene.description, camera=lens))


def with_motion(scene: Scene) -> Scene:
    """The scene while its ball, 82 k triangles, moves by a tenth of its size and the shutter is open."""
    floor, ball, lamp = scene.description.shapes
    there = np.eye(4)
    there[0, 3] = 0.2
    moving = replace(ball, motion=d.Animation(np.array([0.0, 1.0]), np.stack([np.eye(4), there])))
    eye = replace(scene.description.camera, shutter_close=1.0)
    return Scene(replace(scene.description, camera=eye, shapes=(floor, moving, lamp)))


def ratio(plain: Scene, blurred: Scene, shade: str = "area", spp: int = 64) -> float:
    """Median over ROUNDS of the time of `blurred` over the time of `plain`, rendered one after the other."""
    ratios = []
    for _ in range(ROUNDS):
        times = [render(s, shade, spp=spp, threads=1).report["seconds"]["render"] for s in (plain, blurred)]
        ratios.append(times[1] / times[0])
    return statistics.median(ratios)


def main() -> None:
    scene = soft_shadow_scene(256)
    print(f"depth of field costs {ratio(scene, with_lens(scene)):.2f} times the pinhole (round aperture)")
    print(f"depth of field costs {ratio(scene, with_lens(scene, 6)):.2f} times the pinhole (six blades)")
    print(
        f"motion blur costs {ratio(scene, with_motion(scene)):.2f} times the static render (a ball of 82 k triangles)"
    )


if __name__ == "__main__":
    main()
