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
from inspect import signature
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
    _s("first light only", "/ p_y)  # fmt: skip", "/ p_y)\n            return result"),
    _s("last light only", "        y, p_y = light.sample", "        result = black\n        y, p_y = light.sample"),
    _s("black", COS_R, "max(0.0, dot(-L, N))"),
    _s("black", "normalize(y - x)", "normalize(x - y)"),
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

# --- directions to the sky; D is the line that draws, COS the cosine ---

TOWARD, LOOK = "if not shadow_toward(scene, x, w):", "scene.environment.eval(w)"


def skies(draw: str) -> tuple[Variant, ...]:
    """What can go wrong with any direction w."""
    return (
        _s("no shadow test", TOWARD, "if True:"),
        _s("shadow inverted", TOWARD, "if shadow_toward(scene, x, w):"),
        _s("radiance of another direction", LOOK, "scene.environment.eval(N)"),
        _s("radiance of another direction", LOOK, "scene.environment.eval(-w)"),
        _s("not random", "rng.square()", "(0.5, 0.5)"),
        _s("one random number for two", "rng.square()", "twice(rng.square()[0])"),
        _v("radiance missing", "L_env * ", ""),
        _v("radiance power", "L_env * ", "L_env * L_env * "),
        _v("clipped", "return result", "return Vec3(min(1.0, result.x), min(1.0, result.y), min(1.0, result.z))"),
        _v("whole sphere", draw, "sample_sphere(rng.square())" + (", 0.25 / PI" if "sample(" in draw else "")),
    )


UNIFORM, COSINE = "sample_hemisphere(N, rng.square())", "sample_cos_hemisphere(N, rng.square())"
BY_SKY, BY_BRDF = "scene.environment.sample(N, rng.square())", "brdf.sample(V, N, rng.square())"
COS_W = "max(0.0, dot(w, N))"
ANY_BRDF: tuple[Variant, ...] = (
    _s("only diffuse", "brdf.eval(V, w)", "brdf.k_d"),
    _s("V and L reversed", "brdf.eval(V, w)", "brdf.eval(V, -w)"),
    _s("V and L reversed", "brdf.eval(V, w)", "brdf.eval(-V, w)"),
    _s("N for V", "brdf.eval(V, w)", "brdf.eval(N, w)"),
    _s("receiver cosine not clamped", COS_W, "dot(w, N)"),
    _s("receiver cosine absolute", COS_W, "abs(dot(w, N))"),
    _s("normal of the triangle", COS_W, "max(0.0, dot(w, x.n))"),
    _v("receiver cosine missing", "\n                   * max(0.0, dot(w, N)) / p_w", " / p_w"),
    _v("receiver cosine power", COS_W, f"{COS_W} * {COS_W}"),
    _v("f_r missing", "L_env * f_r", "L_env"),
    _v("f_r power", "L_env * f_r", "L_env * f_r * f_r"),
    _v("pdf missing", " / p_w", ""),
    _v("pdf multiplied", " / p_w", " * p_w"),
    _v("pdf power", " / p_w", " / p_w / p_w"),
    _v("no shadow test", TOWARD, "if True:", COS_W, "dot(w, N)"),
    _v("no shadow test", TOWARD, "if True:", COS_W, "abs(dot(w, N))"),
)
LOBE = "sample_phong_lobe(reflect(V, N), n, rng.square())"

VARIANTS: dict[str, tuple[Variant, ...]] = {
    "a1.diffuse": (
        *LAMPS,
        _v("k_d missing", "light.radiance * k_d", "light.radiance"),
        _v("k_d power", "light.radiance * k_d", "light.radiance * k_d * k_d"),
    ),
    "a2.area": (
        *LAMPS,
        _s("only diffuse", "brdf.eval(V, L)", "brdf.k_d"),
        _s("V and L reversed", "brdf.eval(V, L)", "brdf.eval(V, -L)"),
        _s("V and L reversed", "brdf.eval(V, L)", "brdf.eval(-V, L)"),
        _s("N for V", "brdf.eval(V, L)", "brdf.eval(N, L)"),
        _v("f_r missing", "light.radiance * f_r", "light.radiance"),
        _v("f_r power", "light.radiance * f_r", "light.radiance * f_r * f_r"),
    ),
    "a3.uniform": (
        *skies(UNIFORM),
        _v("cosine for uniform", UNIFORM, COSINE),
        _v("receiver cosine missing", COS_W + " * ", ""),
        _v("receiver cosine power", COS_W, f"{COS_W} * {COS_W}"),
        _s("normal of the triangle", COS_W, "max(0.0, dot(w, x.n))"),
        _s("normal of the triangle", "sample_hemisphere(N,", "sample_hemisphere(x.n,"),
        _v("k_d missing", "L_env * k_d", "L_env"),
        _v("k_d power", "L_env * k_d", "L_env * k_d * k_d"),
        _v("pdf missing", " * (2.0 * PI)", ""),
        _v("pdf multiplied", " * (2.0 * PI)", " / (2.0 * PI)"),
        _v("other technique", UNIFORM, COSINE, f"{COS_W} * (2.0 * PI)", "PI"),
    ),
    "a3.cosine": (
        *skies(COSINE),
        _v("uniform for cosine", COSINE, UNIFORM),
        _v("receiver cosine power", "k_d * PI", "k_d * PI * max(0.0, dot(w, N))"),
        _s("normal of the triangle", "sample_cos_hemisphere(N,", "sample_cos_hemisphere(x.n,"),
        _v("k_d missing", "L_env * k_d", "L_env"),
        _v("k_d power", "L_env * k_d", "L_env * k_d * k_d"),
        _v("pdf missing", "k_d * PI", "k_d * max(0.0, dot(w, N))"),
        _v("pdf multiplied", "k_d * PI", "k_d * max(0.0, dot(w, N)) ** 2 / PI"),
        _v("other technique", COSINE, UNIFORM, "k_d * PI", "k_d * max(0.0, dot(w, N)) * 2.0 * PI"),
    ),
    "a4.brdf": (
        *skies(BY_BRDF),
        *ANY_BRDF,
        _v("other technique", BY_BRDF, BY_SKY),
        _v(
            "pdf of the other technique",
            "    if not shadow_toward",
            "    p_w = scene.environment.pdf(N, w)\n    if not shadow_toward",
        ),
        _v("N for V", "brdf.sample(V,", "brdf.sample(N,"),
        _v("uniform for cosine", BY_BRDF, f"{UNIFORM}, 0.5 / PI"),
        _v("cosine for uniform", BY_BRDF, f"{COSINE}, 0.5 / PI"),
    ),
    "a4.brightness": (
        *skies(BY_SKY),
        *ANY_BRDF,
        _v("other technique", BY_SKY, BY_BRDF),
        _v(
            "pdf of the other technique",
            "    if not shadow_toward",
            "    p_w = brdf.pdf(V, w, N)\n    if not shadow_toward",
        ),
        _v("uniform for cosine", BY_SKY, f"{UNIFORM}, 0.5 / PI"),
    ),
    "a5.shade": (
        _s("lobe around N", "reflect(V, N)", "N"),
        _s("not mirrored", "reflect(V, N)", "V"),
        _s("V and L reversed", "reflect(V, N)", "-reflect(V, N)"),
        _s("normal of the triangle", "reflect(V, N)", "reflect(V, x.n)"),
        _s("normal of the triangle", COS_W, "max(0.0, dot(w, x.n))"),
        _s("not random", "rng.square()", "(0.5, 0.5)"),
        _s("not random", LOBE, "reflect(V, N)"),
        _s("one random number for two", "rng.square()", "twice(rng.square()[0])"),
        _s("no shadow test", "light_from(scene, x, w, N)", "scene.environment.eval(w)"),
        _s("radiance of another direction", "light_from(scene, x, w, N)", "light_from(scene, x, reflect(V, N), N)"),
        _v("receiver cosine missing", "max(0.0, dot(w, N)) * ", ""),
        _v("receiver cosine power", COS_W, f"{COS_W} * {COS_W}"),
        _v("exponent off by one", "(n + 2.0) / (n + 1.0)", "1.0"),
        _v("exponent off by one", "(n + 2.0) / (n + 1.0)", "(n + 1.0) / (n + 2.0)"),
        _v("exponent off by one", "(n + 2.0) / (n + 1.0)", "(n + 2.0) / n"),
        _v("exponent off by one", "n, rng.square()", "n + 1.0, rng.square()"),
        _v("exponent off by one", "n, rng.square()", "n - 1.0, rng.square()"),
        _v("pdf missing", "(n + 2.0) / (n + 1.0)", "(n + 2.0) / (2.0 * PI) * max(0.0, dot(w, reflect(V, N))) ** n"),
        _v("f_r missing", "(n + 2.0) / (n + 1.0)", "2.0 * PI / (n + 1.0) / max(1e-9, dot(w, reflect(V, N))) ** n"),
        _v("k_d missing", "k_s * light_from", "light_from"),
        _v("k_d power", "k_s * light_from", "k_s * k_s * light_from"),
        _v("clipped", "light_from(scene, x, w, N) * (", "minimum(light_from(scene, x, w, N)) * ("),
        _v("uniform for cosine", LOBE, UNIFORM),
        _v("cosine for uniform", LOBE, COSINE),
    ),
    "a7.shade": (
        _s(
            "weights missing",
            "return result",
            "return result",
            " * weight(p_y, p_brdf, squared)",
            "",
            " * weight(p_w, brdf.pdf(V, w, N), squared)",
            "",
            " * weight(p_w, p_light, squared)",
            "",
        ),
        _s(
            "weights of one half",
            " * weight(p_y, p_brdf, squared)",
            " * 0.5",
            " * weight(p_w, brdf.pdf(V, w, N), squared)",
            " * 0.5",
            " * weight(p_w, p_light, squared)",
            " * 0.5",
        ),
        _s(
            "weights exchanged",
            "weight(p_y, p_brdf,",
            "weight(p_brdf, p_y,",
            "weight(p_w, brdf.pdf(V, w, N),",
            "weight(brdf.pdf(V, w, N), p_w,",
            "weight(p_w, p_light,",
            "weight(p_light, p_w,",
        ),
        _s("weights exchanged", "weight(p_w, p_light,", "weight(p_light, p_w,"),
        _s("weights exchanged", "weight(p_y, p_brdf,", "weight(p_brdf, p_y,"),
        _s("weights exchanged", "weight(p_w, brdf.pdf(V, w, N),", "weight(brdf.pdf(V, w, N), p_w,"),
        _s("weights missing", " * weight(p_y, p_brdf, squared)", ""),
        _s("weights missing", " * weight(p_w, brdf.pdf(V, w, N), squared)", ""),
        _s("weights missing", " * weight(p_w, p_light, squared)", ""),
        _s("measure of the weight", " * to_area(x, y)", ""),
        _s(
            "other heuristic",
            "weight(p_y, p_brdf, squared)",
            "weight(p_y, p_brdf, True)",
            "N), squared)",
            "N), True)",
            "weight(p_w, p_light, squared)",
            "weight(p_w, p_light, True)",
        ),
        _s("no shadow test", "if not shadow(scene, x, y):", "if True:"),
        _s("no shadow test", "and not shadow_toward(scene, x, w)", ""),
        _s(
            "light samples only",
            "    w, p_w = brdf.sample(V, N, rng.square())",
            "    return result\n    w, p_w = brdf.sample(V, N, rng.square())",
        ),
        _s(
            "BRDF samples only",
            "    w, p_w = brdf.sample(V, N, rng.square())",
            "    result = black\n    w, p_w = brdf.sample(V, N, rng.square())",
        ),
        _v("light samples only", "if scene.environment.present():", "if False:"),
        _v("last light only", "    if scene.environment", "    result = black\n    if scene.environment"),
        _v("pdf missing", "\n                       / p_y * weight", " * weight"),
        _v("pdf missing", "/ p_w * weight(p_w, brdf", "* weight(p_w, brdf"),
        _v("pdf missing", "/ p_w * weight(p_w, p_light", "* weight(p_w, p_light"),
        _v("receiver cosine missing", "* max(0.0, dot(L, N)) * max(", "* max("),
        _v(
            "receiver cosine missing",
            "\n                   * max(0.0, dot(w, N))\n                   / p_w * weight(p_w, p_light",
            "\n                   / p_w * weight(p_w, p_light",
        ),
        _v("receiver cosine missing", "\n                       * max(0.0, dot(w, N))\n", "\n"),
        _v("light cosine missing", " * max(0.0, dot(-L, y.n))", ""),
        _v("distance missing", "\n                       / dist_sqr(x, y)", ""),
        _v("only diffuse", "brdf.eval(V, L)", "brdf.k_d", "brdf.eval(V, w)", "brdf.k_d"),
        _v("N for V", "brdf.eval(V, L)", "brdf.eval(N, L)", "brdf.eval(V, w)", "brdf.eval(N, w)"),
        _v("epsilon", "/ dist_sqr(x, y)", "/ (dist_sqr(x, y) + 1e-3)"),
        _v("weights of one half", "weight(p_y, p_brdf, squared)", "0.5"),
    ),
}

# What a sample is made of, three numbers in each statement; names as in `raylab.grading.diagnosis`.
Features = tuple[tuple[tuple[str, ...], str], ...]
LIT = " if light.radiance.x > 0.0 else black"


def of_lamps(colour: str, name: str) -> Features:
    return (
        (("r2", "cos_r", "cos_s"), f"result += Vec3(dist_sqr(x, y), dot(L, N), dot(-L, y.n)){LIT}"),
        (("p", "one", "one"), f"result += Vec3(p_y, 1.0, 1.0){LIT}"),
        (("radiance",), "result += light.radiance"),
        ((name,), f"result += {colour}{LIT}"),
    )


def of_skies(p: str, colour: str, name: str) -> Features:
    return (
        (("cos_r", "p", "one"), f"result += Vec3(dot(w, N), {p}, 1.0)"),
        (("radiance",), "result += L_env"),
        ((name,), f"result += {colour}"),
    )


PLAIN, GLOSSY = ("lesson_sky_plain", "lesson_sky_hidden"), ("lesson_sky_glossy_plain", "lesson_sky_glossy_hidden")
FEATURES: dict[str, Features] = {
    "a1.diffuse": of_lamps("k_d", "k_d"),
    "a2.area": of_lamps("f_r", "f_r"),
    "a3.uniform": of_skies("1.0", "k_d", "k_d"),
    "a3.cosine": of_skies("1.0", "k_d", "k_d"),
    "a4.brdf": of_skies("p_w", "f_r", "f_r"),
    "a4.brightness": of_skies("p_w", "f_r", "f_r"),
    "a5.shade": (
        (("cos_r", "lobe", "one"), "return Vec3(dot(w, N), dot(w, reflect(V, N)) ** n, 1.0)"),
        (("np1", "np2", "one"), "return Vec3(n + 1.0, n + 2.0, 1.0)"),
        (("k_d",), "return k_s"),
    ),
    "a7.shade": ((("one", "one", "one"), "result += black"),),
}
ALONE: dict[str, tuple[str, ...]] = {  # the scenes in which one light alone makes the sample
    "a1.diffuse": ("lesson_area_plain", "lesson_area_near"),
    "a2.area": ("lesson_area_glossy_plain", "lesson_area_glossy_near"),
    "a3.uniform": PLAIN, "a3.cosine": PLAIN, "a4.brdf": GLOSSY, "a4.brightness": GLOSSY, "a5.shade": GLOSSY,
    "a7.shade": (),
}  # fmt: skip


def minimum(c: Any) -> Any:
    from raylab.vec3 import Vec3

    return Vec3(min(1.0, c.x), min(1.0, c.y), min(1.0, c.z))


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

        def visit_Return(self, node: ast.Return) -> Any:
            return ast.parse(statement).body[0] if statement.startswith("return") else node

    return ast.unparse(ast.fix_missing_locations(Replace().visit(ast.parse(text))))


def alive(solution: Solution, text: str) -> Any:
    """The function that a changed text of a solution defines, where the solution stands."""
    from raylab import sampling, vec3

    module = import_module(f"raylab.{solution.module}")
    names = vars(sampling) | {"Vec3": vec3.Vec3} | vars(module) | {"math": math, "black": vec3.black}
    names |= {"twice": twice, "minimum": minimum}
    exec(compile(text, f"<{solution.task}>", "exec"), names)
    function = names[solution.name]
    if "squared" not in signature(function).parameters:
        return function

    def shade(x: Any, V: Any, brdf: Any, N: Any, scene: Any, rng: Any) -> Any:
        return function(x, V, brdf, N, scene, rng, False)

    return shade


def fingerprint(solution: Solution) -> str:
    """Changes with the solution, its variants and its features."""
    rows = repr((solution.text, VARIANTS[solution.task], FEATURES[solution.task], ALONE[solution.task]))
    return hashlib.sha256(rows.encode()).hexdigest()[:16]
