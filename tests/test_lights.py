"""Lights: points on the shape, densities as Jacobians, integrals over them, and irradiance against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import U53, array, composite, gauss, squares, unit
from scipy.spatial.transform import Rotation

from raylab import description as d
from raylab.emitters import AreaLights
from raylab.geometry import Placement, quadric, quadric_row, world_mesh
from raylab.point import dist_sqr, free_point
from raylab.vec3 import Vec3, black, dot, length, normalize

PI = math.pi
WHITE = np.ones(3)
HERE = Placement(np.zeros(3), 1.0)
LAST = 1.0 - 2.0**-53
EXTREME = [(u, v) for u in (0.0, 2.0**-53, 0.5, LAST) for v in (0.0, 0.5, LAST)]
ORIGIN = free_point(black)


def matrix(scale=(1.0, 1.0, 1.0), offset=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0)):
    """Scale, then a rotation that turns +z to `axis`, then a translation."""
    m = np.eye(4)
    turn, _ = Rotation.align_vectors([np.asarray(axis) / np.linalg.norm(axis)], [[0, 0, 1]])
    m[:3, :3] = turn.as_matrix() @ np.diag(scale)
    m[:3, 3] = offset
    return m


def add(collection, shape):
    """Put a shape of raylab.description into an AreaLights."""
    if isinstance(shape, d.Disk | d.Sphere | d.Cylinder):
        return collection.add_quadric(shape, quadric_row(quadric(shape), HERE))
    warnings: list[str] = []
    mesh = world_mesh(shape, warnings)
    assert not warnings
    return collection.add_mesh(shape, mesh.kind, mesh.vertices, mesh.faces)


def table(*shapes):
    collection = AreaLights()
    for shape in shapes:
        add(collection, shape)
    return collection.table()


def light(shape):
    """The second light of a scene whose first one is a mesh: what belongs to one light must not leak into the next."""
    return table(d.Cube(radiance=WHITE), shape)[1]


def rectangle(**more):
    return d.Rectangle(radiance=WHITE, **more)


def triangle(corners, **more):
    return d.Mesh(radiance=WHITE, vertices=np.asarray(corners, float), faces=np.array([[0, 1, 2]]), **more)


CORNERS = np.array([[0.5, 0.2, 2.0], [1.5, 0.1, 2.5], [0.3, 1.4, 1.5]])
TETRA = d.Mesh(
    radiance=WHITE,
    vertices=np.array([[0.0, 0, 2], [2, 0, 2], [0, 3, 2], [0, 0, 4.0]]),
    faces=np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]),
)
PLACE = {"offset": (1.0, -2.0, 3.0), "axis": (1.0, 2.0, -2.0)}
SHAPES = {
    "rectangle": rectangle(to_world=matrix((2.0, 0.5, 1.0), **PLACE)),
    "triangle": triangle(CORNERS),
    "disk": d.Disk(radiance=WHITE, to_world=matrix((2.0, 0.5, 1.0), **PLACE)),
    "sphere": d.Sphere(radiance=WHITE, to_world=matrix((0.75, 0.75, 0.75), **PLACE)),
    "cylinder": d.Cylinder(radiance=WHITE, radius=0.75, to_world=matrix(**PLACE), p1=np.array([0.0, 0.0, 2.0])),
    "mesh": TETRA,
}
AREAS = {
    "rectangle": 4.0 * 2.0 * 0.5,
    "triangle": 0.5 * np.linalg.norm(np.cross(CORNERS[1] - CORNERS[0], CORNERS[2] - CORNERS[0])),
    "disk": PI * 2.0 * 0.5,
    "sphere": 4.0 * PI * 0.75**2,
    "cylinder": 2.0 * PI * 0.75 * 2.0,
    "mesh": 0.5 * (2 * 3 + 2 * 2 + 3 * 2 + np.linalg.norm(np.cross([-2, 3, 0], [-2, 0, 2]))),
}
NAMES = list(SHAPES)


def residual(name, y):
    """How far the point y misses its shape (0 on it), and what its normal must be; in local coordinates by numpy."""
    if name == "mesh":
        faces = TETRA.vertices[TETRA.faces]
        n = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        height = np.einsum("ij,ij->i", array(y.p) - faces[:, 0], n)
        k = np.argmax(np.where(np.abs(height) < 1e-12, n @ array(y.n), -2.0))
        b = np.linalg.lstsq(np.vstack([faces[k].T, np.ones(3)]), [*y.p, 1.0], rcond=None)[0]
        return max(abs(height[k]), -b.min()), n[k]
    if name == "triangle":
        b = np.linalg.solve(CORNERS.T, array(y.p))
        n = np.cross(CORNERS[1] - CORNERS[0], CORNERS[2] - CORNERS[0])
        return max(abs(b.sum() - 1.0), -b.min(), 0.0), n / np.linalg.norm(n)
    to_world = SHAPES[name].to_world
    local = np.linalg.solve(to_world, [*y.p, 1.0])[:3]
    radial = to_world[:3, :3] @ (local * ([1, 1, 1] if name == "sphere" else [1, 1, 0]))
    if name == "rectangle":
        return max(abs(local[2]), np.abs(local[:2]).max() - 1.0, 0.0), to_world[:3, 2]
    if name == "disk":
        return max(abs(local[2]), math.hypot(*local[:2]) - 1.0, 0.0), to_world[:3, 2]
    if name == "sphere":
        return abs(np.linalg.norm(local) - 1.0), radial / np.linalg.norm(radial)
    return max(abs(math.hypot(*local[:2]) - 0.75), local[2] - 2.0, -local[2], 0.0), radial / np.linalg.norm(radial)


@pytest.mark.parametrize("name", NAMES)
def test_samples_lie_on_the_shape_with_its_normal(name):
    one = light(SHAPES[name])
    for u in EXTREME + squares(50):
        y, p = one.sample(ORIGIN, u)
        miss, n = residual(name, y)
        assert miss <= 64 * U53 * 4  # coordinates up to 4
        assert np.abs(array(y.n) - n).max() <= 64 * U53
        assert 0.0 <= p < math.inf


@pytest.mark.parametrize("name", [n for n in NAMES if n != "sphere"])
def test_a_density_over_the_whole_surface_is_one_over_its_area(name):
    one = light(SHAPES[name])
    assert one.area == pytest.approx(AREAS[name], rel=16 * U53)
    y, p = one.sample(ORIGIN, (0.3, 0.6))
    assert p == one.pdf(ORIGIN, y) == pytest.approx(1.0 / AREAS[name], rel=16 * U53)


@pytest.mark.parametrize("name", NAMES)
def test_the_density_is_one_over_the_jacobian(name):
    """dA = |dy/du1 x dy/du2| du1 du2, hence p |dy/du1 x dy/du2| = 1; differences do not cross faces."""
    one, h = light(SHAPES[name]), 1e-5
    for u1 in (0.13, 0.45, 0.77, 0.93):
        for u2 in (0.1, 0.35, 0.8):
            along = array(one.sample(ORIGIN, (u1 + h, u2))[0].p) - array(one.sample(ORIGIN, (u1 - h, u2))[0].p)
            across = array(one.sample(ORIGIN, (u1, u2 + h))[0].p) - array(one.sample(ORIGIN, (u1, u2 - h))[0].p)
            area = np.linalg.norm(np.cross(along, across)) / (4 * h * h)
            # truncation: 40 h^2 for the sine around and for roots of u1 above 0.02; rounding: 16 U53 / h of |y| < 5
            assert abs(one.sample(ORIGIN, (u1, u2))[1] * area - 1.0) <= 40 * h * h * 25 + 16 * U53 / h * 25


# --- spheres ---


def ball(radius=1.0, **more):
    return light(d.Sphere(radiance=WHITE, radius=radius, **more))


@pytest.mark.parametrize("distance", [1.0 + 1e-8, 1.0 + 1e-4, 1.5, 30.0, 1e8])
def test_seen_from_outside_the_density_integrates_to_one_over_the_visible_cap(distance):
    one, x = ball(), free_point(Vec3(0.0, 0.0, distance))
    total = 0.0
    # p dA = cos / (r^2 Omega) dA: in the angle from the axis, whose edge is where the sight grazes
    edge = math.acos(1.0 / distance)
    height = min(distance - 1.0, 1.0)  # near the surface, half of it comes from a spot of this size
    cuts = np.unique([0.0, *(height * 4.0**k for k in range(14) if height * 4.0**k < edge), edge])
    for t, weight in zip(*composite(24, cuts), strict=True):
        n = Vec3(math.sin(t), 0.0, math.cos(t))
        total += one.pdf(x, free_point(n)._replace(n=n)) * 2.0 * PI * math.sin(t) * weight
    # the distance to y cancels: 1 - z is exact to U53 absolutely
    assert total == pytest.approx(1.0, rel=1e-9 + 64 * U53 / (distance - 1.0))


@pytest.mark.parametrize("distance", [1.0 + 1e-8, 1.0 + 1e-4, 1.5, 30.0, 1e8])
def test_seen_from_outside_sample_and_pdf_agree_and_only_the_front_is_sampled(distance):
    one, x = ball(), free_point(Vec3(0.0, 0.0, distance))
    for u in [*squares(50, seed=1), (0.0, 0.3)]:
        y, p = one.sample(x, u)
        assert abs(length(y.p) - 1.0) <= 8 * U53
        cosine = dot(y.n, normalize(x - y))
        assert cosine > 0.0
        # y is known to U53, and with it 1/r^2 and the cosine at y
        rounding = 64 * U53 * (1.0 + distance) / (length(x - y) * cosine)
        assert one.pdf(x, y) == pytest.approx(p, rel=rounding)


@pytest.mark.parametrize("distance", [0.0, 0.5, 1.0 - 1e-12, 1.0])
def test_seen_from_inside_the_whole_sphere_is_sampled(distance):  # B03
    inwards = d.Sphere(radiance=WHITE, flip_normals=True)
    for one, side in ((ball(), 1.0), (light(inwards), -1.0)):
        x = free_point(Vec3(0.0, distance, 0.0))
        for u in EXTREME + squares(20):
            y, p = one.sample(x, u)
            assert length(y.p - y.n * side) <= 8 * U53
            assert p == one.pdf(x, y) == 1.0 / one.area


@pytest.mark.parametrize("distance", [1.0 + 1e-8, 1.001, 2.0, 1e3, 1e6])
def test_extreme_points_of_the_square_give_points_of_a_sphere(distance):
    one, x = ball(), free_point(unit(0.3, 0.4, -0.5) * distance)
    for u in EXTREME:
        y, p = one.sample(x, u)
        assert abs(length(y.p) - 1.0) <= 8 * U53
        assert 0.0 <= p < math.inf


# --- irradiance ---


def over_light(one, x, f, nodes=32):
    """Integral of f(L) cos_y / r^2 dA, through the light's own sampling: Gauss-Legendre in u, with u1 = t^2."""
    total = 0.0
    for t, wt in zip(*gauss(nodes), strict=True):
        for v, wv in zip(*gauss(nodes), strict=True):
            y, p = one.sample(x, (t * t, v))
            L = normalize(y - x)
            total += f(L) * max(0.0, -dot(L, y.n)) / dist_sqr(x, y) / p * 2.0 * t * wt * wv
    return total


def irradiance(one, x, n):
    return over_light(one, x, lambda L: max(0.0, dot(L, n)))


def lambert(corners, n):
    """Irradiance by a polygon of radiance 1 around the origin above the horizon (Lambert 1760)."""
    v = np.asarray(corners) / np.linalg.norm(corners, axis=1, keepdims=True)
    total = 0.0
    for a, b in zip(v, np.roll(v, -1, axis=0), strict=True):
        normal = np.cross(a, b)
        total += math.atan2(np.linalg.norm(normal), a @ b) * (normal / np.linalg.norm(normal)) @ n
    return abs(total) / 2.0


def test_irradiance_of_a_triangle_a_rectangle_and_a_mesh():
    n = unit(0.1, -0.2, 1.0)
    facing = triangle(CORNERS[::-1])
    assert irradiance(light(facing), ORIGIN, n) == pytest.approx(lambert(CORNERS, array(n)), rel=1e-11)
    assert irradiance(light(triangle(CORNERS)), ORIGIN, n) == 0.0  # it faces away
    down = matrix((1.0, 0.5, 1.0), (0.3, 0.4, 1.5), (0.2, 0.1, -1.0))
    square = [[-1, -1, 0, 1], [1, -1, 0, 1], [1, 1, 0, 1], [-1, 1, 0, 1]]
    corners = (np.array(square) @ down.T)[:, :3]
    lit = irradiance(light(rectangle(to_world=down)), ORIGIN, n)
    assert lit == pytest.approx(lambert(corners, array(n)), rel=1e-11)
    assert irradiance(light(rectangle(to_world=down, flip_normals=True)), ORIGIN, n) == 0.0


def test_irradiance_of_a_disk_of_a_sphere_and_inside_a_sphere():
    up = Vec3(0.0, 0.0, 1.0)
    disk = d.Disk(radiance=WHITE, to_world=matrix((0.5, 0.5, 1.0), (0.0, 0.0, 2.0), (0.0, 1e-9, -1.0)))
    assert irradiance(light(disk), ORIGIN, up) == pytest.approx(PI * 0.25 / (4.0 + 0.25), rel=1e-11)  # B19
    for distance in (1.001, 1.5, 20.0, 1e4):  # B04: E = pi (R / d)^2
        x = free_point(Vec3(0.0, 0.0, -distance))
        assert irradiance(ball(), x, up) == pytest.approx(PI / distance**2, rel=1e-11)


def test_a_sphere_around_a_point_fills_all_directions():
    x, inside = free_point(Vec3(0.1, 0.2, -0.2)), light(d.Sphere(radiance=WHITE, flip_normals=True))
    assert over_light(inside, x, lambda L: 1.0) == pytest.approx(4.0 * PI, rel=1e-11)
    assert over_light(inside, x, lambda L: L.x) == pytest.approx(0.0, abs=1e-11)


def test_irradiance_of_a_closed_cylinder_seen_from_its_axis():
    """From the centre of an end, inwards: all of the hemisphere but the disk at the other end, 1 / (1 + h^2)."""
    h = 1.5
    tube = d.Cylinder(radiance=WHITE, p1=np.array([0.0, 0.0, h]), flip_normals=True)
    E = irradiance(light(tube), ORIGIN, Vec3(0.0, 0.0, 1.0))
    assert pytest.approx(PI * (1.0 - 1.0 / (1.0 + h * h)), rel=1e-11) == E
    assert irradiance(light(d.Cylinder(radiance=WHITE, p1=np.array([0.0, 0.0, h]))), ORIGIN, Vec3(0, 0, 1)) == 0.0
