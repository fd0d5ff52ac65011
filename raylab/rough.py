"""Rough surfaces: metal and plastic made of microfacets, with the methods of `raylab.brdf`.

f_r = F(V . H) D(H) / (4 seen(V) seen(L)),  H = half way between V and L  (Cook and Torrance 1982; Walter et al. 2007)

is what F D G / (4 cos cos) becomes with Smith's separable G = G1(V) G1(L), since seen = cos / G1: finite at grazing
angles. T is a unit vector tangent to the surface, along which the roughness is alpha_u.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from raylab import fresnel
from raylab.brdf import Scattering
from raylab.jit import cached_njit, njit
from raylab.microfacet import Microfacets, sample_visible_normal
from raylab.record import methods_of, record
from raylab.sampling import PI, pdf_cos_hemisphere, sample_cos_hemisphere
from raylab.vec3 import Vec3, black, cross, dot, normalize
from raylab.view import View

LEAST_PDF = 2.0**-1000  # never 0 / 0 where both f_r and p underflow
TABLE = 64  # nodes of a table over cos(theta), as in Mitsuba
QUADRATURE = 64  # facets for each of them, along each side of the square


@record
@methods_of(Scattering)
class RoughConductor(NamedTuple):
    """Rough metal of complex index eta + i k for each colour, times the colour `specular`."""

    facets: Microfacets
    eta: Vec3
    k: Vec3
    specular: Vec3
    N: Vec3
    T: Vec3

    def eval(self, V, L):
        H = normalize(V + L)
        F = fresnel.conductor(dot(V, H), self.eta, self.k)
        return self.specular * F * mirror_lobe(self, V, L, H)

    def sample(self, V, N, u):
        w = reflect_at_facet(self, V, u)
        return w, max(pdf_mirror_lobe(self, V, w), LEAST_PDF)

    def pdf(self, V, w, N):
        return pdf_mirror_lobe(self, V, w)

    def is_glossy(self):
        return True


@record
@methods_of(Scattering)
class RoughPlastic(NamedTuple):
    """A diffuse base, reflectance pi k_d, under a rough clear coat of index eta: what the coat lets in and out,

    f_r = lobe + k_d T(V) T(L) / (eta^2 (1 - R)),

    with T(cos) row `row` of `tables` and R, its last column, the share that the coat sends back inside; `nonlinear`
    weighs R with the reflectance, so that colours become more saturated. Source: Mitsuba 3's roughplastic.
    """

    facets: Microfacets
    eta: float
    k_d: Vec3
    specular: Vec3
    nonlinear: bool
    tables: View
    row: int
    N: Vec3
    T: Vec3

    def eval(self, V, L):
        if dot(L, self.N) <= 0.0:
            return black
        H = normalize(V + L)
        F, _, _ = fresnel.dielectric(dot(V, H), self.eta)
        return self.specular * (F * mirror_lobe(self, V, L, H)) + base(self) * (
            transmittance(self, V) * transmittance(self, L)
        )

    def sample(self, V, N, u):
        diffuse = base_share(self, V)
        if u[0] < diffuse:
            w = sample_cos_hemisphere(N, (u[0] / diffuse, u[1]))
        else:
            w = reflect_at_facet(self, V, (min((u[0] - diffuse) / (1.0 - diffuse), 1.0 - 2.0**-53), u[1]))
        return w, max(self.pdf(V, w, N), LEAST_PDF)

    def pdf(self, V, w, N):
        diffuse = base_share(self, V)
        return diffuse * pdf_cos_hemisphere(N, w) + (1.0 - diffuse) * pdf_mirror_lobe(self, V, w)

    def is_glossy(self):
        return True


# --- the lobe of the facets ---


@njit
def to_local(brdf, v):
    """v in the frame T, N x T, N."""
    return Vec3(dot(v, brdf.T), dot(v, cross(brdf.N, brdf.T)), dot(v, brdf.N))


@njit
def mirror_lobe(brdf, V, L, H):
    """D(H) / (4 seen(V) seen(L)), 1/sr; 0 below the horizon."""
    v, w = to_local(brdf, V), to_local(brdf, L)
    if v.z <= 0.0 or w.z <= 0.0:
        return 0.0
    D = brdf.facets.density(to_local(brdf, H))
    return 0.25 * D / (brdf.facets.seen_as_mitsuba(v) * brdf.facets.seen_as_mitsuba(w))


@njit
def reflect_at_facet(brdf, V, u):
    """V mirrored at a facet that it sees."""
    v = to_local(brdf, V)
    m = sample_visible_normal(brdf.facets, v, u)
    w = m * (2.0 * dot(v, m)) - v
    return normalize(brdf.T * w.x + cross(brdf.N, brdf.T) * w.y + brdf.N * w.z)


@njit
def pdf_mirror_lobe(brdf, V, w):
    """p(w) = p(H) / (4 V . H) = D(H) / (4 seen(V)), 1/sr, above the horizon and below."""
    v, H = to_local(brdf, V), to_local(brdf, V + w)
    return 0.25 * brdf.facets.density(normalize(H)) / brdf.facets.seen(v) if H.z > 0.0 else 0.0


# --- the base under a coat ---


@njit
def base(plastic):
    """k_d / (eta^2 (1 - R)): light that the coat throws back is reflected again, and again."""
    R = plastic.tables[plastic.row, TABLE]
    lost = plastic.k_d * (PI * R) if plastic.nonlinear else Vec3(R, R, R)
    return plastic.k_d / ((Vec3(1.0, 1.0, 1.0) - lost) * (plastic.eta * plastic.eta))


@njit
def transmittance(plastic, v):
    """The share of light from v that enters the coat, linear between the nodes of the table."""
    x = max(0.0, dot(v, plastic.N)) * (TABLE - 1)
    i = min(int(x), TABLE - 2)
    low, high = plastic.tables[plastic.row, i], plastic.tables[plastic.row, i + 1]
    return low + (high - low) * (x - i)


@njit
def base_share(plastic, V):
    """The part of the samples that the base gets, by what reaches it and by the mean reflectances."""
    T = transmittance(plastic, V)
    base = T * PI * (plastic.k_d.x + plastic.k_d.y + plastic.k_d.z)
    coat = (1.0 - T) * (plastic.specular.x + plastic.specular.y + plastic.specular.z)
    return base / (base + coat) if base + coat > 0.0 else 0.0


def plastic_table(kind: int, alpha: float, eta: float) -> npt.NDArray[np.float64]:
    """(TABLE + 1,): the coat's transmittance T at cos(theta) = 0 .. 1 from outside, and its reflectance R inside.

    R = 2 mean(R(cos) cos) over the same nodes: Mitsuba's rule, 1.5 % off the integral, for the same picture.
    """
    table = np.zeros(TABLE + 1)
    facets = Microfacets(kind, float(alpha), float(alpha))
    x, weight = np.polynomial.legendre.leggauss(QUADRATURE)
    _coat(facets, float(eta), 0.5 * (x + 1.0), 0.5 * weight, table)
    return table


def coat(facets: Any, eta: Any, nodes: Any, weights: Any, table: Any) -> None:
    """Fill a table by Gauss-Legendre quadrature over the square of `sample_visible_normal`."""
    inside = 0.0
    for i in range(TABLE):
        cosine = max(1e-6, i / (TABLE - 1.0))
        v = Vec3(np.sqrt(1.0 - cosine * cosine), 0.0, cosine)
        T = R = 0.0
        for a in range(len(nodes)):
            for b in range(len(nodes)):
                m = sample_visible_normal(facets, v, (nodes[a], nodes[b]))
                T += passed(facets, v, m, eta) * weights[a] * weights[b]
                R += sent_back(facets, v, m, 1.0 / eta) * weights[a] * weights[b]
        table[i] = T
        inside += 2.0 * R * cosine / TABLE
    table[TABLE] = inside


@njit
def passed(facets, v, m, eta):
    """(1 - F) G1 of the light from v that goes through a facet m and is not masked behind."""
    _, T, cosine = fresnel.dielectric(dot(v, m), eta)
    w = fresnel.refract(v, m, eta, cosine)
    return T * -w.z / facets.seen_as_mitsuba(-w) if w.z < 0.0 else 0.0


@njit
def sent_back(facets, v, m, eta):
    """F G1 of the light from v that a facet m reflects and that is not masked."""
    w = m * (2.0 * dot(v, m)) - v
    F, _, _ = fresnel.dielectric(dot(v, m), eta)
    return F * w.z / facets.seen_as_mitsuba(w) if w.z > 0.0 else 0.0


_coat = cached_njit(coat)
