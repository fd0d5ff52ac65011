"""After the last slide: estimators that answer the question with which the lecture ends, by light or by BRDF?

By both (`mis_balance`, `mis_power`): each sample is weighed against the density that the other technique has at the
same place. And of many lights by one (`one_light_uniform`, `one_light_power`). All read like the slides' boxes.
"""

from __future__ import annotations

import math

from raylab.embree import TNEAR
from raylab.jit import njit
from raylab.light_choice import choose_uniform
from raylab.lights import to_area
from raylab.mis import balance, power
from raylab.point import dist_sqr
from raylab.shadow import shadow, shadow_toward
from raylab.surface import LIGHT, SHADOW_RAYS, direction32, intersect, round32
from raylab.vec3 import black, dot, normalize


@njit
def mis_balance(x, V, brdf, N, scene, rng):
    """Light and BRDF sampling combined by the balance heuristic, w = p / (p + q); Veach 1997."""
    return mis(x, V, brdf, N, scene, rng, False)


@njit
def mis_power(x, V, brdf, N, scene, rng):
    """Light and BRDF sampling combined by the power heuristic, w = p^2 / (p^2 + q^2); Veach 1997."""
    return mis(x, V, brdf, N, scene, rng, True)


@njit  # exercise a7.shade
def mis(x, V, brdf, N, scene, rng, squared):
    """One sample of each light, one of the sky's brightness, one of the BRDF: sum of weight f / p."""
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            f_r = brdf.eval(V, L)
            p_brdf = brdf.pdf(V, L, N) * to_area(x, y)
            result += (light.radiance * f_r
                       * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n))
                       / dist_sqr(x, y)
                       / p_y * weight(p_y, p_brdf, squared))  # fmt: skip
    if scene.environment.present():
        w, p_w = scene.environment.sample(N, rng.square())
        if p_w > 0.0 and not shadow_toward(scene, x, w):
            L_env = scene.environment.eval(w)
            f_r = brdf.eval(V, w)
            result += (L_env * f_r
                       * max(0.0, dot(w, N))
                       / p_w * weight(p_w, brdf.pdf(V, w, N), squared))  # fmt: skip
    w, p_w = brdf.sample(V, N, rng.square())
    if p_w > 0.0 and dot(w, N) > 0.0 and dot(w, x.n) > 0.0:
        L_i, light, p_light = seen_toward(scene, x, N, w)
        f_r = brdf.eval(V, w)
        result += (L_i * f_r
                   * max(0.0, dot(w, N))
                   / p_w * weight(p_w, p_light, squared))  # fmt: skip
    return result


@njit
def weight(p, q, squared):
    return power(p, q) if squared else balance(p, q)


@njit
def seen_toward(scene, x, N, w):
    """The radiance that comes to x from the direction w, the number of its light (-1: none, or the sky), and the
    density, 1/sr, with which that light's own sample would have come from there."""
    scene.tally[SHADOW_RAYS] += 1
    hit = intersect(scene, round32(x.p + x.n * x.slack), direction32(w), TNEAR, math.inf)
    if not hit.found:
        return scene.environment.eval(w), -1, scene.environment.pdf(N, w)
    light = scene.shapes[hit.shape, LIGHT]
    cosine = -dot(w, hit.x.n)
    if light < 0 or not hit.front or cosine <= 0.0:
        return black, -1, 0.0
    return scene.emission.of_shape(hit.shape), light, scene.lights[light].pdf(x, hit.x) * dist_sqr(x, hit.x) / cosine


@njit
def one_light_uniform(x, V, brdf, N, scene, rng):
    """One of the lights, each as often as the others: g(y) / q, q = 1 / (number of lights)."""
    if len(scene.lights) == 0:
        return black
    i, q = choose_uniform(len(scene.lights), rng.square())
    return one_light(x, V, brdf, N, scene, rng, i) / q


@njit
def one_light_power(x, V, brdf, N, scene, rng):
    """One of the lights, in proportion to its power (an alias table): g(y) / q, q = A L / (sum over the lights)."""
    if len(scene.lights) == 0:
        return black
    i, q = scene.choice.choose(rng.square())
    return one_light(x, V, brdf, N, scene, rng, i) / q


@njit
def one_light(x, V, brdf, N, scene, rng, i):
    """The body of the loop in `area`, for light i alone."""
    light = scene.lights[i]
    y, p_y = light.sample(x, rng.square())
    if shadow(scene, x, y):
        return black
    L = normalize(y - x)
    f_r = brdf.eval(V, L)
    return (light.radiance * f_r
            * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n))
            / dist_sqr(x, y)
            / p_y)  # fmt: skip
