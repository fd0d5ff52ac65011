"""Goal: the reference picture of an assignment's starter scene, kept as numbers.

With it a student's picture can be compared where the solution is not. One file `variants/SCENE.npz` in the folder of
an assignment: the mean of each pixel, and how much the techniques of its tasks scatter.

    python -m raylab.grading.goal a1        renders it anew
"""

from __future__ import annotations

import hashlib
import re
from pathlib import Path
from typing import Any

import numpy as np

from raylab.grading.assignment import Assignment
from raylab.scene import Scene
from raylab.study.compare import Reference, side_of, tile_errors
from raylab.submission.task import Task

SAMPLES, SCATTERED = 1024, 1024  # per pixel: of the reference; of each technique
# The same light by a technique with less noise; other techniques are their own best.
BEST = {
    "area_diffuse": "area_solid_angle", "area": "area_solid_angle", "env_uniform": "mis_balance",
    "env_cosine": "mis_balance", "env_brdf": "mis_balance", "env_brightness": "mis_balance",
}  # fmt: skip
SIZED = re.compile(r'(<default name="spp" value=")[^"]*')


def fingerprint(scene: Path) -> str:
    """Of a scene's text, whatever its number of samples and its line ends."""
    text = SIZED.sub(r"\1", scene.read_text("utf-8"))
    return hashlib.sha256(text.encode("utf-8")).hexdigest()[:32]


def path_of(folder: Path, scene: str) -> Path:
    return folder / "variants" / f"{Path(scene).stem}.npz"


def stored(assignment: Assignment, task: Task, scene: Path, parameters: set[str]) -> Reference | None:
    """The reference of a scene file, if it is the assignment's own in its own size."""
    name = assignment.scenes.get(task.id, "")
    path = path_of(assignment.folder, name)
    if not name or parameters - {"spp"} or not (path.is_file() and scene.is_file()):
        return None
    with np.load(path, allow_pickle=False) as z:
        if str(z["fingerprint"]) != fingerprint(scene):
            return None
        mean, deviation = z["mean"].astype(float), z[f"deviation.{task.id}"].astype(float)
        return Reference(mean, z["error"].astype(float), deviation, float(z["noise"]), str(z["source"]))


def make(assignment: Assignment, scene: str) -> None:
    """Render the reference, and how each technique scatters."""
    import raylab

    path = assignment.folder / scene
    loaded: Scene = raylab.load(path)
    tasks = [t for t in assignment.tasks if assignment.scenes.get(t.id) == scene]
    best = BEST.get(tasks[0].like, tasks[0].like)
    image = raylab.render(loaded, best, sampler="sobol", spp=SAMPLES, seed=1)
    side = side_of(image.mean.shape[1])
    arrays: dict[str, Any] = {
        "mean": image.mean.astype(np.float16), "error": tile_errors(image.standard_error, side).astype(np.float32),
        "noise": np.sqrt(np.mean(image.standard_error**2)), "fingerprint": fingerprint(path),
        "source": f"{best}, {SAMPLES} samples per pixel",
    }  # fmt: skip
    for task in tasks:
        scattered = raylab.render(loaded, task.like, sampler="independent", spp=SCATTERED, seed=2)
        deviation = tile_errors(scattered.standard_error, side) * np.sqrt(SCATTERED)
        arrays[f"deviation.{task.id}"] = deviation.astype(np.float32)
    np.savez_compressed(path_of(assignment.folder, scene), **arrays)


def main(names: list[str]) -> None:
    """Make the pictures of assignments anew."""
    from raylab.grading.assignment import load

    for name in names:
        assignment = load(name)
        for scene in dict.fromkeys(assignment.scenes.values()):
            make(assignment, scene)


if __name__ == "__main__":
    import sys

    main(sys.argv[1:])
