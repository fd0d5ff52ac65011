"""AnyBrdf: the BRDF of a scene with more than diffuse and Phong surfaces.

One record serves all kinds: what its columns mean depends on `kind`, and the kinds that a scene lacks are `Absent`,
so that nothing of them is compiled. A kind makes the BRDF proper of a point with `of(brdf)`; one more kind is one more
record here, one more field of `Kinds`, one more line in each method of `AnyBrdf`, and a row in `raylab.palette`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from raylab.brdf import Lambertian, Phong
from raylab.microfacet import Microfacets
from raylab.record import record
from raylab.rough import RoughConductor, RoughPlastic
from raylab.smooth import Conductor, Dielectric
from raylab.vec3 import Vec3, black
from raylab.view import View

DIFFUSE, PHONG, CONDUCTOR, DIELECTRIC, ROUGH_CONDUCTOR, ROUGH_PLASTIC = range(6)
# Columns of a material's row; what stands from PARAMETERS on is up to the kind.
COLOUR, TEXTURE, SPECULAR, EXPONENT, KIND, PARAMETERS, ROW = 0, 3, 4, 7, 8, 9, 24


@record
class AnyBrdf(NamedTuple):
    """Row `material` of `rows` at a point with normal N; k_d holds the (textured) colour / pi, T is tangent to the
    surface."""

    kind: int
    k_d: Vec3
    N: Vec3
    T: Vec3
    material: int
    rows: View
    kinds: Any  # the Kinds of the scene

    def number(self, column):
        return self.rows[self.material, column]

    def colour(self, column):
        return Vec3(
            self.rows[self.material, column],
            self.rows[self.material, column + 1],
            self.rows[self.material, column + 2],
        )

    def eval(self, V, L):
        kinds = self.kinds
        if kinds.phong.has(self.kind):
            return kinds.phong.of(self).eval(V, L)
        if kinds.rough_conductor.has(self.kind):
            return kinds.rough_conductor.of(self).eval(V, L)
        if kinds.rough_plastic.has(self.kind):
            return kinds.rough_plastic.of(self).eval(V, L)
        return self.k_d  # black for smooth surfaces

    def sample(self, V, N, u):
        kinds = self.kinds
        if kinds.phong.has(self.kind):
            return kinds.phong.of(self).sample(V, N, u)
        if kinds.rough_conductor.has(self.kind):
            return kinds.rough_conductor.of(self).sample(V, N, u)
        if kinds.rough_plastic.has(self.kind):
            return kinds.rough_plastic.of(self).sample(V, N, u)
        if kinds.conductor.has(self.kind):
            return kinds.conductor.of(self).sample(V, N, u)
        if kinds.dielectric.has(self.kind):
            return kinds.dielectric.of(self).sample(V, N, u)
        return Lambertian(self.k_d).sample(V, N, u)

    def pdf(self, V, w, N):
        kinds = self.kinds
        if kinds.phong.has(self.kind):
            return kinds.phong.of(self).pdf(V, w, N)
        if kinds.rough_conductor.has(self.kind):
            return kinds.rough_conductor.of(self).pdf(V, w, N)
        if kinds.rough_plastic.has(self.kind):
            return kinds.rough_plastic.of(self).pdf(V, w, N)
        if self.is_specular():
            return 0.0
        return Lambertian(self.k_d).pdf(V, w, N)

    def lobe(self):
        if self.kinds.phong.has(self.kind):
            return self.kinds.phong.of(self).lobe()
        return black, 0.0

    def is_glossy(self):
        kinds = self.kinds
        if kinds.phong.has(self.kind):
            return kinds.phong.of(self).is_glossy()
        return kinds.rough_conductor.has(self.kind) or kinds.rough_plastic.has(self.kind)

    def is_specular(self):
        return self.kinds.conductor.has(self.kind) or self.kinds.dielectric.has(self.kind)

    def reflection(self, V, N):
        kinds = self.kinds
        if kinds.conductor.has(self.kind):
            return kinds.conductor.of(self).reflection(V, N)
        if kinds.dielectric.has(self.kind):
            return kinds.dielectric.of(self).reflection(V, N)
        return black

    def refraction(self, V, N):
        if self.kinds.dielectric.has(self.kind):
            return self.kinds.dielectric.of(self).refraction(V, N)
        return N, black


@record
class Absent(NamedTuple):
    """A kind of surface that the scene does not have."""

    kind: int = -1

    def has(self, kind):
        return False

    def of(self, brdf):
        return Lambertian(black)


@record
class PhongKind(NamedTuple):
    kind: int = PHONG

    def has(self, kind):
        return kind == PHONG

    def of(self, brdf):
        return Phong(brdf.k_d, brdf.colour(SPECULAR), brdf.number(EXPONENT), brdf.N)


@record
class ConductorKind(NamedTuple):
    """Parameters: eta 3, k 3."""

    kind: int = CONDUCTOR

    def has(self, kind):
        return kind == CONDUCTOR

    def of(self, brdf):
        return Conductor(brdf.colour(PARAMETERS), brdf.colour(PARAMETERS + 3), brdf.colour(SPECULAR))


@record
class DielectricKind(NamedTuple):
    """Parameters: eta, specular transmittance 3."""

    kind: int = DIELECTRIC

    def has(self, kind):
        return kind == DIELECTRIC

    def of(self, brdf):
        return Dielectric(brdf.number(PARAMETERS), brdf.colour(SPECULAR), brdf.colour(PARAMETERS + 1))


@record
class RoughConductorKind(NamedTuple):
    """Parameters: eta 3, k 3, distribution, alpha_u, alpha_v."""

    kind: int = ROUGH_CONDUCTOR

    def has(self, kind):
        return kind == ROUGH_CONDUCTOR

    def of(self, brdf):
        first = PARAMETERS + 6
        facets = Microfacets(int(brdf.number(first)), brdf.number(first + 1), brdf.number(first + 2))
        eta, k = brdf.colour(PARAMETERS), brdf.colour(PARAMETERS + 3)
        return RoughConductor(facets, eta, k, brdf.colour(SPECULAR), brdf.N, brdf.T)


@record
class RoughPlasticKind(NamedTuple):
    """Parameters: distribution, alpha, eta, nonlinear, row of `coats`: what the coats let pass, `plastic_table`."""

    coats: View

    def has(self, kind):
        return kind == ROUGH_PLASTIC

    def of(self, brdf):
        alpha, eta = brdf.number(PARAMETERS + 1), brdf.number(PARAMETERS + 2)
        facets = Microfacets(int(brdf.number(PARAMETERS)), alpha, alpha)
        nonlinear, coat = brdf.number(PARAMETERS + 3) != 0.0, int(brdf.number(PARAMETERS + 4))
        return RoughPlastic(facets, eta, brdf.k_d, brdf.colour(SPECULAR), nonlinear, self.coats, coat, brdf.N, brdf.T)


class Kinds(NamedTuple):
    """The kinds of surface in a scene, `Absent` where there is none; diffuse ones need no record."""

    phong: Any = Absent()
    conductor: Any = Absent()
    dielectric: Any = Absent()
    rough_conductor: Any = Absent()
    rough_plastic: Any = Absent()


RECORDS: dict[int, tuple[str, Any]] = {
    PHONG: ("phong", PhongKind()),
    CONDUCTOR: ("conductor", ConductorKind()),
    DIELECTRIC: ("dielectric", DielectricKind()),
    ROUGH_CONDUCTOR: ("rough_conductor", RoughConductorKind()),
}
