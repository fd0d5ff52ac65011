"""The naked ladder, which dies of a task called `hang`."""

from __future__ import annotations

import os
import runpy
from pathlib import Path

naked = runpy.run_path(str(Path(__file__).with_name("naked.py")))


def climb(source, tasks, **_):
    if any(task["id"] == "hang" for task in tasks):
        os._exit(1)
    return naked["climb"](source, tasks)
