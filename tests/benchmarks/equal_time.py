"""Mean squared error at equal time, raylab against Mitsuba 3 (`llvm_ad_rgb`, `direct`) with each of its samplers.

    python tests/benchmarks/equal_time.py [--mitsuba-python PYTHON] [--scenes soft_shadows cornell_box]

Both render the same file at the same size in one run, first Mitsuba, then raylab; on a machine with other work the
ratio means little. Each ratio is a geometric mean over the times at which both have been measured; the lines above it
give each of them. Compilation is not counted. The truth is the mean of a
long picture of each, so a systematic difference between the two would hurt both alike. Mitsuba needs an LLVM library:
set DRJIT_LIBLLVM_PATH where it does not find one.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import raylab

SCENES = Path(__file__).parents[2] / "reference_scenes"
SAMPLES = (16, 64, 256)
SAMPLERS = ("independent", "stratified", "multijitter", "orthogonal", "ldsampler")
SIZE = 256

MITSUBA = r"""
import json, re, sys, time
from pathlib import Path
import drjit as dr, mitsuba as mi, numpy as np
mi.set_variant("llvm_ad_rgb")
path, out = Path(sys.argv[1]), sys.argv[2]
size, samplers, counts, long = map(json.loads, sys.argv[3:7])
mi.file_resolver().append(str(path.parent))
pictures, rows = {}, []
def load(sampler, count):
    text = re.sub(r'<sampler type="\w+">', f'<sampler type="{sampler}">', path.read_text())
    return mi.load_string(text, width=str(size), height=str(size), spp=str(count))
def shoot(scene, seed, spp=0):
    start = time.perf_counter()
    image = mi.render(scene, seed=seed, spp=spp)
    dr.eval(image); dr.sync_thread()
    seconds = time.perf_counter() - start
    return np.array(image)[..., :3], seconds
for sampler in samplers:
    for count in counts:
        scene = load(sampler, count)
        shoot(scene, 0)
        for repeat in range(5):
            image, seconds = shoot(scene, repeat + 1)
            pictures[f"{sampler} {count} {repeat}"] = image
            rows.append([sampler, int(scene.sensors()[0].sampler().sample_count()), count, repeat, seconds])
scene = load("multijitter", 256)
pictures["long"] = np.mean([shoot(scene, 100 + k)[0].astype(np.float64) for k in range(long)], axis=0)
np.savez(out, rows=json.dumps(rows), **pictures)
"""


def mitsuba_rows(python: str, scene: Path, long: int) -> tuple[list, dict[str, np.ndarray]]:
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "mitsuba.npz")
        arguments = [str(scene), out, str(SIZE), json.dumps(SAMPLERS), json.dumps(SAMPLES), json.dumps(long)]
        environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
        subprocess.run([python, "-c", MITSUBA, *arguments], check=True, env=environment)
        with np.load(out) as data:
            return json.loads(str(data["rows"])), {name: data[name] for name in data.files if name != "rows"}


def at_time(curve: dict[float, float], seconds: float) -> float:
    """The mean squared error of a curve {seconds: error} at a time, along straight lines in log-log."""
    times = sorted(curve)
    return float(np.exp(np.interp(np.log(seconds), np.log(times), np.log([curve[t] for t in times]))))


def compare(python: str, name: str) -> dict[str, float]:
    path = SCENES / name / "scene.xml"
    print(f"{name}: Mitsuba renders ...", flush=True)
    rows, pictures = mitsuba_rows(python, path, long=16)
    scene = raylab.load(path, {"width": SIZE, "height": SIZE})
    print(f"{name}: raylab renders ...", flush=True)
    long = raylab.render(scene, sampler="sobol", spp=4096, seed=1000).mean
    truth = (long + pictures["long"]) / 2
    ours: dict[float, float] = {}
    for spp in (*SAMPLES, 4 * SAMPLES[-1]):
        images = [raylab.render(scene, sampler="sobol", spp=spp, seed=k) for k in range(5)]
        seconds = float(np.median([i.report["seconds"]["render"] for i in images]))
        ours[seconds] = float(np.mean([np.mean((i.mean - truth) ** 2) for i in images]))
        print(f"  raylab sobol {spp:5d} spp  {seconds:7.3f} s  mean squared error {ours[seconds]:.3e}")
    theirs: dict[str, dict[float, float]] = {}
    for sampler in SAMPLERS:
        curve = theirs.setdefault(sampler, {})
        for count in SAMPLES:
            some = [row for row in rows if row[0] == sampler and row[2] == count]
            seconds = float(np.median([row[4] for row in some]))
            errors = [np.mean((pictures[f"{sampler} {count} {row[3]}"] - truth) ** 2) for row in some]
            curve[seconds] = float(np.mean(errors))
            print(f"  Mitsuba {sampler} {some[0][1]:5d} spp  {seconds:7.3f} s  mean squared error {curve[seconds]:.3e}")
    result = {}
    for sampler, curve in theirs.items():
        shared = [t for t in ours if min(curve) <= t <= max(curve)] or [min(max(min(ours), min(curve)), max(ours))]
        result[sampler] = float(np.exp(np.mean([np.log(ours[t] / at_time(curve, t)) for t in shared if t in ours])))
        print(f"{name}: raylab / Mitsuba {sampler}, mean squared error at equal time: {result[sampler]:.2f}")
    return result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mitsuba-python", default=sys.executable)
    parser.add_argument("--scenes", nargs="+", default=["soft_shadows", "cornell_box"])
    options = parser.parse_args()
    for name in options.scenes:
        compare(options.mitsuba_python, name)


if __name__ == "__main__":
    main()
