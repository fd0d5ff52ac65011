"""A million triangles: read from a binary PLY, built, and measured in bytes.

python tests/benchmarks/million.py
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import trimesh

SCENE = """<scene version="3.0.0">
    <integrator type="direct"/>
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="0,-3,3" target="0,0,0" up="0,0,1"/></transform>
        <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film>
    </sensor>
    <shape type="ply"><string name="filename" value="million.ply"/></shape>
    <emitter type="constant"/>
</scene>"""

PROBE = """
import resource, sys, time
from pathlib import Path
import raylab
raylab.load(sys.argv[1])  # a small scene first: libraries are loaded, and counted as none of its memory
def resident():
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()
before, start = resident(), time.perf_counter()
scene = raylab.load(sys.argv[2])
print(time.perf_counter() - start, scene.triangles, resident() - before)
"""


def write_grid(path: Path, side: int) -> None:
    """A wavy square of 2 side^2 triangles."""
    x, y = np.meshgrid(np.linspace(-1, 1, side + 1), np.linspace(-1, 1, side + 1), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), 0.05 * np.sin(20 * x.ravel()) * np.cos(17 * y.ravel())])
    corner = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    faces = np.concatenate([np.stack([corner, corner + side + 1, corner + side + 2], axis=1),
                            np.stack([corner, corner + side + 2, corner + 1], axis=1)])  # fmt: skip
    trimesh.Trimesh(vertices, faces, process=False).export(path)


def main() -> dict[str, float]:
    with tempfile.TemporaryDirectory() as folder:
        small, large = Path(folder) / "small", Path(folder) / "large"
        for place, side in ((small, 4), (large, 708)):
            place.mkdir()
            write_grid(place / "million.ply", side)
            (place / "scene.xml").write_text(SCENE)
        command = [sys.executable, "-c", PROBE, str(small / "scene.xml"), str(large / "scene.xml")]
        out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    seconds, triangles, memory = (float(word) for word in out.split())
    print(f"{triangles:.0f} triangles from PLY, read and built: {seconds:.2f} s, {memory / triangles:.0f} bytes each")
    return {"seconds": seconds, "bytes": memory / triangles}


if __name__ == "__main__":
    main()
