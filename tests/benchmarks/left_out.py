"""What it saves to leave out what a scene does not need: one picture by its own kernel, and by one that has all.

    python tests/benchmarks/left_out.py

The second scene is the first, and far behind the camera a little of everything: a glossy textured ball with smooth
normals, a sphere, a disk, lights of three more kinds and a dark sky image. The picture is the same.
"""

from __future__ import annotations

import statistics
from dataclasses import replace

import numpy as np
import trimesh
from throughput import soft_shadow_scene

from raylab import description as d
from raylab.render import render
from raylab.scene import Scene


def with_everything(scene: Scene) -> Scene:
    described = scene.description
    ball = trimesh.creation.icosphere(subdivisions=1)
    away = np.eye(4)
    away[:3, 3] = (0.0, -9.0, 0.05)
    away[:3, :3] *= 0.01
    image = d.Bitmap(np.full((4, 4, 3), 0.5))
    phong = d.Phong(image, np.full(3, 0.2), 20.0)
    normals = np.asarray(ball.vertex_normals)
    mesh = d.Mesh(vertices=ball.vertices, faces=ball.faces, normals=normals, front=phong, to_world=away)
    sky = np.zeros((4, 8, 3))
    sky[3] = 1e-9  # below the floor
    more = (mesh, d.Sphere(to_world=away), d.Disk(to_world=away))
    return Scene(replace(described, shapes=(*described.shapes, *more), environment=d.ImageEnvironment(sky)))


def main(rounds: int = 5) -> float:
    lean = soft_shadow_scene(256)
    full = with_everything(lean)
    seconds: dict[str, list[float]] = {"its own": [], "one that has all": []}
    for _ in range(rounds):
        for name, scene in (("its own", lean), ("one that has all", full)):
            seconds[name].append(render(scene, "area", spp=64, threads=1).report["seconds"]["render"])
    median = {name: statistics.median(values) for name, values in seconds.items()}
    for name, value in median.items():
        print(f"the same picture by {name} kernel: {value:.2f} s (median of {rounds})")
    ratio = median["one that has all"] / median["its own"]
    print(f"leaving out what the scene does not need: {ratio:.2f} times faster")
    return ratio


if __name__ == "__main__":
    main()
