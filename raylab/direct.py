"""direct: all light of a scene at once, each kind by the best of the lecture's methods for it.

Area lights are sampled over their surfaces, a smooth sky by the BRDF, an image by its brightness. Where a glossy
surface or an image is about, two methods are combined by the balance heuristic (`raylab.mis`): each sample counts as
far as its own method was the likelier one to find it there, so neither a small light nor a narrow lobe makes noise. Of
more than `light_choice.MANY` lights one is sampled, chosen by its power. Which of this a scene needs is known when its
kernel is compiled. In a smooth surface no light can be met but by following the one ray that it reflects, or the one
that it refracts.
"""

from __future__ import annotations

import math

from raylab.beyond import one_light_power, seen_toward
from raylab.brdf import reflect
from raylab.embree import TNEAR
from raylab.jit import njit
from raylab.lights import to_area
from raylab.mis import balance
from raylab.shade import area, directional_light, env_brdf, point_light
from raylab.shadow import shadow, shadow_toward
from raylab.surface import SHADOW_RAYS, direction32, intersect, round32
from raylab.vec3 import black, dot, luminance, normalize


@njit
def direct(x, V, brdf, N, scene, rng):
    """Radiance that leaves x toward V by direct light from everything in the scene."""
    if brdf.is_specular():
        return mirrored(x, V, brdf, N, scene, rng)
    result = point_light(x, V, brdf, N, scene, rng) + directional_light(x, V, brdf, N, scene, rng)
    if scene.materials.glossy() or scene.environment.by_brightness():
        return result + combined(x, V, brdf, N, scene, rng)
    if scene.choice.many():
        result += one_light_power(x, V, brdf, N, scene, rng)
    else:
        result += area(x, V, brdf, N, scene, rng)
    if scene.environment.present():
        result += env_brdf(x, V, brdf, N, scene, rng)
    return result


@njit
def combined(x, V, brdf, N, scene, rng):
    """One sample of each light (or of one of many), one of the sky, one of the BRDF: sum of f / (p_light + p_brdf)."""
    result = black
    if scene.choice.many():
        i, share = scene.choice.choose(rng.square())
        result += by_light(x, V, brdf, N, scene, rng, scene.lights[i], share)
    else:
        for light in scene.lights:
            result += by_light(x, V, brdf, N, scene, rng, light, 1.0)
    if scene.environment.present():
        w, p_w = scene.environment.sample(N, rng.square())
        if p_w > 0.0 and not shadow_toward(scene, x, w):
            weight = balance(p_w, brdf.pdf(V, w, N))
            result += scene.environment.eval(w) * brdf.eval(V, w) * (max(0.0, dot(w, N)) * weight / p_w)
    if brdf.is_glossy() or scene.environment.present():
        result += by_brdf(x, V, brdf, N, scene, rng)
    return result


@njit
def by_light(x, V, brdf, N, scene, rng, light, share):
    """A sample of a light that is chosen with probability `share`, weighed against the density of the BRDF's."""
    y, p_y = light.sample(x, rng.square())
    if shadow(scene, x, y):
        return black
    L, p, jacobian = normalize(y - x), share * p_y, to_area(x, y)
    weight = balance(p, brdf.pdf(V, L, N) * jacobian)
    return light.radiance * brdf.eval(V, L) * (max(0.0, dot(L, N)) * jacobian * weight / p)


@njit
def by_brdf(x, V, brdf, N, scene, rng):
    """The BRDF's sample: whatever light it meets, weighed against the density of that light's own sample."""
    w, p_w = brdf.sample(V, N, rng.square())
    if p_w <= 0.0 or dot(w, N) <= 0.0 or dot(w, x.n) <= 0.0:
        return black
    L, light, p_light = seen_toward(scene, x, N, w)
    if scene.choice.many() and light >= 0:
        p_light *= scene.choice.shares[light]
    return L * brdf.eval(V, w) * (dot(w, N) * balance(p_w, p_light) / p_w)


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
    return intersect(scene, round32(x.p + x.n * (side * x.slack)), direction32(w), TNEAR, math.inf)


@njit
def met(scene, hit, w):
    """The light that comes from a hit, or from the sky in the direction w."""
    if not hit.found:
        return scene.environment.eval(w)
    return scene.emission.of_shape(hit.shape) if hit.front else black
