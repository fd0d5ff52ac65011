"""Spheres, disks and cylinders, met by a ray in float64.

A quadric is a row: kind, origin p, the rows of the map from world to local coordinates, and side (+1, or -1 for
flipped normals); in local coordinates it is the unit sphere, the unit disk in z = 0, or the unit cylinder over
0 <= z <= 1. Embree finds which quadrics a ray may meet and asks `first_hit` where.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from raylab.jit import njit
from raylab.pose import PIECE_COLUMNS, pose_at
from raylab.record import record
from raylab.vec3 import Vec3, dot, normalize

SPHERE, DISK, CYLINDER = range(3)


@record
class Quadric(NamedTuple):
    """One quadric; (a, b, c) are the rows of the world-to-local matrix."""

    kind: int
    p: Vec3
    a: Vec3
    b: Vec3
    c: Vec3
    side: float

    @staticmethod
    def of(rows, i, store):
        return quadric_at(rows, i)

    def distance(self, o, d, tnear, tfar):
        """Where the ray o + t d meets the surface; inf for a miss."""
        return first_hit(self, o, d, tnear, tfar)

    def normal(self, x):
        """The unit normal at the point x of the surface."""
        local = to_local(self, x - self.p)
        if self.kind == DISK:
            gradient = self.c
        elif self.kind == SPHERE:
            gradient = self.a * local.x + self.b * local.y + self.c * local.z
        else:
            gradient = self.a * local.x + self.b * local.y
        return normalize(gradient) * self.side

    def snap(self, x):
        """The point x moved along the radius onto the curved surface, where a hit lies within rounding of it."""
        local = to_local(self, x - self.p)
        if self.kind == SPHERE:
            return self.p + (x - self.p) / math.sqrt(dot(local, local))
        return x

    def surface_uv(self, x):
        """Surface coordinates: disk (r, phi / 2 pi), sphere (phi / 2 pi, theta / pi), cylinder (phi / 2 pi, z)."""
        local = to_local(self, x - self.p)
        turn = math.atan2(local.y, local.x) / (2.0 * math.pi)
        turn = turn if turn >= 0.0 else turn + 1.0
        if self.kind == DISK:
            return math.sqrt(local.x * local.x + local.y * local.y), turn
        if self.kind == SPHERE:
            return turn, math.atan2(math.sqrt(local.x * local.x + local.y * local.y), local.z) / math.pi
        return turn, local.z


@njit
def quadric_at(rows, i):
    """Row i as a record."""
    p, a = Vec3(rows[i, 1], rows[i, 2], rows[i, 3]), Vec3(rows[i, 4], rows[i, 5], rows[i, 6])
    b, c = Vec3(rows[i, 7], rows[i, 8], rows[i, 9]), Vec3(rows[i, 10], rows[i, 11], rows[i, 12])
    return Quadric(int(rows[i, 0]), p, a, b, c, rows[i, 13])


MOVING_COLUMNS = PIECE_COLUMNS  # of a row of a table in which something moves: first the columns of a Quadric
FIRST_PIECE, PIECES, ALL_ROWS = 14, 15, 16  # then where its pieces stand in the table, how many, and the table's length


@record
class MovingQuadric(NamedTuple):
    """A quadric where it stands at the time of the clock, `store`."""

    @staticmethod
    def of(rows, i, store):
        return quadric_at_time(rows, i, store[0])


@njit
def quadric_at_time(rows, i, u):
    """Row i of a table in which something moves, at time u; rows of pieces stand behind those of the quadrics."""
    quadric = quadric_at(rows, i)
    count = int(rows[i, PIECES])
    if count == 0:
        return quadric
    pose = pose_at(rows, int(rows[i, FIRST_PIECE]), count, u)
    a, b, c = pose.inverse_rows()
    return Quadric(quadric.kind, pose.p, a, b, c, quadric.side)


@njit
def to_local(quadric, v):
    """The world vector v in local coordinates."""
    return Vec3(dot(quadric.a, v), dot(quadric.b, v), dot(quadric.c, v))


@njit
def first_hit(quadric, o, d, tnear, tfar):
    """The smallest t in (tnear, tfar) at which o + t d lies on the surface; inf when there is none."""
    o, d = to_local(quadric, o - quadric.p), to_local(quadric, d)
    if quadric.kind == DISK:
        t = -o.z / d.z if d.z != 0.0 else math.inf
        x, y = o.x + t * d.x, o.y + t * d.y
        return t if tnear < t < tfar and x * x + y * y <= 1.0 else math.inf
    low, high = crossings(quadric.kind, o, d)
    for t in (low, high):
        if tnear < t < tfar and (quadric.kind == SPHERE or 0.0 <= o.z + t * d.z <= 1.0):
            return t
    return math.inf


@njit
def crossings(kind, o, d):
    """Both t at which a local ray crosses the unit sphere or the infinite unit cylinder, in order; inf if none.

    The distance to the axis is taken from the point of closest approach, which does not cancel for a far origin.
    """
    z = 1.0 if kind == SPHERE else 0.0
    a = d.x * d.x + d.y * d.y + z * d.z * d.z
    if a == 0.0:
        return math.inf, math.inf
    b = o.x * d.x + o.y * d.y + z * o.z * d.z
    nearest = o - d * (b / a)
    room = 1.0 - (nearest.x * nearest.x + nearest.y * nearest.y + z * nearest.z * nearest.z)
    if room < 0.0:
        return math.inf, math.inf
    q = -(b + math.copysign(math.sqrt(a * room), b))
    radius = math.sqrt(o.x * o.x + o.y * o.y + z * o.z * o.z)
    first = q / a
    second = (radius - 1.0) * (radius + 1.0) / q if q != 0.0 else first
    return min(first, second), max(first, second)
