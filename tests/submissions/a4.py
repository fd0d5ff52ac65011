# ruff: noqa
# fmt: off
"""Right answers to assignment a4, each in another manner: `brdf_MANNER` and `brightness_MANNER`."""
import math
import numpy as np
from raylab.lecture import PI, Vec3, black, dot, shadow_toward


# as on the slide
def brdf_lines(x, V, brdf, N, scene, rng):
    result = black
    w, p_w = brdf.sample(V, N, rng.square())
    if not shadow_toward(scene, x, w):
        L_env = scene.environment.eval(w)
        f_r = brdf.eval(V, w)
        result += L_env * f_r * max(0.0, dot(w, N)) / p_w
    return result


def brightness_lines(x, V, brdf, N, scene, rng):
    result = black
    w, p_w = scene.environment.sample(N, rng.square())
    if not shadow_toward(scene, x, w):
        L_env = scene.environment.eval(w)
        f_r = brdf.eval(V, w)
        result += L_env * f_r * max(0.0, dot(w, N)) / p_w
    return result


# with a helper for both
def g(x, V, brdf, N, scene, w, p_w):
    c = dot(w, N)
    if c <= 0.0 or p_w <= 0.0:
        return black
    if shadow_toward(scene, x, w):
        return black
    return scene.environment.eval(w) * brdf.eval(V, w) * (c / p_w)


def brdf_helper(x, V, brdf, N, scene, rng):
    w, p_w = brdf.sample(V, N, rng.square())
    return g(x, V, brdf, N, scene, w, p_w)


def brightness_helper(x, V, brdf, N, scene, rng):
    w, p_w = scene.environment.sample(N, rng.square())
    return g(x, V, brdf, N, scene, w, p_w)


# the density asked for again
def brdf_asked(x, V, brdf, N, scene, rng):
    w, _ = brdf.sample(V, N, rng.square())
    if shadow_toward(scene, x, w):
        return black
    return scene.environment.eval(w) * brdf.eval(V, w) * max(0.0, dot(w, N)) / max(brdf.pdf(V, w, N), 1e-300)


def brightness_asked(x, V, brdf, N, scene, rng):
    w, _ = scene.environment.sample(N, rng.square())
    if shadow_toward(scene, x, w):
        return black
    return scene.environment.eval(w) * brdf.eval(V, w) * max(0.0, dot(w, N)) / scene.environment.pdf(N, w)


# colours by hand
def brdf_by_hand(x, V, brdf, N, scene, rng):
    w, p = brdf.sample(V, N, rng.square())
    c = w.x * N.x + w.y * N.y + w.z * N.z
    if c < 0 or shadow_toward(scene, x, w):
        return Vec3(0, 0, 0)
    L, f, k = scene.environment.eval(w), brdf.eval(V, w), c / p
    return Vec3(L.x * f.x * k, L.y * f.y * k, L.z * f.z * k)


def brightness_by_hand(x, V, brdf, N, scene, rng):
    w, p = scene.environment.sample(N, rng.square())
    c = w.x * N.x + w.y * N.y + w.z * N.z
    if c < 0 or shadow_toward(scene, x, w):
        return Vec3(0, 0, 0)
    L, f, k = scene.environment.eval(w), brdf.eval(V, w), c / p
    return Vec3(L.x * f.x * k, L.y * f.y * k, L.z * f.z * k)


# random numbers turned round
def brdf_turned(x, V, brdf, N, scene, rng):
    u = rng.square()
    w, p_w = brdf.sample(V, N, (1.0 - u[1], u[0]))
    visible = not shadow_toward(scene, x, w)
    result = scene.environment.eval(w) * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w if visible else black
    return result


def brightness_turned(x, V, brdf, N, scene, rng):
    u = rng.square()
    w, p_w = scene.environment.sample(N, (1.0 - u[1], u[0]))
    visible = not shadow_toward(scene, x, w)
    result = scene.environment.eval(w) * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w if visible else black
    return result


# number by number
def brdf_numbers(x, V, brdf, N, scene, rng):
    a = rng.number()
    b = rng.number()
    direction, density = brdf.sample(V, N, (b, a))
    V_xw = 0.0 if shadow_toward(scene, x, direction) else 1.0
    return V_xw * scene.environment.eval(direction) * brdf.eval(V, direction) * max(0.0, dot(N, direction)) / density


def brightness_numbers(x, V, brdf, N, scene, rng):
    a = rng.number()
    b = rng.number()
    direction, density = scene.environment.sample(N, (b, a))
    V_xw = 0.0 if shadow_toward(scene, x, direction) else 1.0
    return V_xw * scene.environment.eval(direction) * brdf.eval(V, direction) * max(0.0, dot(N, direction)) / density


# arrays
def brdf_arrays(x, V, brdf, N, scene, rng):
    w, p_w = brdf.sample(V, N, rng.square())
    total = np.zeros(3)
    if not shadow_toward(scene, x, w):
        L, f = scene.environment.eval(w), brdf.eval(V, w)
        total += np.array([L.x, L.y, L.z]) * np.array([f.x, f.y, f.z]) * (np.maximum(0.0, dot(w, N)) / p_w)
    return Vec3(total[0], total[1], total[2])


def brightness_arrays(x, V, brdf, N, scene, rng):
    w, p_w = scene.environment.sample(N, rng.square())
    total = np.zeros(3)
    if not shadow_toward(scene, x, w):
        L, f = scene.environment.eval(w), brdf.eval(V, w)
        total += np.array([L.x, L.y, L.z]) * np.array([f.x, f.y, f.z]) * (np.maximum(0.0, dot(w, N)) / p_w)
    return Vec3(total[0], total[1], total[2])


# one factor after the other
def brdf_factors(x, V, brdf, N, scene, rng):
    w, p_w = brdf.sample(V, N, rng.square())
    result = Vec3(1.0, 1.0, 1.0) / p_w
    result *= brdf.eval(V, w)
    result *= scene.environment.eval(w)
    result *= max(dot(w, N), 0.0)
    if shadow_toward(scene, x, w):
        result *= 0.0
    return result


def brightness_factors(x, V, brdf, N, scene, rng):
    w, p_w = scene.environment.sample(N, rng.square())
    result = Vec3(1.0, 1.0, 1.0) / p_w
    result *= brdf.eval(V, w)
    result *= scene.environment.eval(w)
    result *= max(dot(w, N), 0.0)
    if shadow_toward(scene, x, w):
        result *= 0.0
    return result


# a loop of one
def brdf_loop(x, V, brdf, N, scene, rng):
    total, samples = black, 1
    for i in range(samples):
        w, p_w = brdf.sample(V, N, rng.square())
        if dot(w, N) > 0.0 and not shadow_toward(scene, x, w):
            total = total + scene.environment.eval(w) * brdf.eval(V, w) * dot(w, N) / p_w
    return total / samples


def brightness_loop(x, V, brdf, N, scene, rng):
    total, samples = black, 1
    for i in range(samples):
        w, p_w = scene.environment.sample(N, rng.square())
        if dot(w, N) > 0.0 and not shadow_toward(scene, x, w):
            total = total + scene.environment.eval(w) * brdf.eval(V, w) * dot(w, N) / p_w
    return total / samples


# f, p, f / p, with functions inside
def brdf_inner(x, V, brdf, N, scene, rng):
    plus = lambda c: c if c > 0.0 else 0.0
    w, p = brdf.sample(V, N, rng.square())
    f = scene.environment.eval(w) * brdf.eval(V, w) * plus(dot(w, N))
    return f / p * (1.0 - shadow_toward(scene, x, w))


def brightness_inner(x, V, brdf, N, scene, rng):
    plus = lambda c: c if c > 0.0 else 0.0
    w, p = scene.environment.sample(N, rng.square())
    f = scene.environment.eval(w) * brdf.eval(V, w) * plus(dot(w, N))
    return f / p * (1.0 - shadow_toward(scene, x, w))
