"""Microfacets: a rough surface as many small mirrors, slide "Cause of glossy reflection" (rough surfaces).

Directions are local: z along the normal N, x and y along the tangents to which the roughness alpha_u and alpha_v
belongs. v is the direction that sees or is seen, z > 0, m the normal of a facet; all have unit length.
Sources: Walter et al. 2007, "Microfacet models for refraction through rough surfaces"; Heitz 2014, "Understanding the
masking-shadowing function in microfacet-based BRDFs", JCGT 3(2).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from raylab.jit import njit
from raylab.record import record
from raylab.sampling import PI, turn
from raylab.vec3 import Vec3, dot, normalize

GGX, BECKMANN = 0, 1
LEAST_ALPHA = 1e-4  # Mitsuba's floor: smoother surfaces are rendered as rough as this


@record
class Microfacets(NamedTuple):
    """How the normals of the facets are distributed: `kind` GGX or BECKMANN, roughness along x and along y."""

    kind: int
    alpha_u: float
    alpha_v: float

    def density(self, m):
        """D(m), 1/sr: area of the facets per solid angle of their normals, for an area 1 of the surface."""
        x, y, z2 = m.x / self.alpha_u, m.y / self.alpha_v, m.z * m.z
        if m.z <= 0.0:
            return 0.0
        if self.kind == GGX:
            return 1.0 / (PI * self.alpha_u * self.alpha_v * (x * x + y * y + z2) ** 2)
        return math.exp(-(x * x + y * y) / z2) / (PI * self.alpha_u * self.alpha_v) / z2 / z2

    def seen(self, v):
        """Area of the facets that v sees, projected along v: integral of D(m) max(0, v . m) = v.z / G1(v) (Smith)."""
        s = roughness(self, v)
        if self.kind == GGX:
            return 0.5 * (v.z + math.sqrt(v.z * v.z + s * s))
        if s == 0.0:
            return v.z
        a = v.z / s
        return 0.5 * (v.z * (1.0 + math.erf(a)) + s * math.exp(-a * a) / math.sqrt(PI))

    def seen_as_mitsuba(self, v):
        """The same with Walter's rational G1 for Beckmann, off by up to 0.35 %: what Mitsuba renders."""
        s = roughness(self, v)
        if self.kind == GGX:
            return self.seen(v)
        if v.z >= 1.6 * s:
            return v.z
        a = v.z / s
        return s * (1.0 + 2.276 * a + 2.577 * a * a) / (3.535 + 2.181 * a)


@njit
def roughness(facets, v):
    """Slope alpha sin(theta) of the facets along v."""
    x, y = facets.alpha_u * v.x, facets.alpha_v * v.y
    return math.sqrt(x * x + y * y)


# --- the normals that a direction sees ---


@njit
def sample_visible_normal(facets, v, u):
    """A normal m with density proportional to D(m) max(0, v . m).

    Stretched by alpha, every roughness is 1: GGX is a hemisphere there (Heitz 2018, JCGT 7(4)), Beckmann a Gaussian.
    """
    stretched = stretch(facets, v)
    m = ggx_normal(stretched, u) if facets.kind == GGX else beckmann_normal(stretched, u)
    return normalize(Vec3(facets.alpha_u * m.x, facets.alpha_v * m.y, m.z))


@njit
def pdf_visible_normal(facets, v, m):
    """p(m) = D(m) max(0, v . m) / seen(v), 1/sr."""
    return facets.density(m) * max(0.0, dot(v, m)) / facets.seen(v)


@njit
def invert_visible_normal(facets, v, m):
    stretched = stretch(facets, v)
    m = Vec3(m.x / facets.alpha_u, m.y / facets.alpha_v, m.z)
    return ggx_square(stretched, m) if facets.kind == GGX else beckmann_square(stretched, m)


@njit
def stretch(facets, v):
    """The direction v in coordinates in which the roughness is 1."""
    return normalize(Vec3(facets.alpha_u * v.x, facets.alpha_v * v.y, v.z))


# --- GGX: the visible part of a hemisphere, by the mirror image of v in it ---


@njit
def ggx_normal(v, u):
    """Half way from v to a direction uniform over the cap z > -v.z: what a half ball of mirrors reflects.

    Source: Dupuy and Benyoub 2023, "Sampling visible GGX normals with spherical caps".
    """
    height = (1.0 - u[0]) * (1.0 + v.z)  # above the rim of the cap
    r = math.sqrt(u[0] * (1.0 + v.z) * (height + one_minus_z(v)))
    phi = 2.0 * PI * u[1]
    return Vec3(r * math.cos(phi) + v.x, r * math.sin(phi) + v.y, height)


@njit
def ggx_square(v, m):
    m = normalize(m)
    c = m * (2.0 * dot(v, m)) - v
    return 1.0 - (c.z + v.z) / (1.0 + v.z), turn(c.y, c.x)


@njit
def one_minus_z(v):
    """1 - v.z of a unit vector with z > 0, without cancellation."""
    return (v.x * v.x + v.y * v.y) / (1.0 + v.z)


# --- Beckmann: Gaussian slopes, those across v free, those along v as far as v sees them ---


@njit
def beckmann_normal(v, u):
    """The normal of slopes (-x / z, -y / z) drawn along v by `seen_slope` and across v from a Gaussian."""
    sine = math.sqrt(v.x * v.x + v.y * v.y)
    x, y = (v.x / sine, v.y / sine) if sine > 0.0 else (1.0, 0.0)
    along, across = seen_slope(v.z, sine, u[0]), seen_slope(1.0, 0.0, u[1])
    return Vec3(y * across - x * along, -x * across - y * along, 1.0)


@njit
def beckmann_square(v, m):
    sine = math.sqrt(v.x * v.x + v.y * v.y)
    x, y = (v.x / sine, v.y / sine) if sine > 0.0 else (1.0, 0.0)
    along, across = -(x * m.x + y * m.y) / m.z, (y * m.x - x * m.y) / m.z
    _, high = slope_range(v.z, sine)
    return slopes_below(v.z, sine, along) / slopes_below(v.z, sine, high), 0.5 * math.erfc(-across)


@njit
def slopes_below(cosine, sine, s):
    """2 times the area, projected along v, of facets with slope < s along v: integral of e^(-t^2) (cos - t sin)."""
    return cosine * math.erfc(-s) + sine * math.exp(-s * s) / math.sqrt(PI)


@njit
def slope_range(cosine, sine):
    """Slopes that v sees, -inf to cot(theta), as far as they matter: 10^-22 of a Gaussian lies beyond 7."""
    return -7.0, (cosine / sine if cosine < 7.0 * sine else 7.0)


@njit
def seen_slope(cosine, sine, u):
    """The slope below which the fraction u of all lies that v sees: Newton's method, kept between two bounds."""
    low, high = slope_range(cosine, sine)
    wanted = u * slopes_below(cosine, sine, high)
    s = min(0.0, high)
    for _ in range(100):
        excess = slopes_below(cosine, sine, s) - wanted
        low, high = (low, s) if excess > 0.0 else (s, high)
        rate = 2.0 / math.sqrt(PI) * math.exp(-s * s) * (cosine - s * sine)
        following = s - excess / rate if rate > 0.0 else low
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - s) <= 2.0**-50:
            return following
        s = following
    return s
