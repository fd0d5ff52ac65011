"""Vet: may this function name what it names? Asked of the syntax tree.

The namespace of a submission holds allowed objects only, so a name leads to one of them, to a local variable or to
nothing; an attribute must be listed. `raylab.submission.wall` asks the same of what numba makes of it.
"""

from __future__ import annotations

import ast
import builtins
import types
from collections.abc import Iterator
from typing import Any

from raylab.submission import allowed
from raylab.submission.allowed import Unavailable
from raylab.submission.finding import Problem
from raylab.submission.source import Source
from raylab.submission.task import Task

_ROWS: tuple[tuple[tuple[type, ...], str, str], ...] = (
    ((ast.Import, ast.ImportFrom), "An import stands inside the function.", "Move it to the top of the file."),
    ((ast.With,), "`with` cannot be used in graded functions; files cannot be opened.", "Use the arguments only."),
    (
        (ast.Global,), "A shade() cannot change globals: a sample must depend on its arguments only.",
        "Return what you have found.",
    ),
    ((ast.Nonlocal,), "An inner function cannot change variables of the outer one.", "Return what it has found."),
    (
        (ast.Try,), "`try` cannot be used in graded functions.",
        "Test before dividing (if p > 0.0:) instead of catching.",
    ),
    ((ast.ClassDef,), "Classes cannot be used inside a function.", "Use numbers, tuples and Vec3."),
    (
        (ast.Yield, ast.YieldFrom), "`yield` cannot be used in graded functions.",
        "Add up in a for loop and return the sum.",
    ),
    ((ast.Await,), "`await` cannot be used in graded functions.", ""),
    (
        (ast.AsyncFunctionDef, ast.AsyncFor, ast.AsyncWith), "`async` cannot be used in graded functions.",
        "Write def, for and if.",
    ),
    (
        (ast.GeneratorExp,), "A generator (... for ... in ...) cannot be compiled.",
        "Write a for loop that adds up: result += ...",
    ),
    ((ast.Dict, ast.DictComp), "Dictionaries cannot be used in graded functions.", "Use variables or tuples."),
    ((ast.Set, ast.SetComp), "Sets cannot be used in graded functions.", "Use tuples."),
    ((ast.Delete,), "`del` cannot be used in graded functions.", "Leave the variable alone."),
    ((ast.NamedExpr,), "`:=` cannot be compiled.", "Write the assignment on a line of its own."),
    ((ast.Match,), "`match` cannot be compiled.", "Write if and elif."),
)  # fmt: skip
_REFUSED = {node: (sentence, advice) for nodes, sentence, advice in _ROWS for node in nodes}


def called(source: Source, name: str) -> set[str]:
    """The functions of the file that one of them names."""
    return {n.id for n in ast.walk(source.functions[name]) if isinstance(n, ast.Name)} & source.functions.keys()


def reachable(source: Source, *names: str) -> list[str]:
    """These functions, and all functions of the file that they call, at any depth."""
    found: list[str] = []
    waiting = list(names)
    while waiting:
        current = waiting.pop()
        if current not in found:
            found.append(current)
            waiting += sorted(called(source, current))
    return found


def vet(source: Source, task: Task) -> None:
    """Raise a Problem for the first thing, from top to bottom, that the task's function must not do."""
    problems = [p for name in reachable(source, task.function) for p in _Vet(source, task, name).problems()]
    if problems:
        raise min(problems, key=lambda p: (p.line, p.sentence.startswith("`.")))  # names before attributes


class _Vet:
    """One function and what it names."""

    def __init__(self, source: Source, task: Task, name: str) -> None:
        self.source, self.task, self.function = source, task, source.functions[name]
        self.local = set(_bound(self.function))

    def problems(self) -> Iterator[Problem]:
        own = called(self.source, self.function.name)
        if self.function.name in reachable(self.source, *own):
            around = "" if self.function.name in own else f", by way of `{sorted(own)[0]}`"
            line = next(n.lineno for n in ast.walk(self.function) if isinstance(n, ast.Name) and n.id in own)
            yield Problem(
                f"`{self.function.name}` calls itself{around}.", "Write a loop: no box of the lecture needs recursion.",
                line,
            )  # fmt: skip
        owned = {id(n.value) for n in ast.walk(self.function) if isinstance(n, ast.Attribute)}
        for node in ast.walk(self.function):
            line = getattr(node, "lineno", 0)
            if type(node) in _REFUSED:
                yield Problem(*_REFUSED[type(node)], line)
            elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and id(node) not in owned:
                yield from self._judge(self._named(node), node)
            elif isinstance(node, ast.Attribute):
                yield from self._attribute(node)

    def _named(self, node: ast.expr) -> Any:
        """The object that a name or a dotted name stands for; a local variable stands for None."""
        if isinstance(node, ast.Attribute):
            owner = self._named(node.value)
            if isinstance(owner, types.ModuleType):
                return allowed.member(owner, node.attr)
            return owner if isinstance(owner, Unavailable) else None
        if not isinstance(node, ast.Name) or node.id in self.local or node.id in self.source.functions:
            return None
        for known in (self.source.names, allowed.BUILT_INS, allowed.ERRORS):
            if node.id in known:
                return known[node.id]
        return _unknown(node.id, self.local | self.source.names.keys() | self.source.functions.keys())

    def _judge(self, value: Any, node: ast.expr) -> Iterator[Problem]:
        if isinstance(value, Unavailable):
            yield Problem(value.sentence, value.advice, node.lineno)
        elif isinstance(value, list):
            yield Problem(f"`{ast.unparse(node)}` cannot be used in graded functions.", "", node.lineno)
        for word in self.task.withheld:
            if value is not None and value is getattr(allowed.lecture, word, self):
                yield Problem(
                    f"`{word}` is what you are asked to write yourself here.",
                    "Work it out from u1 and u2.",
                    node.lineno,
                )

    def _attribute(self, node: ast.Attribute) -> Iterator[Problem]:
        owner = self._named(node.value)
        if isinstance(owner, Unavailable):
            yield Problem(owner.sentence, owner.advice, node.lineno)
        elif isinstance(owner, types.ModuleType):
            yield from self._judge(allowed.member(owner, node.attr), node)
        elif not isinstance(node.ctx, ast.Load):
            yield Problem(
                f"This line changes `{ast.unparse(node)}`; points, vectors and lights do not change.",
                "Make a new vector: Vec3(x, y, z).", node.lineno,
            )  # fmt: skip
        elif node.attr not in allowed.ATTRIBUTES:
            yield Problem(f"`.{node.attr}` is not known here.", _instead(node.attr), node.lineno)


_HANDED = "It must be an argument of this function"
_MEANT = {
    "light": "The lights are in the scene: for light in scene.lights:", "lights": "Write scene.lights.",
    "y": "A point on a light: y, p_y = light.sample(x, rng.square())", "L": "The direction: L = normalize(y - x)",
    "p_y": "The density: y, p_y = light.sample(x, rng.square())",
    "w": "A direction: w = sample_hemisphere(N, rng.square())",
    "u": "A pair of random numbers: u = rng.square()", "u1": "Two random numbers: u1, u2 = rng.square()",
    "u2": "Two random numbers: u1, u2 = rng.square()", "V": f"{_HANDED}, as on the slides for any BRDF.",
    "brdf": f"{_HANDED}; a diffuse surface has k_d instead.", "k_d": f"{_HANDED}; any other BRDF is brdf.eval(V, L).",
    "x": f"{_HANDED}.", "N": f"{_HANDED}.", "scene": f"{_HANDED}.", "rng": f"{_HANDED}.",
    "np": "Write at the top: import numpy as np", "math": "Write at the top: import math",
    "pi": "Import it: from raylab.lecture import PI",
}  # fmt: skip
_RNG = ("uniform", "random", "rand", "next", "random_sample", "randint")


def _instead(attribute: str) -> str:
    if attribute in _RNG:
        return "rng has number() and square()."
    words = {"norm": "length", "mag": "length", "magnitude": "length", "normalized": "normalize", "unit": "normalize"}
    word = words.get(attribute, attribute)
    if callable(getattr(allowed.lecture, word, None)):
        return f"It is a function: write {word}(v)."
    if attribute in ("normal", "N_y"):
        return "The normal at the point y is y.n."
    found = allowed.nearest(attribute, allowed.ATTRIBUTES)
    if not found:
        found = allowed.nearest(attribute, allowed.lecture.__all__)
    return found


def _unknown(name: str, known: Any) -> Unavailable:
    if hasattr(builtins, name):
        return Unavailable(
            f"`{name}` cannot be used in graded functions.", "Use the arguments and raylab.lecture only."
        )
    if name in allowed.lecture.__all__:
        return Unavailable(f"`{name}` is not defined.", f"Import it: from raylab.lecture import {name}")
    if name in _MEANT:
        return Unavailable(f"`{name}` is not defined.", _MEANT[name])
    every = [*known, *allowed.BUILT_INS, *allowed.lecture.__all__]
    return Unavailable(f"`{name}` is not defined.", allowed.nearest(name, every) or "Check how it is written.")


def _bound(function: ast.FunctionDef) -> Iterator[str]:
    """All names that are given a value somewhere inside."""
    for node in ast.walk(function):
        if isinstance(node, ast.arg):
            yield node.arg
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.FunctionDef) and node is not function:
            yield node.name
