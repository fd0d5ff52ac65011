"""Map variants: what can go wrong with plain functions: samplers of directions and lens points, densities, weights."""

from __future__ import annotations

from raylab.grading.variant import Variant

HEIGHT = "math.sqrt((1.0 - z) * (1.0 + z))"  # the sine that goes with z


def wrong(cause: str, *bodies: str) -> tuple[Variant, ...]:
    """Other bodies of the solution; all may also be wrong by a factor."""
    return tuple(Variant(cause, structural=True, body=body) for body in bodies)


def drawn(axis: str, z: str, r: str = HEIGHT) -> str:
    """A direction at the height z, on a circle of radius r."""
    return f"z = {z}\nreturn lift({axis}, z, {r}, u[1])"


def directions(axis: str, z: str) -> tuple[Variant, ...]:
    """What can go wrong with any direction around `axis` whose height is z."""
    head = f"z = {z}\nr, phi = {HEIGHT}, 2.0 * PI * u[1]\n"
    a, b = "r * math.cos(phi)", "r * math.sin(phi)"
    return (
        *wrong("half a turn", *(f"{head}return lift({axis}, z, r, {u})" for u in ("0.5 * u[1]", "u[1] / (2.0 * PI)"))),
        *wrong("one random number for two", f"{head}return lift({axis}, z, r, u[0])"),
        *wrong("not random", f"return {axis}", *(f"u = {u}\n{drawn(axis, z)}" for u in ("(0.5, u[1])", "(u[0], 0.5)"))),
        *wrong("not turned to the axis", f"{head}return Vec3({a}, {b}, z)"),
        *wrong("axes exchanged", *(f"{head}return from_frame({axis}, {c})" for c in (f"z, {a}, {b}", f"{a}, z, {b}"))),
        *wrong("below the horizon", drawn(axis, f"-({z})")),
        *wrong("sine for cosine", f"{head}return lift({axis}, r, z, u[1])"),
        *wrong("not of unit length", f"{head}return from_frame({axis}, math.cos(phi), math.sin(phi), z)"),
        *wrong("not of unit length", drawn(axis, z, "math.sqrt(1.0 - z)"), drawn(axis, z, "1.0 - z")),
    )


TO_SQUARE = "x, y = 2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0\n"
ANGLE = "math.cos(0.5 * PI * u[0])"
HEMISPHERE = (
    *directions("N", "u[0]"),
    *wrong("cosine for uniform", drawn("N", "math.sqrt(1.0 - u[0])"), drawn("N", "math.sqrt(u[0])")),
    *wrong("another power of the cosine", drawn("N", "u[0] * u[0]")),
    *wrong("angle for height", drawn("N", ANGLE)),
    *wrong("whole sphere", drawn("N", "1.0 - 2.0 * u[0]")),
    *wrong("square for disk", f"{TO_SQUARE}return normalize(from_frame(N, x, y, 1.0))"),
)
COS_HEMISPHERE = (
    *directions("N", "math.sqrt(1.0 - u[0])"),
    *wrong("uniform for cosine", drawn("N", "u[0]"), drawn("N", "1.0 - u[0]")),
    *wrong("another power of the cosine", drawn("N", "(1.0 - u[0]) ** (1.0 / 3.0)")),
    *wrong("no square root", drawn("N", "math.sqrt(1.0 - u[0] * u[0])")),
    *wrong("angle for height", drawn("N", ANGLE)),
    *wrong("whole sphere", drawn("N", "1.0 - 2.0 * u[0]")),
    *wrong("square for disk", f"{TO_SQUARE}return from_frame(N, x, y, math.sqrt(max(0.0, 1.0 - x * x - y * y)))"),
)
PHONG = "(1.0 - u[0]) ** (1.0 / (n + 1.0))"
PHONG_LOBE = (
    *directions("R", PHONG),
    *wrong("exponent off by one", *(drawn("R", PHONG.replace("n + 1.0", n)) for n in ("n", "n + 2.0"))),
    *wrong("power for root", *(drawn("R", f"(1.0 - u[0]) ** {n}") for n in ("(n + 1.0)", "n"))),
    *wrong("exponent missing", drawn("R", "u[0]"), drawn("R", "1.0 - u[0]"), drawn("R", "math.sqrt(1.0 - u[0])")),
    *wrong("another power of the cosine", *(drawn("R", f"({PHONG}) ** {e}") for e in ("0.5", "2.0"))),
    *wrong("angle for height", drawn("R", f"math.cos(0.5 * PI * {PHONG})")),
)
COSINE_POWER, NORM = "cos_power(R, n, w)", "(n + 1.0) / (2.0 * PI)"
PHONG_PDF = (
    *wrong("normalisation missing", f"return {COSINE_POWER}"),
    *wrong("exponent off by one", *(f"return {m} / (2.0 * PI) * {COSINE_POWER}" for m in ("n", "(n + 2.0)"))),
    *wrong("exponent off by one", *(f"return {NORM} * cos_power(R, {m}, w)" for m in ("n + 1.0", "n - 1.0"))),
    *wrong("pdf multiplied", f"return 2.0 * PI / (n + 1.0) * {COSINE_POWER}"),
    *wrong("lobe behind R", *(f"return {NORM} * {c} ** n" for c in ("dot(R, w)", "abs(dot(R, w))"))),
    *wrong(
        "exponent missing",
        f"return {NORM} * max(0.0, dot(R, w))",
        *(f"return {m} if dot(R, w) > 0.0 else 0.0" for m in ("0.5 / PI", NORM)),
    ),
)
APERTURE = (
    *wrong("no square root", "r, phi = u[0], 2.0 * PI * u[1]\nreturn a * r * math.cos(phi), a * r * math.sin(phi)"),
    *wrong("radius missing", "return sample_disk(u)"),
    *wrong("radius power", "x, y = sample_disk(u)\nreturn a * a * x, a * a * y"),
    *wrong("radius power", "x, y = sample_disk(u)\nreturn math.sqrt(a) * x, math.sqrt(a) * y"),
    *wrong("square for disk", f"{TO_SQUARE}return a * x, a * y", "return a * u[0], a * u[1]"),
    *wrong("half a turn", "x, y = sample_disk((u[0], 0.5 * u[1]))\nreturn a * x, a * y"),
    *wrong("half a turn", "x, y = sample_disk((u[0], u[1] / (2.0 * PI)))\nreturn a * x, a * y"),
    *wrong("one random number for two", "x, y = sample_disk((u[0], u[0]))\nreturn a * x, a * y"),
    *wrong("on the rim", "x, y = sample_disk((1.0, u[1]))\nreturn a * x, a * y"),
    *wrong("not random", "return 0.0, 0.0"),
)
P = "Vec3(px, py, 0.0)"
LENS = (
    *wrong("focus sphere", *(f"d = normalize(toward) * f - {P}\nreturn d{by}" for by in (" / d.z", "", " / f"))),
    *wrong("lens point ignored", "return toward"),
    *wrong("lens point added", f"return toward + {P} / f"),
    *wrong("not divided by f", f"return toward - {P}"),
    *wrong("multiplied by f", f"return toward - {P} * f"),
    *wrong("z is not 1", f"return toward * f - {P}", f"return normalize(toward - {P} / f)"),
    *wrong("axes exchanged", "return toward - Vec3(py, px, 0.0) / f"),
    *wrong("focus point missing", f"return toward / f - {P}", f"d = toward - {P}\nreturn Vec3(d.x / f, d.y / f, 1.0)"),
    *wrong("backwards", f"d = {P} - toward * f\nreturn d"),
)
TIME = (
    *wrong("opening missing", "return u * (close - open)"),
    *wrong("shutter not scaled", "return open + u", "return u"),
    *wrong("interval for end", "return open + u * close", "return u * close"),
    *wrong("reversed", "return close + u * (open - close)"),
    *wrong("not random", "return 0.5 * (open + close)", "return open", "return close"),
)
BETWEEN = "return p0 * (1.0 - s) + p1 * s"
CLAMPED = "s = min(max(s, 0.0), 1.0)\n"
MOTION = (
    *wrong("not clamped", f"s = (t - t0) / (t1 - t0)\n{BETWEEN}"),
    *wrong("not clamped", *(f"s = {c}((t - t0) / (t1 - t0), {e})\n{BETWEEN}" for c, e in (("min", 1.0), ("max", 0.0)))),
    *wrong("reversed", f"s = 1.0 - (t - t0) / (t1 - t0)\n{CLAMPED}{BETWEEN}"),
    *wrong("time not scaled", f"s = t - t0\n{CLAMPED}{BETWEEN}", f"s = t\n{CLAMPED}{BETWEEN}"),
    *wrong("beginning missing", f"s = t / (t1 - t0)\n{CLAMPED}{BETWEEN}", f"s = t / t1\n{CLAMPED}{BETWEEN}"),
    *wrong("beginning missing", f"s = (t - t0) / t1\n{CLAMPED}{BETWEEN}"),
    *wrong("reversed", f"s = (t1 - t) / (t1 - t0) if t0 < t < t1 else (0.0 if t <= t0 else 1.0)\n{BETWEEN}"),
    *wrong("time not scaled", f"s = min(max(t, t0), t1) - t0\n{BETWEEN}"),
    *wrong("jumps", "return p0 if t < t1 else p1", "return p1 if t > t0 else p0"),
    *wrong("jumps", "return p0 if t < 0.5 * (t0 + t1) else p1"),
    *wrong("not even", f"s = (t - t0) / (t1 - t0)\n{CLAMPED}s = s * s * (3.0 - 2.0 * s)\n{BETWEEN}"),
    *wrong("velocity for position", f"s = (t - t0) / (t1 - t0)\n{CLAMPED}return p0 + p1 * s"),
    *wrong("velocity for position", f"s = (t - t0) / (t1 - t0)\n{CLAMPED}return (p1 - p0) * s"),
    *wrong("not random", "return p0", "return p1"),
)


def weights(P: str, Q: str) -> tuple[Variant, ...]:
    """What can go wrong with the weight P / (P + Q)."""
    return (
        *wrong("weights exchanged", f"return {Q} / ({P} + {Q})"),
        *wrong("weights of one half", "return 0.5"),
        *wrong("sum missing", f"return {P} / {Q}", f"return {P}", "return 1.0"),
        *wrong("greater one takes all", "return 1.0 if p > q else 0.0"),
        *wrong("epsilon", *(f"return {P} / ({P} + {Q} + {e})" for e in ("1e-3", "1e-6"))),
        *wrong("squares", "return p * p / (p + q)", "return math.sqrt(p / (p + q))", "return (p / (p + q)) ** 2"),
    )


SQUARES = ("(p * p)", "(q * q)")
VARIANTS: dict[str, tuple[Variant, ...]] = {
    "a3.hemisphere": HEMISPHERE,
    "a3.cos_hemisphere": COS_HEMISPHERE,
    "a5.lobe": PHONG_LOBE,
    "a5.pdf": PHONG_PDF,
    "a6.aperture": APERTURE,
    "a6.lens": LENS,
    "a6.time": TIME,
    "a6.motion": MOTION,
    "a7.balance": (
        *weights("p", "q"),
        *wrong("other heuristic", "return 1.0 / (1.0 + (q / p) ** 2) if p > 0.0 else 0.0"),
        *wrong("weights exchanged", "return 1.0 / (1.0 + (p / q) ** 2)"),
    ),
    "a7.power": (
        *weights(*SQUARES),
        *wrong("other heuristic", "return p / (p + q)"),
        *wrong("overflow", *("return {0} / ({0} + {1})".format(*s) for s in (SQUARES, ("p**2", "q**2")))),
        *wrong("weights exchanged", "return q / (p + q)", "return 1.0 / (1.0 + (p / q) ** 2) if p > 0.0 else 0.0"),
    ),
}
SAMPLERS = {
    "sample_hemisphere": ("N, u", HEMISPHERE),
    "sample_cos_hemisphere": ("N, u", COS_HEMISPHERE),
    "sample_phong_lobe": ("R, n, u", PHONG_LOBE),
}


def inside(sampler: str) -> tuple[Variant, ...]:
    """A right function that calls a wrong sampler, which it has by that name."""
    arguments, variants = SAMPLERS[sampler]
    head = f"def {sampler}({arguments}):\n    "
    return tuple(Variant(v.cause, helper=head + v.body.replace("\n", "\n    ")) for v in variants)
