"""Pixel filters as densities, and pinhole rays against a camera in plain numpy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import ALPHA, U53, array, chi_square_p, eye_ray, same_bits, size, squares
from scipy.spatial.transform import Rotation
from scipy.special import erf

from raylab import camera
from raylab import description as d
from raylab.errors import SceneError
from raylab.geometry import Placement
from raylab.jit import njit
from raylab.sensor import make_camera as pinhole
from raylab.vec3 import Vec3

U24 = 2.0**-24  # rounding unit of float32
HERE = Placement(np.zeros(3), 1.0)
LAST = 1.0 - 2.0**-53


# --- filters ---


def box_cdf(x, radius):
    return (x / radius + 1.0) / 2.0


def tent_cdf(x, radius):
    s = x / radius
    return np.where(s < 0.0, (1.0 + s) ** 2 / 2.0, 1.0 - (1.0 - s) ** 2 / 2.0)


def gaussian_cdf(x, radius, stddev):
    """Of exp(-x^2 / 2 s^2) - exp(-r^2 / 2 s^2) in [-r, r], the difference that Mitsuba's filter has (gaussian.cpp)."""

    def integral(t):
        floor = math.exp(-(radius**2) / (2 * stddev**2))
        return stddev * math.sqrt(math.pi / 2) * erf(t / (stddev * math.sqrt(2))) - floor * t

    return (integral(x) + integral(radius)) / (2.0 * integral(radius))


FILTERS = {
    "box": (d.Filter("box", 0.5), lambda x: box_cdf(x, 0.5)),
    "wide box": (d.Filter("box", 1.25), lambda x: box_cdf(x, 1.25)),
    "tent": (d.Filter("tent", 1.0), lambda x: tent_cdf(x, 1.0)),
    "wide tent": (d.Filter("tent", 2.5), lambda x: tent_cdf(x, 2.5)),
    "gaussian": (d.Filter("gaussian", 2.0, 0.5), lambda x: gaussian_cdf(x, 2.0, 0.5)),
    "cut gaussian": (d.Filter("gaussian", 1.0, 0.8), lambda x: gaussian_cdf(x, 1.0, 0.8)),
}


def table_error(description, cdf, steps=4096):
    """Bound on |F(x(u)) - u|: a chord of F over a step of width h is off by h^2 max|f'| / 8; so is the finer grid."""
    if description.kind != "gaussian":
        return 8 * U53
    r, s = description.radius, description.stddev
    x = cdf_inverse(cdf, r, np.linspace(0.0, 1.0, steps + 1))
    far, near = np.maximum(np.abs(x[:-1]), np.abs(x[1:])), np.minimum(np.abs(x[:-1]), np.abs(x[1:]))
    mass = s * math.sqrt(2 * math.pi) * erf(r / (s * math.sqrt(2))) - 2.0 * r * math.exp(-(r**2) / (2 * s**2))
    steepest = far / s**2 * np.exp(-(near**2) / (2 * s**2)) / mass  # |f'| = |x| / s^2 exp(-x^2 / 2 s^2) / mass
    grid = 2.0 * r / (16 * steps)  # where the table is made: trapezoids, and chords between them
    return (steepest * np.diff(x) ** 2).max() / 8.0 + steepest.max() * grid**2 * (2.0 / 8.0 + 2.0 / 12.0) + 64 * U53


def cdf_inverse(cdf, radius, u):
    """By bisection."""
    low, high = np.full_like(u, -radius), np.full_like(u, radius)
    for _ in range(60):
        middle = (low + high) / 2.0
        below = cdf(middle) < u
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return (low + high) / 2.0


@pytest.mark.parametrize("name", FILTERS)
def test_filters_invert_their_distribution_function(name):
    description, cdf = FILTERS[name]
    made, error = camera.make_filter(description), table_error(description, cdf)
    for u in [*squares(200), (0.0, LAST), (LAST, 0.0), (0.5, 2.0**-53)]:
        x = np.array(made.sample(u))
        assert np.abs(x).max() <= description.radius
        assert np.abs(cdf(x) - np.array(u)).max() <= error


@pytest.mark.parametrize("name", FILTERS)
def test_filters_are_densities_and_symmetric(name):
    """Chi-square of positions in equal cells of the support; the table's own error is far below 1 / sqrt(n)."""
    description, cdf = FILTERS[name]
    made, n, side = camera.make_filter(description), size(20_000, 3_000), size(8, 4)
    x = np.array([made.sample(u) for u in squares(n, seed=1)])
    edges = np.linspace(-description.radius, description.radius, side + 1)
    share = np.diff(cdf(edges))
    assert share == pytest.approx(share[::-1], abs=1e-12)
    counts, *_ = np.histogram2d(*x.T, bins=(edges, edges))
    assert chi_square_p(counts, n * np.outer(share, share)) > ALPHA


def test_the_table_of_a_filter_is_read_linearly():
    table = camera.TableFilter(camera.View(np.array([-1.0, 0.0, 3.0])))
    assert table.sample((0.25, 0.75)) == (-0.5, 1.5)
    assert table.sample((0.0, 0.5)) == (-1.0, 0.0)
    assert table.sample((LAST, 1.0)) == (pytest.approx(3.0, abs=8 * U53), 3.0)


# --- rays ---


class Fixed:
    """A stream that gives one point."""

    def __init__(self, u):
        self.u = u

    def square(self):
        return self.u


def placed(offset=(0.0, 0.0, 0.0), turn=(0.3, -1.1, 0.7), scale=1.0):
    m = np.eye(4)
    m[:3, :3] = Rotation.from_rotvec(turn).as_matrix() * scale
    m[:3, 3] = offset
    return m


def numpy_ray(c, px, py):
    """Origin and direction of depth 1 through film position (px, py) pixels: +x is left, +y is up, +z ahead."""
    aspect = c.width / c.height
    tangent = math.tan(math.radians(c.fov) / 2)
    wide = {"x": True, "y": False, "smaller": aspect <= 1, "larger": aspect > 1}.get(c.fov_axis)
    if c.fov_axis == "diagonal":
        tan_y = tangent / math.hypot(aspect, 1.0)
        tan_x = tan_y * aspect
    else:
        tan_x, tan_y = (tangent, tangent / aspect) if wide else (tangent * aspect, tangent)
    u, v = px / c.width + c.principal_point_offset[0], py / c.height + c.principal_point_offset[1]
    axes = c.to_world[:3, :3] / np.linalg.norm(c.to_world[:3, :3], axis=0)
    return c.to_world[:3, 3], axes @ [tan_x * (1 - 2 * u), tan_y * (1 - 2 * v), 1.0]


CAMERAS = {
    "plain": d.Camera(),
    "turned": d.Camera(to_world=placed((0.1, -0.2, 0.3)), width=64, height=32, near_clip=0.0),
    "tall": d.Camera(to_world=placed(), width=30, height=50, fov=100.0, fov_axis="y"),
    "smaller wide": d.Camera(to_world=placed(), width=50, height=30, fov=70.0, fov_axis="smaller"),
    "smaller tall": d.Camera(to_world=placed(), width=30, height=50, fov=70.0, fov_axis="smaller"),
    "larger wide": d.Camera(to_world=placed(), width=50, height=30, fov=70.0, fov_axis="larger"),
    "larger tall": d.Camera(to_world=placed(), width=30, height=50, fov=70.0, fov_axis="larger"),
    "diagonal": d.Camera(to_world=placed(), width=50, height=30, fov=70.0, fov_axis="diagonal"),
    "shifted": d.Camera(to_world=placed(), width=50, height=30, principal_point_offset=(0.1, -0.25)),
    "scaled": d.Camera(to_world=placed(scale=7.0), width=16, height=16),
}
FILM = [(0, 0), (7, 3), (15, 15)]


@pytest.mark.parametrize("name", CAMERAS)
def test_rays_are_those_of_a_plain_camera(name):
    c = CAMERAS[name]
    eye = pinhole(c, HERE)
    for column, row in FILM:
        for u in ((0.5, 0.5), (0.0, 0.25)):  # box filter: the centre of the pixel, and a point on its left edge
            o, ray, far = eye_ray(eye, column, row, Fixed(u))
            start, want = numpy_ray(c, column + u[0], row + u[1])
            assert np.abs(array(ray) - want).max() <= 2 * U24 * np.abs(want).max()
            near = start + want * c.near_clip
            assert np.abs(array(o) - near).max() <= 2 * U24 * (np.abs(start).max() + c.near_clip)
            assert far == pytest.approx(c.far_clip - c.near_clip, rel=4 * U53)  # in units of the direction, of depth 1


def test_rays_hold_float32_numbers():
    o, ray, _ = eye_ray(pinhole(CAMERAS["turned"], HERE), 3, 5, Fixed((0.3, 0.7)))
    for v in (o, ray):
        assert same_bits([*v], np.float32([*v]).astype(float))


def test_the_field_of_view_spans_the_film():
    c = d.Camera(fov=90.0, width=100, height=50)
    eye = pinhole(c, HERE)
    _, left, _ = eye_ray(eye, 0, 0, Fixed((0.0, 0.0)))
    _, right, _ = eye_ray(eye, 99, 49, Fixed((LAST, LAST)))
    assert [*left] == pytest.approx([1.0, 0.5, 1.0], abs=U24)
    assert [*right] == pytest.approx([-1.0, -0.5, 1.0], abs=U24)


def test_rays_go_where_the_filter_says():
    c = d.Camera(filter=d.Filter("tent", 1.5), width=8, height=8)
    eye, (dx, dy) = pinhole(c, HERE), camera.make_filter(c.filter).sample((0.1, 0.8))
    _, ray, _ = eye_ray(eye, 2, 5, Fixed((0.1, 0.8)))
    assert np.abs(array(ray) - numpy_ray(c, 2.5 + dx, 5.5 + dy)[1]).max() <= 2 * U24


def test_a_camera_is_placed_with_its_scene():
    """Twice as near in a scene drawn to half its size: directions stay, distances scale."""
    half = Placement(np.array([1.0, 2.0, 3.0]), 0.5)
    c = d.Camera(to_world=placed((2.0, 2.0, 2.0)), near_clip=0.25, far_clip=80.0)
    eye, same = pinhole(c, half), pinhole(c, HERE)
    assert [*eye.origin] == [0.5, 0.0, -0.5]
    assert (eye.start, eye.far) == (0.125, 40.0)
    assert eye.corner == same.corner


@pytest.mark.parametrize("distance", [3.0, 1e3, 1e6])
def test_a_far_camera_meets_the_same_points(distance):
    """All content lies within [-1, 1]; the ray may start where it gets there, so that float32 resolves it."""
    eye_at = np.array([0.6, -0.48, 0.64]) * distance
    matrix = np.eye(4)
    ahead = -eye_at / distance
    left = np.cross([0.0, 1.0, 0.0], ahead)
    left /= np.linalg.norm(left)
    matrix[:3] = np.stack([left, np.cross(ahead, left), ahead, eye_at], axis=1)
    c = d.Camera(to_world=matrix, fov=math.degrees(2 * math.atan(1.5 / distance)), width=64, height=64, far_clip=1e9)
    eye = pinhole(c, HERE)
    for column, row in ((0, 0), (31, 31), (40, 13), (63, 20)):
        o, ray, far = eye_ray(eye, column, row, Fixed((0.5, 0.5)))
        start, want = numpy_ray(c, column + 0.5, row + 0.5)
        nearest = start + want * (-(start @ want) / (want @ want))  # of the true ray to the centre
        t = (nearest - array(o)) @ array(ray) / (array(ray) @ array(ray))
        assert 0.0 < t < far
        assert np.linalg.norm(array(o)) > math.sqrt(3.0) - 8 * U24  # outside the box that holds everything
        path = np.linalg.norm(array(o)) + t * np.linalg.norm([*ray])
        assert np.linalg.norm(array(o) + t * array(ray) - nearest) <= 2 * U24 * path + 8 * U53 * distance
        assert far + np.linalg.norm(array(o) - start) / np.linalg.norm(want) == pytest.approx(1e9, rel=1e-6)
    if distance > 100:
        assert np.linalg.norm(array(o)) < 4.0


@pytest.mark.parametrize("sheared", [False, True])
@pytest.mark.parametrize("distance", [0.5, 2.5, 100.0])
def test_eye_rays_begin_before_all_content(distance, sheared):
    """Points of the box that holds everything have at least the depth at which rays begin, wherever the eye looks."""
    rng = np.random.default_rng(1)
    content = np.concatenate([rng.uniform(-1.0, 1.0, (200, 3)), 2.0 * np.indices((2, 2, 2)).reshape(3, -1).T - 1.0])
    for _ in range(50):
        axes = Rotation.random(random_state=rng).as_matrix().T
        if sheared:
            axes[2] += 0.6 * axes[0]
            axes /= np.linalg.norm(axes, axis=1, keepdims=True)
        origin = distance * Rotation.random(random_state=rng).as_matrix()[0]
        begin = camera.first_depth(0.25, *(Vec3(*v) for v in (origin, *axes)))
        depth = (content - origin) @ np.linalg.inv(axes)[:, 2]  # p = origin + x left + y up + depth forward
        assert begin >= 0.25
        assert begin == 0.25 or begin <= depth.min()
        assert distance < 50.0 or begin == 0.25 or depth.min() - begin < 4.0


def test_a_far_plane_before_the_content_is_kept():
    c = d.Camera(to_world=placed((0.0, 0.0, 100.0), (0.0, math.pi, 0.0)), far_clip=50.0)
    _, _, far = eye_ray(pinhole(c, HERE), 128, 128, Fixed((0.5, 0.5)))
    assert 0.0 < far < 1e-20


@njit
def ray_of(eye, column, row, source):
    film, lens = eye.draw(source)
    return eye.ray(column, row, film, lens, 0.0)


@pytest.mark.parametrize("kind", ["box", "tent", "gaussian"])
def test_a_kernel_gets_what_plain_python_gets(kind):
    from raylab.samplers import make

    eye = pinhole(d.Camera(to_world=placed((9.0, 8.0, 7.0)), filter=d.Filter(kind, 2.0, 0.5)), HERE)
    sampler = make("independent", 1, 4)
    for pixel in range(5):
        compiled = ray_of(eye, pixel, 3, sampler.stream(pixel, 0, 0))
        plain = eye_ray(eye, pixel, 3, sampler.stream(pixel, 0, 0))
        assert same_bits([*compiled[0], *compiled[1], compiled[2]], [*plain[0], *plain[1], plain[2]])


BAD = [
    (d.Camera(width=0), "at least one pixel, got 0 x 256"),
    (d.Camera(fov=180.0), "fov must be between 0 and 180 degrees, got 180"),
    (d.Camera(fov=0.0), "fov"),
    (d.Camera(near_clip=-1.0), "near_clip"),
    (d.Camera(near_clip=2.0, far_clip=1.0), "near_clip < far_clip"),
    (d.Camera(to_world=np.zeros((4, 4))), "invertible"),
    (d.Camera(to_world=np.full((4, 4), np.nan)), "finite"),
    (d.Camera(filter=d.Filter("box", 0.0)), "positive radius"),
]


@pytest.mark.parametrize(("bad", "message"), BAD)
def test_a_camera_that_sees_nothing_is_refused(bad, message):
    with pytest.raises(SceneError, match=message):
        pinhole(bad, HERE)


def test_origin_and_direction_are_vectors():
    o, ray, far = eye_ray(pinhole(d.Camera(), HERE), 0, 0, Fixed((0.5, 0.5)))
    assert (type(o), type(ray), type(far)) == (Vec3, Vec3, float)
