"""Many lights: the time of a sample, by light and by all its lights, and the memory, for 100 to 100,000 small lamps.

    python tests/benchmarks/lights.py

The lamps hang at random over a floor, each with the same share of the same total power. `direct` samples one of them,
chosen by an alias table; what is left of their number is the cache and a deeper tree for the shadow rays.
"""

from __future__ import annotations

import resource
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from scenes import GREY, camera, moved

import raylab
from raylab import description as d

WIDTH, SPP = 128, 16


def lamps(n: int) -> raylab.Scene:
    """n spheres of one total power over a floor."""
    rng = np.random.default_rng(0)
    radius = 0.01 * np.sqrt(100.0 / n)
    places = rng.uniform((-3.0, -3.0, 1.5), (3.0, 3.0, 3.0), (n, 3))
    radiance = np.full(3, 60.0)
    floor = d.Rectangle(to_world=moved(0, 0, 0, 4, 4, 1), front=GREY, back=GREY)
    hung = tuple(d.Sphere(center=p, radius=radius, radiance=radiance, front=None) for p in places)
    return raylab.Scene(d.SceneDescription(camera=camera(WIDTH), shapes=(floor, *hung)))


def memory() -> float:
    """The most memory that this process has held, in MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1024.0 if sys.platform != "darwin" else 1024.0**2)


def main() -> None:
    print(f"{'lights':>8} {'load s':>8} {'ns a sample':>12} {'mean':>9} {'memory MB':>10}")
    for n in (100, 1_000, 10_000, 100_000):
        start = time.perf_counter()
        scene = lamps(n)
        loaded = time.perf_counter() - start
        raylab.render(scene, spp=1, threads=1)
        times = []
        for seed in range(5):
            image = raylab.render(scene, spp=SPP, threads=1, seed=seed, sampler="independent")
            times.append(image.report["seconds"]["render"])
        sample = np.median(times) / (WIDTH * WIDTH * SPP) * 1e9
        print(f"{n:8d} {loaded:8.2f} {sample:12.0f} {image.mean.mean():9.5f} {memory():10.0f}", flush=True)


if __name__ == "__main__":
    main()
