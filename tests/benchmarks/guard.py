"""What the guard costs: bounds on roundings, offsets and the test of every ray, against the usual code without them.

    python tests/benchmarks/guard.py [--rounds 15]

The usual code is this package with tnear = 1e-4, shadow rays from point to point that end at 1 - 1e-4, and no test
whether a ray is one; both render the same pictures in turns. At most 12 % more time is promised.
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
from pathlib import Path

from against import CASES, ROOT, Checkout

EDITS = {  # file -> what is taken out, and what stands there then
    "surface.py": {"return dd > 0.0 and dot(o, o) + dd < math.inf": "return True"},
    "embree.py": {"TNEAR = 2.0**-100": "TNEAR = 1e-4"},
    "shadow.py": {
        "reach = y.slack + dot(y.tilt, absolute(d))": "reach = 0.0",
        "origin = round32(x.p + x.n * x.slack)": "origin = round32(x.p)",
        "round32(y.p + y.n * reach - origin), 1.0)": "round32(y.p - origin), 1.0 - 1e-4)",
        "round32(x.p + x.n * x.slack), direction32(w)": "round32(x.p), round32(w)",
        "if not (is_valid_ray(o, d) and tfar > 0.0):": "if not is_valid_ray(o, d):",
    },
}


def without_guard(folder: Path) -> None:
    """A copy of the package with the edits; each must fit."""
    shutil.copytree(ROOT / "raylab", folder / "raylab", ignore=shutil.ignore_patterns("__pycache__"))
    for name, edits in EDITS.items():
        path = folder / "raylab" / name
        text = path.read_text()
        for old, new in edits.items():
            assert text.count(old) == 1, f"{name}: {old!r}"
            text = text.replace(old, new)
        path.write_text(text)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        without_guard(Path(folder))
        bare, guarded = Checkout(Path(folder)), Checkout(ROOT)
        for case in CASES:
            pairs = [(bare.render(*case, seed), guarded.render(*case, seed)) for seed in range(options.rounds + 1)][1:]
            least = [min(pair[k][0] for pair in pairs) for k in (0, 1)]
            means = [sum(pair[k][1] for pair in pairs) / len(pairs) for k in (0, 1)]
            print(
                f"{case[0]}, {case[1]}: {least[0] * 1e3:.0f} ms without, {least[1] * 1e3:.0f} ms with the guard: "
                f"{least[1] / least[0]:.3f} times (mean radiance {means[0]:.6f} and {means[1]:.6f})",
                flush=True,
            )
        bare.close()
        guarded.close()


if __name__ == "__main__":
    main()
