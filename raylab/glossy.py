"""Slide "Creating glossy reflections": one reflected ray, jittered in three ways.

Each function sends one ray near the mirror direction R of V and looks up what it meets: a light or the environment.
What it estimates is the light reflected by the lobe of `brdf.lobe()`, specular reflectance k_s and Phong exponent n;
the diffuse part of a surface, and microfacets, are left to others. A ray below the horizon brings nothing. The lobes:

glossy_jitter   w = normalize(R + offset), the offset uniform in a disk of radius a across R. So p(w) = 1 / (pi a^2
                cos^3 alpha) while tan alpha <= a, alpha the angle from R, and f_r = k_s p(w) / (w . N). With
                a^2 = 4 / (n + 3) the mean of tan^2 alpha is that of sin^2 alpha in Phong's lobe, 2 / (n + 3), but the
                lobe has a sharp rim. What the horizon cuts off is lost.
glossy_phong    w from Phong's lobe itself, p(w) = (n + 1) / (2 pi) cos^n alpha, weighed by f_r cos(theta) / p:
                exactly Phong, f_r = k_s (n + 2) / (2 pi) cos^n alpha.
glossy_normal   w = V mirrored in a jittered normal m, p(m) = (e + 1) / (2 pi) (m . N)^e. Mirroring spreads solid
                angles by 4 (V . m), so p(w) = p(m) / (4 |V . m|) and f_r = k_s p(w) / (w . N): a lobe about the half
                vector. At V = N, m . N = cos(alpha / 2): with e = 4 n + 1 the lobe falls off from R as Phong's does,
                exp(-n alpha^2 / 2). At another angle of incidence theta it keeps that width in the plane of incidence
                and is cos(theta) times as wide across it: highlights are stretched, as on a real floor.

Only Phong's f_r is the same with V and w exchanged. All three agree for narrow lobes (n large) near V = N.
"""

from __future__ import annotations

import math

from raylab.brdf import reflect
from raylab.embree import TNEAR
from raylab.jit import njit
from raylab.sampling import PI, cos_power, from_frame, sample_disk, sample_phong_lobe
from raylab.surface import SHADOW_RAYS, direction32, intersect, round32
from raylab.vec3 import black, dot, normalize


@njit
def glossy_jitter(x, V, brdf, N, scene, rng):
    """Slide "Creating glossy reflections": not exactly in mirror direction; add a random offset.

    L_r = k_s L(w)
    """
    k_s, n = brdf.lobe()
    w = sample_jitter(reflect(V, N), jitter_radius(n), rng.square())
    return k_s * light_from(scene, x, w, N)


@njit  # exercise a5.shade
def glossy_phong(x, V, brdf, N, scene, rng):
    """Slide "Creating glossy reflections": the math worked out to match Phong exactly.

    g(w) = L(w) f_r(v, w) (w . n) / p(w) = L(w) k_s (w . n) (n + 2) / (n + 1)
    """
    k_s, n = brdf.lobe()
    w = sample_phong_lobe(reflect(V, N), n, rng.square())
    return k_s * light_from(scene, x, w, N) * (max(0.0, dot(w, N)) * (n + 2.0) / (n + 1.0))


@njit
def glossy_normal(x, V, brdf, N, scene, rng):
    """Slide "Creating glossy reflections": by jittering the normal.

    L_r = k_s L(w)
    """
    k_s, n = brdf.lobe()
    m = sample_phong_lobe(N, normal_exponent(n), rng.square())
    return k_s * light_from(scene, x, reflect(V, m), N)


@njit
def light_from(scene, x, w, N):
    """What a ray from x in the direction w meets: the front of a light, the environment, or nothing that shines."""
    if dot(w, N) <= 0.0 or dot(w, x.n) <= 0.0:
        return black
    scene.tally[SHADOW_RAYS] += 1
    hit = intersect(scene, round32(x.p + x.n * x.slack), direction32(w), TNEAR, math.inf)
    if not hit.found:
        return scene.environment.eval(w)
    return scene.emission.of_shape(hit.shape) if hit.front else black


# --- a random offset ---


@njit
def jitter_radius(n):
    """The radius a of the disk of offsets that goes with Phong's exponent n: a^2 = 4 / (n + 3)."""
    return 2.0 / math.sqrt(n + 3.0)


@njit
def sample_jitter(R, a, u):
    """normalize(R + offset), the offset uniform in the disk of radius a across R."""
    s, t = sample_disk(u)
    return normalize(from_frame(R, a * s, a * t, 1.0))


@njit
def pdf_jitter(R, a, w):
    """p(w) = 1 / (pi a^2 cos^3 alpha) while tan alpha <= a, 1/sr."""
    c = dot(R, w)
    return 1.0 / (PI * a * a * c * c * c) if c > 0.0 and 1.0 - c * c <= a * a * c * c else 0.0


# --- a jittered normal ---


@njit
def normal_exponent(n):
    """The exponent e of the normals that goes with Phong's exponent n: e = 4 n + 1."""
    return 4.0 * n + 1.0


@njit
def pdf_normal(V, N, e, w):
    """p(w) = (e + 1) / (2 pi) (m . N)^e / (4 |V . m|), 1/sr; m halfway between V and w, or opposite to that.

    The normals m and -m mirror alike, but only one of them lies on the side of N.
    """
    m = normalize(V + w)
    m = m if dot(m, N) >= 0.0 else -m
    return (e + 1.0) / (2.0 * PI) * cos_power(N, e, m) / (4.0 * abs(dot(V, m)))
