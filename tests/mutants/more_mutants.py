"""Mistakes that a mean may not see at all: ties, picks, densities, relations between scenes, what a call does besides."""

from __future__ import annotations

from mutants.area_mutants import AREA, one
from mutants.patch import Edit

HIDDEN = [
    one("a49", "sphere: sampled all over, |cosine|: its back shines through", "ball", "MR", AREA,
        "max(0.0, dot(-L, y.n))", "abs(dot(-L, y.n))", 99.7, Edit(AREA, "if not shadow(scene, x, y):", "if True:"),
        Edit("light_shapes:SphereShape.sample", "if d2 <= radius * radius * (1.0 + 2.0**-40):", "if d2 > 0.0:")),
    one("a103", "in focus at a distance along the ray, not on a plane", "lens aslant", "M", "camera:ThinLens.ray",
        "a * self.power", "a * (self.power * length(toward))", -51.5),
    one("C3", "one time for all samples of a pixel", "shrinks direct crossing_edge", "C", "packet:Packet.drawn_time",
        "at(TIME, lane)", "at(TIME, 0)"),
    one("V7", "says by power, picks evenly, rightly weighed", "picks power; lights by power", "P",
        "light_choice:choose_by_alias", "return i, table.shares[i]",
        "return min(int(u[0] * len(table.shares)), len(table.shares) - 1), 1.0 / len(table.shares)"),
    one("V9", "firefly clamp that touches 0.01 % of the energy", "rectangle", "T", AREA, "return result",
        "top = k_d * Vec3(3.0, 2.0, 4.0) * 0.5212\n"
        "    return Vec3(min(result.x, top.x), min(result.y, top.y), min(result.z, top.z))", -0.01),
    one("P8", "1 % of the samples at the pole", "map cosine; sky, cosine", "JTP", "sampling:sample_cos_hemisphere",
        "math.sqrt(1.0 - u[0]), math.sqrt(u[0])",
        "(1.0 if u[0] < 0.01 else math.sqrt(1.0 - u[0])), (0.0 if u[0] < 0.01 else math.sqrt(u[0]))"),
    one("P10", "pdf() off by 2 %, samples come with their own", "map Lambert; sky, brdf", "QI", "brdf:Lambertian.pdf",
        "return pdf_cos_hemisphere(N, w)", "return 1.02 * pdf_cos_hemisphere(N, w)"),
    one("P10b", "the same where both are off", "map Lambert", "JI", "sampling:pdf_cos_hemisphere",
        "/ PI", "/ PI * 1.02"),
    one("P11", "always the middle of a texel", "map image; image", "TP", "environment:Nearest.sample_cell",
        "return h, v, 1.0", "return 0.5, 0.5, 1.0"),
    one("P12", "rand() % 1000", "numbers", "T", "rng:uniform", "(u64(bits) >> u64(11)) * 1.1102230246251565e-16",
        "(u64(bits) >> u64(11)) % u64(1000) * 0.001"),
    one("c31", "cone: its pdf is not 0 outside", "map cone", "I", "sampling:pdf_cone",
        "or length(cross(axis, w)) > sin_max + 2.0**-50:", "or length(cross(axis, w)) > 1.2 * sin_max:"),
    one("c32", "shadow rays have lost the time of their eye ray", "moving light", "M", "shadow:is_blocked",
        "scene.motion.time()", "0.0"),
    one("c33", "pixel: half a pixel to the side", "unbiased direct crossing_edge", "M", "camera:BoxFilter.sample",
        "self.radius * (2.0 * u[0] - 1.0)", "self.radius * 2.0 * u[0]"),
    one("c34", "point light weighed against the BRDF's samples", "point, directly", "MR", "direct:direct",
        "result = point_light(x, V, brdf, N, scene, rng)",
        "result = point_light(x, V, brdf, N, scene, rng) * balance(1.0, brdf.pdf(V, N, N))"),
    one("c35", "the light's normal is another in its pdf than in its sample", "two methods", "MR", "light_shapes:to_area",
        "-dot(d, y.n)", "dot(d, y.n)"),
    one("c36", "values rounded to 8 bits on their way into the mean", "running mean", "T", "pixels:receive",
        "step = value - mean", "value = Vec3(round(value.x * 255.0) / 255.0, value.y, value.z)\n"
        "            step = value - mean"),
]  # fmt: skip

RELATIONS = [
    one("D1", "1/r: the unit of length matters", "relation times_3 area_diffuse polygons", "D", AREA,
        "/ dist_sqr(x, y)", "/ dist_sqr(x, y) ** 0.5"),
    one("D2", "p(y) forgotten: so it does", "relation times_3 area_diffuse polygons", "D", AREA, "/ p_y)", ")"),
    one("D3", "the first light only", "relation light_order area_diffuse polygons", "D", AREA, "/ p_y)  # fmt: skip",
        "/ p_y)\n            break"),
    one("D4", "y up for z up", "relation rotated env_cosine image_sky", "D", "shade:env_cosine", "environment.eval(w)",
        "environment.eval(Vec3(w.x, w.z, w.y))"),
    one("D5", "left for right", "relation mirrored env_cosine image_sky", "D", "shade:env_cosine", "environment.eval(w)",
        "environment.eval(Vec3(-w.x, w.y, w.z))"),
    one("D6", "half of the sky's columns are dark", "relation sky_rolled env_cosine image_sky", "D",
        "environment:Nearest.eval", "return vec3_at(self.pixels, row * self.width + column)",
        "return vec3_at(self.pixels, row * self.width + column) * (1.0 if column < self.width // 2 else 0.0)"),
    one("D7", "fireflies clamped at a fixed value", "relation exposure_4 env_cosine image_sky", "D", "shade:env_cosine",
        "return result", "return Vec3(min(result.x, 0.1), min(result.y, 0.1), min(result.z, 0.1))"),
    one("D8", "radiance squared", "relation exposure_3 area_diffuse polygons", "D", AREA, "light.radiance * k_d",
        "light.radiance * light.radiance * k_d"),
    one("D9", "a little ambient light", "relation exposure_3 area_diffuse polygons", "D", AREA, "result = black",
        "result = Vec3(0.001, 0.001, 0.001)"),
    one("D10", "the world's z axis for the normal", "relation rotated area_diffuse polygons", "D", AREA,
        "max(0.0, dot(L, N))", "max(0.0, L.z)"),
    one("D11", "divided by the number of lights", "relation light_split area_diffuse polygons", "D", AREA,
        "return result", "return result / len(scene.lights)"),
    one("D12", "the lobe does not follow the view", "brdf", "D", "brdf:Phong.eval", "reflect(V, self.N)", "self.N"),
    one("D13", "the lobe without its other half: f_r(v, w) is not f_r(w, v)", "brdf", "D", "brdf:Phong.eval",
        "return self.k_d + self.k_s * lobe", "return self.k_d + self.k_s * (lobe * dot(L, self.N))"),
]  # fmt: skip

CALLS = [
    one("W1", "a random generator of its own", "watch area_diffuse polygons", "W", AREA, "rng.square()",
        "(random.random(), random.random())"),
    one("W2", "keeps state between calls", "watch area_diffuse polygons", "W", AREA, "return result",
        "CALLS.append(1)\n    return result / len(CALLS)"),
    one("W3", "changes a light", "watch area_diffuse polygons", "W", AREA, "return result",
        "scene.lights.rows[0, 1] = 0.0\n    return result"),
    one("W4", "NaN at a grazing angle", "watch area_diffuse polygons", "W", AREA, "return result",
        "return result * (1e308 * 10.0 - 1e308 * 10.0)"),
    one("W5", "returns a number for a colour", "watch area_diffuse polygons", "W", AREA, "return result",
        "return result.x"),
    one("W6", "negative light", "watch area_diffuse polygons", "W", AREA, "return result",
        "return result - Vec3(0.001, 0.001, 0.001)"),
]  # fmt: skip

MUTANTS = [*HIDDEN, *RELATIONS, *CALLS]
