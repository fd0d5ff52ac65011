"""Mean squared error at equal time, raylab against Mitsuba 3 (`llvm_ad_rgb`, `direct`) with each of its samplers.

    python tests/benchmarks/equal_time.py [--mitsuba-python PYTHON] [--scenes soft_shadows cornell_box]

Both render the same file at the same size in one run, picture by picture in turn, each after a first picture that is
not counted (compilation). Times are medians. Each ratio is a geometric mean over raylab's three times, at which
Mitsuba's curve is read off; behind it stand the three. The truth is the mean of a long picture of each, so a systematic
difference between the two would hurt both alike. Mitsuba needs an LLVM library: set DRJIT_LIBLLVM_PATH where it does
not find one.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import raylab

SCENES = Path(__file__).parents[2] / "reference_scenes"
SAMPLES = (16, 64, 256)
SAMPLERS = ("independent", "stratified", "multijitter", "orthogonal", "ldsampler")
SIZE = 256

REPEATS = 7

MITSUBA = r"""
import json, re, sys, time
from pathlib import Path
import drjit as dr, mitsuba as mi, numpy as np
mi.set_variant("llvm_ad_rgb")
path, out, size = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
mi.file_resolver().append(str(path.parent))
scenes = {}
for line in sys.stdin:
    sampler, count, seed = json.loads(line)
    if (sampler, count) not in scenes:
        text = re.sub(r'<sampler type="\w+">', f'<sampler type="{sampler}">', path.read_text())
        scenes[sampler, count] = mi.load_string(text, width=size, height=size, spp=str(count))
    scene = scenes[sampler, count]
    start = time.perf_counter()
    image = mi.render(scene, seed=seed)
    dr.eval(image); dr.sync_thread()
    seconds = time.perf_counter() - start
    np.save(out, np.array(image)[..., :3])
    print()  # Mitsuba's own messages may have left a line open
    print(json.dumps([int(scene.sensors()[0].sampler().sample_count()), seconds]), flush=True)
"""


class Mitsuba:
    """A process that renders one scene with Mitsuba, picture by picture."""

    def __init__(self, python: str, scene: Path, folder: str) -> None:
        self.out = Path(folder) / "mitsuba.npy"
        environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
        self.process = subprocess.Popen(
            [python, "-c", MITSUBA, str(scene), str(self.out), str(SIZE)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment,
        )  # fmt: skip

    def render(self, sampler: str, count: int, seed: int) -> tuple[np.ndarray, int, float]:
        """The picture, its samples per pixel and its seconds."""
        assert self.process.stdin
        assert self.process.stdout
        self.process.stdin.write(json.dumps([sampler, count, seed]) + "\n")
        self.process.stdin.flush()
        lines = iter(self.process.stdout.readline, "")
        spp, seconds = json.loads(next(line for line in lines if line.startswith("[")))
        return np.load(self.out).astype(np.float64), spp, seconds

    def close(self) -> None:
        self.process.communicate()


def raylab_render(scene: raylab.Scene, spp: int, seed: int) -> tuple[np.ndarray, int, float]:
    image = raylab.render(scene, sampler="sobol", spp=spp, seed=seed)
    return image.mean, spp, image.report["seconds"]["render"]


def at_time(curve: dict[float, float], seconds: float) -> float:
    """The mean squared error of a curve {seconds: error} at a time: lines in log-log, the outer ones prolonged."""
    times = np.log(sorted(curve))
    errors = np.log([curve[t] for t in sorted(curve)])
    k = int(np.clip(np.searchsorted(times, np.log(seconds)), 1, len(times) - 1))
    slope = (errors[k] - errors[k - 1]) / (times[k] - times[k - 1])
    return float(np.exp(errors[k] + slope * (np.log(seconds) - times[k])))


def compare(python: str, name: str) -> dict[str, float]:
    path = SCENES / name / "scene.xml"
    scene = raylab.load(path, {"width": SIZE, "height": SIZE})
    with tempfile.TemporaryDirectory() as folder:
        mitsuba = Mitsuba(python, path, folder)
        print(f"{name}: a long picture by each ...", flush=True)
        long = [mitsuba.render("multijitter", 256, 100 + k)[0] for k in range(16)]
        truth = (np.mean(long, axis=0) + raylab.render(scene, sampler="sobol", spp=4096, seed=1000).mean) / 2
        renderers = {("raylab", spp): partial(raylab_render, scene, spp) for spp in SAMPLES}
        for sampler in SAMPLERS:
            renderers |= {(sampler, spp): partial(mitsuba.render, sampler, spp) for spp in SAMPLES}
        curves = measure(renderers, truth)
        mitsuba.close()
    ours, result = curves.pop("raylab"), {}
    for sampler, curve in curves.items():
        ratios = [ours[t] / at_time(curve, t) for t in ours]
        result[sampler] = float(np.exp(np.mean(np.log(ratios))))
        points = ", ".join(f"{r:.2f}" for r in ratios)
        print(f"{name}: raylab / Mitsuba {sampler}, mean squared error at equal time: {result[sampler]:.2f} ({points})")
    return result


def measure(renderers: dict[tuple[str, int], Any], truth: np.ndarray) -> dict[str, dict[float, float]]:
    """{name: {seconds: mean squared error}}, the renderers taking turns."""
    runs: dict[tuple[str, int], list[tuple[float, float]]] = {key: [] for key in renderers}
    spp = {}
    for repeat in range(REPEATS + 1):
        print(f"  round {repeat} of {REPEATS} ...", flush=True)
        for key, draw in renderers.items():
            picture, spp[key], seconds = draw(repeat)
            if repeat > 0:
                runs[key].append((seconds, float(np.mean((picture - truth) ** 2))))
    curves: dict[str, dict[float, float]] = {}
    for key, pairs in runs.items():
        seconds, error = float(np.median([p[0] for p in pairs])), float(np.mean([p[1] for p in pairs]))
        curves.setdefault(key[0], {})[seconds] = error
        print(f"  {key[0]:12s} {spp[key]:5d} spp  {seconds:7.3f} s  mean squared error {error:.3e}")
    return curves


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mitsuba-python", default=sys.executable)
    parser.add_argument("--scenes", nargs="+", default=["soft_shadows", "cornell_box"])
    options = parser.parse_args()
    for name in options.scenes:
        compare(options.mitsuba_python, name)


if __name__ == "__main__":
    main()
