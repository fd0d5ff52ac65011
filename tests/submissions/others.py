# ruff: noqa
# fmt: off
"""Correct answers to other boxes of the lecture, in several manners."""
import math
import numpy as np
from raylab.brdf import reflect
from raylab.lights import to_area
from raylab.mis import balance
from raylab.point import dist_sqr
from raylab.sampling import PI, frame, from_frame, sample_cos_hemisphere, sample_hemisphere
from raylab.shadow import shadow, shadow_toward
from raylab.vec3 import Vec3, black, cross, dot, length, normalize
from raylab.lecture import light_from, seen_toward, sample_phong_lobe
from raylab import lecture


# --- area ---


def area_slide(x, V, brdf, N, scene, rng):
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            f_r = brdf.eval(V, L)
            result += light.radiance * f_r * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y) / p_y
    return result


def area_keywords(x, V, brdf, N, scene, rng):
    return gather(scene, rng, point=x, eye=V, brdf=brdf, normal=N)


def gather(scene, rng, point, eye, brdf, normal):
    result = black
    for light in scene.lights:
        y, p_y = light.sample(point, rng.square())
        if not shadow(scene, point, y):
            L = lecture.normalize(y - point)
            result += light.radiance * brdf.eval(eye, L) * (max(0.0, dot(L, normal)) * to_area(point, y) / p_y)
    return result


def area_sum(x, V, brdf, N, scene, rng):
    E = [sample_light(light, x, V, brdf, N, scene, rng) for light in scene.lights]
    total = black
    for e in E:
        total += e
    return total


def sample_light(light, x, V, brdf, N, scene, rng):
    y, p_y = light.sample(x, rng.square())
    if shadow(scene, x, y):
        return black
    L = normalize(y - x)
    return light.radiance * brdf.eval(V, L) * (max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / (dist_sqr(x, y) * p_y))


# --- sky ---


def uniform_slide(x, k_d, N, scene, rng):
    result = black
    w = sample_hemisphere(N, rng.square())
    if not shadow_toward(scene, x, w):
        result += scene.environment.eval(w) * k_d * max(0.0, dot(w, N)) * (2.0 * PI)
    return result


def uniform_own(x, k_d, N, scene, rng):
    u1, u2 = rng.square()
    phi, z = 2.0 * math.pi * u1, u2
    r = math.sqrt(max(0.0, 1.0 - z * z))
    a = Vec3(1.0, 0.0, 0.0) if abs(N.x) < 0.5 else Vec3(0.0, 1.0, 0.0)
    t = normalize(cross(N, a))
    s = cross(t, N)
    w = s * (r * math.cos(phi)) + t * (r * math.sin(phi)) + N * z
    if shadow_toward(scene, x, w):
        return black
    p_w = 1.0 / (2.0 * math.pi)
    return scene.environment.eval(w) * k_d * (z / p_w)


def uniform_rejected(x, k_d, N, scene, rng):
    w = Vec3(2.0, 0.0, 0.0)
    while dot(w, w) > 1.0 or dot(w, w) == 0.0:
        w = Vec3(2.0 * rng.number() - 1.0, 2.0 * rng.number() - 1.0, 2.0 * rng.number() - 1.0)
    w = normalize(w)
    if dot(w, N) < 0.0:
        w = -w
    if shadow_toward(scene, x, w):
        return black
    return scene.environment.eval(w) * k_d * dot(w, N) * 2 * PI


def cosine_slide(x, k_d, N, scene, rng):
    result = black
    w = sample_cos_hemisphere(N, rng.square())
    if not shadow_toward(scene, x, w):
        L_env = scene.environment.eval(w)
        result += L_env * k_d * PI
    return result


def cosine_sphere(x, k_d, N, scene, rng):
    """A point uniform on the unit sphere around the tip of N."""
    z = 1.0 - 2.0 * rng.number()
    phi = 2.0 * PI * rng.number()
    r = math.sqrt(max(0.0, 1.0 - z * z))
    w = N + Vec3(r * math.cos(phi), r * math.sin(phi), z)
    if length(w) < 1e-9:
        return black
    w = normalize(w)
    return black if shadow_toward(scene, x, w) else scene.environment.eval(w) * k_d * np.pi


def brdf_slide(x, V, brdf, N, scene, rng):
    w, p_w = brdf.sample(V, N, rng.square())
    if shadow_toward(scene, x, w) or dot(w, N) <= 0.0:
        return black
    return scene.environment.eval(w) * brdf.eval(V, w) * (dot(w, N) / p_w)


def brightness_slide(x, V, brdf, N, scene, rng):
    sky = scene.environment
    w, p_w = sky.sample(N, rng.square())
    result = black
    if not shadow_toward(scene, x, w) and p_w > 0:
        result = sky.eval(w) * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w
    return result


# --- glossy ---


def phong_slide(x, V, brdf, N, scene, rng):
    k_s, n = brdf.lobe()
    w = sample_phong_lobe(reflect(V, N), n, rng.square())
    return k_s * light_from(scene, x, w, N) * (max(0.0, dot(w, N)) * (n + 2.0) / (n + 1.0))


def phong_own(x, V, brdf, N, scene, rng):
    k_s, n = brdf.lobe()
    R = 2.0 * dot(V, N) * N - V
    u, v = rng.square()
    c = (1.0 - u) ** (1.0 / (n + 1.0))
    s = math.sqrt(max(0.0, 1.0 - c * c))
    t1, t2 = frame(R)
    w = t1 * (s * math.cos(2 * PI * v)) + t2 * (s * math.sin(2 * PI * v)) + R * c
    p = (n + 1) / (2 * PI) * c**n
    f = (n + 2) / (2 * PI) * c**n
    if p == 0.0:
        return black
    return light_from(scene, x, w, N) * k_s * (f * max(0.0, dot(w, N)) / p)


# --- both ---


def mis_slide(x, V, brdf, N, scene, rng):
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            p_b = brdf.pdf(V, L, N) * to_area(x, y)
            result += light.radiance * brdf.eval(V, L) * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y) / p_y * balance(p_y, p_b)
    if scene.environment.present():
        w, p_w = scene.environment.sample(N, rng.square())
        if p_w > 0.0 and not shadow_toward(scene, x, w):
            result += scene.environment.eval(w) * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w * balance(p_w, brdf.pdf(V, w, N))
    w, p_w = brdf.sample(V, N, rng.square())
    if p_w > 0.0 and dot(w, N) > 0.0 and dot(w, x.n) > 0.0:
        L_i, _, p_l = seen_toward(scene, x, N, w)
        result += L_i * brdf.eval(V, w) * max(0.0, dot(w, N)) / p_w * balance(p_w, p_l)
    return result


def mis_by_hand(x, V, brdf, N, scene, rng):
    total = black
    w, p_w = brdf.sample(V, N, rng.square())
    if p_w > 0.0 and dot(w, N) > 0.0 and dot(w, x.n) > 0.0:
        L, which, p = seen_toward(scene, x, N, w)
        total = L * brdf.eval(V, w) * dot(w, N) / (p_w + p)
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if shadow(scene, x, y):
            continue
        d2 = dist_sqr(x, y)
        L = normalize(y - x)
        cos_y = dot(-L, y.n)
        p_as_direction = p_y * d2 / cos_y
        total += light.radiance * brdf.eval(V, L) * max(0.0, dot(L, N)) / (p_as_direction + brdf.pdf(V, L, N))
    if scene.environment.present():
        w, p_w = scene.environment.sample(N, rng.square())
        if p_w > 0.0 and not shadow_toward(scene, x, w):
            total += scene.environment.eval(w) * brdf.eval(V, w) * max(0.0, dot(w, N)) / (p_w + brdf.pdf(V, w, N))
    return total


# --- maps: u -> a direction and its density ---


def hemisphere_slide(N, u):
    z = u[0]
    r = math.sqrt((1.0 - z) * (1.0 + z))
    phi = 2.0 * PI * u[1]
    return from_frame(N, r * math.cos(phi), r * math.sin(phi), z), 0.5 / PI


def hemisphere_turned(N, u):
    u1, u2 = u
    s, t = frame(N)
    theta, phi = math.acos(1 - u2), 2 * math.pi * u1
    return (s * math.cos(phi) + t * math.sin(phi)) * math.sin(theta) + N * math.cos(theta), 1 / (2 * math.pi)


def hemisphere_folded(N, u):
    z = 1.0 - 2.0 * u[0]
    r = np.sqrt(max(0.0, 1.0 - z**2))
    w = Vec3(r * np.cos(2 * np.pi * u[1]), r * np.sin(2 * np.pi * u[1]), z)
    if dot(w, N) < 0:
        w = -w
    return w, 1 / (2 * np.pi)


def cosine_lifted(N, u):
    r, phi = math.sqrt(u[0]), 2.0 * PI * u[1]
    z = math.sqrt(max(0.0, 1.0 - u[0]))
    return from_frame(N, r * math.cos(phi), r * math.sin(phi), z), z / PI


def cosine_arcsin(N, u):
    theta = np.arcsin(np.sqrt(u[1]))
    s, t = frame(N)
    w = s * (np.sin(theta) * np.cos(2 * np.pi * u[0])) + t * (np.sin(theta) * np.sin(2 * np.pi * u[0])) + N * np.cos(theta)
    return w, np.cos(theta) / np.pi


def lens_point(u, radius):
    r, phi = radius * math.sqrt(u[0]), 2.0 * PI * u[1]
    return r * math.cos(phi), r * math.sin(phi)
