"""The shade() of every slide of "Advanced Ray Tracing", in slide order.

Each function returns the radiance that leaves x toward V, estimated from one sample of each light (or direction).
Where a line differs from its slide:

- `scene` and `rng` are arguments; on the slides they are global. `rng.square()` is a point uniform in the square.
- A point x or y carries the normal of its surface, so the slide's `light.normal` is `y.n`: the normal at y, since a
  sphere or a mesh has another one at each point. For the same reason dist_sqr(x, y) is distSqr(x, y).
- max(0, .) around each cosine: a surface is lit from above only, a light shines on one side only. Without it the
  slide's first box returns negative light.
- `shadow` is two functions: of a point, and of a direction (`shadow_toward`).
- `brdf.sample(N)` needs V as well; the captions of the two last boxes are swapped on the slide.
- k_d is a BRDF value, reflectance / pi, in 1/sr.
"""

from __future__ import annotations

from raylab.jit import njit
from raylab.point import dist_sqr
from raylab.sampling import PI, sample_cos_hemisphere, sample_hemisphere
from raylab.shadow import shadow, shadow_toward
from raylab.vec3 import black, dot, normalize


@njit
def point_light(x, V, brdf, N, scene, rng):
    """Slide "Illumination as integration" (over the light), step 1: a point source.

    L_r = I f_r(v, w) cos(theta_r) / r^2
    """
    result = black
    for light in scene.points:
        y = light.y
        if not shadow(scene, x, y):
            L = normalize(y - x)
            f_r = brdf.eval(V, L)
            result += light.I * f_r * max(0.0, dot(L, N)) / dist_sqr(x, y)
    return result


@njit  # exercise a1.diffuse
def area_diffuse(x, k_d, N, scene, rng):
    """Slide "Area source by Monte Carlo (diffuse)".

    g(y) = L_s k_d cos(theta_r) cos(theta_s) / (|x - y|^2 p(y)),  p in 1/m^2
    """
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            result += (light.radiance * k_d
                       * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n))
                       / dist_sqr(x, y)
                       / p_y)  # fmt: skip
    return result


@njit  # exercise a2.area
def area(x, V, brdf, N, scene, rng):
    """Slide "Area source by Monte Carlo".

    g(y) = L_s f_r(v, w) |n_x . w| |n_y . w| / (|x - y|^2 p(y)),  p in 1/m^2
    """
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            f_r = brdf.eval(V, L)
            result += (light.radiance * f_r
                       * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n))
                       / dist_sqr(x, y)
                       / p_y)  # fmt: skip
    return result


@njit
def area_solid_angle(x, V, brdf, N, scene, rng):
    """Slide "Area source by Monte Carlo", y drawn uniformly from the solid angle Omega of the light.

    g(y) = L_s f_r(v, w) |n_x . w| |n_y . w| / (|x - y|^2 p(y)),  p = |n_y . w| / (|x - y|^2 Omega) in 1/m^2
    """
    result = black
    for light in scene.lights:
        y, p_y = light.sample_solid_angle(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            f_r = brdf.eval(V, L)
            result += (light.radiance * f_r
                       * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n))
                       / dist_sqr(x, y)
                       / p_y)  # fmt: skip
    return result


@njit
def directional_light(x, V, brdf, N, scene, rng):
    """Slide "Illumination as integration" (over incoming directions), step 1: a directional source.

    L_r = I f_r(v, w) cos(theta)
    """
    result = black
    for light in scene.suns:
        w = light.w
        if not shadow_toward(scene, x, w):
            f_r = brdf.eval(V, w)
            result += light.I * f_r * max(0.0, dot(w, N))
    return result


@njit  # exercise a3.uniform
def env_uniform(x, k_d, N, scene, rng):
    """Slide "Diffuse surface in env. by Monte Carlo": uniform hemisphere sampling, p(w) = 1 / (2 pi).

    g(w) = 2 pi L(w) k_d (w . n)
    """
    result = black
    w = sample_hemisphere(N, rng.square())
    if not shadow_toward(scene, x, w):
        L_env = scene.environment.eval(w)
        result += (L_env * k_d
                   * max(0.0, dot(w, N)) * (2.0 * PI))  # fmt: skip
    return result


@njit  # exercise a3.cosine
def env_cosine(x, k_d, N, scene, rng):
    """Slide "Diffuse surface in env. by Monte Carlo": cosine-proportional sampling, p(w) = cos(theta) / pi.

    g(w) = pi L(w) k_d
    """
    result = black
    w = sample_cos_hemisphere(N, rng.square())
    if not shadow_toward(scene, x, w):
        L_env = scene.environment.eval(w)
        result += L_env * k_d * PI
    return result


@njit  # exercise a4.brightness
def env_brightness(x, V, brdf, N, scene, rng):
    """Slide "Arbitrary surface in env. by Monte Carlo": sampling by lighting environment, p(w) = L_i(w) / M.

    g(w) = L(w) f_r(v, w) (w . n) / p(w)
    """
    result = black
    w, p_w = scene.environment.sample(N, rng.square())
    if not shadow_toward(scene, x, w):
        L_env = scene.environment.eval(w)
        f_r = brdf.eval(V, w)
        result += (L_env * f_r
                   * max(0.0, dot(w, N)) / p_w)  # fmt: skip
    return result


@njit  # exercise a4.brdf
def env_brdf(x, V, brdf, N, scene, rng):
    """Slide "Arbitrary surface in env. by Monte Carlo": sampling by BRDF, p(w) = f_r(v, w) / M(v).

    g(w) = L(w) f_r(v, w) (w . n) / p(w). Here a Lambertian p holds the cosine as well, which only helps.
    """
    result = black
    w, p_w = brdf.sample(V, N, rng.square())
    if not shadow_toward(scene, x, w):
        L_env = scene.environment.eval(w)
        f_r = brdf.eval(V, w)
        result += (L_env * f_r
                   * max(0.0, dot(w, N)) / p_w)  # fmt: skip
    return result
