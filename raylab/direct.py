"""direct: all light of a scene at once, each kind by the best of the lecture's methods for it.

Area lights are sampled over their surfaces, a smooth sky by the BRDF, an image by its brightness. Where a glossy
surface or an image is about, two methods are combined by the balance heuristic (Veach and Guibas 1995): each sample
is divided by the density that both methods together have there, so neither a small light nor a narrow lobe makes
noise. Which of this a scene needs is known when its kernel is compiled. In a smooth surface no light can be met but by
following the one ray that it reflects, or the one that it refracts.
"""

from __future__ import annotations

import math

from raylab.brdf import reflect
from raylab.embree import TNEAR
from raylab.jit import njit
from raylab.point import dist_sqr
from raylab.shade import area, directional_light, env_brdf, point_light
from raylab.shadow import shadow, shadow_toward
from raylab.surface import LIGHT, SHADOW_RAYS, intersect, round32
from raylab.vec3 import black, dot, luminance, normalize


@njit
def direct(x, V, brdf, N, scene, rng):
    """Radiance that leaves x toward V by direct light from everything in the scene."""
    if brdf.is_specular():
        return mirrored(x, V, brdf, N, scene, rng)
    result = point_light(x, V, brdf, N, scene, rng) + directional_light(x, V, brdf, N, scene, rng)
    if scene.materials.glossy() or scene.environment.by_brightness():
        return result + combined(x, V, brdf, N, scene, rng)
    result += area(x, V, brdf, N, scene, rng)
    if scene.environment.present():
        result += env_brdf(x, V, brdf, N, scene, rng)
    return result


@njit
def combined(x, V, brdf, N, scene, rng):
    """One sample of each light, one of the sky, one of the BRDF: sum of f / (p_light + p_brdf)."""
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            to_area = max(0.0, dot(-L, y.n)) / dist_sqr(x, y)
            p = p_y + brdf.pdf(V, L, N) * to_area
            result += light.radiance * brdf.eval(V, L) * (max(0.0, dot(L, N)) * to_area / p)
    if scene.environment.present():
        w, p_w = scene.environment.sample(N, rng.square())
        if p_w > 0.0 and not shadow_toward(scene, x, w):
            p = p_w + brdf.pdf(V, w, N)
            result += scene.environment.eval(w) * brdf.eval(V, w) * (max(0.0, dot(w, N)) / p)
    if brdf.is_glossy() or scene.environment.present():
        result += by_brdf(x, V, brdf, N, scene, rng)
    return result


@njit
def by_brdf(x, V, brdf, N, scene, rng):
    """The BRDF's sample: whatever light it meets, weighed against the density of that light's own sample."""
    w, p_w = brdf.sample(V, N, rng.square())
    if p_w <= 0.0 or dot(w, N) <= 0.0 or dot(w, x.n) <= 0.0:
        return black
    scene.tally[SHADOW_RAYS] += 1
    hit = intersect(scene, round32(x.p + x.n * x.slack), round32(w), TNEAR, math.inf)
    f = brdf.eval(V, w) * dot(w, N)
    if not hit.found:
        return scene.environment.eval(w) * f / (p_w + scene.environment.pdf(N, w))
    light = scene.shapes[hit.shape, LIGHT]
    if light < 0 or not hit.front:
        return black
    to_area = max(0.0, -dot(w, hit.x.n)) / dist_sqr(x, hit.x)
    p_y = scene.lights[light].pdf(x, hit.x)
    return scene.emission.of_shape(hit.shape) * f * (to_area / (p_w * to_area + p_y))


@njit
def mirrored(x, V, brdf, N, scene, rng):
    """A smooth surface: the light or sky in the mirrored or in the refracted direction, one of them by chance."""
    reflected = brdf.reflection(V, N)
    w, refracted = brdf.refraction(V, N)
    R, T = luminance(reflected), luminance(refracted)
    if rng.number() * (R + T) < R:
        r = reflect(V, N)
        return met(scene, follow(scene, x, r), r) * reflected * ((R + T) / R)
    if T > 0.0:
        return met(scene, follow(scene, x, w), w) * refracted * ((R + T) / T)
    return black


@njit
def follow(scene, x, w):
    """The first hit of the ray from x toward w, which starts on the side of the surface that w points to."""
    side = 1.0 if dot(w, x.n) > 0.0 else -1.0
    scene.tally[SHADOW_RAYS] += 1
    return intersect(scene, round32(x.p + x.n * (side * x.slack)), round32(w), TNEAR, math.inf)


@njit
def met(scene, hit, w):
    """The light that comes from a hit, or from the sky in the direction w."""
    if not hit.found:
        return scene.environment.eval(w)
    return scene.emission.of_shape(hit.shape) if hit.front else black
