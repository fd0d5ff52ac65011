"""Mistakes in light from the sky, and in lobes."""

from __future__ import annotations

from mutants.area_mutants import one
from mutants.patch import Edit, Mutant

UNIFORM, COSINE = "shade:env_uniform", "shade:env_cosine"
WEIGHT = "* max(0.0, dot(w, N)) * (2.0 * PI)"
HEMISPHERE = "sample_hemisphere(N, rng.square())"
ANSWER = (
    "e = scene.environment\n    exact = k_d * (e.radiance * PI + Vec3(dot(e.red, N), dot(e.green, N), dot(e.blue, N)) "
    "* (2.0 * PI / 3.0))\n    return "
)

SKIES = [
    one("a53", "pi instead of 2 pi", "sky, uniform", "MR", UNIFORM, "(2.0 * PI)", "PI", -50.1),
    one("a54", "4 pi", "sky, uniform", "MR", UNIFORM, "(2.0 * PI)", "(4.0 * PI)", 100.2),
    one("a55", "cosine sampling, and the cosine again", "sky, cosine", "MR", COSINE, "* k_d * PI",
        "* k_d * PI * dot(w, N)", -31.7),
    one("a56", "cosine's weight with uniform directions: exact under any constant sky", "sky, uniform", "MRV", UNIFORM,
        WEIGHT, "* PI", -5.1),
    one("a57", "uniform weight with cosine directions", "sky, uniform", "MRV", UNIFORM, HEMISPHERE,
        "sample_cos_hemisphere(N, rng.square())", 36.8),
    one("a58", "theta uniform", "sky, uniform; map hemisphere", "MRPJ", "sampling:sample_hemisphere", "z = u[0]",
        "z = math.cos(0.5 * PI * u[0])", 31.5),
    one("a59", "half a turn", "sky, uniform; map hemisphere", "MRPJ", "sampling:lift", "2.0 * PI * u2", "PI * u2", -18.8),
    one("a60", "degrees given to cos", "sky, uniform; map hemisphere", "PJ", "sampling:lift", "2.0 * PI * u2", "360.0 * u2", -0.2),
    one("a61", "theta and phi share a random number", "sky, uniform; map hemisphere", "MPJ", "sampling:sample_hemisphere",
        "u[1])", "u[0])", -5.2),
    one("a62", "the local direction taken for the world's", "sky, uniform", "MR", "sampling:from_frame",
        "return s * x + t * y + n * z", "return Vec3(x, y, z)", 9.1),
    one("a63", "frame not normalised", "sky, uniform; map hemisphere", "MPJ", "sampling:from_frame", "s * x + t * y + n * z",
        "s * (0.9 * x) + t * (0.9 * y) + n * z", -0.1),
    one("a64", "Malley's disk with r = u", "sky, cosine; map cosine", "MPJ", "sampling:sample_cos_hemisphere",
        "math.sqrt(1.0 - u[0]), math.sqrt(u[0])", "math.sqrt(1.0 - u[0] * u[0]), u[0]", 3.6),
    one("a65", "whole sphere with 2 pi", "sky, uniform", "MR", UNIFORM, HEMISPHERE, "sample_sphere(rng.square())", -49.8),
    one("a66", "whole sphere, |cosine|", "sky, uniform", "MR", UNIFORM, HEMISPHERE, "sample_sphere(rng.square())", -20.0,
        Edit(UNIFORM, "max(0.0, dot(w, N))", "abs(dot(w, N))"), Edit(UNIFORM, "if not shadow_toward(scene, x, w):", "if True:")),
    one("a67", "looks up the sky behind", "sky, uniform", "MR", UNIFORM, "environment.eval(w)", "environment.eval(-w)", -40.1),
    one("a68", "the sky mirrored in x", "sky, uniform", "MR", UNIFORM, "environment.eval(w)",
        "environment.eval(Vec3(-w.x, w.y, w.z))", -16.7),
    one("a69", "y up for z up", "sky, uniform", "MR", UNIFORM, "environment.eval(w)", "environment.eval(Vec3(w.x, w.z, w.y))", -1.6),
    one("a70", "z = u^(1/2.05)", "sky, cosine; map cosine", "MPJ", "sampling:sample_cos_hemisphere",
        "math.sqrt(1.0 - u[0]), math.sqrt(u[0])",
        "(1.0 - u[0]) ** (1 / 2.05), math.sqrt(1.0 - (1.0 - u[0]) ** (2 / 2.05))", 0.2),
    one("a71", "normalised cube, flipped up", "sky, uniform; map hemisphere", "MPJ", "sampling:sample_hemisphere",
        "return lift(N, z, math.sqrt((1.0 - z) * (1.0 + z)), u[1])",
        "x, y, h = 2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0, u[0] * 97.0 % 1.0\n    r = math.sqrt(x * x + y * y + h * h)\n"
        "    return from_frame(N, x / r, y / r, h / r)", -1.5),
    one("a72", "no shadow test", "blocked sky", "MR", COSINE, "if not shadow_toward(scene, x, w):", "if True:", 14.7),
    one("a72b", "the shadow ray ends at 1", "blocked sky", "MR", "shadow:shadow_toward", "math.inf", "0.1"),
    one("a73", "shadow test inverted", "blocked sky", "MR", COSINE, "if not shadow_toward", "if shadow_toward", -85.3),
    one("c19", "the factor 2 of printed cosine-hemisphere code", "map cosine; sky, cosine", "MPJ",
        "sampling:sample_cos_hemisphere", "math.sqrt(1.0 - u[0]), math.sqrt(u[0])",
        "math.sqrt(1.0 - u[0]), 2.0 * math.sqrt(u[0])"),
    one("c20", "two mistakes that cancel under a constant sky", "sky, uniform", "MRV", UNIFORM, WEIGHT, "* PI", None),
]  # fmt: skip

HIDDEN = [
    one("V1", "says uniform, samples the cosine, rightly weighed", "sky, uniform", "V", UNIFORM, WEIGHT, "* PI", 0.0,
        Edit(UNIFORM, HEMISPHERE, "sample_cos_hemisphere(N, rng.square())")),
    one("V2", "returns the exact answer", "sky, uniform", "V", UNIFORM, "return result", ANSWER + "exact", 0.0),
    one("V3", "secretly the mean of two samples", "sky, uniform", "V", UNIFORM, "return result",
        "w = sample_hemisphere(N, rng.square())\n    return (result + scene.environment.eval(w) * k_d "
        "* max(0.0, dot(w, N)) * (2.0 * PI)) * 0.5", 0.0),
    one("V4a", "nine tenths the exact answer", "sky, uniform", "V", UNIFORM, "return result", ANSWER + "exact * 0.9 + result * 0.1", 0.0),
    one("V4b", "a twentieth the exact answer", "sky, uniform", "V", UNIFORM, "return result",
        ANSWER + "exact * 0.05 + result * 0.95", 0.0),
    one("V5", "says cosine, samples uniformly, rightly weighed", "sky, cosine", "VR", COSINE, "sample_cos_hemisphere(N, rng.square())",
        HEMISPHERE, 0.0, Edit(COSINE, "* k_d * PI", "* k_d * (2.0 * PI) * dot(w, N)")),
    one("V6", "says by the BRDF, samples uniformly, rightly weighed", "sky, brdf", "VR", "brdf:Lambertian.sample",
        "w = sample_cos_hemisphere(N, u)\n        return w, pdf_cos_hemisphere(N, w)", "return sample_hemisphere(N, u), 0.5 / PI", 0.0),
    one("V8", "says by brightness, samples the hemisphere, rightly weighed", "sky, brightness", "VR",
        "environment:GradientEnvironment.sample", "return w, self.pdf(N, w)", "return sample_hemisphere(N, u), 0.5 / PI", 0.0),
]  # fmt: skip

IMAGES = [
    one("a74", "rows without their solid angle, pdf as well", "image", "MR", "environment:cell_pdf",
        "2.0 * PI / env.columns * (env.heights[row] - env.heights[row + 1])",
        "4.0 * PI / (env.columns * env.rows)", 134.1),
    one("a75", "rows by their solid angle, pdf without it", "image", "MR", "environment:cell_pdf",
        "(env.heights[row] - env.heights[row + 1])", "(PI / env.rows)", 133.7),
    one("a82", "no samples where the sky is dim", "image", "MR", "sky:image_environment", "weights = brightness * ",
        "weights = np.where(brightness < 2.0, 0.0, brightness) * ", -8.0),
    one("a76", "pdf per image area instead of solid angle", "image", "MR", "environment:cell_pdf", "/ solid_angle",
        "* env.rows * env.columns", -88.2),
    one("a77", "pdf as if all texels were as large", "image", "MR", "environment:cell_pdf", "/ solid_angle",
        "* (env.rows * env.columns / (4.0 * PI))", 48.5),
    one("a78", "1 / p forgotten", "image", "MR", "shade:env_brightness", " / p_w)", ")", 369.8),
    one("a79", "looks up the next column", "image", "MR", "environment:Nearest.eval", "int(u * self.width), self.width - 1)",
        "int(u * self.width) + 1, self.width - 1)", 2.2),
    one("a79b", "looks up half a texel further", "image", "MR", "environment:Nearest.eval", "int(u * self.width), self.width - 1)",
        "int(u * self.width + 0.5), self.width - 1)"),
    one("a80", "radiance clamped to 10 of 160", "image", "MR", "shade:env_brightness", "L_env = scene.environment.eval(w)",
        "L_env = scene.environment.eval(w)\n        L_env = Vec3(min(L_env.x, 10.0), min(L_env.y, 10.0), min(L_env.z, 10.0))", -23.6),
    one("a81", "radiance clamped to 0.975 of the brightest", "image", "M", "shade:env_brightness",
        "L_env = scene.environment.eval(w)",
        "L_env = scene.environment.eval(w)\n        L_env = Vec3(min(L_env.x, 117.0), min(L_env.y, 78.0), min(L_env.z, 156.0))", -0.7),
    one("c21", "a row's share for a cell's", "image", "MR", "environment:cell_pdf", "return p_row * p_cell", "return p_row * p_row"),
    one("c22", "cell chosen, but its corner taken", "image", "MR", "environment:Nearest.sample_cell", "return h, v, 1.0",
        "return 0.0, 0.0, 1.0"),
    one("c23", "longitude from the other side", "image", "MR", "environment:angles", "turn(x, -z)", "turn(-x, -z)"),
    one("c24", "cosine forgotten", "image", "MR", "shade:env_brightness", "max(0.0, dot(w, N))", "1.0"),
    one("c25", "gradient: pdf over the hemisphere, samples over the sphere", "sky, brightness", "MR",
        "environment:GradientEnvironment.pdf", "(4.0 * PI * self.a)", "(2.0 * PI * self.a)"),
]  # fmt: skip

LOBES = [
    one("a84", "lobe normalised by (n + 1)", "lobe", "MR", "brdf:Phong.eval", "(self.n + 2.0)", "(self.n + 1.0)", -8.1),
    one("a85", "pdf normalised by (n + 2)", "lobe; map Phong", "MPJ", "sampling:pdf_phong_lobe", "(n + 1.0)", "(n + 2.0)", -8.2),
    one("a86", "z = u^(1/n)", "lobe; map Phong", "MPJ", "sampling:sample_phong_lobe", "/ (n + 1.0)", "/ n", 0.2),
    one("a86b", "z = u^(1/(n+2))", "lobe; map Phong", "MPJ", "sampling:sample_phong_lobe", "/ (n + 1.0)", "/ (n + 2.0)"),
    one("a87", "no cosine at the receiver", "lobe", "MR", "shade:env_brdf", "max(0.0, dot(w, N))", "1.0", 182.0),
    one("a88", "|cosine|, and samples below the surface counted", "lobe", "MR", "shade:env_brdf", "max(0.0, dot(w, N))",
        "abs(dot(w, N))", 7.6, Edit("shade:env_brdf", "if not shadow_toward(scene, x, w):", "if True:")),
    one("a89", "negative cosines kept", "lobe", "R", "shade:env_brdf", "max(0.0, dot(w, N))", "dot(w, N)", -7.8,
        Edit("shade:env_brdf", "if not shadow_toward(scene, x, w):", "if True:")),
    one("a90", "draws again what falls below the surface", "lobe", "MR", "shade:env_brdf", "w, p_w = brdf.sample(V, N, rng.square())",
        "w, p_w = brdf.sample(V, N, rng.square())\n    while dot(w, N) <= 0.0:\n        w, p_w = brdf.sample(V, N, rng.square())", 18.9),
    one("a91", "samples about N, pdf about R: the slide's brdf.sample(N)", "lobe", "MR", "brdf:Phong.sample",
        "sample_phong_lobe(reflect(V, N)", "sample_phong_lobe(N", 207.3),
    one("a92", "wrong sign in the mirror direction", "lobe", "MR", "brdf:Phong.sample", "sample_phong_lobe(reflect(V, N)",
        "sample_phong_lobe(V", -92.3),
    one("a93", "half vector for the mirror direction", "lobe", "MR", "brdf:Phong.eval", "cos_power(reflect(V, self.N), self.n, L)",
        "cos_power(self.N, self.n, (V + L) / (2.0 + 2.0 * dot(V, L)) ** 0.5)", 275.1),
    one("a94", "chosen lobe only, without its probability", "diffuse and lobe", "MR", "brdf:Phong.pdf",
        "return diffuse * pdf_cos_hemisphere(N, w) + (1.0 - diffuse) * lobe", "return pdf_cos_hemisphere(N, w) + lobe", -50.0),
    one("a95", "whole BRDF over the pdf of the chosen lobe: unbiased, of infinite variance", "diffuse and lobe", "R",
        "brdf:Phong.sample", "return w, max(self.pdf(V, w, N), 2.0**-1000)",
        "lobe = pdf_phong_lobe(reflect(V, N), self.n, w)\n"
        "        return w, max(pdf_cos_hemisphere(N, w) if u[0] < diffuse else lobe, 2.0**-1000)", -1.3),
    one("c26", "diffuse part left out of the pdf", "diffuse and lobe", "MR", "brdf:Phong.pdf",
        "diffuse * pdf_cos_hemisphere(N, w) + ", ""),
    one("c27", "lobes not chosen by their albedos", "diffuse and lobe", "R", "brdf:diffuse_share",
        "luminance(brdf.k_d) * PI", "luminance(brdf.k_d) * 1.0"),
]  # fmt: skip

MUTANTS: list[Mutant] = [*SKIES, *HIDDEN, *IMAGES, *LOBES]
