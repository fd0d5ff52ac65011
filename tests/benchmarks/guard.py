"""What the guard costs: bounds on roundings, offsets and the test of every ray, against the usual code without them.

    python tests/benchmarks/guard.py [--rounds 15]

The usual code is this package with tnear = 1e-4, shadow rays from point to point that end at 1 - 1e-4, and no test
whether a ray is one; both render the same pictures in turns. At most 12 % more time is promised. As where a process
happens to lie in memory changes its speed by some percent, each ratio, a median over the rounds, is taken in several
pairs of fresh processes: their geometric mean, and in brackets each of them.
"""

from __future__ import annotations

import argparse
import shutil
import statistics
import tempfile
from pathlib import Path

from against import CASES, ROOT, Checkout

PROCESSES = 5
EDITS = {  # file -> what is taken out, and what stands there then
    "surface.py": {"return reach > 0.0 and size32(o) + reach < math.inf": "return True"},
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


def ratios(bare_folder: Path, rounds: int) -> list[float]:
    """The time with the guard over that without, of each case, by two fresh processes; the means must agree."""
    bare, guarded, found = Checkout(bare_folder), Checkout(ROOT), []
    for case in CASES:
        pairs = [(bare.render(*case, seed), guarded.render(*case, seed)) for seed in range(rounds + 1)][1:]
        without, with_guard = (statistics.fmean(pair[k][1] for pair in pairs) for k in (0, 1))
        assert abs(with_guard - without) < 1e-3 * without, f"{case[0]}: mean radiance {without} and {with_guard}"
        found.append(statistics.median(pair[1][0] / pair[0][0] for pair in pairs))
    bare.close()
    guarded.close()
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        without_guard(Path(folder))
        found = list(zip(*(ratios(Path(folder), options.rounds) for _ in range(PROCESSES)), strict=True))
    for case, each in zip(CASES, found, strict=True):
        listed = ", ".join(f"{one:.2f}" for one in each)
        print(f"{case[0]}, {case[1]}: {statistics.geometric_mean(each):.3f} times the time without ({listed})")


if __name__ == "__main__":
    main()
