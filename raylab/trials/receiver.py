"""Receiver: the surface at the origin of every lesson, and what it reflects of lamps and skies, by quadrature."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from raylab import description as d
from raylab.closed_forms import irradiance as forms
from raylab.closed_forms import phong
from raylab.trials.polygon import area_of
from raylab.trials.trial import (
    BLACK,
    LUMINANCE,
    Answer,
    Array,
    Trial,
    Z,
    colour,
    moved,
    moved_point,
    random_pose,
    unit,
)

ERROR = 1e-4  # of a truth: rounding of the scene, 2^-24 of a hundred times the least distance, and of the quadrature


@dataclass(frozen=True, eq=False)
class Surface:
    """The receiver: reflectances, the exponent of its lobe, shading normal N, mirror direction R."""

    diffuse: Array
    specular: Array
    exponent: int
    N: Array
    view: Array

    @property
    def R(self) -> Array:
        return 2.0 * float(self.N @ self.view) * self.N - self.view

    @property
    def material(self) -> d.Material:
        glossy = self.specular.any()
        return d.Phong(self.diffuse, self.specular, float(self.exponent)) if glossy else d.Diffuse(self.diffuse)

    def lobe(self, w: Array) -> Array:
        n = self.exponent
        return self.specular * ((n + 2) / (2.0 * math.pi) * np.maximum(0.0, w @ self.R) ** n)[..., None]

    def f_r(self, w: Array) -> Array:
        """(..., 3) for directions (..., 3)."""
        return self.diffuse / math.pi + self.lobe(w)

    @property
    def largest(self) -> Array:
        return self.diffuse / math.pi + self.specular * (self.exponent + 2) / (2.0 * math.pi)

    def cosine(self, w: Array) -> Array:
        return np.maximum(0.0, w @ self.N)[..., None]

    @property
    def share(self) -> float:
        """The probability that `brdf.sample` takes the diffuse part."""
        diffuse, specular = float(LUMINANCE @ self.diffuse), float(LUMINANCE @ self.specular)
        return diffuse / (diffuse + specular)

    def pdf(self, w: Array) -> Array:
        """The density of `brdf.sample`, 1/sr."""
        n = self.exponent
        lobe = (n + 1) / (2.0 * math.pi) * np.maximum(0.0, w @ self.R)[..., None] ** n
        return self.share * self.cosine(w) / math.pi + (1.0 - self.share) * lobe

    def under(self, corners: Array, keep: tuple[Array, Array] | None = None) -> Array:
        """Light reflected from a polygon of radiance 1, or from what a half space leaves of it."""
        seen = corners if keep is None else forms.clip(corners, *keep)
        seen = forms.clip(seen, Z)
        even = self.diffuse / math.pi * float(forms.polygon(seen, n=self.N))
        if not self.specular.any():
            return even
        return even + self.specular * phong.polygon(seen, self.exponent, self.R, self.N)


def surface(rng: np.random.Generator, glossy: bool, tilted: bool) -> Surface:
    """Seen from an azimuth near 180; a tilted one leans by 25 to 35 degrees to the azimuth 180.

    A glossy one that is tilted has a wide lobe and is seen at a grazing angle, so that the horizon of N cuts the lobe.
    """
    lean = rng.uniform(25, 35) if tilted else 0.0
    grazing = glossy and tilted
    exponent = 3 if grazing else int(2 * rng.integers(1, 4) + 1)
    specular = colour(rng, 0.1, 0.5) if glossy else BLACK
    view = unit(rng.uniform(10, 16) if grazing else rng.uniform(35, 50), 180.0 + rng.uniform(-20, 20))
    return Surface(colour(rng, 0.1, 0.5), specular, exponent, unit(90.0 - lean, 180.0), view)


def put_up(
    name: str, rng: np.random.Generator, own: Surface, answers: dict[str, Answer], shapes: list[d.Shape],
    sky: Callable[[Array], d.Environment] | None = None,
) -> Trial:  # fmt: skip
    """The receiver, a triangle with a shading normal at each corner, and all else, in a random pose."""
    pose, third = random_pose(rng), 2.0 * math.pi / 3.0 * np.arange(3)
    corners = 0.005 * np.stack([np.cos(third), np.sin(third), 0.0 * third], axis=1)
    receiver = d.Mesh(
        vertices=corners, faces=np.array([[0, 1, 2]]), normals=np.tile(own.N, (3, 1)), front=own.material
    )  # fmt: skip
    described = d.SceneDescription(
        camera=d.Camera(to_world=pose, width=1, height=1),
        shapes=tuple(moved(pose, shape) for shape in (receiver, *shapes)),
        environment=sky(pose[:3, :3]) if sky else None,
        sampler="independent",
        name=name,
    )
    return Trial(name, described, answers, (moved_point(pose, BLACK), pose[:3, :3] @ own.view), ERROR)


def over_rectangle(corners: Array, f: Callable[[Array, Array, Array], Array], nodes: int = 64) -> Array:
    """The integral over a rectangle of f(w, r^2, cosine at the light) dA, Gauss-Legendre."""
    t, weights = np.polynomial.legendre.leggauss(nodes)
    t, weights = 0.5 * (t + 1.0), 0.5 * weights
    a, b = corners[1] - corners[0], corners[3] - corners[0]
    y = corners[0] + t[:, None, None] * a + t[None, :, None] * b
    normal = np.cross(a, b) / np.linalg.norm(np.cross(a, b))
    r2 = (y * y).sum(-1, keepdims=True)
    w = y / np.sqrt(r2)
    return area_of(corners) * np.einsum(
        "i,j,ijc->c", weights, weights, f(w, r2, np.maximum(0.0, -(w @ normal))[..., None])
    )


def over_cone(axis: Array, least: float, f: Callable[[Array], Array], nodes: int = 96) -> Array:
    """The integral of f(w) over the directions w with w . axis >= `least`: Gauss-Legendre in the cosine."""
    t, weights = np.polynomial.legendre.leggauss(nodes)
    z, weights = least + (1.0 - least) * 0.5 * (t + 1.0), 0.5 * (1.0 - least) * weights
    phi, r = 2.0 * math.pi * (np.arange(4 * nodes) + 0.5) / (4 * nodes), np.sqrt(1.0 - z * z)
    s = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    s /= np.linalg.norm(s)
    plane = np.cos(phi)[:, None] * s + np.sin(phi)[:, None] * np.cross(axis, s)
    w = z[:, None, None] * axis + r[:, None, None] * plane
    return 2.0 * math.pi / (4 * nodes) * np.einsum("i,ijc->c", weights, f(w))
