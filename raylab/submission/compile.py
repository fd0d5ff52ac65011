"""Compile: everything that a task's function reaches, with bounds checks, and without any cache on disk.

A student's function need not be decorated, and neither need its helpers. Integer and float division by zero raise
ZeroDivisionError, as in Python; an index past the end raises IndexError.
"""

from __future__ import annotations

import types
import warnings
from collections.abc import Callable
from typing import Any

import numba
import numpy as np
import numpy.typing as npt
from numba.core.errors import NumbaError, NumbaWarning

from raylab.jit import OPTIONS, Compiled, entry_point
from raylab.plain import Plain
from raylab.submission.finding import Problem
from raylab.submission.messages import explain_compiler
from raylab.submission.shape import ENTRY
from raylab.submission.source import Source
from raylab.submission.task import WIDTHS, Task
from raylab.submission.vet import reachable
from raylab.submission.wall import may_be_unset, wall
from raylab.vec3 import Vec3
from raylab.view import View

STUDENT = OPTIONS | {"error_model": "python", "boundscheck": True}
Array = npt.NDArray[np.float64]
type_errors = NumbaError  # what the compiler says of a function, and nothing that a function raises as it runs


def prepare(source: Source, task: Task, entry: str) -> Compiled:
    """The entry function of a task, to be compiled when its arguments are known; a Problem if the wall refuses."""
    space = source.namespace(entry, silent=True)
    names = [*reachable(source, task.function), ENTRY]
    plain = [space[name] for name in names]
    with explained(source):
        for function in plain:
            wall(function, lambda value: any(value is p for p in plain))
    for name in names:
        space[name] = Compiled(space[name], STUDENT)
    return space[ENTRY]


def unset(source: Source, task: Task) -> list[Problem]:
    """Variables that Python would miss on some way through the functions, and the compiler takes for 0."""
    space = source.namespace(silent=True)
    found = [pair for name in reachable(source, task.function) for pair in may_be_unset(space[name])]
    return [
        Problem(
            f"`{name}` may have no value here: not all ways through the function give it one.",
            "If so, Python stops and compiled code takes it for 0. Give it a value first.", line, kind="note",
        )
        for line, name in found
    ]  # fmt: skip


class explained:  # noqa: N801 (a context manager)
    """Turns what the compiler says into a Problem."""

    def __init__(self, source: Source, errors: type[Exception] = Exception) -> None:
        self.source, self.errors = source, errors

    def __enter__(self) -> None:
        self.quiet = warnings.catch_warnings()
        self.quiet.__enter__()
        warnings.simplefilter("ignore", NumbaWarning)

    def __exit__(self, kind: Any, error: BaseException | None, trace: types.TracebackType | None) -> None:
        self.quiet.__exit__(kind, error, trace)
        if isinstance(error, self.errors) and not isinstance(error, Problem):
            raise explain_compiler(error, self.source) from None


def compile_shade(source: Source, task: Task, compiled: Compiled, plain: Plain) -> None:
    """Compile for the arguments of `plain`; a Problem if that cannot be done, or if no colour comes out."""
    arguments = (*plain.arguments(compiled.py_func), plain.data, plain.stream(0))
    signature = tuple(numba.typeof(a) for a in arguments)
    with explained(source):
        compiled.inner.compile(signature)
    returned = str(compiled.inner.overloads[signature].signature.return_type)
    if returned != "Vec3":
        raise explain_compiler(TypeError(f"returns {returned}"), source)


class Mapped:
    """A plain function over rows of inputs (n, k), giving rows of results (n, m)."""

    def __init__(self, source: Source, task: Task, compiled: Compiled) -> None:
        self.task, self.__name__ = task, task.function
        space: dict[str, Any] = {"function": compiled, "Vec3": Vec3}
        exec(compile(_loop(task), "<raylab>", "exec"), space)
        with explained(source):
            self.run: Callable[..., None] = entry_point(
                Compiled(space["over_rows"], STUDENT), (View(np.zeros((1, 1))), View(np.zeros((1, 1))))
            )

    def __call__(self, rows: Array) -> Array:
        rows, (k, m) = np.ascontiguousarray(rows, np.float64), self.task.columns
        if rows.ndim != 2 or rows.shape[1] != k:
            raise ValueError(f"{self.__name__} takes rows of {k} numbers, got an array of shape {rows.shape}")
        results = np.empty((len(rows), m))
        self.run(View(rows), View(results))
        return results


def _loop(task: Task) -> str:
    """The source of a kernel that calls the function for each row."""
    arguments, column = [], 0
    for kind in task.takes:
        numbers = [f"rows[i, {column + j}]" for j in range(WIDTHS[kind])]
        column += len(numbers)
        arguments.append({"vector": "Vec3({})", "pair": "({})", "number": "{}"}[kind].format(", ".join(numbers)))
    stores, column = [], 0
    for place, kind in enumerate(task.gives):
        part = "found" if len(task.gives) == 1 else f"found[{place}]"
        for j in range(WIDTHS[kind]):
            value = {"vector": f"{part}.{'xyz'[j]}", "pair": f"{part}[{j}]", "number": part}[kind]
            stores.append(f"        results[i, {column}] = {value}")
            column += 1
    call = f"        found = function({', '.join(arguments)})"
    return "\n".join(["def over_rows(rows, results):", "    for i in range(len(rows)):", call, *stores, ""])
