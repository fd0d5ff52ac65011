"""What a surface is made of: material number, normal and texture coordinates -> brdf.

The kinds of table differ in the BRDF that they make, and `textures` in whether there is anything to look up, so that
a scene of plain diffuse surfaces is compiled without lobes, without mirrors and without textures.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from raylab.brdf import Lambertian, Phong
from raylab.jit import njit
from raylab.kinds import CONDUCTOR, DIELECTRIC, KIND, PHONG, ROUGH_CONDUCTOR, ROUGH_PLASTIC, TEXTURE, AnyBrdf
from raylab.record import record
from raylab.sampling import frame
from raylab.vec3 import Vec3, vec3_at
from raylab.view import View

BILINEAR, NEAREST = 0, 1
REPEAT, MIRROR, CLAMP = 0, 1, 2


@record
class NoTextures(NamedTuple):
    """Every colour is the same all over its surface."""

    tag: int = 0

    def colour(self, texture, uv, plain):
        return plain


@record
class Textures(NamedTuple):
    """Images (first texel, width, height, filter, wrap) in `sheets` (n, 5), their texels, one below the other, and
    the affine map of (u, v) in `maps` (n, 6); row 0 is the top, v = 1."""

    sheets: View
    maps: View
    texels: View

    def colour(self, texture, uv, plain):
        if texture < 0:
            return plain
        u = self.maps[texture, 0] * uv[0] + self.maps[texture, 1] * uv[1] + self.maps[texture, 2]
        v = self.maps[texture, 3] * uv[0] + self.maps[texture, 4] * uv[1] + self.maps[texture, 5]
        x, y = u * self.sheets[texture, 1], (1.0 - v) * self.sheets[texture, 2]
        if not (abs(x) < 2.0**31 and abs(y) < 2.0**31):
            return Vec3(math.nan, math.nan, math.nan)
        if self.sheets[texture, 3] == NEAREST:
            return texel(self, texture, math.floor(x), math.floor(y))
        i, j = math.floor(x - 0.5), math.floor(y - 0.5)
        s, t = x - 0.5 - i, y - 0.5 - j
        top = texel(self, texture, i, j) * (1.0 - s) + texel(self, texture, i + 1, j) * s
        bottom = texel(self, texture, i, j + 1) * (1.0 - s) + texel(self, texture, i + 1, j + 1) * s
        return top * (1.0 - t) + bottom * t


@njit
def texel(textures, texture, i, j):
    """Texel (column i, row j), whatever lies outside the image brought back as the wrap mode says."""
    width, height = textures.sheets[texture, 1], textures.sheets[texture, 2]
    mode = textures.sheets[texture, 4]
    column, row = wrap(int(i), width, mode), wrap(int(j), height, mode)
    return vec3_at(textures.texels, textures.sheets[texture, 0] + row * width + column)


@njit
def wrap(i, n, mode):
    """An index in 0 .. n - 1 for any i."""
    if mode == REPEAT:
        return i % n
    if mode == MIRROR:
        return min(i % (2 * n), 2 * n - 1 - i % (2 * n))
    return min(max(i, 0), n - 1)


@record
class DiffuseMaterials(NamedTuple):
    """Rows (reflectance 3, texture)."""

    rows: View
    textures: Any

    def at(self, material, N, uv):
        plain = vec3_at(self.rows, material)
        return Lambertian(self.textures.colour(int(self.rows[material, 3]), uv, plain) / math.pi)

    def glossy(self):
        return False

    def smooth(self):
        return False


@record
class PhongMaterials(NamedTuple):
    """Rows (diffuse reflectance 3, texture, specular reflectance 3, exponent); diffuse ones have a black lobe."""

    rows: View
    textures: Any

    def at(self, material, N, uv):
        plain = vec3_at(self.rows, material)
        k_d = self.textures.colour(int(self.rows[material, 3]), uv, plain) / math.pi
        k_s = Vec3(self.rows[material, 4], self.rows[material, 5], self.rows[material, 6])
        return Phong(k_d, k_s, self.rows[material, 7], N)

    def glossy(self):
        return True

    def smooth(self):
        return False


@record
class AnyMaterials(NamedTuple):
    """Rows of ROW columns (`raylab.kinds`), each of one of the `kinds` of the scene."""

    rows: View
    textures: Any
    kinds: Any  # Kinds

    def at(self, material, N, uv):
        plain = vec3_at(self.rows, material)
        k_d = self.textures.colour(int(self.rows[material, TEXTURE]), uv, plain) / math.pi
        tangent, _ = frame(N)
        return AnyBrdf(int(self.rows[material, KIND]), k_d, N, tangent, material, self.rows, self.kinds)

    def glossy(self):
        """Does any surface have a lobe?"""
        rough = self.kinds.rough_conductor.has(ROUGH_CONDUCTOR) or self.kinds.rough_plastic.has(ROUGH_PLASTIC)
        return rough or self.kinds.phong.has(PHONG)

    def smooth(self):
        """Is any surface a mirror or a piece of glass?"""
        return self.kinds.conductor.has(CONDUCTOR) or self.kinds.dielectric.has(DIELECTRIC)
