"""Stiff shades: what is usually written, and not built in because there is better; to be measured beside the cure."""

from __future__ import annotations

from raylab.beyond import seen_toward
from raylab.jit import njit
from raylab.lights import to_area
from raylab.point import curved_point
from raylab.sampling import PI, sample_hemisphere, sample_sphere
from raylab.shadow import shadow, shadow_toward
from raylab.vec3 import black, dot, normalize


@njit
def by_brdf(x, V, brdf, N, scene, rng):
    """The BRDF's sample alone, whatever light it meets: f_r cos / p where it meets one, else nothing."""
    w, p_w = brdf.sample(V, N, rng.square())
    if p_w <= 0.0 or dot(w, N) <= 0.0 or dot(w, x.n) <= 0.0:
        return black
    L, _, _ = seen_toward(scene, x, N, w)
    return L * brdf.eval(V, w) * (dot(w, N) / p_w)


@njit
def uniform_hemisphere(x, V, brdf, N, scene, rng):
    """Slide "Diffuse surface in env. by Monte Carlo" for any surface: p(w) = 1 / (2 pi)."""
    w = sample_hemisphere(N, rng.square())
    if shadow_toward(scene, x, w):
        return black
    return scene.environment.eval(w) * brdf.eval(V, w) * (max(0.0, dot(w, N)) * (2.0 * PI))


@njit
def sphere_by_area(x, V, brdf, N, scene, rng):
    """Points uniform over whole spheres, p = 1 / (4 pi R^2): half of them and more face away."""
    result = black
    for light in scene.lights:
        n = sample_sphere(rng.square())
        y = curved_point(light.p + n * light.e1.x, n)
        if not shadow(scene, x, y):
            L = normalize(y - x)
            result += light.radiance * brdf.eval(V, L) * (max(0.0, dot(L, N)) * to_area(x, y) * light.area)
    return result
