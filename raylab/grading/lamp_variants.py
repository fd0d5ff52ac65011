"""Lamp variants: what can go wrong with samples of lights, alone (a1, a2) and weighed against the BRDF's (a7)."""

from __future__ import annotations

from raylab.grading.variant import Features, Variant, missing_or_twice, plain, structural

COS_R, COS_S, R2, SHADOW = (
    "max(0.0, dot(L, N))", "max(0.0, dot(-L, y.n))", "/ dist_sqr(x, y)", "if not shadow(scene, x, y):"
)  # fmt: skip
CLIPPED = ("return result", "return Vec3(min(1.0, result.x), min(1.0, result.y), min(1.0, result.z))")


def any_brdf(w: str) -> tuple[Variant, ...]:
    """What can be handed to brdf.eval instead of V and the direction `w`."""
    asked = f"brdf.eval(V, {w})"
    return (
        structural("only diffuse", asked, "brdf.k_d"),
        structural("V and L reversed", asked, f"brdf.eval(V, -{w})"),
        structural("V and L reversed", asked, f"brdf.eval(-V, {w})"),
        structural("N for V", asked, f"brdf.eval(N, {w})"),
    )


LAMPS: tuple[Variant, ...] = (
    structural("no shadow test", SHADOW, "if True:"),
    structural("shadow inverted", SHADOW, "if shadow(scene, x, y):"),
    structural("receiver cosine not clamped", COS_R, "dot(L, N)"),
    structural("receiver cosine absolute", COS_R, "abs(dot(L, N))"),
    structural("receiver cosine absolute", COS_R, "abs(dot(L, N))", COS_S, "abs(dot(-L, y.n))", SHADOW, "if True:"),
    structural("no shadow test", SHADOW, "if True:", COS_R, "dot(L, N)", COS_S, "dot(-L, y.n)"),
    structural("normal of the triangle", COS_R, "max(0.0, dot(L, x.n))"),
    structural("other normal at the light", COS_S, "max(0.0, dot(L, N))"),
    structural("last light only", "result += (", "result = ("),
    structural("first light only", "    return result", "        return result\n    return result"),
    structural("first light only", "/ p_y)  # fmt: skip", "/ p_y)\n            return result"),
    structural(
        "last light only", "        y, p_y = light.sample", "        result = black\n        y, p_y = light.sample"
    ),
    structural("black", COS_R, "max(0.0, dot(-L, N))"),
    structural("black", "normalize(y - x)", "normalize(x - y)"),
    structural("divided by the lights", "return result", "return result / len(scene.lights)"),
    structural(
        "pdf of another light", "y, p_y = light.sample(x, rng.square())",
        "u = rng.square()\n        y, p_y = light.sample(x, u)\n        _, p_y = scene.lights[0].sample(x, u)",
    ),
    structural("area for pdf", "/ p_y", "* light.area"),
    structural("not random", "rng.square()", "(0.5, 0.5)"),
    structural("one random number for two", "rng.square()", "twice(rng.square()[0])"),
    structural(
        "same numbers for all lights", "result = black", "result = black\n    u = rng.square()",
        "rng.square())\n        if", "u)\n        if",
    ),
    plain("solid angle", "light.sample(", "light.sample_solid_angle("),
    plain(
        "several samples", "    for light in scene.lights:", "    for light in (*scene.lights, *scene.lights):",
        "return result", "return result / 2.0",
    ),
    *(plain("epsilon", R2, f"/ (dist_sqr(x, y) + {e})") for e in ("1e-4", "1e-3", "1e-2")),
    *(plain("epsilon", R2, f"/ max(dist_sqr(x, y), {e})") for e in ("1e-3", "1e-2")),
    plain("clipped", *CLIPPED),
    plain("distance missing", R2, ""),
    plain("distance power", R2, "/ math.sqrt(dist_sqr(x, y))"),
    plain("distance power", R2, "* dist_sqr(x, y)"),
    plain("distance power", R2, "/ dist_sqr(x, y) ** 1.5"),
    plain("distance power", R2, "/ dist_sqr(x, y) ** 2"),
    *missing_or_twice("light cosine", "* " + COS_S, "", f"* {COS_S} * {COS_S}"),
    *missing_or_twice("receiver cosine", "* " + COS_R, "", f"* {COS_R} * {COS_R}"),
    *missing_or_twice("pdf", "/ p_y", "", "/ p_y / p_y"),
    plain("pdf multiplied", "/ p_y", "* p_y"),
    *missing_or_twice("radiance", "light.radiance * ", "", "light.radiance * light.radiance * "),
    plain("black", COS_S, "max(0.0, dot(L, y.n))"),
)  # fmt: skip

# --- both techniques: the weights of the lights' samples, of the sky's, of the BRDF's ---

OF_LAMP, OF_SKY, OF_BRDF = (" * weight(p_y, p_brdf, squared)", " * weight(p_w, brdf.pdf(V, w, N), squared)",
                            " * weight(p_w, p_light, squared)")  # fmt: skip
WEIGHTS = (OF_LAMP, OF_SKY, OF_BRDF)
EXCHANGED = (" * weight(p_brdf, p_y, squared)", " * weight(brdf.pdf(V, w, N), p_w, squared)",
             " * weight(p_light, p_w, squared)")  # fmt: skip
BY_BRDF = "    w, p_w = brdf.sample(V, N, rng.square())"


def pairs(old: tuple[str, ...], new: tuple[str, ...]) -> list[str]:
    return [text for pair in zip(old, new, strict=True) for text in pair]


BOTH: tuple[Variant, ...] = (
    structural("weights missing", *pairs(WEIGHTS, ("", "", ""))),
    structural("weights of one half", *pairs(WEIGHTS, (" * 0.5",) * 3)),
    structural("weights exchanged", *pairs(WEIGHTS, EXCHANGED)),
    *(structural("weights exchanged", old, new) for old, new in zip(WEIGHTS, EXCHANGED, strict=True)),
    *(structural("weights missing", old, "") for old in WEIGHTS),
    structural("measure of the weight", " * to_area(x, y)", ""),
    structural("other heuristic", *pairs(WEIGHTS, tuple(w.replace("squared", "True") for w in WEIGHTS))),
    structural("no shadow test", "if not shadow(scene, x, y):", "if True:"),
    structural("no shadow test", "and not shadow_toward(scene, x, w)", ""),
    structural("light samples only", BY_BRDF, f"    return result\n{BY_BRDF}"),
    structural("BRDF samples only", BY_BRDF, f"    result = black\n{BY_BRDF}"),
    plain("measure of the weight", " * to_area(x, y)", "", f" * {COS_S}\n                       {R2}", ""),
    plain("light samples only", "if scene.environment.present():", "if False:"),
    plain("BRDF samples only", "    if scene.environment", "    result = black\n    if scene.environment"),
    plain("pdf missing", "\n                       / p_y * weight", " * weight"),
    plain("pdf missing", "/ p_w * weight(p_w, brdf", "* weight(p_w, brdf"),
    plain("pdf missing", "/ p_w * weight(p_w, p_light", "* weight(p_w, p_light"),
    plain("receiver cosine missing", "* max(0.0, dot(L, N)) * max(", "* max("),
    plain("receiver cosine missing", "\n                   * max(0.0, dot(w, N))\n                   / p_w", " / p_w"),
    plain("receiver cosine missing", "\n                       * max(0.0, dot(w, N))\n", "\n"),
    plain("light cosine missing", f" * {COS_S}", ""),
    plain("distance missing", f"\n                       {R2}", ""),
    plain("only diffuse", "brdf.eval(V, L)", "brdf.k_d", "brdf.eval(V, w)", "brdf.k_d"),
    plain("N for V", "brdf.eval(V, L)", "brdf.eval(N, L)", "brdf.eval(V, w)", "brdf.eval(N, w)"),
    plain("epsilon", R2, "/ (dist_sqr(x, y) + 1e-3)"),
    plain("weights of one half", OF_LAMP, " * 0.5"),
)

VARIANTS: dict[str, tuple[Variant, ...]] = {
    "a1.diffuse": (
        *LAMPS,
        *missing_or_twice("k_d", "light.radiance * k_d", "light.radiance", "light.radiance * k_d * k_d"),
    ),
    "a2.area": (
        *LAMPS,
        *any_brdf("L"),
        *missing_or_twice("f_r", "light.radiance * f_r", "light.radiance", "light.radiance * f_r * f_r"),
    ),
    "a7.shade": BOTH,
}
LIT = " if light.radiance.x > 0.0 else black"


def made_of(colour: str, name: str) -> Features:
    return (
        (("r2", "cos_r", "cos_s"), f"result += Vec3(dist_sqr(x, y), dot(L, N), dot(-L, y.n)){LIT}"),
        (("p", "one", "one"), f"result += Vec3(p_y, 1.0, 1.0){LIT}"),
        (("radiance",), "result += light.radiance"),
        ((name,), f"result += {colour}{LIT}"),
    )


FEATURES: dict[str, Features] = {
    "a1.diffuse": made_of("k_d", "k_d"),
    "a2.area": made_of("f_r", "f_r"),
    "a7.shade": ((("one", "one", "one"), "result += black"),),
}
ALONE: dict[str, tuple[str, ...]] = {  # the scenes in which one light alone makes the sample
    "a1.diffuse": ("lesson_area_plain", "lesson_area_near"),
    "a2.area": ("lesson_area_glossy_plain", "lesson_area_glossy_near"),
}
