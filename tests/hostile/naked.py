"""A ladder without any wall: it runs a submission as ordinary Python, so that only the jail stands in its way."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np


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
        if type(value).__name__ == "Vec3":
            return [value.x, value.y, value.z]
        return [value] if isinstance(value, float) else value

    return lambda rows: np.array([each(row) for row in rows])
