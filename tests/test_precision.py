"""The precision policy: no false shadow, whatever the unit, the place and the shape of the triangles."""

from __future__ import annotations

import math

import numpy as np
import pytest

from raylab import description as d
from raylab.jit import njit
from raylab.point import plane_table, triangle_frame
from raylab.sampling import sample_cos_hemisphere, sample_triangle
from raylab.scene import Scene
from raylab.shadow import shadow, shadow_toward
from raylab.surface import SHADOW_RAYS, intersect, round32, triangle_hit
from raylab.vec3 import Vec3, vec3_at
from raylab.view import View

GREY = d.Diffuse(np.full(3, 0.5))


def rotation(angle: float) -> np.ndarray:
    """A rotation about an axis that no triangle is aligned with."""
    k = np.array([0.36, 0.48, 0.8])
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def placed(scale: float, offset: np.ndarray, angle: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3] = rotation(angle) * scale
    matrix[:3, 3] = offset
    return matrix


@njit
def leave_surface(scene, targets, directions, hits):
    """From points on each triangle, rays over the hemisphere: how many hit something."""
    for i in range(len(targets)):
        face = i % len(scene.faces)
        v0 = vec3_at(scene.vertices, scene.faces[face, 0])
        v1, v2 = vec3_at(scene.vertices, scene.faces[face, 1]), vec3_at(scene.vertices, scene.faces[face, 2])
        n, _, _ = triangle_frame(v0, v1, v2)
        b1, b2 = sample_triangle((targets[i, 0], targets[i, 1]))
        p = v0 + (v1 - v0) * b1 + (v2 - v0) * b2
        o = round32(p + n * 0.5)
        hit = triangle_hit(scene, 0, face, o, round32(p - o))
        w = sample_cos_hemisphere(hit.x.n, (directions[i, 0], directions[i, 1]))
        hits[0] += shadow_toward(scene, hit.x, w)


@pytest.mark.parametrize("aspect", [1.0, 1e-2, 2e-4])
@pytest.mark.parametrize(("scale", "offset"), [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e4), (1e-3, 1e6)])
def test_a_single_triangle_never_shadows_itself(aspect, scale, offset):
    """A02 to A06 of the extreme cases: nothing but the triangle is there, so every hit would be a false one."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0.3, aspect, 0]])
    matrix = placed(scale, np.array([1.0, 0.7, -0.4]) * offset, 0.7)
    scene = Scene(d.SceneDescription(shapes=(d.Mesh(vertices=corners, faces=np.array([[0, 1, 2]]), to_world=matrix),)))
    if offset == 1e6:  # the corners themselves are rounded to 1e-10 of 1e-3: still one triangle
        assert len(scene.data.faces) == 1
    rng = np.random.default_rng(11)
    n = 40_000
    u = rng.random((n, 2))
    u[:, 0] = 1.0 - 10.0 ** rng.uniform(-14, 0, n)  # cosines from 1e-7 to 1
    hits = View(np.zeros(1, np.int64))
    leave_surface(scene.data, View(rng.random((n, 2))), View(u), hits)
    assert hits[0] == 0
    assert scene.data.tally[SHADOW_RAYS] == n


@njit
def count_blocked(scene, points, u, blocked):
    """Shadow rays from points of shape 0 (faces 0, 1) to the light; `blocked` gets a 1 for each in shadow."""
    for i in range(len(points)):
        v0, v1, v3 = vec3_at(scene.vertices, 0), vec3_at(scene.vertices, 1), vec3_at(scene.vertices, 3)
        p = v0 + (v1 - v0) * points[i, 0] + (v3 - v0) * points[i, 1]
        n, _, _ = triangle_frame(v0, v1, v3)
        o = round32(p + n * 0.0625)
        hit = intersect(scene, o, round32(p - o), 0.0, math.inf)
        for light in scene.lights:
            y, _ = light.sample(hit.x, (u[i, 0], u[i, 1]))
            blocked[i] = 1 if shadow(scene, hit.x, y) else 0


def floor_and_light(matrix: np.ndarray, gap: float | None) -> Scene:
    """A floor, a light above it that faces down, and perhaps a shelf that hides all of the light, `gap` below it."""

    def at(z: float, size: float, down: bool) -> np.ndarray:
        local = np.diag([size, -size if down else size, -1.0 if down else 1.0, 1.0])
        local[2, 3] = z
        return matrix @ local

    shapes = [
        d.Rectangle(to_world=at(0.0, 1.0, False), front=GREY),
        d.Rectangle(to_world=at(1.0, 0.5, True), radiance=np.ones(3), front=None),
    ]
    if gap is not None:
        shapes.append(d.Rectangle(to_world=at(1.0 - gap, 2.0, True), front=GREY, back=GREY))
    return Scene(d.SceneDescription(shapes=tuple(shapes)))


VARIANTS = [
    (scale, offset, angle) for scale in (1e-6, 2.0**-10, 1.0, 1e6) for offset in (0.0, 1e3) for angle in (0.0, 0.7)
] + [(1.0, 1e9, 0.0)]  # fmt: skip


@pytest.mark.parametrize(("scale", "offset", "angle"), VARIANTS)
@pytest.mark.parametrize("gap", [None, 2.0**-12])
def test_shadow_rays_are_right_at_every_scale_and_place(scale, offset, angle, gap):
    """A04, A05, A08 to A11: all light arrives, or none of it when a plate 2^-12 below the light is in the way."""
    direction = np.array([1.0, 0.7, -0.4]) * offset * (scale if offset < 1e9 else 1.0)
    scene = floor_and_light(placed(scale, direction, angle), gap)
    rng = np.random.default_rng(13)
    n = 20_000
    blocked = View(np.zeros(n, np.int64))
    count_blocked(scene.data, View(rng.uniform(0.01, 0.99, (n, 2))), View(rng.random((n, 2))), blocked)
    assert blocked.array.sum() == (0 if gap is None else n)


def test_grazing_light_is_not_shadowed_by_itself():
    """A08: a light of size 1 at distance 3, seen at cosines down to 1e-3: both ends of the ray are kept off."""
    tilt = np.eye(4)
    tilt[:3, :3] = np.array([[0.0, 0, -1], [0, 1, 0], [1, 0, 0]])  # the light faces -x
    tilt[:3, :3] *= 0.5
    shapes = [d.Rectangle(front=GREY, to_world=np.diag([1e-3, 1e-3, 1.0, 1.0]))]
    for k, height in enumerate((3.0, 2.5, 2.0)):
        m = tilt.copy()
        m[:3, 3] = (1e-3 * (k + 2), 0.0, height)
        shapes.append(d.Rectangle(to_world=m, radiance=np.ones(3), front=None))
    for shape in shapes[1:]:  # one light at a time: the others would stand in the way
        scene = Scene(d.SceneDescription(shapes=(shapes[0], shape)))
        rng = np.random.default_rng(17)
        n = 20_000
        blocked = View(np.zeros(n, np.int64))
        count_blocked(scene.data, View(rng.uniform(0.4, 0.6, (n, 2))), View(rng.random((n, 2))), blocked)
        assert blocked.array.sum() == 0


def test_loader_and_kernel_agree_on_the_offset_terms():
    rng = np.random.default_rng(5)
    for corners in rng.normal(size=(50, 3, 3)):
        n, slack, tilt = triangle_frame(*(Vec3(*c) for c in corners))
        row = plane_table(corners[None])[0]
        n_array, slack_array, tilt_array = row[:3], row[4], row[5:]
        np.testing.assert_allclose(tuple(n), n_array, rtol=0, atol=8 * 2.0**-53 * np.abs(corners).max() ** 2 / 1e-3)
        assert slack == pytest.approx(slack_array, rel=1e-12)
        np.testing.assert_allclose(tuple(tilt), tilt_array, rtol=1e-12)


def test_offset_bound_covers_the_derived_one():
    """slack + tilt . |y - x| is never below 4 * 2^-24 (B + longest edge) as derived in docs/precision.md."""
    rng = np.random.default_rng(19)
    for _ in range(300):
        v = rng.uniform(-1, 1, (3, 3)) * 10.0 ** rng.uniform(-3, 0)
        v[2] = v[0] + (v[1] - v[0]) * rng.random() + (v[2] - v[0]) * 10.0 ** rng.uniform(-3, 0)
        y = rng.dirichlet([1, 1, 1]) @ v
        x = rng.uniform(-1, 1, 3)
        row = plane_table(v[None])[0]
        n, slack, tilt = row[:3], row[4], row[5:]
        r = np.abs(v - x).max(axis=0)
        edges = [v[1] - v[0], v[2] - v[1], v[0] - v[2]]
        c = np.max([np.roll(np.abs(e), -1) * np.roll(np.abs(f), -2) + np.roll(np.abs(e), -2) * np.roll(np.abs(f), -1)
                    for e in edges for f in edges if e is not f], axis=0)  # fmt: skip
        twice_area = np.linalg.norm(np.cross(edges[0], edges[1]))
        longest = max(np.linalg.norm(e) for e in edges)
        b = np.abs(n) @ (np.abs(y) + r + np.abs(y - x)) + r @ c / twice_area
        ours = slack + np.abs(n) @ np.abs(y) * 4 * 2.0**-24 + tilt @ np.abs(y - x)
        assert ours >= 4 * 2.0**-24 * (b + longest) * (1 - 1e-9)
