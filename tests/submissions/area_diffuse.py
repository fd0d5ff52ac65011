# ruff: noqa
# fmt: off
"""Correct answers to "Area source by Monte Carlo (diffuse)", each in another manner; none is styled by us."""
import math
import random
from math import sqrt, pi

import matplotlib.pyplot as plt
import numpy as np
from numba import njit
from raylab.lecture import PI, Vec3, absolute, black, cross, dist_sqr, dot, length, normalize, shadow, shadow_toward

TWO_PI = 2.0 * PI
DARK = Vec3(0.0, 0.0, 0.0)
SAMPLES = 2
EPSILON: float = 1e-12
CORNERS = (0.25, 0.75)


# as on the slide
def slide(x, k_d, N, scene, rng):
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            result += (light.radiance * k_d
                       * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n))
                       / dist_sqr(x, y)
                       / p_y)
    return result


# helpers, in the order in which they were thought of
def with_helpers(x, k_d, N, scene, rng):
    total = DARK
    for light in scene.lights:
        total = total + one(light, x, k_d, N, scene, rng.square())
    return total


def one(light, x, k_d, N, scene, u):
    y, p = light.sample(x, u)
    return light.radiance * k_d * (geometry(x, y, N) * visible(scene, x, y) / p)


def geometry(x, y, N):
    d = y - x
    r = length(d)
    return clamped(dot(d, N) / r) * clamped(-dot(d, y.n) / r) / (r * r)


def clamped(c):
    if c > 0:
        return c
    return 0.0


def visible(scene, x, y):
    return 0.0 if shadow(scene, x, y) else 1.0


# early ends
def early_ends(x, k_d, N, scene, rng):
    result = black
    for light in scene.lights:
        (y, p_y) = light.sample(x, rng.square())
        L = normalize(y - x)
        cos_x = dot(L, N)
        if cos_x <= 0.0:
            continue
        cos_y = -dot(L, y.n)
        if not cos_y > 0.0:
            continue
        if shadow(scene, x, y):
            continue
        result = result + light.radiance * k_d * cos_x * cos_y / (dist_sqr(x, y) * p_y)
    return result


# vectors by hand
def by_hand(x, k_d, N, scene, rng):
    r, g, b = 0.0, 0.0, 0.0
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        dx = y.p.x - x.p.x
        dy = y.p.y - x.p.y
        dz = y.p.z - x.p.z
        d2 = dx * dx + dy * dy + dz * dz
        d = math.sqrt(d2)
        cx = (dx * N.x + dy * N.y + dz * N.z) / d
        cy = -(dx * y.n.x + dy * y.n.y + dz * y.n.z) / d
        if cx > 0 and cy > 0 and not shadow(scene, x, y):
            f = cx * cy / d2 / p_y
            r += light.radiance.x * k_d.x * f
            g += light.radiance.y * k_d.y * f
            b += light.radiance.z * k_d.z * f
    return Vec3(r, g, b)


# an index
def by_index(x, k_d, N, scene, rng):
    result = black
    for i in range(len(scene.lights)):
        y, p_y = scene.lights[i].sample(x, rng.square())
        if shadow(scene, x, y) == False:
            L = normalize(y - x)
            result += scene.lights[i].radiance * k_d * abs(dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y) / p_y * (dot(L, N) > 0)
    return result


# while, and numbers drawn one by one
def with_while(x, k_d, N, scene, rng):
    i = 0
    result = Vec3(0, 0, 0)
    while i < len(scene.lights):
        light = scene.lights[i]
        i += 1
        u1 = rng.number()
        u2 = rng.number()
        y, p_y = light.sample(x, (u1, u2))
        if not shadow(scene, x, y):
            L = normalize(y - x)
            c = max(0, dot(L, N)) * max(0, dot(-L, y.n))
            result += light.radiance * k_d * c / (p_y * dist_sqr(x, y))
    return result


# the other order of random numbers, and turned round
def other_numbers(x, k_d, N, scene, rng):
    result = black
    for light in scene.lights:
        u = rng.square()
        y, p_y = light.sample(x, (1.0 - u[1], u[0]))
        if not shadow(scene, x, y):
            w = y - x
            result += light.radiance * k_d * (max(0.0, dot(w, N)) * max(0.0, -dot(w, y.n)) / dot(w, w) ** 2 / p_y)
    return result


# more samples of each light
def several_samples(x, k_d, N, scene, rng):
    result = black
    for light in scene.lights:
        for _ in range(SAMPLES):
            y, p_y = light.sample(x, rng.square())
            if not shadow(scene, x, y):
                L = normalize(y - x)
                result += light.radiance * k_d * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y) / p_y
    return result / SAMPLES


# arrays
def with_arrays(x, k_d, N, scene, rng):
    total = np.zeros(3)
    n = np.array([N.x, N.y, N.z])
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            d = np.array([y.p.x - x.p.x, y.p.y - x.p.y, y.p.z - x.p.z])
            L = d / np.linalg.norm(d)
            m = np.array([y.n.x, y.n.y, y.n.z])
            f = max(0.0, np.dot(L, n)) * max(0.0, np.dot(-L, m)) / np.dot(d, d) / p_y
            total += f * np.array([light.radiance.x * k_d.x, light.radiance.y * k_d.y, light.radiance.z * k_d.z])
    return Vec3(total[0], total[1], total[2])


# decorated and annotated
@njit(fastmath=True, cache=True)
def decorated(x, k_d: Vec3, N: Vec3, scene, rng) -> Vec3:
    """Docstring."""
    E: Vec3 = black  # irradiance
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        V: float = 0.0 if shadow(scene, x, y) else 1.0
        L = normalize(y - x)
        E += light.radiance * (V * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y) / p_y)
    return k_d * E


# uniform in solid angle where that is possible
def by_solid_angle(x, k_d, N, scene, rng):
    result = black
    for light in scene.lights:
        y, p_y = light.sample_solid_angle(x, rng.square())
        if p_y > 0.0 and not shadow(scene, x, y):
            L = normalize(y - x)
            result += light.radiance * k_d * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y) / p_y
    return result


# inner functions, enumerate, zip, a conditional expression, other argument names
def inner(point, albedo, normal, world, random_numbers):
    plus = lambda a: a if a > 0.0 else 0.0
    result = black
    for number, lamp in enumerate(world.lights):
        assert number >= 0
        y, density = lamp.sample(point, random_numbers.square())
        if shadow(world, point, y):
            contribution = black
        else:
            L = normalize(y - point)
            contribution = lamp.radiance * albedo * plus(dot(L, normal)) * plus(dot(-L, y.n)) / dist_sqr(point, y) / density
        result = result + contribution
    return result


# a list of contributions; prints on the way
def with_lists(x, k_d, N, scene, rng):
    parts = [black]
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            print(f"{L.x:.3f}", L, p_y)
            parts.append(light.radiance * k_d * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y) / p_y)
    result = parts[0]
    for part in parts[1:]:
        result += part
    return result


# one light, chosen at random
def one_of_them(x, k_d, N, scene, rng):
    n = len(scene.lights)
    if n == 0:
        return black
    light = scene.lights[min(int(rng.number() * n), n - 1)]
    y, p_y = light.sample(x, rng.square())
    if shadow(scene, x, y):
        return black
    L = normalize(y - x)
    return light.radiance * k_d * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y) / p_y * n


# opposite pairs of points
def antithetic(x, k_d, N, scene, rng):
    result = black
    for light in scene.lights:
        u = rng.square()
        for v in (u, (1.0 - u[0], 1.0 - u[1])):
            y, p_y = light.sample(x, v)
            if not shadow(scene, x, y):
                L = normalize(y - x)
                result += 0.5 * light.radiance * k_d * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y) / p_y
    return result


if __name__ == "__main__":
    import raylab

    plt.imshow(raylab.render(raylab.load("scene.xml"), slide))
    print(random.random())
