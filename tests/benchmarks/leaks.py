"""How many rays slip out of a closed ball along the edges of its triangles, at rest and while it moves.

python tests/benchmarks/leaks.py [rays]
"""

from __future__ import annotations

import sys

import numpy as np
import trimesh

from raylab import samplers
from raylab.embree import EmbreeScene, trace
from raylab.jit import njit
from raylab.sampling import sample_sphere
from raylab.surface import round32
from raylab.vec3 import Vec3

STEP = (0.13, 0.07, -0.05)


def ball(subdivisions: int, moves: bool) -> EmbreeScene:
    """A ball of 20 * 4^subdivisions triangles around the origin, at rest or on its way to STEP."""
    mesh = trimesh.creation.icosphere(subdivisions, radius=0.4)
    n, scene = len(mesh.vertices), EmbreeScene()
    vertices = np.zeros((2 * n + 2, 3), np.float32)
    vertices[:n], vertices[n : 2 * n] = mesh.vertices, mesh.vertices + np.array(STEP)
    scene.add_mesh(vertices[: 2 * n] if moves else vertices[:n], mesh.faces.astype(np.uint32), int(moves))
    scene.commit()
    return scene


@njit
def escaped(handle, sampler, n):
    """Rays of all directions and times from points near the centre that meet nothing."""
    out = 0
    for i in range(n):
        rng = sampler.stream(0, 0, i)
        time = np.float64(np.float32(rng.number()))
        o = round32(Vec3(0.05 + 0.05 * rng.number(), 0.02, 0.01))
        geometry, _ = trace(handle, o, round32(sample_sphere(rng.square())), 0.0, 10.0, time)
        if geometry < 0:
            out += 1
    return out


def share(subdivisions: int, moves: bool, n: int) -> int:
    """How many of n rays escape."""
    scene = ball(subdivisions, moves)
    return int(escaped(scene.handle, samplers.make("independent", 1, n), n))


def main() -> None:
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 20_000_000
    for moves in (False, True):
        print(f"{'moving' if moves else 'at rest'}: {share(6, moves, n)} of {n} rays slip out of 81920 triangles")


if __name__ == "__main__":
    main()
