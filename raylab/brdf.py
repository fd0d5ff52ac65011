"""BRDFs: eval(V, L) -> f_r in 1/sr, sample(V, N, u) -> w, p_w, pdf(V, w, N) in 1/sr, lobe() -> k_s, n.

A smooth surface (`is_specular()`) has no f_r to speak of: it is black in `eval` and cannot be met by chance. Instead
`reflection(V, N)` is the share of light that it mirrors, `refraction(V, N)` the direction and share that it lets pass;
both are black for all others. `is_glossy()` tells whether there is a lobe, so that sampling the BRDF helps.

V points to the eye, L and w to the light, N to the side of V; all have unit length. f_r does not contain the
cosine, and k_d is a BRDF value (reflectance / pi), as on the slides.
"""

from __future__ import annotations

from typing import NamedTuple

from raylab.jit import njit
from raylab.record import methods_of, record
from raylab.sampling import PI, cos_power, pdf_cos_hemisphere, pdf_phong_lobe, sample_cos_hemisphere, sample_phong_lobe
from raylab.vec3 import Vec3, black, dot, luminance


@njit
def reflect(V, N):
    """The mirror direction R = 2 (N . V) N - V."""
    return N * (2.0 * dot(N, V)) - V


class Scattering:
    """A surface that sends light in all directions, so that nothing is left for the mirrored one or the refracted."""

    def is_specular(self):
        return False

    def reflection(self, V, N):
        return black

    def refraction(self, V, N):
        return N, black


@record
@methods_of(Scattering)
class Lambertian(NamedTuple):
    """f_r = k_d, sampled in proportion to f_r cos(theta)."""

    k_d: Vec3

    def eval(self, V, L):
        return self.k_d

    def sample(self, V, N, u):
        w = sample_cos_hemisphere(N, u)
        return w, pdf_cos_hemisphere(N, w)

    def pdf(self, V, w, N):
        return pdf_cos_hemisphere(N, w)

    def lobe(self):
        return black, 0.0

    def is_glossy(self):
        return False


@record
@methods_of(Scattering)
class Phong(NamedTuple):
    """f_r = k_d + k_s (n + 2) / (2 pi) max(0, R . L)^n, the energy-normalised modified Phong model.

    Source: Lafortune and Willems 1994, "Using the modified Phong reflectance model for physically based
    rendering". Sampled as a mixture: the diffuse part by the cosine, the lobe around R by its own density, in
    proportion to their albedos. A direction below the horizon has f_r cos(theta) = 0 and counts as a sample.
    """

    k_d: Vec3
    k_s: Vec3
    n: float
    N: Vec3

    def eval(self, V, L):
        lobe = (self.n + 2.0) / (2.0 * PI) * cos_power(reflect(V, self.N), self.n, L)
        return self.k_d + self.k_s * lobe

    def sample(self, V, N, u):
        diffuse = diffuse_share(self)
        if u[0] < diffuse:
            w = sample_cos_hemisphere(N, (u[0] / diffuse, u[1]))
        else:
            u1 = min((u[0] - diffuse) / (1.0 - diffuse), 1.0 - 2.0**-53)
            w = sample_phong_lobe(reflect(V, N), self.n, (u1, u[1]))
        return w, max(self.pdf(V, w, N), 2.0**-1000)  # never 0 / 0 where both f_r and p underflow

    def pdf(self, V, w, N):
        diffuse = diffuse_share(self)
        lobe = pdf_phong_lobe(reflect(V, N), self.n, w)
        return diffuse * pdf_cos_hemisphere(N, w) + (1.0 - diffuse) * lobe

    def lobe(self):
        return self.k_s, self.n

    def is_glossy(self):
        return luminance(self.k_s) > 0.0


@njit
def diffuse_share(brdf):
    """The part of the albedo that is diffuse; 1 for a black surface."""
    diffuse, specular = luminance(brdf.k_d) * PI, luminance(brdf.k_s)
    return diffuse / (diffuse + specular) if specular > 0.0 else 1.0
