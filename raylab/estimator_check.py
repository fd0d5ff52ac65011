"""Estimator check: what is wrong with a shade() before any statistics, said by name.

The function runs in plain Python, in a process of its own with a time limit: so it can be watched while it runs, and
cannot hang or harm the one that asks. `check` calls it some dozens of times in a trial and looks at what it returns,
what it does to its arguments, and where its random numbers come from.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

SECONDS = 20.0  # for `CALLS` calls in plain Python, which take a hundredth of that
CALLS = 48
KINDS = {
    "type": "returns the wrong type",
    "shape": "returns the wrong shape",
    "nan": "returns NaN or infinity",
    "negative": "returns negative light",
    "bound": "returns more than one sample of this technique can be",
    "mutation": "changes its arguments",
    "state": "keeps state between calls",
    "global random": "uses a random generator of its own, not rng",
    "time limit": "does not return",
    "error": "raises an exception",
}


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong, one of KINDS, and what was seen."""

    kind: str
    seen: str

    def __str__(self) -> str:
        return f"{KINDS[self.kind]}: {self.seen}"


def check(
    shade: Callable[..., Any], technique: str, trial: str = "polygons", *, seed: int = 0, seconds: float = SECONDS
) -> list[Finding]:
    """What is wrong with `shade` in a trial of `technique`; [] when nothing is.

    The child process imports the file in which the function is written, as far as its definition, without the
    compiler. Raises OSError when there is no such file (a function typed at the prompt).
    """
    import inspect

    function = getattr(shade, "py_func", shade)
    source = inspect.getsourcefile(function)
    if source is None or not Path(source).is_file():
        raise OSError(f"shade {function.__name__!r} is not in a file, so that no other process can run it")
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder, "findings.json")
        task = {
            "file": source, "name": function.__qualname__, "technique": technique, "trial": trial, "seed": seed,
            "answer": str(answer),
        }  # fmt: skip
        environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONDONTWRITEBYTECODE": "1"}
        environment["PYTHONPATH"] = os.pathsep.join(p for p in (str(Path(source).parent), *sys.path) if p)
        command = [sys.executable, "-W", "ignore", "-m", "raylab.estimator_watch", json.dumps(task)]
        try:
            done = subprocess.run(command, env=environment, timeout=seconds, capture_output=True, text=True)
        except subprocess.TimeoutExpired:
            return [Finding("time limit", f"{CALLS} calls were not done in {seconds:g} s")]
        if not answer.is_file():
            last = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
            return [Finding("error", last)]
        return [Finding(kind, seen) for kind, seen in json.loads(answer.read_text())]
