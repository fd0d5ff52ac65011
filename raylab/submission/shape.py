"""Shape: is the function there, has somebody written it, and does it take the arguments that it will be given?"""

from __future__ import annotations

import ast
from collections.abc import Sequence

from raylab.submission.allowed import nearest
from raylab.submission.finding import Problem
from raylab.submission.source import Source
from raylab.submission.task import Task

ENTRY = "raylab_entry"  # the name of the function that calls the student's with arguments in the slide's order


def check_shape(source: Source, task: Task) -> tuple[str, list[tuple[int, str]]]:
    """The text of the entry function, and remarks; a Problem if it is missing, a stub or takes other things."""
    function = source.functions.get(task.function)
    if function is None:
        raise _missing(source, task)
    if is_stub(function):
        raise unfinished(task.function, function.lineno)
    passed, remarks = _arguments(function, task)
    given = ", ".join(task.arguments)
    return f"def {ENTRY}({given}):\n    return {task.function}({passed})\n", remarks


def unfinished(name: str, line: int) -> Problem:
    """Not attempted: no fault, and no points."""
    return Problem(
        f"`{name}` is not written yet.", "Write the slide's box where the stub stands.", line,
        kind="unfinished",
    )  # fmt: skip


def is_stub(function: ast.FunctionDef) -> bool:
    """Whether nothing stands in it but a docstring, pass, ..., or raise NotImplementedError."""
    return all(_is_empty(statement) for statement in function.body)


def _is_empty(node: ast.stmt) -> bool:
    if isinstance(node, ast.Raise) and node.exc is not None:
        raised = node.exc.func if isinstance(node.exc, ast.Call) else node.exc
        return isinstance(raised, ast.Name) and raised.id == "NotImplementedError"
    if isinstance(node, ast.Return):
        return node.value is None or (isinstance(node.value, ast.Constant) and node.value.value is None)
    return isinstance(node, ast.Pass) or (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant))


def _missing(source: Source, task: Task) -> Problem:
    wanted = f"def {task.function}({', '.join(task.arguments)}):"
    if task.function in source.names:
        return Problem(f"`{task.function}` is not a function of this file.", f"Write it with {wanted}")
    if not source.functions:
        return Problem(f"The file has no functions; `{task.function}` was expected.", f"It begins: {wanted}")
    there = ", ".join(f"`{name}`" for name in source.functions)
    close = nearest(task.function, source.functions)
    line = source.functions[close.split("`")[1]].lineno if close else 0
    return Problem(
        f"There is no function `{task.function}`; the file has {there}.", close or f"It begins: {wanted}", line
    )


def _arguments(function: ast.FunctionDef, task: Task) -> tuple[str, list[tuple[int, str]]]:
    """How to call the function: by name where the slide's names are there, else by place."""
    wanted = task.arguments
    every = [a.arg for a in (*function.args.posonlyargs, *function.args.args)]
    needed = every[: len(every) - len(function.args.defaults)]
    if set(wanted) <= set(every) and set(needed) <= set(wanted):
        return ", ".join(f"{name}" for name in sorted(wanted, key=every.index)), []
    taken = every[: len(wanted)]
    others = [(i, a) for i, a in enumerate(taken) if a != wanted[min(i, len(wanted) - 1)]]
    misplaced = [a for _, a in others if a in wanted]
    if len(taken) == len(wanted) and len(needed) <= len(wanted) and not misplaced:
        renamed = _list([f"`{a}` for `{wanted[i]}`" for i, a in others])
        return ", ".join(wanted), [(function.lineno, f"The slide has other names: you wrote {renamed}. It works.")]
    raise Problem(
        f"`{function.name}` takes ({', '.join(every)}); it will be given ({', '.join(wanted)}).",
        f"The line must be: def {function.name}({', '.join(wanted)}):",
        function.lineno,
    )


def _list(items: Sequence[str]) -> str:
    return ", ".join(items[:-1]) + " and " + items[-1] if len(items) > 1 else "".join(items)
