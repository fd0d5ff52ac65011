# ruff: noqa
# fmt: off
"""Right answers to assignment a2, each in another manner: `area_MANNER`."""
import math
import numpy as np
from raylab.lecture import PI, Vec3, black, dist_sqr, dot, length, normalize, shadow, to_area


def area_by_index(x, V, brdf, N, scene, rng):
    result = black
    for i in range(len(scene.lights)):
        y, p_y = scene.lights[i].sample(x, rng.square())
        if shadow(scene, x, y) == False:
            w = normalize(y - x)
            g = scene.lights[i].radiance * brdf.eval(V, w)
            g = g * max(dot(w, N), 0.0)
            g = g * max(-dot(w, y.n), 0.0)
            g = g / dist_sqr(x, y)
            result = result + g / p_y
    return result


def area_while(x, V, brdf, N, scene, rng):
    number, total = 0, Vec3(0, 0, 0)
    while number < len(scene.lights):
        lamp = scene.lights[number]
        u1 = rng.number()
        u2 = rng.number()
        y, p = lamp.sample(x, (u1, u2))
        number += 1
        if shadow(scene, x, y):
            continue
        L = normalize(y - x)
        total += brdf.eval(V, L) * lamp.radiance * (max(0, dot(L, N)) * max(0, dot(-L, y.n)) / (p * dist_sqr(x, y)))
    return total


def area_by_hand(x, V, brdf, N, scene, rng):
    r = g = b = 0.0
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        dx, dy, dz = y.p.x - x.p.x, y.p.y - x.p.y, y.p.z - x.p.z
        d2 = dx * dx + dy * dy + dz * dz
        d = math.sqrt(d2)
        cx = (dx * N.x + dy * N.y + dz * N.z) / d
        cy = -(dx * y.n.x + dy * y.n.y + dz * y.n.z) / d
        if cx <= 0 or cy <= 0:
            continue
        if shadow(scene, x, y):
            continue
        f = brdf.eval(V, Vec3(dx / d, dy / d, dz / d))
        c = cx * cy / d2 / p_y
        r += light.radiance.x * f.x * c
        g += light.radiance.y * f.y * c
        b += light.radiance.z * f.z * c
    return Vec3(r, g, b)


def area_early_ends(x, V, brdf, N, scene, rng):
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        L = normalize(y - x)
        cos_x = dot(L, N)
        cos_y = dot(L * -1.0, y.n)
        if cos_x < 0.0 or cos_y < 0.0 or shadow(scene, x, y):
            continue
        result += cos_x * cos_y / (dist_sqr(x, y) * p_y) * light.radiance * brdf.eval(V, L)
    return result


def area_long_vectors(x, V, brdf, N, scene, rng):
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            d = y - x
            r = length(d)
            result += light.radiance * brdf.eval(V, d / r) * max(0.0, dot(d, N)) * max(0.0, -dot(d, y.n)) / r**4 / p_y
    return result


def area_mirrored(x, V, brdf, N, scene, rng):
    result = black
    for light in scene.lights:
        a, b = rng.square()
        y, p_y = light.sample(x, (1.0 - b, 1.0 - a))
        if not shadow(scene, x, y):
            L = normalize(y - x)
            result += light.radiance * brdf.eval(V, L) * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y) / p_y
    return result


def area_arrays(x, V, brdf, N, scene, rng):
    total = np.zeros(3)
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            d = np.array([y.p.x - x.p.x, y.p.y - x.p.y, y.p.z - x.p.z])
            L = d / np.linalg.norm(d)
            f = brdf.eval(V, Vec3(L[0], L[1], L[2]))
            c = max(0.0, np.dot(L, np.array([N.x, N.y, N.z]))) * max(0.0, -np.dot(L, np.array([y.n.x, y.n.y, y.n.z])))
            total += np.array([light.radiance.x * f.x, light.radiance.y * f.y, light.radiance.z * f.z]) * (c / np.dot(d, d) / p_y)
    return Vec3(total[0], total[1], total[2])


def area_backwards(x, V, brdf, N, scene, rng):
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        w = normalize(x - y)
        lit = 0.0 if shadow(scene, x, y) else 1.0
        result += lit * light.radiance * brdf.eval(V, -w) * max(0.0, -dot(w, N)) * max(0.0, dot(w, y.n)) / (p_y * dist_sqr(y, x))
    return result


def area_measures(x, V, brdf, N, scene, rng):
    """The density turned into one over directions."""
    result = black
    for lamp in scene.lights:
        y, p_y = lamp.sample(x, rng.square())
        jacobian = to_area(x, y)
        if jacobian > 0.0 and not shadow(scene, x, y):
            w = normalize(y - x)
            p_w = p_y / jacobian
            result += lamp.radiance * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w
    return result
