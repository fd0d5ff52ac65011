"""Render speed of this checkout against an older commit: what a scene does not need must not cost it anything.

    python tests/benchmarks/against.py COMMIT [--rounds 15]

The older package is taken out of git. Both render the same pictures in turn; the ratio is of the least times,
which other work on the machine disturbs least.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
CASES = (("soft_shadows", "area_diffuse"), ("cornell_box", "direct"), ("ball_under_sky", "direct"))
CHILD = """
import json, sys
import raylab
scenes = {}
for line in sys.stdin:
    name, shade, seed = json.loads(line)
    if name not in scenes:
        scenes[name] = raylab.load(f"{sys.argv[1]}/reference_scenes/{name}/scene.xml", {"width": 256, "height": 256})
    image = raylab.render(scenes[name], shade, sampler="sobol", spp=64, seed=seed)
    print(json.dumps([image.report["seconds"]["render"], float(image.mean.mean())]), flush=True)
"""


class Checkout:
    """A process that renders with the package in a folder."""

    def __init__(self, folder: Path) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-c", CHILD, str(ROOT)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
            cwd=folder, env=dict(os.environ, PYTHONPATH=str(folder)),
        )  # fmt: skip

    def render(self, name: str, shade: str, seed: int) -> tuple[float, float]:
        """Seconds and mean radiance."""
        assert self.process.stdin
        assert self.process.stdout
        self.process.stdin.write(json.dumps([name, shade, seed]) + "\n")
        self.process.stdin.flush()
        seconds, mean = json.loads(self.process.stdout.readline())
        return seconds, mean

    def close(self) -> None:
        self.process.communicate()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commit")
    parser.add_argument("--rounds", type=int, default=15)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        archive = subprocess.run(
            ["git", "archive", options.commit, "raylab"], cwd=ROOT, check=True, capture_output=True
        ).stdout
        with tarfile.open(fileobj=io.BytesIO(archive)) as files:
            files.extractall(folder, filter="data")
        old, new = Checkout(Path(folder)), Checkout(ROOT)
        for case in CASES:
            compare(old, new, case, options)
        old.close()
        new.close()


def compare(old: Checkout, new: Checkout, case: tuple[str, str], options: argparse.Namespace) -> None:
    pairs = []
    for seed in range(options.rounds + 1):
        (before, first), (now, second) = old.render(*case, seed), new.render(*case, seed)
        if seed > 0:
            pairs.append((before, now))
    before, now = (min(p[k] for p in pairs) for k in (0, 1))
    same = "the same mean" if first == second else f"means {first!r} and {second!r}"
    print(
        f"{case[0]}, {case[1]}: {before * 1e3:.0f} ms at {options.commit}, {now * 1e3:.0f} ms here: "
        f"{before / now:.3f} times as fast ({same})",
        flush=True,
    )


if __name__ == "__main__":
    main()
