"""Smooth surfaces: mirrors and glass, with the methods of `raylab.brdf`.

All light from one direction goes to one or two others, so f_r is a delta: `eval` and `pdf` are 0, and where a slide
divides by the density of `sample` the 1 that stands for it changes nothing.
"""

from __future__ import annotations

from typing import NamedTuple

from raylab import fresnel
from raylab.brdf import reflect
from raylab.record import methods_of, record
from raylab.vec3 import Vec3, black, dot


class Smooth:
    """What mirrors and glass have in common."""

    def eval(self, V, L):
        return black

    def sample(self, V, N, u):
        return reflect(V, N), 1.0

    def pdf(self, V, w, N):
        return 0.0

    def is_glossy(self):
        return False

    def is_specular(self):
        return True


@record
@methods_of(Smooth)
class Conductor(NamedTuple):
    """A metal mirror: complex index eta + i k for each colour, times the colour `specular`."""

    eta: Vec3
    k: Vec3
    specular: Vec3

    def reflection(self, V, N):
        return self.specular * fresnel.conductor(abs(dot(N, V)), self.eta, self.k)

    def refraction(self, V, N):
        return N, black


@record
@methods_of(Smooth)
class Dielectric(NamedTuple):
    """The boundary of glass seen from the side with the index n_i; eta = n_t / n_i.

    Radiance changes by 1 / eta^2 where light comes out of the other medium: the same flux fills another solid angle.
    """

    eta: float
    specular: Vec3
    transmittance: Vec3

    def reflection(self, V, N):
        R, _, _ = fresnel.dielectric(abs(dot(N, V)), self.eta)
        return self.specular * R

    def refraction(self, V, N):
        _, T, cos_t = fresnel.dielectric(abs(dot(N, V)), self.eta)
        return fresnel.refract(V, N, self.eta, cos_t), self.transmittance * (T / (self.eta * self.eta))
