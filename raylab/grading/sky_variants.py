"""Sky variants: what can go wrong with a direction w to the sky (a3, a4), and in Phong's lobe (a5)."""

from __future__ import annotations

from raylab.grading import map_variants
from raylab.grading.lamp_variants import CLIPPED, any_brdf
from raylab.grading.variant import Features, Variant, missing_or_twice, plain, structural

TOWARD, LOOK, COS = "if not shadow_toward(scene, x, w):", "scene.environment.eval(w)", "max(0.0, dot(w, N))"
UNIFORM, COSINE = "sample_hemisphere(N, rng.square())", "sample_cos_hemisphere(N, rng.square())"
BY_SKY, BY_BRDF = "scene.environment.sample(N, rng.square())", "brdf.sample(V, N, rng.square())"
FROM, LOBE = "light_from(scene, x, w, N)", "sample_phong_lobe(reflect(V, N), n, rng.square())"
NUMBERS = (
    structural("not random", "rng.square()", "(0.5, 0.5)"),
    structural("one random number for two", "rng.square()", "twice(rng.square()[0])"),
)


def any_direction(draw: str) -> tuple[Variant, ...]:
    """What can go wrong with any direction w that the text `draw` makes."""
    return (
        *NUMBERS,
        structural("no shadow test", TOWARD, "if True:"),
        structural("shadow inverted", TOWARD, "if shadow_toward(scene, x, w):"),
        structural("radiance of another direction", LOOK, "scene.environment.eval(N)"),
        structural("radiance of another direction", LOOK, "scene.environment.eval(-w)"),
        *missing_or_twice("radiance", "L_env * ", "", "L_env * L_env * "),
        plain("clipped", *CLIPPED),
        plain("whole sphere", draw, "sample_sphere(rng.square())" + (", 0.25 / PI" if "sample(" in draw else "")),
    )


def diffuse(draw: str, other: str, wrong: str) -> tuple[Variant, ...]:
    """Of a diffuse surface: `draw` makes the direction, `other` would be that of the other box."""
    return (
        *any_direction(draw),
        plain(wrong, draw, other),
        *missing_or_twice("k_d", "L_env * k_d", "L_env", "L_env * k_d * k_d"),
        structural("normal of the triangle", draw, draw.replace("(N,", "(x.n,")),
        *map_variants.inside(draw.partition("(")[0]),
    )


def glossy(draw: str, other: str, other_pdf: str) -> tuple[Variant, ...]:
    """Of any surface: `draw` makes the direction and its density, `other` those of the other technique."""
    return (
        *any_direction(draw),
        *any_brdf("w"),
        structural("receiver cosine not clamped", COS, "dot(w, N)"),
        structural("receiver cosine absolute", COS, "abs(dot(w, N))"),
        structural("normal of the triangle", COS, "max(0.0, dot(w, x.n))"),
        *missing_or_twice(
            "receiver cosine", f"\n                   * {COS} / p_w", " / p_w", f" * {COS} * {COS} / p_w"
        ),
        *missing_or_twice("f_r", "L_env * f_r", "L_env", "L_env * f_r * f_r"),
        *missing_or_twice("pdf", " / p_w", "", " / p_w / p_w"),
        plain("pdf multiplied", " / p_w", " * p_w"),
        plain("no shadow test", TOWARD, "if True:", COS, "dot(w, N)"),
        plain("no shadow test", TOWARD, "if True:", COS, "abs(dot(w, N))"),
        plain("other technique", draw, other),
        plain("pdf of the other technique", f"    {TOWARD[:20]}", f"    p_w = {other_pdf}\n    {TOWARD[:20]}"),
        plain("uniform for cosine", draw, f"{UNIFORM}, 0.5 / PI"),
    )


VARIANTS: dict[str, tuple[Variant, ...]] = {
    "a3.uniform": (
        *diffuse(UNIFORM, COSINE, "cosine for uniform"),
        plain("whole sphere", UNIFORM, "sample_sphere(rng.square())", COS, "dot(w, N)"),
        *missing_or_twice("receiver cosine", COS + " * ", "", f"{COS} * {COS} * "),
        structural("normal of the triangle", COS, "max(0.0, dot(w, x.n))"),
        plain("pdf missing", " * (2.0 * PI)", ""),
        plain("pdf multiplied", " * (2.0 * PI)", " / (2.0 * PI)"),
        plain("other technique", UNIFORM, COSINE, f"{COS} * (2.0 * PI)", "PI"),
    ),
    "a3.cosine": (
        *diffuse(COSINE, UNIFORM, "uniform for cosine"),
        plain("receiver cosine power", "k_d * PI", f"k_d * PI * {COS}"),
        plain("pdf missing", "k_d * PI", f"k_d * {COS}"),
        plain("pdf multiplied", "k_d * PI", f"k_d * {COS} ** 2 / PI"),
        plain("other technique", COSINE, UNIFORM, "k_d * PI", f"k_d * {COS} * 2.0 * PI"),
    ),
    "a4.brdf": (
        *glossy(BY_BRDF, BY_SKY, "scene.environment.pdf(N, w)"),
        plain("N for V", "brdf.sample(V,", "brdf.sample(N,"),
        plain("cosine for uniform", BY_BRDF, f"{COSINE}, 0.5 / PI"),
    ),
    "a4.brightness": glossy(BY_SKY, BY_BRDF, "brdf.pdf(V, w, N)"),
    "a5.shade": (
        *NUMBERS,
        structural("lobe around N", "reflect(V, N)", "N"),
        structural("not mirrored", "reflect(V, N)", "V"),
        structural("V and L reversed", "reflect(V, N)", "-reflect(V, N)"),
        structural("normal of the triangle", "reflect(V, N)", "reflect(V, x.n)"),
        structural("normal of the triangle", COS, "max(0.0, dot(w, x.n))"),
        structural("not random", LOBE, "reflect(V, N)"),
        structural("no shadow test", FROM, LOOK),
        structural("radiance of another direction", FROM, "light_from(scene, x, reflect(V, N), N)"),
        *missing_or_twice("receiver cosine", f"{COS} * ", "", f"{COS} * {COS} * "),
        plain("exponent off by one", "(n + 2.0) / (n + 1.0)", "1.0"),
        plain("exponent off by one", "(n + 2.0) / (n + 1.0)", "(n + 1.0) / (n + 2.0)"),
        plain("exponent off by one", "(n + 2.0) / (n + 1.0)", "(n + 2.0) / n"),
        plain("exponent off by one", "n, rng.square()", "n + 1.0, rng.square()"),
        plain("exponent off by one", "n, rng.square()", "n - 1.0, rng.square()"),
        plain("pdf missing", "(n + 2.0) / (n + 1.0)", "(n + 2.0) / (2.0 * PI) * max(0.0, dot(w, reflect(V, N))) ** n"),
        plain("f_r missing", "(n + 2.0) / (n + 1.0)", "2.0 * PI / (n + 1.0) / max(1e-9, dot(w, reflect(V, N))) ** n"),
        *missing_or_twice("k_d", "k_s * light_from", "light_from", "k_s * k_s * light_from"),
        plain("clipped", f"{FROM} * (", f"minimum({FROM}) * ("),
        plain("uniform for cosine", LOBE, UNIFORM),
        plain("cosine for uniform", LOBE, COSINE),
        *map_variants.inside("sample_phong_lobe"),
    ),
}  # fmt: skip


def made_of(p: str, colour: str, name: str) -> Features:
    return (
        (("cos_r", "p", "one"), f"result += Vec3(dot(w, N), {p}, 1.0)"),
        (("radiance",), "result += L_env"),
        ((name,), f"result += {colour}"),
    )


FEATURES: dict[str, Features] = {
    "a3.uniform": made_of("1.0", "k_d", "k_d"),
    "a3.cosine": made_of("1.0", "k_d", "k_d"),
    "a4.brdf": made_of("p_w", "f_r", "f_r"),
    "a4.brightness": made_of("p_w", "f_r", "f_r"),
    "a5.shade": (
        (("cos_r", "lobe", "one"), "return Vec3(dot(w, N), dot(w, reflect(V, N)) ** n, 1.0)"),
        (("np1", "np2", "one"), "return Vec3(n + 1.0, n + 2.0, 1.0)"),
        (("k_d",), "return k_s"),
    ),
}
PLAIN, GLOSSY = ("lesson_sky_plain", "lesson_sky_hidden"), ("lesson_sky_glossy_plain", "lesson_sky_glossy_hidden")
ALONE: dict[str, tuple[str, ...]] = {
    "a3.uniform": PLAIN, "a3.cosine": PLAIN, "a4.brdf": GLOSSY, "a4.brightness": GLOSSY, "a5.shade": GLOSSY,
}  # fmt: skip
