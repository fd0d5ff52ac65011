"""Slides "Motion blur": time in rays and shadows, and pictures whose blur has a closed form."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers import ALPHA, array, same_bits
from scenes import GREY, animation, camera, dance, look_at, moved, room, shutter, turned
from scipy import integrate, stats

from raylab import description as d
from raylab import keyframes
from raylab.closed_forms import blur
from raylab.errors import SceneError
from raylab.jit import njit
from raylab.motion import Moving, Static, own_copy
from raylab.render import render
from raylab.sampling import sample_cos_hemisphere, sample_triangle
from raylab.scene import Scene
from raylab.shadow import shadow_toward
from raylab.surface import intersect, round32, triangle_hit
from raylab.vec3 import Vec3
from raylab.view import View

U24 = 2.0**-24
DAY = (0.0, 1.0)  # the shutter


# --- what moves, at any time ---


def path_scene(motion, shape, **more):
    """A scene of one moving shape, and a static floor below."""
    floor = d.Rectangle(to_world=moved(0, 0, -2, 3, 3, 1), front=GREY)
    return Scene(d.SceneDescription(camera=shutter(camera(4)), shapes=(floor, replace(shape, motion=motion)), **more))


@njit
def hit_at(scene, time, o, w):
    scene.motion.set(time)
    return intersect(scene, o, w, 0.0, math.inf)


CORNERS = np.array([[0.9, -0.1, 0.0], [1.1, -0.1, 0], [1.0, 0.2, 0]])
TRIANGLE = d.Mesh(vertices=CORNERS, faces=np.array([[0, 1, 2]]), front=GREY, back=GREY)


def test_a_rotating_mesh_is_where_its_closed_form_says():
    """A triangle goes round the axis; rays straight down meet it within the stated bound, at any time."""
    scene = path_scene(animation(turned(0), turned(160)), TRIANGLE)
    p = scene.placement
    assert 0.0 < scene.motion_error <= keyframes.TOLERANCE * 2.3
    inner = scene.motion_error * 1.5 / 0.05  # of the triangle, in units of its smallest height, stay within it
    assert inner < 0.1
    for t in np.float32([0.0, 0.123, 0.5, 0.777, 1.0]):
        rotation = turned(160 * float(t))[:3, :3]
        for b in ([0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.2, 0.2, 0.6]):
            x = p.points(rotation @ (np.array(b) @ CORNERS))
            hit = hit_at(scene.data, float(t), round32(Vec3(x[0], x[1], 0.75)), Vec3(0.0, 0.0, -1.0))
            assert hit.found
            assert hit.shape == 1
            assert abs(hit.x.p.z - p.points([0, 0, 0.0])[2]) <= 4 * U24
        for b in ([1.2, -0.1, -0.1], [-0.1, 1.2, -0.1], [-0.1, -0.1, 1.2]):
            x = p.points(rotation @ (np.array(b) @ CORNERS))
            assert hit_at(scene.data, float(t), round32(Vec3(x[0], x[1], 0.75)), Vec3(0.0, 0.0, -1.0)).shape == 0


@pytest.mark.parametrize(("shape", "middle"), [
    (d.Sphere(center=np.array([1.0, 0, 0]), radius=0.25, front=GREY), [1.0, 0, 0]),
    (d.Disk(front=GREY), [0.0, 0, 0]),
    (d.Cylinder(p0=np.array([1.0, 0, 0]), p1=np.array([1.0, 0, 1.0]), radius=0.2, front=GREY, back=GREY), [1.0, 0, 0]),
])  # fmt: skip
def test_a_rotating_quadric_is_exact(shape, middle):
    """The hit lies on the quadric of that very time, to float32 of the ray; Embree's boxes never miss it."""
    motion = animation(
        turned(0, (0.6, 0, 0.8), (0, 0, 1)), turned(170, (0.6, 0, 0.8), (0.5, 0, 1)), turned(40, (0, 1, 0))
    )
    scene, rng = path_scene(motion, shape), np.random.default_rng(8)
    p, found, eye = scene.placement, 0, np.array([0.2, -2.5, 2.5])
    for t in np.float32(rng.random(20)):
        matrix = keyframes.matrix_at(motion, float(t))
        still = Scene(replace(scene.description, camera=camera(4), shapes=(
            scene.description.shapes[0], replace(shape, motion=None, to_world=matrix))))  # fmt: skip
        s = still.placement
        for local in middle + rng.normal(0, 0.1, (3, 3)):
            target = matrix[:3, :3] @ local + matrix[:3, 3]
            o, w = round32(Vec3(*p.points(eye))), round32(Vec3(*(p.points(target) - p.points(eye))))
            hit = hit_at(scene.data, float(t), o, w)
            world_o = array(o) / p.scale + p.centre
            other = intersect(
                still.data, round32(Vec3(*s.points(world_o))), round32(Vec3(*(array(w) / p.scale * s.scale))),
                0.0, math.inf,
            )  # fmt: skip
            assert hit.found == other.found
            assert hit.shape == other.shape
            found += hit.shape == 1
            if hit.shape == 1 and abs(np.dot(array(hit.N), array(w))) > 0.1 * np.linalg.norm(array(w)):
                where = array(hit.x.p) / p.scale + p.centre
                assert np.abs(where - (array(other.x.p) / s.scale + s.centre)).max() <= 1e3 * U24
    assert found > 20


# --- the frozen shutter ---


def test_what_stands_still_while_the_shutter_is_open_is_static():
    scene = Scene(dance(shutter_open=2.0, shutter_close=3.0))
    assert isinstance(scene.data.motion, Static)
    assert isinstance(Scene(dance(shutter_open=0.9, shutter_close=3.0)).data.motion, Moving)


# --- case C2: a moving edge ---


def test_closed_forms_of_motion():
    """Case C2 and another by quadrature over time; C3 by quadrature over the height."""
    assert blur.moving_edge(-0.5, 2.0, (0.0, 1.0)) == 0.5
    share, _ = integrate.quad(lambda t: min(max(-0.3 + 1.7 * t, 0), 1), 0, 1, points=[0.3 / 1.7, 1.3 / 1.7])
    assert blur.moving_edge(-0.3, 1.7, (0.0, 1.0)) == pytest.approx(share, abs=1e-9)
    disk, _ = integrate.quad(lambda h: math.pi * 1.5**2 / (1.5**2 + h * h) / 2, 1, 3)
    assert math.pi * blur.moving_disk_light(1.5, 1.0, 3.0) == pytest.approx(disk, rel=1e-12)
    assert math.pi * blur.moving_disk_light(1.5, 1.0, 3.0) == pytest.approx(1.22320921399, abs=5e-12)


def edge(first, speed, width, moving_eye=False, depth=10.0, rows=1024):
    """One column of pixels, `width` wide at the depth of a shining half-plane x < first + speed t: all the same."""
    fov = math.degrees(2 * math.atan(width / 2 / depth))
    plane = d.Rectangle(to_world=moved(first - 50, 0, depth, -50, 2000, -1), radiance=np.ones(3), front=None)
    eye = d.Camera(fov=fov, width=1, height=rows)
    if moving_eye:
        eye = replace(eye, motion=animation(np.eye(4), moved(-speed, 0, 0)))
    else:
        plane = replace(plane, motion=animation(plane.to_world, moved(first + speed - 50, 0, depth, -50, 2000, -1)))
    return Scene(d.SceneDescription(camera=shutter(eye), shapes=(plane,)))


def mean_and_variance(scene, sampler, n, seed):
    """Of the pixels of one column, each the mean of n samples (of each of two streams)."""
    streams = 1 if sampler == "independent" else 2
    pixels = render(scene, sampler=sampler, spp=n * streams, seed=seed).mean[..., 0].ravel()
    return pixels, streams


@pytest.mark.parametrize("sampler", ["independent", "stratified", "sobol"])
def test_a_moving_edge_covers_a_pixel_as_the_formula_says(sampler):
    """Pixels with a width, and pixels like points, whose variance is known: F (1 - F) / N, N^-2 for strata of time.

    Only the stratum in which the edge passes counts: p (1 - p) / N^2. Family error 1e-6.
    """
    want = blur.moving_edge(-0.3, 1.7, (0.0, 1.0))
    pixels, _ = mean_and_variance(edge(-0.3 - 0.5, 1.7, 1.0), sampler, 64, 5)
    assert abs(pixels.mean() - want) < stats.norm.isf(ALPHA / 16) * stats.sem(pixels)
    scene, covered = edge(-0.6, 2.0, 1e-9), 0.7  # the edge passes at t = 0.3
    for n in (16, 256):
        pixels, streams = mean_and_variance(scene, sampler, n, 6)
        assert abs(pixels.mean() - covered) < stats.norm.isf(ALPHA / 16) * stats.sem(pixels) + 4 * U24
        p = (covered * n) % 1.0
        theory = covered * (1 - covered) / n if sampler == "independent" else p * (1 - p) / n**2
        ratio = ((pixels - covered) ** 2).sum() * streams / theory
        low, high = stats.chi2.ppf([ALPHA / 16, 1 - ALPHA / 16], len(pixels))
        if sampler != "sobol" or n == 16:  # a Sobol' dimension is stratified too
            assert low < ratio < high, (sampler, n)


def test_a_moving_camera_blurs_like_a_moving_world():
    scene = edge(-0.3 - 0.5, 1.7, 1.0, moving_eye=True)
    assert isinstance(scene.data.motion, Moving)
    want = blur.moving_edge(-0.3, 1.7, (0.0, 1.0))
    pixels, _ = mean_and_variance(scene, "independent", 64, 7)
    assert abs(pixels.mean() - want) < stats.norm.isf(ALPHA) * math.sqrt(want * (1 - want) / 64 / len(pixels))


# --- case C3: lights that move ---


def receiver(*lights, size=16):
    """A small white square at the origin, facing +z, seen from the side."""
    square = d.Rectangle(to_world=moved(0, 0, 0, 1e-3, 1e-3, 1), front=d.Diffuse(np.ones(3)))
    eye = d.Camera(to_world=look_at((0.4, 0, 0.3), (0, 0, 0), (0, 1, 0)), fov=1e-5, width=size, height=size)
    return Scene(d.SceneDescription(camera=shutter(eye), shapes=(square, *lights)))


def test_a_rising_disk_light_gives_case_c3():
    def disk(h):
        return moved(0, 0, h, 1.5, -1.5, -1)

    light = d.Disk(motion=animation(disk(1.0), disk(3.0)), radiance=np.ones(3), front=None)
    image = render(receiver(light), "area", sampler="independent", spp=512, seed=9)
    want = blur.moving_disk_light(1.5, 1.0, 3.0)  # E / pi
    error = math.hypot(image.image_standard_error[0], 0.0)
    assert abs(image.image_mean[0] - want) < stats.norm.isf(ALPHA) * error
    assert error < 0.002 * want


def test_moving_lights_of_every_kind_light_as_they_stand():
    """A square, a triangle, a cube, a sphere, a disk and a cylinder move and turn at once; each alone hides nothing.

    Against the same lights standing at the 16 nodes of a Gauss rule in time, sampled by the same estimator.
    """

    def lights(t=None):
        box = {"radiance": np.ones(3), "front": None}
        triangle = np.array([[-0.5, -0.5, 0.0], [0.5, -0.5, 0], [0, 0.6, 0]])
        kinds = [
            d.Rectangle(**box),
            d.Mesh(vertices=triangle, faces=np.array([[0, 1, 2]]), **box),
            d.Cube(**box),
            d.Sphere(**box),
            d.Disk(**box),
            d.Cylinder(**box),
        ]
        made = []
        for k, shape in enumerate(kinds):
            turn = np.array([math.cos(k * math.pi / 3), math.sin(k * math.pi / 3)])
            keys = [turned(180 + a, (turn[1], -turn[0], 0), (*(2.2 * turn * (1 + b)), 1.6 + b), (0.4,) * 3)
                    for a, b in ((20.0, 0.0), (60.0, 0.4))]  # fmt: skip
            motion = animation(*keys)
            made.append(
                replace(shape, motion=motion) if t is None else replace(shape, to_world=keyframes.matrix_at(motion, t))
            )
        return made

    image = render(receiver(*lights()), "area", sampler="sobol", spp=512, seed=9)
    nodes, weights = np.polynomial.legendre.leggauss(5)
    still = [
        render(receiver(*lights(0.5 + 0.5 * x)), "area", sampler="sobol", spp=64, seed=k) for k, x in enumerate(nodes)
    ]
    want = sum(w / 2 * s.image_mean[0] for w, s in zip(weights, still, strict=True))
    error = math.sqrt(
        image.image_standard_error[0] ** 2
        + sum((w / 2 * s.image_standard_error[0]) ** 2 for w, s in zip(weights, still, strict=True))
    )
    assert abs(image.image_mean[0] - want) < stats.norm.isf(ALPHA) * error + 1e-5 * want
    assert error < 0.002 * want


# --- shadows ---


@njit
def leave_moving_surface(scene, targets, directions, times, hits):
    """From points on a moving triangle, rays over the hemisphere: how many hit something."""
    for i in range(len(targets)):
        scene.motion.set(times[i])
        motion, vertices = scene.motion, scene.vertices
        v0, v1, v2 = motion.vertex(vertices, 0, 0), motion.vertex(vertices, 0, 1), motion.vertex(vertices, 0, 2)
        b1, b2 = sample_triangle((targets[i, 0], targets[i, 1]))
        p = v0 + (v1 - v0) * b1 + (v2 - v0) * b2
        o = round32(Vec3(p.x + 0.1, p.y + 0.2, p.z + 0.5))
        hit = triangle_hit(scene, 0, 0, o, round32(p - o))
        w = sample_cos_hemisphere(hit.x.n, (directions[i, 0], directions[i, 1]))
        hits[0] += shadow_toward(scene, hit.x, w)


@pytest.mark.parametrize("aspect", [1.0, 1e-2])
@pytest.mark.parametrize("scale", [1.0, 1e6])
def test_a_moving_triangle_never_shadows_itself(aspect, scale):
    """The offset bound holds with Embree's own interpolation in float32; nothing else is there to be hit."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0.3, aspect, 0]])
    keys = [
        turned(10, (0.6, 0, 0.8), (0, 0, 0), (scale,) * 3),
        turned(130, (0, 0.6, 0.8), (2 * scale, 0.7 * scale, 0), (scale,) * 3),
    ]
    shape = d.Mesh(vertices=corners, faces=np.array([[0, 1, 2]]), motion=animation(*keys), front=GREY, back=GREY)
    scene = Scene(d.SceneDescription(camera=shutter(d.Camera()), shapes=(shape,)))
    rng, n = np.random.default_rng(11), 40_000
    u = rng.random((n, 2))
    u[:, 0] = 1.0 - 10.0 ** rng.uniform(-14, 0, n)
    times = np.float32(rng.random(n)).astype(float)
    hits = View(np.zeros(1, np.int64))
    leave_moving_surface(scene.data, View(rng.random((n, 2))), View(u), View(times), hits)
    assert hits[0] == 0


def test_shadows_are_those_of_the_instant():
    """A plate crosses the light: half of the time the floor is dark, whatever the time of the eye ray's own surface."""
    plate = d.Rectangle(
        motion=animation(moved(-1.0, 0, 0.5, 1, 1, 1), moved(1.0, 0, 0.5, 1, 1, 1)), front=GREY, back=GREY
    )
    light = d.Rectangle(to_world=moved(0, 0, 1, 1e-4, -1e-4, -1), radiance=np.full(3, 1e8), front=None)
    dark = d.Rectangle(
        motion=animation(moved(-2.0, 0, 0.5, 1, 1, 1), moved(2.0, 0, 0.5, 1, 1, 1)), front=GREY, back=GREY
    )
    bright = render(receiver(light, size=8), "area", sampler="independent", spp=64).image_mean[0]
    assert render(receiver(light, plate, size=8), "area", sampler="independent", spp=64).image_mean[0] == 0.0
    image = render(receiver(light, dark, size=8), "area", sampler="independent", spp=512)
    want, n = 0.5 * bright, 512 * 64
    assert abs(image.image_mean[0] - want) < stats.norm.isf(ALPHA) * bright * 0.5 / math.sqrt(n) + 1e-6 * bright


def test_each_thread_has_its_own_clock_and_lights():
    scene = Scene(dance(shutter_open=0.0, shutter_close=1.0))
    data = own_copy(scene.data)
    data.motion.set(0.75)
    assert scene.data.motion.time() == 0.0
    assert data.quadrics.table.store is data.motion.clock
    assert not same_bits(data.lights.rows.array.ravel(), scene.data.lights.rows.array.ravel())
    still = room(4).data
    assert isinstance(still.motion, Static)
    assert own_copy(still) is still


BAD = [
    (animation(np.eye(4)), "two keyframes or more, got 1"),
    (animation(np.eye(4), np.eye(4), times=[1, 0]), "must be finite and increase"),
    (animation(np.eye(4), np.eye(4), times=[1, 1]), "must be finite and increase"),
    (animation(np.eye(4), np.eye(4), times=[0, np.nan]), "must be finite and increase"),
    (animation(np.eye(4), np.diag([1.0, 1, 0, 1])), "time 1 squeezes space flat"),
    (animation(np.eye(4), np.full((4, 4), np.nan)), "time 1 must be finite"),
    (animation(np.eye(4), np.diag([1.0, 1, -1, 1])), "inside out"),
]


@pytest.mark.parametrize(("motion", "message"), BAD)
def test_keyframes_that_make_no_sense_are_refused(motion, message):
    with pytest.raises(SceneError, match=message):
        path_scene(motion, TRIANGLE)


@pytest.mark.parametrize("interval", [(1.0, 0.0), (0.0, math.nan), (-math.inf, 0.0)])
def test_a_shutter_that_closes_before_it_opens_is_refused(interval):
    with pytest.raises(SceneError, match="shutter_open <= shutter_close"):
        Scene(dance(shutter_open=interval[0], shutter_close=interval[1]))
