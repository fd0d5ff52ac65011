"""Variants: the reference with a mistake planted in it, to be compared with a submission number by number.

A row is a cause (`raylab.grading.causes`) and edits of the solution's text: `old` occurs in it and becomes `new`
everywhere. `FEATURES` are statements that stand in for the one that adds a sample up, and return what a sample is made
of. This module knows the solutions: students do not get it, but what follows from it as numbers (`table`).
"""

from __future__ import annotations

import ast
import hashlib
import math
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from raylab.grading.stub import Solution

Edits = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Variant:
    """A mistake. Those that are `structural` also occur together with a wrong factor."""

    cause: str
    edits: Edits
    structural: bool = False


def _v(cause: str, *edits: str, structural: bool = False) -> Variant:
    return Variant(cause, tuple(zip(edits[::2], edits[1::2], strict=True)), structural)


def _s(cause: str, *edits: str) -> Variant:
    return _v(cause, *edits, structural=True)


BACK, ADD = "\n        ", "result += (light.radiance"
COS_R, COS_S, R2, SHADOW = (
    "max(0.0, dot(L, N))", "max(0.0, dot(-L, y.n))", "/ dist_sqr(x, y)", "if not shadow(scene, x, y):"
)  # fmt: skip

LAMPS: tuple[Variant, ...] = (
    _s("no shadow test", SHADOW, "if True:"),
    _s("shadow inverted", SHADOW, "if shadow(scene, x, y):"),
    _s("receiver cosine not clamped", COS_R, "dot(L, N)"),
    _s("receiver cosine absolute", COS_R, "abs(dot(L, N))"),
    _s("receiver cosine absolute", COS_R, "abs(dot(L, N))", COS_S, "abs(dot(-L, y.n))", SHADOW, "if True:"),
    _s("no shadow test", SHADOW, "if True:", COS_R, "dot(L, N)", COS_S, "dot(-L, y.n)"),
    _s("normal of the triangle", COS_R, "max(0.0, dot(L, x.n))"),
    _s("other normal at the light", COS_S, "max(0.0, dot(L, N))"),
    _s("other normal at the light", COS_S, "max(0.0, dot(-L, N))"),
    _s("last light only", "result += (", "result = ("),
    _s("first light only", "    return result", "        return result\n    return result"),
    _s("divided by the lights", "return result", "return result / len(scene.lights)"),
    _s("pdf of another light", "y, p_y = light.sample(x, rng.square())",
       "u = rng.square()\n        y, p_y = light.sample(x, u)\n        _, p_y = scene.lights[0].sample(x, u)"),
    _s("area for pdf", "/ p_y", "* light.area"),
    _s("not random", "rng.square()", "(0.5, 0.5)"),
    _s("one random number for two", "rng.square()", "twice(rng.square()[0])"),
    _s("same numbers for all lights", "result = black", "result = black\n    u = rng.square()", "rng.square())\n        if",
       "u)\n        if"),
    _v("solid angle", "light.sample(", "light.sample_solid_angle("),
    _v("several samples", "    for light in scene.lights:", "    for light in (*scene.lights, *scene.lights):",
       "return result", "return result / 2.0"),
    _v("epsilon", R2, "/ (dist_sqr(x, y) + 1e-3)"),
    _v("epsilon", R2, "/ (dist_sqr(x, y) + 1e-4)"),
    _v("epsilon", R2, "/ (dist_sqr(x, y) + 1e-2)"),
    _v("epsilon", R2, "/ max(dist_sqr(x, y), 1e-2)"),
    _v("epsilon", R2, "/ max(dist_sqr(x, y), 1e-3)"),
    _v("clipped", "return result", "return Vec3(min(1.0, result.x), min(1.0, result.y), min(1.0, result.z))"),
    _v("distance missing", R2, ""),
    _v("distance power", R2, "/ math.sqrt(dist_sqr(x, y))"),
    _v("distance power", R2, "* dist_sqr(x, y)"),
    _v("distance power", R2, "/ dist_sqr(x, y) ** 1.5"),
    _v("distance power", R2, "/ dist_sqr(x, y) ** 2"),
    _v("light cosine missing", "* " + COS_S, ""),
    _v("receiver cosine missing", "* " + COS_R, ""),
    _v("light cosine power", COS_S, f"{COS_S} * {COS_S}"),
    _v("receiver cosine power", COS_R, f"{COS_R} * {COS_R}"),
    _v("pdf missing", "/ p_y", ""),
    _v("pdf multiplied", "/ p_y", "* p_y"),
    _v("pdf power", "/ p_y", "/ p_y / p_y"),
    _v("radiance missing", "light.radiance * ", ""),
    _v("radiance power", "light.radiance * ", "light.radiance * light.radiance * "),
    _v("black", COS_S, "max(0.0, dot(L, y.n))"),
)  # fmt: skip

VARIANTS: dict[str, tuple[Variant, ...]] = {
    "a1.diffuse": (
        *LAMPS,
        _v("k_d missing", "light.radiance * k_d", "light.radiance"),
        _v("k_d power", "light.radiance * k_d", "light.radiance * k_d * k_d"),
    ),
}

# What a sample is made of, three numbers in each statement; names as in FACTORS below.
FEATURES: dict[str, tuple[tuple[tuple[str, ...], str], ...]] = {
    "a1.diffuse": (
        (("r2", "cos_r", "cos_s"), "result += Vec3(dist_sqr(x, y), dot(L, N), dot(-L, y.n)) if light.radiance.x > 0.0 else black"),
        (("p", "one", "one"), "result += Vec3(p_y, 1.0, 1.0) if light.radiance.x > 0.0 else black"),
        (("radiance",), "result += light.radiance"),
        (("k_d",), "result += k_d if light.radiance.x > 0.0 else black"),
    ),
}  # fmt: skip
ALONE: dict[str, tuple[str, ...]] = {
    "a1.diffuse": ("lesson_area_plain", "lesson_area_near")
}  # where features make sense


def twice(u: float) -> tuple[float, float]:
    return u, u


def edited(text: str, edits: Edits) -> str:
    """LookupError when something that is to be changed is not there."""
    for old, new in edits:
        if old not in text:
            raise LookupError(f"{old!r} does not occur in\n{text}")
        text = text.replace(old, new)
    return text


def featured(text: str, statement: str) -> str:
    """The solution with `statement` in place of the one that adds a sample up."""

    class Replace(ast.NodeTransformer):
        def visit_AugAssign(self, node: ast.AugAssign) -> Any:
            return ast.parse(statement).body[0]

    return ast.unparse(ast.fix_missing_locations(Replace().visit(ast.parse(text))))


def alive(solution: Solution, text: str) -> Any:
    """The function that a changed text of a solution defines, where the solution stands."""
    from raylab import sampling, vec3

    module = import_module(f"raylab.{solution.module}")
    names = vars(sampling) | {"Vec3": vec3.Vec3} | vars(module) | {"math": math, "twice": twice, "black": vec3.black}
    exec(compile(text, f"<{solution.task}>", "exec"), names)
    return names[solution.name]


def fingerprint(solution: Solution) -> str:
    """Changes with the solution, its variants and its features."""
    rows = repr((solution.text, VARIANTS[solution.task], FEATURES[solution.task], ALONE[solution.task]))
    return hashlib.sha256(rows.encode()).hexdigest()[:16]
