"""Mistakes in light from areas, points and directions. `bias` is the table's, of another scene: an orientation only."""

from __future__ import annotations

from mutants.patch import Edit, Mutant

AREA = "shade:area_diffuse"
COSINES = "max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n))"
NO_SELF = (
    Edit("shadow:shadow", "dot(x.n, d) <= 0.0 or ", ""),
    Edit("shadow:shadow", "x.p + x.n * x.slack", "x.p + x.n * (x.slack if dot(x.n, d) > 0.0 else -x.slack)"),
)
NO_BACK = (
    Edit("shadow:shadow", " or facing < reach", ""),
    Edit(
        "shadow:shadow", "y.p + y.n * reach - origin", "y.p + y.n * (reach if dot(y.n, d) < 0.0 else -reach) - origin"
    ),
)


def one(
    name: str, what: str, trial: str, test: str, where: str, old: str, new: str, bias: float | None = None, *more: Edit
):
    return Mutant(name, what, trial, test, (Edit(where, old, new), *more), bias, f"3a {name[1:]}")


RECTANGLE = [
    one("a1", "no cosine at the receiver", "rectangle", "MR", AREA, "max(0.0, dot(L, N)) * ", "", 10.4),
    one("a2", "no cosine at the light", "rectangle", "MR", AREA, " * max(0.0, dot(-L, y.n))", "", 18.9),
    one("a3", "both cosines missing", "rectangle", "MR", AREA, "* " + COSINES, "", 31.6),
    one("a4", "1/r instead of 1/r^2", "large rectangle", "MR", AREA, "/ dist_sqr(x, y)", "/ dist_sqr(x, y) ** 0.5", 20.8),
    one("a5", "1/r^3", "rectangle", "MR", AREA, "/ dist_sqr(x, y)", "/ dist_sqr(x, y) ** 1.5", -15.7),
    one("a6", "L not normalised", "rectangle", "MR", AREA, "L = normalize(y - x)", "L = y - x", 48.8),
    one("a7", "multiplies by p instead of dividing", "rectangle", "MR", AREA, "/ p_y", "* p_y", -76.9),
    one("a8", "pdf forgotten", "rectangle", "MR", AREA, "/ p_y", "", -51.9),
    one("a9", "area 1 % too large", "rectangle", "MR", "light_shapes:RectangleShape.sample", "1.0 / light.area",
        "1.0 / (1.01 * light.area)", 0.9),
    one("a10", "area not scaled with the object (1.05 x)", "rectangle", "MR", "light_shapes:RectangleShape.sample",
        "1.0 / light.area", "1.05 ** 2 / light.area", -9.3),
    one("a11", "one 1/pi too many", "rectangle", "MR", AREA, "* k_d\n", "* k_d / 3.141592653589793\n", -68.2),
    one("a12", "one pi too many", "rectangle", "MR", AREA, "* k_d\n", "* k_d * 3.141592653589793\n", 214.1),
    one("a13", "k_d squared", "rectangle", "MR", AREA, "* k_d\n", "* k_d * k_d\n", -40.0),
    one("a14", "the same random number for both axes", "horizon", "MR", "light_shapes:RectangleShape.sample",
        "light.e2 * u[1]", "light.e2 * u[0]", 5.4),
    one("a15", "samples half of the light", "blocked", "MR", "light_shapes:RectangleShape.sample",
        "light.e1 * u[0]", "light.e1 * (0.5 * u[0])", 35.5),
    one("a16", "corner taken for centre", "rectangle", "MR", "light_shapes:RectangleShape.sample",
        "light.e1 * u[0]", "light.e1 * (u[0] - 0.5)", -19.1),
    one("a17", "normal of the light flipped", "rectangle", "MR", "light_shapes:RectangleShape.sample",
        "facet_point(y, light.n,", "facet_point(y, -light.n,", -100.0),
    one("a18", "receiver's normal not normalised (1.02)", "rectangle", "MR", AREA, "dot(L, N)", "dot(L, N * 1.02)", 1.9),
    one("a19", "firefly clamp at nine tenths of the largest sample", "rectangle", "M", AREA, "return result",
        "top = k_d * Vec3(3.0, 2.0, 4.0) * 0.4824\n"
        "    return Vec3(min(result.x, top.x), min(result.y, top.y), min(result.z, top.z))", -0.6),
    one("a20", "firefly clamp at 1.05 times the mean", "rectangle", "MR", AREA, "return result",
        "top = k_d * Vec3(3.0, 2.0, 4.0) * 0.4503\n"
        "    return Vec3(min(result.x, top.x), min(result.y, top.y), min(result.z, top.z))",
        -3.8),
    one("a21", "rounded to 1/255 of 1", "rectangle", "M", AREA, "return result",
        "return Vec3(round(result.x * 255) / 255, round(result.y * 255) / 255, round(result.z * 255) / 255)", -0.4),
    one("c1", "red and blue exchanged", "rectangle", "MR", AREA, "return result", "return Vec3(result.z, result.y, result.x)"),
    one("c2", "light's colour taken for grey", "rectangle", "MR", AREA, "light.radiance * k_d",
        "dot(light.radiance, Vec3(0.3, 0.4, 0.3)) * k_d"),
    one("c3", "area factor missing, invisible where A = 1", "large rectangle", "MR", "light_shapes:RectangleShape.sample",
        "1.0 / light.area", "1.0"),
    one("c4", "emission twice", "rectangle", "MR", AREA, "result += (light.radiance", "result += 2.0 * (light.radiance"),
    one("c5", "NaN now and then", "rectangle", "R", AREA, "/ p_y", "/ p_y * (1e308 * 10.0 - 1e308 * 10.0 if dot(L, N) > 0.75 else 1.0)"),
    one("c6", "pdf per solid angle where one per area is needed", "rectangle, solid angle", "MR",
        "light_shapes:Flat.pdf_solid_angle", " * to_area(x, y)", ""),
    one("c7", "light without a BRDF", "rectangle, any BRDF", "MR", "shade:area", "light.radiance * f_r", "light.radiance"),
    one("c8", "BRDF evaluated with the arguments of a mirror", "two methods", "MR", "direct:by_light",
        "light.radiance * brdf.eval(V, L)", "light.radiance * brdf.eval(V, -L)"),
]  # fmt: skip

SHADOWS = [
    one("a22", "cosine at the receiver not clamped", "horizon", "R", AREA, "max(0.0, dot(L, N))", "dot(L, N)", -135.5,
        *NO_SELF),
    one("a23", "|cosine| at the receiver, as on the slide", "horizon", "MR", AREA, "max(0.0, dot(L, N))", "abs(dot(L, N))",
        136.2, *NO_SELF),
    one("a24", "|cosine| at the light, as on the slide", "facing away", "MR", AREA, "max(0.0, dot(-L, y.n))",
        "abs(dot(-L, y.n))", 3.7, *NO_BACK),
    one("a25", "cosine at the light not clamped", "facing away", "MR", AREA, "max(0.0, dot(-L, y.n))", "dot(-L, y.n)",
        -3.8, *NO_BACK),
    one("a26", "no shadow test", "blocked", "MR", AREA, "if not shadow(scene, x, y):", "if True:", 40.3),
    one("a27", "shadow test inverted", "blocked", "MR", AREA, "if not shadow(scene, x, y):", "if shadow(scene, x, y):", -59.5),
    one("a28", "shadow ray without an end", "blocked, and one behind", "MR", "shadow:shadow", "- origin), 1.0)",
        "- origin), math.inf)", -12.1),
    one("a29", "half of the shadow rays meet their own surface", "rectangle", "MR", AREA, "if not shadow(scene, x, y):",
        "if not shadow(scene, x, y) and rng.number() < 0.5:", -50.1),
    one("a30", "1 % of the shadow rays meet their own surface", "rectangle", "MR", AREA, "if not shadow(scene, x, y):",
        "if not shadow(scene, x, y) and rng.number() < 0.99:", -1.0),
    one("a31", "the light shadows itself", "rectangle", "MR", "shadow:shadow", "- origin), 1.0)", "- origin), 1.01)", -100.0),
    one("a32", "one shadow ray, to the light's first corner, for all samples", "blocked", "MR", AREA,
        "if not shadow(scene, x, y):", "if not shadow(scene, x, light.sample(x, (0.5, 0.5))[0]):", 40.5),
    one("a33", "shadow rays start 0.05 away: a blocker nearby is missed", "blocked nearby", "MR", "shadow:shadow",
        "x.p + x.n * x.slack", "x.p + x.n * 0.05", 2.1),
    one("c9", "the sky's shadow ray starts below the surface", "blocked sky", "MR", "shadow:shadow_toward",
        "x.p + x.n * x.slack", "x.p - x.n * x.slack"),
]  # fmt: skip

LIGHTS = [
    one("a34", "only the first light", "two lights", "MR", AREA, "/ p_y)  # fmt: skip", "/ p_y)\n            break", -52.9),
    one("a35", "= instead of +=: the last light only", "two lights", "MR", AREA, "result += (light", "result = (light", -47.1),
    one("a36", "divides by the number of lights", "two lights", "MR", AREA, "return result", "return result / 2.0", -50.0),
    one("a37", "one light by chance, without 1/p", "two lights", "MR", AREA, "if not shadow(scene, x, y):",
        "chosen = rng.number() < 0.5\n        if chosen and not shadow(scene, x, y):", -50.0),
    one("a38", "the first light's p for every light", "two lights", "MR", AREA, "/ p_y)", "* scene.lights[0].area)", 2.2),
    one("a39", "chosen 0.45 : 0.55, weighed as even", "two lights", "MR", AREA, "if not shadow(scene, x, y):",
        "share = 0.45 if light.radiance.x < 5.0 else 0.55\n"
        "        result += black if rng.number() < share else black\n"
        "        if not shadow(scene, x, y) and rng.number() < share:", 1.8),
    one("c10", "a light's radiance of another light", "two lights", "MR", AREA, "light.radiance * k_d",
        "scene.lights[0].radiance * k_d"),
    one("b1", "point light: no 1/r^2", "point", "R", "shade:point_light", " / dist_sqr(x, y)", ""),
    one("b2", "point light: no cosine", "point", "MR", "shade:point_light", " * max(0.0, dot(L, N))", ""),
    one("b3", "point light counted twice, as the released Mitsuba 3.9.1 does", "point", "MR", "shade:point_light",
        "result += light.I", "result += 2.0 * light.I"),
    one("b4", "point light: power taken for intensity", "point", "MR", "shade:point_light", "light.I * f_r",
        "light.I * f_r / (4.0 * PI)"),
    one("b5", "sun: no cosine", "sun", "MR", "shade:directional_light", " * max(0.0, dot(w, N))", ""),
    one("b6", "sun: direction reversed", "sun", "MR", "shade:directional_light", "w = light.w", "w = -light.w"),
    one("b7", "sun: divided by r^2 = 4", "sun", "MR", "shade:directional_light", "light.I * f_r", "light.I * f_r / 4.0"),
]  # fmt: skip

SHAPES = [
    one("a40", "triangle: b = (u, (1 - u) v)", "triangle", "MR", "sampling:sample_triangle",
        "return root * (1.0 - u[1]), root * u[1]", "return u[0], (1.0 - u[0]) * u[1]", -25.0),
    one("a42", "triangle: area without 1/2", "triangle", "MR", "light_shapes:TriangleShape.sample", "1.0 / light.area",
        "1.0 / (2.0 * light.area)", 100.2),
    one("a43", "triangle: not folded, the parallelogram", "triangle", "MR", "sampling:sample_triangle",
        "return root * (1.0 - u[1]), root * u[1]", "return u[0], u[1]", -40.1),
    one("a41", "triangle: three numbers normalised", "triangle", "MR", "sampling:sample_triangle",
        "return root * (1.0 - u[1]), root * u[1]",
        "w = u[0] * 97.0 % 1.0\n    return u[0] / (u[0] + u[1] + w), u[1] / (u[0] + u[1] + w)", 7.3),
    one("a44", "disk: r = u", "disk", "MR", "sampling:sample_disk", "math.sqrt(u[0])", "u[0]", 6.0),
    one("a45", "disk: half a turn", "disk; map disk", "MPJ", "sampling:sample_disk", "2.0 * PI * u[1]", "PI * u[1]", 0.2),
    one("a46", "disk: 6.0 for 2 pi", "disk; map disk", "MPJ", "sampling:sample_disk", "2.0 * PI * u[1]", "6.0 * u[1]", 2.6),
    one("a47", "disk: the square around it, with pi R^2", "disk", "MR", "sampling:sample_disk",
        "return r * math.cos(phi), r * math.sin(phi)", "return 2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0", -6.7),
    one("a48", "sphere: theta uniform", "inside a ball", "MR", "sampling:sample_sphere",
        "return Vec3(r * math.cos(phi), r * math.sin(phi), 1.0 - 2.0 * u[0])",
        "t = PI * u[0]\n    return Vec3(math.sin(t) * math.cos(phi), math.sin(t) * math.sin(phi), math.cos(t))", 17.9),
    one("a50", "sphere: pdf 1 / (2 pi R^2)", "inside a ball", "MR", "light_shapes:SphereShape.sample",
        "outwards * side), 1.0 / light.area", "outwards * side), 2.0 / light.area", -50.1),
    one("a51", "cone: the sine taken for the tangent", "ball", "MR", "light_shapes:SphereShape.sample",
        "to_centre / d, radius / d", "to_centre / d, math.sin(math.atan(radius / d))", -13.8),
    one("a52", "cone: theta uniform", "ball; map cone", "MPJ", "sampling:sample_cone", "x = u[0] * one_minus_cos(sin_max)",
        "x = 1.0 - math.cos(u[0] * math.asin(sin_max))", 1.4),
    one("c11", "cone: normal of the far side", "ball", "MR", "light_shapes:first_normal", "w * -cosine - sine", "w * cosine - sine"),
    one("c12", "sphere's pdf without the distance", "ball", "MR", "light_shapes:SphereShape.sample", " * dist_sqr(x, y))", ")"),
    one("c13", "sphere: light from inside treated as from outside", "inside a ball", "MR", "light_shapes:SphereShape.sample",
        "outwards * side), 1.0 / light.area", "outwards), 1.0 / light.area"),
    one("c14", "solid angle: Omega of half of the rectangle", "rectangle, solid angle", "MR",
        "light_shapes:RectangleShape.pdf_angle", "pdf_rectangle_angle(a, light.e1, light.e2)",
        "(2.0 * pdf_rectangle_angle(a, light.e1, light.e2))"),
]  # fmt: skip

METHODS = [
    one("c15", "MIS: area measure next to solid angle", "two methods", "MR", "direct:by_light",
        "brdf.pdf(V, L, N) * jacobian)", "brdf.pdf(V, L, N))"),
    one("c16", "MIS: weights of one side only", "two methods", "MR", "direct:by_brdf", "balance(p_w, p_light)", "1.0"),
    one("c17", "MIS: BRDF's samples below the horizon kept", "two methods", "=", "direct:by_brdf", " or dot(w, N) <= 0.0", ""),
    one("c18", "MIS: the pdf is off by 0.93", "two methods", "MR", "brdf:Phong.pdf",
        "return diffuse * pdf_cos_hemisphere(N, w) + (1.0 - diffuse) * lobe",
        "return 0.93 * (diffuse * pdf_cos_hemisphere(N, w) + (1.0 - diffuse) * lobe)"),
]  # fmt: skip

EQUIVALENT = [
    one("e1", "cosine at the receiver not clamped: shadow() has looked already", "horizon", "=", AREA,
        "max(0.0, dot(L, N))", "dot(L, N)"),
    one("e2", "|cosine| at the light: shadow() has looked already", "facing away", "=", AREA, "max(0.0, dot(-L, y.n))",
        "abs(dot(-L, y.n))"),
    one("e3", "sqrt(1 - u) for sqrt(u)", "triangle", "=", "sampling:sample_triangle", "math.sqrt(u[0])", "math.sqrt(1.0 - u[0])"),
    one("e4", "triangle folded (Turk) instead of square root", "triangle", "=", "sampling:sample_triangle",
        "return root * (1.0 - u[1]), root * u[1]",
        "return (u[0], u[1]) if u[0] + u[1] <= 1.0 else (1.0 - u[0], 1.0 - u[1])"),
    one("e5", "the disk by concentric squares", "disk", "=", "sampling:sample_disk",
        "return r * math.cos(phi), r * math.sin(phi)", "return sample_concentric_disk(u)"),
    one("e6", "left-handed frame", "sky, cosine", "=", "sampling:frame", "Vec3(b, sign + n.y * n.y * a, -n.y)",
        "-Vec3(b, sign + n.y * n.y * a, -n.y)"),
    one("e7", "the disk's radius from the other end", "disk", "=", "sampling:sample_disk", "math.sqrt(u[0])",
        "math.sqrt(1.0 - u[0])"),
    one("e8", "lights summed another way", "two lights", "=", AREA, "result += (light.radiance", "result = result + (light.radiance"),
    one("e9", "p first, then the square of the distance", "rectangle", "=", AREA, "/ dist_sqr(x, y)", "/ dist_sqr(y, x)"),
    one("e10", "abs() where it cannot be negative", "sky, cosine", "=", "shade:env_cosine", "* k_d * PI", "* k_d * abs(PI)"),
    one("e11", "corners the other way round", "rectangle", "=", "light_shapes:RectangleShape.sample", "light.e1 * u[0] + light.e2 * u[1]",
        "light.e1 * (1.0 - u[0]) + light.e2 * u[1]"),
    one("e12", "a random number drawn and not used", "rectangle", "=", AREA, "result = black", "result = black * rng.number()"),
    one("e13", "uniform hemisphere from the other end", "sky, uniform", "=", "sampling:sample_hemisphere", "z = u[0]", "z = 1.0 - u[0]"),
]  # fmt: skip

MUTANTS = [*RECTANGLE, *SHADOWS, *LIGHTS, *SHAPES, *METHODS, *EQUIVALENT]
