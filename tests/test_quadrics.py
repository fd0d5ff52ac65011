"""Spheres, disks and cylinders: hits against fifty-digit arithmetic, edges, normals and coordinates."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from helpers import U53, array, size, unit

from raylab import description as d
from raylab import quadrics
from raylab.geometry import Placement, quadric, quadric_row
from raylab.jit import njit
from raylab.quadrics import CYLINDER, DISK, SPHERE, Quadric
from raylab.record import Table
from raylab.vec3 import Vec3

INF = math.inf
HERE = Placement(np.zeros(3), 1.0)
EGG = np.array([[2.0, 0.3, 0.0, 1.0], [0.0, 0.5, -0.2, -2.0], [0.1, 0.0, 1.0, 0.5], [0, 0, 0, 1]])
SHAPES = {
    "sphere": d.Sphere(),
    "small far sphere": d.Sphere(center=np.array([3.0, -2.0, 1.0]), radius=1e-3),
    "egg": d.Sphere(to_world=EGG),
    "disk": d.Disk(),
    "tilted disk": d.Disk(to_world=EGG),
    "cylinder": d.Cylinder(),
    "pipe": d.Cylinder(p0=np.array([1.0, 2.0, 3.0]), p1=np.array([-1.0, 2.5, 4.0]), radius=0.25),
    "bent cylinder": d.Cylinder(to_world=EGG),
}
KIND = {d.Sphere: SPHERE, d.Disk: DISK, d.Cylinder: CYLINDER}


def rows(*shapes):
    return np.stack([quadric_row(quadric(s), HERE) for s in shapes])


def make(shape):
    return Table(Quadric, rows(shape))[0]


def exact_hits(q, o, ray):
    """All (t, slack) of the ray on the surface, in order, in fifty digits; slack: how far inside its edges, locally."""
    with mpmath.workdps(50):
        matrix = mpmath.matrix([[*q.a], [*q.b], [*q.c]])
        o = matrix * (mpmath.matrix([*o]) - mpmath.matrix([*q.p]))
        ray = matrix * mpmath.matrix([*ray])
        if q.kind == DISK:
            if ray[2] == 0:
                return []
            t = -o[2] / ray[2]
            return [(t, 1 - mpmath.hypot(o[0] + t * ray[0], o[1] + t * ray[1]))]
        axes = range(3) if q.kind == SPHERE else range(2)
        a, b, c = (
            sum(f(i) for i in axes) for f in (lambda i: ray[i] ** 2, lambda i: o[i] * ray[i], lambda i: o[i] ** 2)
        )
        room = b * b - a * (c - 1)
        if a == 0 or room < 0:
            return []
        hits = [(-b - mpmath.sqrt(room)) / a, (-b + mpmath.sqrt(room)) / a]
        z = [mpmath.mpf(0.5) if q.kind == SPHERE else o[2] + t * ray[2] for t in hits]
        return [(t, min(height, 1 - height)) for t, height in zip(hits, z, strict=True)]


def tolerance(q, o, ray, t):
    """Rounding of the local ray is 16 U53 of its size; where it grazes, a step across becomes a longer step along."""
    matrix = np.array([[*q.a], [*q.b], [*q.c]])
    local, along = matrix @ (array(o) - array(q.p)), matrix @ array(ray)
    at = local + float(t) * along
    normal = np.array([0, 0, 1]) if q.kind == DISK else at * ([1, 1, 1] if q.kind == SPHERE else [1, 1, 0])
    sizes = np.abs(matrix) @ (np.abs(array(o)) + np.abs(array(q.p)) + abs(float(t)) * np.abs(array(ray)))
    return 16 * U53 * (1.0 + sizes.sum()) / abs(normal @ along)


def rays(q, n, far, seed):
    """Rays from `far` local radii (0: from inside) at points around the quadric: within, near and beyond its edge."""
    rng = np.random.default_rng(seed)
    back = np.linalg.inv(np.array([[*q.a], [*q.b], [*q.c]]))
    for _ in range(n):
        start = rng.normal(size=3)
        start *= far / np.linalg.norm(start) if far else 0.5 / max(1.0, np.linalg.norm(start))
        towards = rng.normal(size=3)
        towards *= rng.choice([0.5, 0.999, 1.0, 1.2]) / np.linalg.norm(towards)
        scale = 10.0 ** rng.uniform(-3, 3)
        yield Vec3(*(back @ start + array(q.p))), Vec3(*(back @ (towards - start) * scale))


@pytest.mark.parametrize("far", [0.0, 1.5, 10.0, 1e4])
@pytest.mark.parametrize("name", SHAPES)
def test_hits_are_those_of_exact_arithmetic(name, far):
    q, checked = make(SHAPES[name]), 0
    for o, ray in rays(q, size(60, 30), far, seed=1):
        exact = exact_hits(q, o, ray)
        found = q.distance(o, ray, 0.0, INF)
        want, doubtful = INF, False
        for t, slack in exact:
            error = tolerance(q, o, ray, t)
            if not error < 0.1 * abs(t):  # grazing: a hair decides whether there is a hit at all
                doubtful = True
            elif t > 0 and abs(slack) <= 64 * U53 * (1.0 + far) / min(1.0, 1.0 / (1.0 + far)):
                doubtful = True  # on the edge of a disk or a cylinder
            elif t > 0 and slack > 0 and want == INF:
                want = t
        if not doubtful:
            checked += 1
            assert (found == INF) == (want == INF)
            if want != INF:
                assert abs(found - want) <= tolerance(q, o, ray, want)
    assert checked > size(60, 30) / 3


@pytest.mark.parametrize("gap", [1e-2, 1e-6, 1e-10])
@pytest.mark.parametrize("far", [2.0, 100.0])
def test_grazing_rays_hit_and_miss_a_sphere(gap, far):
    """A ray that passes at the distance 1 - gap hits, at 1 + gap misses; it meets at sqrt(2 gap) around the tangent."""
    q = make(SHAPES["sphere"])
    along = Vec3(0.0, 0.0, 1.0)
    for turn in np.linspace(0.0, 6.0, 7):
        side = array(unit(math.cos(turn), math.sin(turn), 0.0))
        inside, outside = (Vec3(*(side * s - [0.0, 0.0, far])) for s in (1.0 - gap, 1.0 + gap))
        half = math.sqrt(gap * (2.0 - gap))
        t = q.distance(inside, along, 0.0, INF)
        assert t == pytest.approx(far - half, abs=16 * U53 * far / half)
        assert q.distance(inside, along, far, INF) == pytest.approx(far + half, abs=16 * U53 * far / half)
        assert q.distance(outside, along, 0.0, INF) == INF


def test_the_interval_of_the_ray_is_open():
    q, o, ray = make(SHAPES["sphere"]), Vec3(0.0, 0.0, -3.0), Vec3(0.0, 0.0, 1.0)
    assert q.distance(o, ray, 0.0, INF) == 2.0
    assert q.distance(o, ray, 2.0, INF) == 4.0
    assert q.distance(o, ray, 0.0, 2.0) == INF
    assert q.distance(o, ray, 2.0, 4.0) == INF
    assert q.distance(o, ray, 1.9, 2.1) == 2.0
    assert q.distance(o, -ray, 0.0, INF) == INF
    disk = make(SHAPES["disk"])
    assert disk.distance(o, ray, 0.0, INF) == 3.0
    assert disk.distance(o, ray, 0.0, 3.0) == disk.distance(o, ray, 3.0, INF) == INF


def test_the_edge_of_a_disk_belongs_to_it():
    q, up = make(SHAPES["disk"]), Vec3(0.0, 0.0, 1.0)
    for x, y in ((1.0, 0.0), (0.6, -0.8), (0.0, 0.0)):
        assert q.distance(Vec3(x, y, -1.0), up, 0.0, INF) == 1.0
    for x, y in ((1.0 + 2 * U53, 0.0), (0.6, -0.8000001)):
        assert q.distance(Vec3(x, y, -1.0), up, 0.0, INF) == INF
    assert q.distance(Vec3(-2.0, 0.0, 0.0), Vec3(1.0, 0.0, 0.0), 0.0, INF) == INF  # in its plane
    assert q.distance(Vec3(-2.0, 0.0, 1e-3), Vec3(1.0, 0.0, 0.0), 0.0, INF) == INF  # parallel to it


def test_the_ends_of_a_cylinder_belong_to_it_and_are_open():
    q = make(SHAPES["cylinder"])
    inwards = Vec3(-1.0, 0.0, 0.0)
    for z, hit in ((0.0, True), (1.0, True), (0.5, True), (-1e-9, False), (1.0 + 1e-9, False)):
        assert q.distance(Vec3(3.0, 0.0, z), inwards, 0.0, INF) == (2.0 if hit else INF)
    through_the_end = Vec3(0.0, 0.0, -1.0), Vec3(0.5, 0.0, 1.0)  # leaves through the wall at z = 1
    assert q.distance(*through_the_end, 0.0, INF) == 2.0
    assert q.distance(Vec3(0.0, 0.0, -1.0), Vec3(0.8, 0.0, 1.0), 0.0, INF) == 1.25
    assert q.distance(Vec3(0.0, 0.0, -1.0), Vec3(0.4, 0.0, 1.0), 0.0, INF) == INF  # out at the other end
    assert q.distance(Vec3(0.5, 0.0, -1.0), Vec3(0.0, 0.0, 1.0), 0.0, INF) == INF  # parallel to the axis
    assert q.distance(Vec3(-3.0, 0.0, -1.6), Vec3(1.0, 0.0, 0.5), 0.0, INF) == 4.0  # over the near rim, the far wall


def test_a_ray_from_inside_meets_the_far_side():
    for name, o in (("sphere", Vec3(0.5, 0.0, 0.0)), ("cylinder", Vec3(0.5, 0.0, 0.5))):
        assert make(SHAPES[name]).distance(o, Vec3(1.0, 0.0, 0.0), 0.0, INF) == 0.5
        assert make(SHAPES[name]).distance(o, Vec3(-2.0, 0.0, 0.0), 0.0, INF) == 0.75


def test_a_ray_from_the_surface_finds_the_other_side():
    q = make(SHAPES["sphere"])
    for towards in (unit(-1, 0.3, 0.2), unit(-0.1, 1.0, 0.0)):
        t = q.distance(Vec3(1.0, 0.0, 0.0), towards, 0.0, INF)
        assert t == pytest.approx(-2.0 * towards.x, rel=16 * U53)
    assert q.distance(Vec3(1.0, 0.0, 0.0), unit(0.5, 1.0, 0.0), 0.0, INF) == INF


# --- what is known at a hit ---


def surface_points(q, n, seed=2):
    """Points of the surface by numpy, and their local coordinates."""
    rng = np.random.default_rng(seed)
    back = np.linalg.inv(np.array([[*q.a], [*q.b], [*q.c]]))
    for _ in range(n):
        local = rng.normal(size=3)
        if q.kind == SPHERE:
            local /= np.linalg.norm(local)
        elif q.kind == CYLINDER:
            local = np.array([*(local[:2] / np.linalg.norm(local[:2])), rng.random()])
        else:
            local = np.array([*(local[:2] / np.linalg.norm(local[:2]) * rng.random()), 0.0])
        yield Vec3(*(back @ local + array(q.p))), local, back


@pytest.mark.parametrize("flip", [False, True])
@pytest.mark.parametrize("name", SHAPES)
def test_normals_are_across_all_tangents_and_point_outwards(name, flip):
    q = make(type(SHAPES[name])(**(vars(SHAPES[name]) | {"flip_normals": flip})))
    for x, local, back in surface_points(q, 20):
        n = array(q.normal(x))
        outwards = {SPHERE: local, CYLINDER: local * [1, 1, 0], DISK: np.array([0, 0, 1.0])}[q.kind]
        first = np.cross(outwards, [0.3, 0.5, 0.7])
        condition = np.linalg.cond(back) * (1.0 + np.abs(array(q.p)).max() * np.linalg.norm([*q.a]))
        for tangent in (back @ first, back @ np.cross(outwards, first)):
            assert abs(n @ tangent) <= 64 * U53 * condition * np.linalg.norm(tangent)
        assert np.linalg.norm(n) == pytest.approx(1.0, abs=8 * U53)
        assert (n @ (back @ outwards) > 0.0) != flip


@pytest.mark.parametrize("name", SHAPES)
def test_surface_coordinates_are_mitsubas(name):
    """Sphere (phi / 2 pi, theta / pi), disk (r, phi / 2 pi), cylinder (phi / 2 pi, z)."""
    q = make(SHAPES[name])
    for x, local, back in surface_points(q, 20):
        phi = math.atan2(local[1], local[0]) / (2 * math.pi) % 1.0
        want = {
            SPHERE: (phi, math.acos(np.clip(local[2], -1, 1)) / math.pi),
            DISK: (math.hypot(local[0], local[1]), phi),
            CYLINDER: (phi, local[2]),
        }[q.kind]
        condition = np.linalg.cond(back) * (1.0 + np.abs(array(q.p)).max() * np.linalg.norm([*q.a]))
        error = 64 * U53 * condition / min(1.0, math.hypot(local[0], local[1]), math.sqrt(max(1 - local[2] ** 2, 1e-9)))
        assert q.surface_uv(x) == pytest.approx(want, abs=error)


def test_snap_brings_a_hit_onto_the_sphere_along_the_radius():
    for name in ("sphere", "egg", "small far sphere"):
        q = make(SHAPES[name])
        matrix = np.array([[*q.a], [*q.b], [*q.c]])
        for x, local, _ in surface_points(q, 20):
            off = Vec3(*(array(q.p) + (array(x) - array(q.p)) * 1.001))
            snapped = matrix @ (array(q.snap(off)) - array(q.p))
            rounding = 64 * U53 * (1.0 + np.abs(matrix).max() * np.abs(array(q.p)).max())
            assert snapped == pytest.approx(local, abs=rounding)
    disk, x = make(SHAPES["disk"]), Vec3(0.1, 0.2, 0.3)
    assert disk.snap(x) == x


@njit
def nearest(table, o, ray):
    best, which = INF, -1
    for i in range(len(table)):
        t = table[i].distance(o, ray, 0.0, best)
        if t < best:
            best, which = t, i
    return best, which


def test_a_table_of_quadrics_in_a_kernel():
    table = Table(Quadric, rows(*(d.Sphere(center=np.array([0.0, 0.0, z]), radius=0.5) for z in (4.0, 2.0, 6.0))))
    assert nearest(table, Vec3(0, 0, 0), Vec3(0, 0, 1)) == (1.5, 1)
    assert nearest(table, Vec3(0, 0, 0), Vec3(0, 0, -1)) == (INF, -1)


def test_every_kind_has_its_number():
    assert [rows(SHAPES[name])[0, 0] for name in ("sphere", "disk", "cylinder")] == [
        quadrics.SPHERE, quadrics.DISK, quadrics.CYLINDER,
    ]  # fmt: skip
