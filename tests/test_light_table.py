"""The table of lights: meshes, sides, all kinds in one kernel; from descriptions, of which some are refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import U53, array, same_bits, squares
from test_lights import CORNERS, HERE, ORIGIN, PI, SHAPES, TETRA, WHITE, light, rectangle, table, triangle

from raylab import description as d
from raylab import lights
from raylab.emitters import AreaLights, colour, point_table, sun_table
from raylab.errors import SceneError
from raylab.geometry import Placement
from raylab.jit import njit
from raylab.point import free_point
from raylab.vec3 import Vec3, black, dot

# --- meshes ---


def test_a_mesh_light_picks_triangles_in_proportion_to_their_area():
    """At n equally spaced u1, each triangle is found as often as its share says, give or take one."""
    second = d.Mesh(radiance=WHITE, vertices=TETRA.vertices + 10.0, faces=TETRA.faces[::-1])
    lamps = table(TETRA, second)
    faces = TETRA.vertices[TETRA.faces]
    n = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    areas = np.linalg.norm(n, axis=1) / 2.0
    normals = n / (2.0 * areas[:, None])
    steps = 500
    for lamp, offset in zip(lamps, (0.0, 10.0), strict=True):
        found = np.zeros(4)
        for k in range(steps):
            y, p = lamp.sample(ORIGIN, ((k + 0.5) / steps, 0.3))
            assert 2.0 <= y.p.z - offset <= 4.0
            found[np.argmax(normals @ array(y.n))] += 1
            assert p == pytest.approx(1.0 / areas.sum(), rel=16 * U53)
        assert np.all(np.abs(found - steps * areas / areas.sum()) <= 1.0)


def test_two_triangles_that_make_no_rectangle_are_a_mesh():
    bent = d.Mesh(radiance=WHITE, vertices=TETRA.vertices, faces=TETRA.faces[:2])
    assert light(bent).kind == lights.MESH
    assert light(triangle(CORNERS)).kind == lights.TRIANGLE
    assert light(rectangle()).kind == lights.RECTANGLE
    assert light(d.Cube(radiance=WHITE)).kind == lights.MESH


@pytest.mark.parametrize("flip", [False, True])
@pytest.mark.parametrize("mirror", [1.0, -1.0])
@pytest.mark.parametrize("kind", [d.Rectangle, d.Disk, d.Sphere, d.Cylinder, d.Cube])
def test_the_side_that_emits(kind, mirror, flip):
    """The normal is the local +z, or outwards, also in a mirror; flip_normals turns it."""
    shape = kind(radiance=WHITE, to_world=np.diag([mirror, 1.0, 1.0, 1.0]), flip_normals=flip)
    y, _ = light(shape).sample(free_point(Vec3(0.1, 0.2, 0.3)), (0.3, 0.6))
    away = {d.Rectangle: Vec3(0, 0, 1), d.Disk: Vec3(0, 0, 1), d.Cylinder: Vec3(y.p.x, y.p.y, 0)}.get(kind, y.p)
    assert dot(y.n, away) * (-1.0 if flip else 1.0) > 0.9


# --- all kinds in one kernel ---


@njit
def everything(lamps, x, u):
    total = black
    for lamp in lamps:
        y, p = lamp.sample(x, u)
        z, q = lamp.sample_solid_angle(x, u)
        total += z.p * lamp.pdf_solid_angle(x, y) + z.n * q
        total += lamp.radiance * p + y.p + y.n * (2.0 * y.slack) + Vec3(lamp.pdf(x, y), y.tilt.x, 0.0)
    return total


def test_a_kernel_gets_what_plain_python_gets():
    lamps = table(*SHAPES.values())
    plain = getattr(everything, "py_func", everything)
    for x in (ORIGIN, free_point(Vec3(1.0, -2.0, 3.5))):  # outside the sphere and inside
        for u in squares(10):
            assert same_bits([*everything(lamps, x, u)], [*plain(lamps, x, u)])


def test_no_lights():
    assert everything(AreaLights().table(), ORIGIN, (0.5, 0.5)) == black
    assert len(AreaLights().table()) == len(point_table([], HERE)) == len(sun_table([])) == 0


def test_kinds_that_a_scene_lacks_are_not_in_its_kernel():
    shapes = table(SHAPES["disk"])[0].shapes
    assert [type(s) is lights.Absent for s in shapes] == [True, True, False, True, True, True]
    assert not any(s.has(k) for s in shapes for k in range(6) if k != lights.DISK)


# --- from description to table ---


def test_point_and_directional_lights():
    half = Placement(np.array([1.0, 0.0, 0.0]), 0.5)
    (point,) = point_table([d.PointLight(np.array([3.0, 4.0, 0.0]), np.array([8.0, 4.0, 0.0]))], half)
    assert point.y.p == Vec3(1.0, 2.0, 0.0)
    assert Vec3(2.0, 1.0, 0.0) == point.I  # W/sr: irradiance I / r^2 is the same in both units
    (sun,) = sun_table([d.DirectionalLight(np.array([0.0, 3.0, -4.0]), np.array([1.0, 2.0, 3.0]))])
    assert [*sun.w] == pytest.approx([0.0, -0.6, 0.8], rel=4 * U53)  # towards the light
    assert Vec3(1.0, 2.0, 3.0) == sun.I


BAD = [
    (lambda: colour([1.0, -1.0, 0.0], "it"), "it must be finite and not negative"),
    (lambda: colour([1.0, math.nan, 0.0], "it"), "it must be finite"),
    (lambda: colour([1.0, 2.0], "it"), "it must be one number or an RGB triple"),
    (lambda: point_table([d.PointLight(np.array([0.0, math.inf, 0.0]), WHITE)], HERE), "position"),
    (lambda: point_table([d.PointLight(np.zeros(3), -WHITE)], HERE), "point light: intensity"),
    (lambda: sun_table([d.DirectionalLight(np.zeros(3), WHITE)]), "not zero"),
    (lambda: light(d.Sphere(name="egg", radiance=WHITE, to_world=np.diag([1.0, 2.0, 1.0, 1.0]))), "'egg'.*stretched"),
    (lambda: light(d.Sphere(name="egg", radiance=WHITE, to_world=np.diag([1.0, 1.0, 2.0, 1.0]))), "'egg'.*stretched"),
    (lambda: light(d.Cylinder(name="tin", radiance=WHITE, to_world=np.diag([1.0, 2.0, 1.0, 1.0]))), "'tin'.*stretched"),
    (lambda: light(d.Rectangle(name="lamp", radiance=-WHITE)), "'lamp'.*not negative"),
]  # fmt: skip


@pytest.mark.parametrize(("make", "message"), BAD)
def test_what_is_no_light_is_refused(make, message):
    with pytest.raises(SceneError, match=message):
        make()


def test_a_cylinder_may_be_stretched_along_its_axis():
    tall = light(d.Cylinder(radiance=WHITE, to_world=np.diag([2.0, 2.0, 5.0, 1.0])))
    assert tall.area == pytest.approx(2.0 * PI * 2.0 * 5.0, rel=16 * U53)
