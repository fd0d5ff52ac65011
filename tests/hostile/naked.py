"""A ladder without any wall: it runs a submission as ordinary Python, so that only the jail stands in its way."""

from __future__ import annotations

import sys
from collections import namedtuple
from types import ModuleType, SimpleNamespace

import numpy as np

sys.modules["raylab.lecture"] = lecture = ModuleType("raylab.lecture")  # the real one takes a second to import
lecture.Vec3 = namedtuple("Vec3", "x y z")


def climb(source, tasks, **_):
    module = {"__name__": "submission"}
    exec(compile(source, "shade.py", "exec"), module)
    functions = {}
    for task in tasks:
        function = module.get(task["function"])
        functions[task["id"]] = over_rows(function, task.get("takes", [])) if task["kind"] == "map" else function
    return SimpleNamespace(findings=module.get("FINDINGS", []), functions=functions)


def over_rows(function, takes):
    def each(row):
        value = function(tuple(map(float, row))) if takes == ["pair"] else function(*map(float, row))
        return [value] if isinstance(value, float) else value

    return lambda rows: np.array([each(row) for row in rows])
