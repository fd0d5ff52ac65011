"""Where a moving thing stands at a time: motion between two keyframes, evaluated in float64.

Time u runs from 0, the shutter opens, to 1, it closes. A motion is a sequence of pieces, rows of a table made by
`raylab.keyframes`; in each the local point x stands at

    T + R S x,   T = T0 + s T',   S = S0 + s S',   R = A + sin(s angle) B + cos(s angle) C,   s = (u - u0) / (u1 - u0)

with R a rotation of constant speed about a fixed axis (Rodrigues): no more than one sine and one cosine.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from raylab.jit import njit
from raylab.record import record
from raylab.vec3 import Vec3, cross, dot

# Columns of a piece: u0, u1, angle; then vectors: T0, T', the rows of A, B and C, the columns of S0 and S', which are
# the images of the three axes and of the origin.
_T, _A, _B, _C, _S, _DS, PIECE_COLUMNS = 3, 9, 18, 27, 36, 48, 60
LINEAR = [c for first in (_S, _DS) for c in range(first, first + 9)]  # columns of the images of axes


@record
class Pose(NamedTuple):
    """The affine map to the world: the images of the axes, x, y and z, and of the origin, p."""

    x: Vec3
    y: Vec3
    z: Vec3
    p: Vec3

    def inverse_rows(self):
        """The rows of the inverse of the linear part."""
        a, b, c = cross(self.y, self.z), cross(self.z, self.x), cross(self.x, self.y)
        scale = 1.0 / dot(self.x, a)
        return a * scale, b * scale, c * scale


@njit
def _vec(rows, i, j):
    return Vec3(rows[i, j], rows[i, j + 1], rows[i, j + 2])


@njit
def pose_at(rows, first, count, u):
    """The pose at time u of the motion with pieces first .. first + count - 1."""
    i = first
    while i < first + count - 1 and u > rows[i, 1]:
        i += 1
    s = (u - rows[i, 0]) / (rows[i, 1] - rows[i, 0])
    sine, cosine = 0.0, 1.0
    if rows[i, 2] != 0.0:
        sine, cosine = math.sin(s * rows[i, 2]), math.cos(s * rows[i, 2])
    r0 = _vec(rows, i, _A) + _vec(rows, i, _B) * sine + _vec(rows, i, _C) * cosine
    r1 = _vec(rows, i, _A + 3) + _vec(rows, i, _B + 3) * sine + _vec(rows, i, _C + 3) * cosine
    r2 = _vec(rows, i, _A + 6) + _vec(rows, i, _B + 6) * sine + _vec(rows, i, _C + 6) * cosine
    x = _turned(r0, r1, r2, _vec(rows, i, _S) + _vec(rows, i, _DS) * s)
    y = _turned(r0, r1, r2, _vec(rows, i, _S + 3) + _vec(rows, i, _DS + 3) * s)
    z = _turned(r0, r1, r2, _vec(rows, i, _S + 6) + _vec(rows, i, _DS + 6) * s)
    origin = _turned(r0, r1, r2, _vec(rows, i, _S + 9) + _vec(rows, i, _DS + 9) * s)
    return Pose(x, y, z, _vec(rows, i, _T) + _vec(rows, i, _T + 3) * s + origin)


@njit
def _turned(r0, r1, r2, v):
    return Vec3(dot(r0, v), dot(r1, v), dot(r2, v))
