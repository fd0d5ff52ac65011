"""A whole grading of right code, in a process of its own: `python -m mutants.grading` prints what it found as JSON.

The functions are those of `raylab.shade`, as a student hands them in: plain functions in a file, not compiled before.
"""

from __future__ import annotations

import importlib.util
import json
import multiprocessing
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

ASSIGNMENT = (  # claim, trial, technique, other arguments
    ("unbiased", "polygons", "area_diffuse", {}), ("unbiased", "polygons", "area", {}),
    ("unbiased", "round_lights", "area_diffuse", {}), ("unbiased", "points_and_suns", "point_light", {}),
    ("unbiased", "gradient_sky", "env_uniform", {}), ("unbiased", "gradient_sky", "env_cosine", {}),
    ("shrinks", "polygons", "area_diffuse", {}), ("independent", "polygons", "area_diffuse", {}),
    ("variance", "gradient_sky", "env_uniform", {}), ("variance", "gradient_sky", "env_cosine", {}),
    ("more_rays", "polygons", "area_diffuse", {}), ("same_mean", "polygons", "area_diffuse", {"other": "area"}),
    ("relation", "polygons", "area_diffuse", {"relation": "times_3"}),
    ("relation", "polygons", "area_diffuse", {"relation": "rotated"}),
    ("well_behaved", "polygons", "area_diffuse", {}),
)  # fmt: skip


def submission(folder: Path) -> Any:
    """A module with the slides' functions as a student writes them."""
    source = (Path(__file__).resolve().parents[2] / "raylab" / "shade.py").read_text()
    path = folder / "submission.py"
    path.write_text(source.replace("@njit\n", ""))
    spec = importlib.util.spec_from_file_location("submission", path)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def grade(token: str, trials: list[str]) -> list[Any]:
    """The claims in these trials; the budget is that of the token, whoever else spends of it."""
    from raylab.stats import Budget
    from raylab.testing import Examiner

    examiner, found = Examiner(Budget.replay(token), threads=1), []
    with tempfile.TemporaryDirectory() as folder:
        handed_in = submission(Path(folder))
        for claim, trial, technique, more in ASSIGNMENT:
            if trial in trials:
                shade = getattr(handed_in, technique)
                r = getattr(examiner, claim)(technique=technique, shade=shade, trial=trial, **more)
                found.append((r.name, r.outcome, r.samples, r.seconds, r.preparing))
    return found


def main() -> None:
    """Two processes share the trials."""
    from raylab.stats.budget import Budget

    start, token = time.perf_counter(), Budget().token
    shares = [["polygons"], sorted({trial for _, trial, _, _ in ASSIGNMENT} - {"polygons"})]
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
        claims = [claim for part in pool.map(grade, [token] * 2, shares) for claim in part]
    json.dump({"claims": claims, "seconds": time.perf_counter() - start, "token": token}, sys.stdout)


if __name__ == "__main__":
    main()
