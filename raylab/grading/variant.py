"""Variant: the reference with a mistake planted in it, as text that can be run where the solution stands."""

from __future__ import annotations

import ast
import math
from dataclasses import dataclass
from importlib import import_module
from inspect import signature
from typing import Any

from raylab.grading.stub import Solution

Edits = tuple[tuple[str, str], ...]
# What a sample is made of, three numbers in each statement; names as in `raylab.grading.paired`.
Features = tuple[tuple[tuple[str, ...], str], ...]


@dataclass(frozen=True)
class Variant:
    """A mistake. Those that are `structural` also occur together with a wrong factor.

    `edits`: `old` occurs in the solution's text and becomes `new` everywhere; `body`: what stands in the place of the
    solution's; `helper`: a wrong function that the solution calls by its name.
    """

    cause: str
    edits: Edits = ()
    structural: bool = False
    body: str = ""
    helper: str = ""


def plain(cause: str, *edits: str, structural: bool = False) -> Variant:
    return Variant(cause, tuple(zip(edits[::2], edits[1::2], strict=True)), structural)


def structural(cause: str, *edits: str) -> Variant:
    return plain(cause, *edits, structural=True)


def missing_or_twice(name: str, text: str, without: str, twice: str) -> tuple[Variant, Variant]:
    """A factor that is forgotten, or comes in once more."""
    return plain(f"{name} missing", text, without), plain(f"{name} power", text, twice)


def edited(text: str, variant: Variant) -> str:
    """The solution's text with the mistake in it; LookupError when something that is to be changed is not there."""
    for old, new in variant.edits:
        if old not in text:
            raise LookupError(f"{old!r} does not occur in\n{text}")
        text = text.replace(old, new)
    if variant.body:
        text = f"{text.partition(':')[0]}:\n    " + variant.body.replace("\n", "\n    ")
    return f"{variant.helper}\n\n\n{text}" if variant.helper else text


def featured(text: str, statement: str) -> str:
    """The solution with `statement` in place of the one that adds a sample up."""

    class Replace(ast.NodeTransformer):
        def visit_AugAssign(self, node: ast.AugAssign) -> Any:
            return ast.parse(statement).body[0]

        def visit_Return(self, node: ast.Return) -> Any:
            return ast.parse(statement).body[0] if statement.startswith("return") else node

    return ast.unparse(ast.fix_missing_locations(Replace().visit(ast.parse(text))))


def alive(solution: Solution, text: str) -> Any:
    """The function that a changed text of a solution defines, where the solution stands."""
    from raylab import sampling, vec3

    module = import_module(f"raylab.{solution.module}")
    names = vars(sampling) | vars(vec3) | vars(module) | {"math": math, "twice": twice, "minimum": minimum}
    exec(compile(text, f"<{solution.task}>", "exec"), names)
    function = names[solution.name]
    if "squared" not in signature(function).parameters:
        return function

    def shade(x: Any, V: Any, brdf: Any, N: Any, scene: Any, rng: Any) -> Any:
        return function(x, V, brdf, N, scene, rng, False)

    return shade


def minimum(c: Any) -> Any:
    from raylab.vec3 import Vec3

    return Vec3(min(1.0, c.x), min(1.0, c.y), min(1.0, c.z))


def twice(u: float) -> tuple[float, float]:
    return u, u
