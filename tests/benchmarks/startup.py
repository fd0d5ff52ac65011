"""Time to the first picture in a fresh process, with nothing cached and again; and what `import raylab` adds.

python tests/benchmarks/startup.py
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SCENE = Path(__file__).parents[2] / "reference_scenes" / "cs667_triangle_normal" / "scene.xml"
NUMBA = "import numba, numpy"


def seconds(arguments: list[str], cache: str) -> float:
    """Wall time of a fresh Python process whose cache folder is `cache`."""
    start = time.perf_counter()
    environment = dict(os.environ, XDG_CACHE_HOME=cache)
    subprocess.run([sys.executable, *arguments], check=True, env=environment, capture_output=True)
    return time.perf_counter() - start


def main() -> dict[str, float]:
    result = {}
    with tempfile.TemporaryDirectory() as folder:
        for suffix in ("npz", "png"):
            cache = str(Path(folder) / suffix)
            picture = str(Path(folder) / f"picture.{suffix}")
            render = ["-m", "raylab.cli", "render", str(SCENE), "--spp", "16", "-o", picture]
            result[f"first picture, nothing cached (.{suffix})"] = seconds(render, cache)
            again = statistics.median(seconds(render, cache) for _ in range(5))
            result[f"again, median of 5 (.{suffix})"] = again
        imports = {"import numba, numpy": [], "import raylab": []}
        for _ in range(7):
            for name in imports:
                imports[name].append(seconds(["-c", f"{NUMBA}; {name}"], folder))
        median = {name: statistics.median(values) for name, values in imports.items()}
        result["import raylab, more than numba and numpy"] = median["import raylab"] - median["import numba, numpy"]
    for name, value in result.items():
        print(f"{name}: {value:.2f} s")
    return result


if __name__ == "__main__":
    main()
