"""Estimator watch: the child process of `raylab.estimator_check`; one shade(), called and watched in plain Python.

python -m raylab.estimator_watch '{"file": ..., "name": ..., "technique": ..., "trial": ..., ...}'
"""

from __future__ import annotations

import importlib.util
import inspect
import json
import math
import random
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from raylab import trials
from raylab.estimator_check import CALLS
from raylab.plain import Plain
from raylab.vec3 import Vec3

Findings = list[tuple[str, str]]


class GlobalRandomError(Exception):
    """Somebody asked a random generator that is not the one passed in."""


def forbid_global_random() -> None:
    """From here on `random` and `numpy.random` refuse to answer."""

    def refuse(name: str) -> Callable[..., Any]:
        def refused(*arguments: Any, **more: Any) -> Any:
            raise GlobalRandomError(name)

        return refused

    for module in (random, np.random):
        for name in dir(module):
            member = getattr(module, name)
            if not name.startswith("_") and callable(member) and not (inspect.isclass(member) and name[0] == "B"):
                setattr(module, name, refuse(f"{module.__name__}.{name}"))


def load(file: str, name: str) -> Callable[..., Any]:
    """The function `name` of a file; a decorated one without its decoration."""
    spec = importlib.util.spec_from_file_location(Path(file).stem, file)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    found: Any = module
    for part in name.split("."):
        found = getattr(found, part)
    return getattr(found, "py_func", found)


def components(value: Any) -> tuple[list[float] | None, tuple[str, str] | None]:
    """The three numbers of what was returned, or what is wrong with it."""
    if isinstance(value, Vec3):
        return [value.x, value.y, value.z], None
    kind = type(value).__name__
    if isinstance(value, np.ndarray | list | tuple) and np.shape(value) != (3,):
        return None, ("shape", f"{kind} of shape {np.shape(value)}, expected a Vec3 of three numbers")
    return None, ("type", f"{kind}, expected a Vec3")


def watch(shade: Callable[..., Any], trial: Any, technique: str, seed: int) -> Findings:
    """Everything that is wrong, each kind once, in the order in which it was seen."""
    watched, bound = Plain(trial.scene, trial.place, seed), trial.answer(technique).bound
    found: dict[str, str] = {}
    before = watched.state()
    first: dict[int, list[float]] = {}
    forbid_global_random()
    for number in [*range(CALLS // 2), *range(CALLS // 2)]:  # the same numbers twice: the same values are due
        try:
            values, wrong = components(watched.call(shade, number))
        except GlobalRandomError as error:
            return [*found.items(), ("global random", f"{error}() was called")]
        except Exception as error:
            return [*found.items(), ("error", f"{type(error).__name__}: {error}")]
        if watched.state() != before:
            return [*found.items(), ("mutation", f"after call {number} an argument is not what it was")]
        if wrong or values is None:
            return [*found.items(), wrong or ("type", "")]
        judge(values, bound, found)
        if repr(first.setdefault(number, values)) != repr(values):
            found.setdefault("state", f"call {number} gave {first[number]} first and {values} with the same numbers")
    return list(found.items())


def judge(values: list[float], bound: Any, found: dict[str, str]) -> None:
    """Look at one sample."""
    if not all(math.isfinite(v) for v in values):
        found.setdefault("nan", str(values))
    elif min(values) < 0.0:
        found.setdefault("negative", str(values))
    elif any(v > b for v, b in zip(values, bound, strict=True)):
        found.setdefault("bound", f"{values}, at most {[float(b) for b in bound]}")


def main(task: dict[str, Any]) -> None:
    trial = trials.make(task["trial"], task["seed"])
    trial.scene  # noqa: B018 (built before the generators are closed)
    try:
        shade = load(task["file"], task["name"])
    except Exception as error:
        findings: Findings = [("error", f"{type(error).__name__}: {error}")]
    else:
        findings = watch(shade, trial, task["technique"], task["seed"])
    Path(task["answer"]).write_text(json.dumps(findings))


if __name__ == "__main__":
    main(json.loads(sys.argv[1]))
