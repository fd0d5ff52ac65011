"""What students write: shade functions that are right, that have one mistake each, or that should never be run."""

from __future__ import annotations

import random

import numpy as np

from raylab.jit import njit
from raylab.point import dist_sqr
from raylab.sampling import PI, sample_cos_hemisphere, sample_hemisphere
from raylab.shadow import shadow, shadow_toward
from raylab.vec3 import Vec3, black, dot, normalize

CALLS = []


@njit
def reflected(x, y, light, k_d, N):
    """g(y) p(y), on the slide."""
    L = normalize(y - x)
    return light.radiance * k_d * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y)


@njit
def seen(x, w, scene):
    return black if shadow_toward(scene, x, w) else scene.environment.eval(w)


def correct(x, k_d, N, scene, rng):
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            result += reflected(x, y, light, k_d, N) / p_y
    return result


# --- mistakes with lights ---


def without_shadow(x, k_d, N, scene, rng):
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        result += reflected(x, y, light, k_d, N) / p_y
    return result


def one_over_r(x, k_d, N, scene, rng):
    """r instead of r^2."""
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            result += reflected(x, y, light, k_d, N) * dist_sqr(x, y) ** 0.5 / p_y
    return result


def no_area(x, k_d, N, scene, rng):
    """p(y) forgotten."""
    result = black
    for light in scene.lights:
        y, _ = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            result += reflected(x, y, light, k_d, N)
    return result


def first_light(x, k_d, N, scene, rng):
    """Only the first light."""
    light = scene.lights[0]
    y, p_y = light.sample(x, rng.square())
    return black if shadow(scene, x, y) else reflected(x, y, light, k_d, N) / p_y


# --- mistakes with an environment ---


def cosine_twice(x, k_d, N, scene, rng):
    w = sample_cos_hemisphere(N, rng.square())
    return seen(x, w, scene) * k_d * PI * dot(w, N)


def half_the_hemisphere(x, k_d, N, scene, rng):
    u = rng.square()
    w = sample_hemisphere(N, (u[0], 0.5 * u[1]))
    return seen(x, w, scene) * k_d * 2.0 * PI * dot(w, N)


def flipped_sky(x, k_d, N, scene, rng):
    """The environment looked up with x and -x confused."""
    w = sample_cos_hemisphere(N, rng.square())
    if shadow_toward(scene, x, w):
        return black
    return scene.environment.eval(Vec3(-w.x, w.y, w.z)) * k_d * PI


def clamped(x, k_d, N, scene, rng):
    """Fireflies cut off."""
    w = sample_cos_hemisphere(N, rng.square())
    L = seen(x, w, scene) * k_d * PI
    return Vec3(min(L.x, 0.1), min(L.y, 0.1), min(L.z, 0.1))


# --- what no estimator may do ---


def returns_nan(x, k_d, N, scene, rng):
    return correct(x, k_d, N, scene, rng) * (float("nan") if rng.number() < 0.5 else 1.0)


def returns_a_number(x, k_d, N, scene, rng):
    return 0.5


def returns_two_numbers(x, k_d, N, scene, rng):
    return np.array([0.5, 0.5])


def returns_nothing(x, k_d, N, scene, rng):
    correct(x, k_d, N, scene, rng)


def returns_negative_light(x, k_d, N, scene, rng):
    return correct(x, k_d, N, scene, rng) - Vec3(0.0, 1e3, 0.0)


def forgets_the_cosines_and_multiplies_by_pi(x, k_d, N, scene, rng):
    return correct(x, k_d, N, scene, rng) * 30.0


def changes_a_light(x, k_d, N, scene, rng):
    scene.lights.rows[0, 1] = 0.0
    return correct(x, k_d, N, scene, rng)


def changes_the_normal(x, k_d, N, scene, rng):
    N.z = -N.z
    return correct(x, k_d, N, scene, rng)


def keeps_state(x, k_d, N, scene, rng):
    CALLS.append(1)
    return correct(x, k_d, N, scene, rng) * (1.0 / len(CALLS))


def uses_random(x, k_d, N, scene, rng):
    return correct(x, k_d, N, scene, rng) * random.random()


def uses_numpy(x, k_d, N, scene, rng):
    return correct(x, k_d, N, scene, rng) * np.random.default_rng(1).random()


def never_returns(x, k_d, N, scene, rng):
    while True:
        pass


def raises(x, k_d, N, scene, rng):
    return scene.no_such_thing
