# ruff: noqa
# fmt: off
"""Right answers to assignment a7, each in another manner: `balance_MANNER`, `power_MANNER`, `shade_MANNER`."""
import math
import numpy as np
from raylab.lecture import PI, Vec3, black, dist_sqr, dot, length, normalize, seen_toward, shadow, shadow_toward, to_area


# as on the slide
def balance_slide(p, q):
    return p / (p + q)


def power_slide(p, q):
    if p == 0.0:
        return 0.0
    r = q / p
    return 1.0 / (1.0 + r * r)


def shade_slide(x, V, brdf, N, scene, rng):
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            w_y = balance_slide(p_y, brdf.pdf(V, L, N) * to_area(x, y))
            result += light.radiance * brdf.eval(V, L) * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y) / p_y * w_y
    w, p_w = scene.environment.sample(N, rng.square())
    if p_w > 0.0 and not shadow_toward(scene, x, w):
        result += scene.environment.eval(w) * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w * balance_slide(p_w, brdf.pdf(V, w, N))
    w, p_w = brdf.sample(V, N, rng.square())
    if p_w > 0.0 and dot(w, N) > 0.0 and dot(w, x.n) > 0.0:
        L_i, light, p_l = seen_toward(scene, x, N, w)
        result += L_i * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w * balance_slide(p_w, p_l)
    return result


# the density of all techniques together
def balance_sum(p, q):
    total = p + q
    return p / total if total > 0.0 else 0.0


def power_sum(p, q):
    largest = max(p, q)
    if largest == 0.0:
        return 0.0
    a, b = p / largest, q / largest
    return a**2 / (a**2 + b**2)


def shade_sum(x, V, brdf, N, scene, rng):
    total = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        L = normalize(y - x)
        if shadow(scene, x, y) or dot(L, N) <= 0.0 or dot(-L, y.n) <= 0.0:
            continue
        jacobian = dot(-L, y.n) / dist_sqr(x, y)
        total += light.radiance * brdf.eval(V, L) * dot(L, N) / (p_y / jacobian + brdf.pdf(V, L, N))
    w, p = scene.environment.sample(N, rng.square())
    if p > 0.0 and not shadow_toward(scene, x, w):
        total += scene.environment.eval(w) * brdf.eval(V, w) * max(0.0, dot(w, N)) / (p + brdf.pdf(V, w, N))
    w, p = brdf.sample(V, N, rng.square())
    if p > 0.0 and dot(w, N) > 0.0 and dot(w, x.n) > 0.0:
        L_i, _, q = seen_toward(scene, x, N, w)
        total += L_i * brdf.eval(V, w) * dot(w, N) / (p + q)
    return total


# the BRDF first
def balance_ratio(p, q):
    if p == 0:
        return 0.0
    return 1 / (1 + q / p)


def power_ratio(p, q):
    if p > 0.0:
        return 1 / (1 + (q / p) ** 2)
    return 0.0


def shade_ratio(x, V, brdf, N, scene, rng):
    result = black
    w, p_w = brdf.sample(V, N, rng.square())
    if p_w > 0.0 and dot(w, N) > 0.0 and dot(w, x.n) > 0.0:
        L_i, light, p_l = seen_toward(scene, x, N, w)
        result = L_i * brdf.eval(V, w) * (dot(w, N) / p_w * balance_ratio(p_w, p_l))
    w, p_w = scene.environment.sample(N, rng.square())
    if p_w > 0.0 and not shadow_toward(scene, x, w):
        c = max(0.0, dot(w, N))
        result += scene.environment.eval(w) * brdf.eval(V, w) * (c / p_w * balance_ratio(p_w, brdf.pdf(V, w, N)))
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            g = max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y)
            result += light.radiance * brdf.eval(V, L) * (g / p_y * balance_ratio(p_y, brdf.pdf(V, L, N) * to_area(x, y)))
    return result


# helpers
def balance_helpers(p, q):
    return share(p, q, 1)


def power_helpers(p, q):
    return share(p, q, 2)


def share(p, q, beta):
    if p <= 0.0:
        return 0.0
    r = q / p
    if beta == 2:
        r *= r
    return 1.0 / (1.0 + r)


def by_light(light, x, V, brdf, N, scene, u):
    y, p_y = light.sample(x, u)
    if shadow(scene, x, y):
        return black
    L = normalize(y - x)
    f = light.radiance * brdf.eval(V, L) * max(0.0, dot(L, N)) * to_area(x, y)
    return f / p_y * share(p_y, to_area(x, y) * brdf.pdf(V, L, N), 1)


def by_sky(x, V, brdf, N, scene, u):
    w, p = scene.environment.sample(N, u)
    if p <= 0.0 or shadow_toward(scene, x, w):
        return black
    return scene.environment.eval(w) * brdf.eval(V, w) * max(0.0, dot(w, N)) / p * share(p, brdf.pdf(V, w, N), 1)


def by_brdf(x, V, brdf, N, scene, u):
    w, p = brdf.sample(V, N, u)
    if p <= 0.0 or dot(w, N) <= 0.0 or dot(w, x.n) <= 0.0:
        return black
    L, _, q = seen_toward(scene, x, N, w)
    return L * brdf.eval(V, w) * dot(w, N) / p * share(p, q, 1)


def shade_helpers(x, V, brdf, N, scene, rng):
    result = by_brdf(x, V, brdf, N, scene, rng.square()) + by_sky(x, V, brdf, N, scene, rng.square())
    for light in scene.lights:
        result += by_light(light, x, V, brdf, N, scene, rng.square())
    return result


# by index, mirrored random numbers
def balance_index(p, q):
    weights = (p, q)
    return weights[0] / (weights[0] + weights[1])


def power_index(p, q):
    total = p + q
    a, b = p / total, q / total
    return a * a / (a * a + b * b)


def mirrored(rng):
    u = rng.square()
    return 1.0 - u[0], 1.0 - u[1]


def shade_index(x, V, brdf, N, scene, rng):
    result = black
    for i in range(len(scene.lights)):
        y, p_y = scene.lights[i].sample(x, mirrored(rng))
        if shadow(scene, x, y) == False:
            L = normalize(y - x)
            p_b = brdf.pdf(V, L, N) * to_area(x, y)
            result += scene.lights[i].radiance * brdf.eval(V, L) * max(0.0, dot(L, N)) * to_area(x, y) / p_y * balance_index(p_y, p_b)
    w, p_w = scene.environment.sample(N, mirrored(rng))
    if p_w > 0.0 and not shadow_toward(scene, x, w):
        result += scene.environment.eval(w) * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w * balance_index(p_w, brdf.pdf(V, w, N))
    w, p_w = brdf.sample(V, N, mirrored(rng))
    if p_w > 0.0 and dot(w, N) > 0.0 and dot(w, x.n) > 0.0:
        seen = seen_toward(scene, x, N, w)
        result += seen[0] * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w * balance_index(p_w, seen[2])
    return result


# numpy
def balance_numpy(p, q):
    both = np.array([p, q])
    return both[0] / np.sum(both)


def power_numpy(p, q):
    both = np.array([p, q]) / np.maximum(p, q)
    return both[0] ** 2 / np.sum(both * both)


def shade_numpy(x, V, brdf, N, scene, rng):
    total = np.zeros(3)
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            d = y - x
            L = d / length(d)
            f, c = brdf.eval(V, L), np.maximum(0.0, dot(L, N)) * np.maximum(0.0, -dot(L, y.n)) / dot(d, d)
            k = c / p_y * balance_numpy(p_y, brdf.pdf(V, L, N) * to_area(x, y))
            total += np.array([light.radiance.x * f.x, light.radiance.y * f.y, light.radiance.z * f.z]) * k
    result = Vec3(total[0], total[1], total[2])
    w, p_w = scene.environment.sample(N, rng.square())
    if p_w > 0.0 and not shadow_toward(scene, x, w):
        result += scene.environment.eval(w) * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w * balance_numpy(p_w, brdf.pdf(V, w, N))
    w, p_w = brdf.sample(V, N, rng.square())
    if p_w > 0.0 and dot(w, N) > 0.0 and dot(w, x.n) > 0.0:
        L_i, light, p_l = seen_toward(scene, x, N, w)
        result += L_i * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w * balance_numpy(p_w, p_l)
    return result


# densities over directions throughout
def balance_directions(p, q):
    return 1.0 - q / (p + q)


def power_directions(p, q):
    h = math.hypot(p, q)
    return (p / h) * (p / h)


def shade_directions(x, V, brdf, N, scene, rng):
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            w = normalize(y - x)
            cos_y = max(0.0, dot(-w, y.n))
            if cos_y > 0.0:
                p_w = p_y * dist_sqr(x, y) / cos_y
                result += light.radiance * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w * balance_sum(p_w, brdf.pdf(V, w, N))
    w, p_w = scene.environment.sample(N, rng.square())
    if p_w > 0.0 and not shadow_toward(scene, x, w):
        result += scene.environment.eval(w) * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w * balance_sum(p_w, brdf.pdf(V, w, N))
    w, p_w = brdf.sample(V, N, rng.square())
    if p_w > 0.0 and dot(w, N) > 0.0 and dot(w, x.n) > 0.0:
        L_i, light, p_l = seen_toward(scene, x, N, w)
        result += L_i * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w * balance_sum(p_w, p_l)
    return result


# early ends; numbers one by one
def balance_early_ends(p, q):
    if p <= 0.0:
        return 0.0
    if q <= 0.0:
        return 1.0
    return p / (p + q)


def power_early_ends(p, q):
    if p <= 0.0:
        return 0.0
    if q <= 0.0:
        return 1.0
    b = balance_early_ends(p, q)
    c = balance_early_ends(q, p)
    return b * b / (b * b + c * c)


def shade_early_ends(x, V, brdf, N, scene, rng):
    result = Vec3(0.0, 0.0, 0.0)
    for light in scene.lights:
        a = rng.number()
        b = rng.number()
        y, p_y = light.sample(x, (a, b))
        L = normalize(y - x)
        cx = dot(L, N)
        if cx <= 0:
            continue
        cy = -dot(L, y.n)
        if cy <= 0:
            continue
        if shadow(scene, x, y):
            continue
        f = light.radiance * brdf.eval(V, L) * cx * cy / dist_sqr(x, y)
        result = result + f / (p_y + brdf.pdf(V, L, N) * cy / dist_sqr(x, y))
    a = rng.number()
    b = rng.number()
    w, p_w = scene.environment.sample(N, (a, b))
    if dot(w, N) > 0 and p_w > 0 and not shadow_toward(scene, x, w):
        result = result + scene.environment.eval(w) * brdf.eval(V, w) * dot(w, N) / p_w * balance_early_ends(p_w, brdf.pdf(V, w, N))
    a = rng.number()
    b = rng.number()
    w, p_w = brdf.sample(V, N, (a, b))
    if p_w <= 0.0 or dot(w, N) <= 0.0 or dot(w, x.n) <= 0.0:
        return result
    L_i, light, p_l = seen_toward(scene, x, N, w)
    return result + L_i * brdf.eval(V, w) * dot(w, N) / p_w * balance_early_ends(p_w, p_l)


# while; the sky first
def balance_while(p, q):
    total = 0.0
    for density in (p, q):
        total += density
    return p / total


def power_while(p, q):
    if p == 0.0:
        return 0.0
    total = 0.0
    for density in (p, q):
        r = density / p
        total += r * r
    return 1.0 / total


def shade_while(x, V, brdf, N, scene, rng):
    total = black
    if scene.environment.present():
        w, p_w = scene.environment.sample(N, rng.square())
        if not shadow_toward(scene, x, w) and p_w > 0.0:
            total = scene.environment.eval(w) * brdf.eval(V, w) * (max(0.0, dot(w, N)) * balance_while(p_w, brdf.pdf(V, w, N)) / p_w)
    i = 0
    while i < len(scene.lights):
        y, p_y = scene.lights[i].sample(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            p_b = brdf.pdf(V, L, N) * to_area(x, y)
            total += scene.lights[i].radiance * brdf.eval(V, L) * (max(0.0, dot(L, N)) * to_area(x, y) * balance_while(p_y, p_b) / p_y)
        i += 1
    w, p_w = brdf.sample(V, N, rng.square())
    if p_w > 0.0 and dot(w, N) > 0.0 and dot(w, x.n) > 0.0:
        L_i, _, p_l = seen_toward(scene, x, N, w)
        total += L_i * brdf.eval(V, w) * (dot(w, N) * balance_while(p_w, p_l) / p_w)
    return total


# a weight for each of the two
def balance_pair(p, q):
    w_p, _ = both_weights(p, q)
    return w_p


def both_weights(p, q):
    s = 1.0 / (p + q)
    return p * s, q * s


def power_pair(p, q):
    w_p, w_q = both_weights(p, q)
    return w_p * w_p / (w_p * w_p + w_q * w_q)


def shade_pair(x, V, brdf, N, scene, rng):
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        visible = 0.0 if shadow(scene, x, y) else 1.0
        L = normalize(y - x)
        g = max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y)
        weight, _ = both_weights(p_y, brdf.pdf(V, L, N) * to_area(x, y))
        result += visible * light.radiance * brdf.eval(V, L) * g * weight / p_y
    w, p_w = scene.environment.sample(N, rng.square())
    if p_w > 0.0 and not shadow_toward(scene, x, w):
        weight, _ = both_weights(p_w, brdf.pdf(V, w, N))
        result += scene.environment.eval(w) * brdf.eval(V, w) * max(0.0, dot(w, N)) * weight / p_w
    w, p_w = brdf.sample(V, N, rng.square())
    if p_w > 0.0 and dot(w, N) > 0.0 and dot(w, x.n) > 0.0:
        L_i, light, p_l = seen_toward(scene, x, N, w)
        weight, _ = both_weights(p_w, p_l)
        result += L_i * brdf.eval(V, w) * max(0.0, dot(w, N)) * weight / p_w
    return result
