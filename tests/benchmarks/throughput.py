"""Render throughput against the same rays in bare single-ray Embree calls from a C loop; and two threads against one.

    python tests/benchmarks/throughput.py

Prints ratios taken in one run, interleaved. Needs a C compiler (`cc`).
"""

from __future__ import annotations

import ctypes
import statistics
import subprocess
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import trimesh

from raylab import description as d
from raylab import samplers
from raylab.embree import TNEAR, library
from raylab.jit import njit
from raylab.packet import new_packet
from raylab.pixels import cached_accumulate, new_accumulator, view
from raylab.render import render
from raylab.scene import Scene
from raylab.strategies import strategy
from raylab.surface import TALLIES, intersect, round32
from raylab.vec3 import absolute, dot
from raylab.view import View

SIZE, SPP = 512, 16


def soft_shadow_scene(size: int = SIZE) -> Scene:
    """A ball of 82 k triangles on a floor under an area light: camera rays and shadow rays of all kinds."""
    grey = d.Diffuse(np.full(3, 0.5))
    ball = trimesh.creation.icosphere(subdivisions=6)
    floor = np.diag([10.0, 10.0, 1.0, 1.0])
    lamp = np.diag([1.0, -1.0, -1.0, 1.0])
    lamp[:3, 3] = (2.0, -1.0, 4.0)
    forward = np.array([0.0, 6.0, -2.2]) / np.hypot(6.0, 2.2)
    left = np.array([-1.0, 0.0, 0.0])
    to_world = np.eye(4)
    to_world[:3, :3] = np.stack([left, np.cross(forward, left), forward], axis=1)
    to_world[:3, 3] = (0.0, -6.0, 3.0)
    return Scene(
        d.SceneDescription(
            camera=d.Camera(to_world=to_world, fov=45.0, width=size, height=size),
            shapes=(
                d.Rectangle(to_world=floor, front=grey, back=grey),
                d.Mesh(vertices=ball.vertices + np.array([0, 0, 1]), faces=ball.faces, front=grey, back=grey),
                d.Rectangle(to_world=lamp, front=None, radiance=np.full(3, 8.0)),
            ),
            sampler="independent",
        )
    )


@njit
def record_rays(scene, camera, sampler, width, rows, spp, rays):
    """The camera and the shadow ray of each sample, as the kernel would trace them."""
    i = 0
    for row in range(rows[0], rows[1]):
        for column in range(width):
            for sample in range(spp):
                rng = sampler.stream(row * width + column, 0, sample)
                film, lens = camera.draw(rng)
                o, direction, tfar = camera.ray(column, row, film, lens, 0.0)
                put(rays, 2 * i, o, direction, tfar)
                rays[2 * i + 1, 7] = np.float32(-1.0)
                hit = intersect(scene, o, direction, 0.0, tfar)
                if hit.found and scene.shapes[hit.shape, 2] >= 0:
                    for light in scene.lights:
                        y, _ = light.sample(hit.x, rng.square())
                        to_light = y - hit.x
                        reach = y.slack + dot(y.tilt, absolute(to_light))
                        if dot(hit.x.n, to_light) > 0.0 and -dot(y.n, to_light) >= reach:
                            start = round32(hit.x.p + hit.x.n * hit.x.slack)
                            put(rays, 2 * i + 1, start, round32(y.p + y.n * reach - start), 1.0)
                i += 1


@njit
def put(rays, i, o, direction, tfar):
    rays[i, 0], rays[i, 1], rays[i, 2] = np.float32(o.x), np.float32(o.y), np.float32(o.z)
    rays[i, 3] = np.float32(TNEAR)
    rays[i, 4], rays[i, 5], rays[i, 6] = np.float32(direction.x), np.float32(direction.y), np.float32(direction.z)
    rays[i, 7] = np.float32(tfar)


def c_loop() -> ctypes.CDLL:
    """Compile bare_embree.c."""
    source = Path(__file__).with_name("bare_embree.c")
    target = Path(tempfile.mkdtemp()) / "bare_embree.so"
    subprocess.run(["cc", "-O3", "-march=native", "-shared", "-fPIC", str(source), "-o", str(target)], check=True)
    loop = ctypes.CDLL(str(target))
    loop.trace_all.restype = ctypes.c_int64
    return loop


def measure(work, threads: int) -> float:
    """Seconds for work(top, bottom) over all bands of rows."""
    bands = [(top, top + SIZE // 16) for top in range(0, SIZE, SIZE // 16)]
    start = time.perf_counter()
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(lambda band: work(*band), bands))
    return time.perf_counter() - start


def main(rounds: int = 7) -> dict[str, float]:
    scene = soft_shadow_scene()
    data, camera, shade = scene.data, scene.camera, strategy("area_diffuse", scene)
    loop, rtc = c_loop(), library()
    addresses = [ctypes.cast(getattr(rtc, name), ctypes.c_void_p) for name in ("rtcIntersect1", "rtcOccluded1")]
    rays = np.zeros((SIZE, SIZE * SPP * 2, 8), np.float32)
    for row in range(SIZE):
        record_rays(data, camera, samplers.make("independent", 0, SPP), SIZE, (row, row + 1), SPP, View(rays[row]))
    accumulator = new_accumulator(1, SIZE, SIZE)

    def bare(top: int, bottom: int) -> None:
        part = rays[top:bottom]
        loop.trace_all(*addresses, ctypes.c_void_p(scene.embree.handle), part.ctypes.data_as(ctypes.c_void_p),
                       ctypes.c_int64(part.size // 16))  # fmt: skip

    def raylab(top: int, bottom: int) -> None:
        tallied = data._replace(tally=View(np.zeros(TALLIES, np.int64)))
        sampler = samplers.make("independent", 0, SPP)
        cached_accumulate(
            tallied, camera, shade, sampler, new_packet(), view(accumulator), SIZE, SIZE, (top, bottom), (0, SPP)
        )

    raylab(0, 1)
    seconds: dict[str, list[float]] = {f"{name} {k}": [] for name in ("bare", "raylab") for k in (1, 2)}
    for _ in range(rounds):
        for name, work in (("bare", bare), ("raylab", raylab)):
            for k in (1, 2):
                seconds[f"{name} {k}"].append(measure(work, k))
    samples = SIZE * SIZE * SPP / 1e6
    median = {name: statistics.median(values) for name, values in seconds.items()}
    for name, value in median.items():
        print(f"{name} thread(s): {samples / value:6.2f} M samples/s (median of {rounds})")
    whole = render(scene, "area_diffuse", spp=SPP, threads=2).report["seconds"]["render"]
    print(f"render() on 2 threads: {samples / whole:6.2f} M samples/s")
    result = {
        "share of bare Embree, one thread": median["bare 1"] / median["raylab 1"],
        "share of bare Embree, two threads": median["bare 2"] / median["raylab 2"],
        "two threads against one": median["raylab 1"] / median["raylab 2"],
    }
    for name, value in result.items():
        print(f"{name}: {value:.2f}")
    return result


if __name__ == "__main__":
    main()
