"""Slide "Basic ray tracing": mirrors, glass and hard shadows, one ray through the centre of each pixel.

Nothing is random, so pictures are compared with the closed forms pixel by pixel. What is left is the rounding of
Embree's rays to float32: a direction off by 2^-24 in each of the few bounces.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import size
from scenes import camera, look_at, moved

from raylab import description as d
from raylab.errors import SceneError, UserError
from raylab.render import render
from raylab.scene import Scene

RAY = 64 * 2.0**-24  # rounded directions, some bounces, curved glass that spreads them


def picture(*shapes, lights=(), environment=None, cam, max_depth=10, shade="basic"):
    """(h, w, 3) through the pixels' centres."""
    described = d.SceneDescription(
        camera=cam, shapes=shapes, lights=lights, environment=environment, max_depth=max_depth, sampler="centre"
    )
    return render(Scene(described), shade, threads=1).mean


def eye(origin, target, width, fov=60.0):
    return d.Camera(to_world=look_at(origin, target), fov=fov, width=width, height=width)


def directions(cam):
    """(h, w, 3): unit directions through the centres of the pixels, by hand."""
    n, t = cam.width, math.tan(math.radians(cam.fov) / 2)
    x = t * (1.0 - 2.0 * (np.arange(n) + 0.5) / n)
    left, up, forward = (cam.to_world[:3, k] for k in range(3))
    w = forward + x[None, :, None] * left + x[:, None, None] * up
    return w / np.linalg.norm(w, axis=-1, keepdims=True)


def sky(w):
    """A gradient that tells directions and colours apart."""
    return SKY.radiance + w @ SKY.gradient.T


SKY = d.GradientEnvironment(np.array([1.0, 1.2, 0.9]), np.diag([0.6, 0.5, 0.4]))


# --- Fresnel and Snell once more, by numpy in the textbook's form ---


def boundary(c, eta):
    """R and cos(theta_t) for an array of cosines."""
    t = np.sqrt(np.maximum(0.0, 1.0 - (1.0 - c * c) / eta**2))
    r_s, r_p = (c - eta * t) / (c + eta * t), (eta * c - t) / (eta * c + t)
    return np.where(1.0 - (1.0 - c * c) / eta**2 <= 0.0, 1.0, (r_s**2 + r_p**2) / 2), t


def reflected(w, n):
    return w - 2.0 * (w * n).sum(-1, keepdims=True) * n


def refracted(w, n, eta):
    """w arrives at the side of n; eta = n_t / n_i."""
    c = -(w * n).sum(-1, keepdims=True)
    _, t = boundary(c, eta)
    return w / eta + (c / eta - t) * n


# --- mirrors ---


@pytest.mark.parametrize("max_depth", [1, 2, 4, 12])
def test_mirror_corridor(max_depth):
    """Between two mirrors of reflectance r a ray that is mirrored k times brings r^k L, or nothing when it is cut.

    Unfolded, the ray goes straight, through planes x = 0, 1, 2, ... of length 1 < z < 11. A path of k mirrors has
    k + 1 rays.
    """
    r = np.array([0.9, 0.8, 0.5])
    mirror = d.Conductor(specular_reflectance=r)
    turn = np.array([[0.0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]])  # normal z to x
    walls = [
        d.Rectangle(to_world=moved(x, 0, 6) @ turn @ np.diag([5.0, 1000, 1, 1]), front=mirror, back=mirror)
        for x in (0.0, 1.0)
    ]
    to_world = look_at((0.437, 0, 0), (0.437, 0, 1), up=(0, 1, 0))
    cam = d.Camera(to_world=to_world, fov=80.0, width=size(24, 8), height=1)
    image = picture(*walls, environment=d.ConstantEnvironment(np.ones(3)), cam=cam, max_depth=max_depth)
    n = cam.width
    left, forward = cam.to_world[:3, 0], cam.to_world[:3, 2]
    for column in range(n):
        w = forward + math.tan(math.radians(40)) * (1 - 2 * (column + 0.5) / n) * left
        planes = np.arange(-100, 101)
        z = (planes - 0.437) / w[0] * w[2]
        first = z[z > 0].min()
        k = int(((z > 1) & (z < 11)).sum()) if first > 1.0 else 0
        assert np.abs(z[z > 0][:, None] - [1, 11]).min() > 1e-4  # no ray near an edge
        expected = r**k if k + 1 <= max_depth else np.zeros(3)
        assert image[0, column] == pytest.approx(expected, rel=1e-12), (column, k)


def test_a_ray_is_mirrored_as_by_hand():
    """A tilted mirror under a gradient sky: L(2 (n . v) n - v) times the reflectance of gold at that angle."""
    eta, k = np.array([0.2, 0.4, 1.3]), np.array([3.9, 2.4, 1.9])
    to_world = moved(0, 0, 0, 50, 50, 50) @ np.array(
        [[1, 0, 0, 0], [0, 0.8, -0.6, 0], [0, 0.6, 0.8, 0], [0, 0, 0, 1.0]]
    )
    cam = eye((0.3, 0.2, 3.0), (0.0, 0.0, 0.0), size(16, 4), fov=30.0)
    image = picture(d.Rectangle(to_world=to_world, front=d.Conductor(eta, k)), environment=SKY, cam=cam)
    w, n = directions(cam), np.array([0.0, -0.6, 0.8])
    c = -(w @ n)[..., None]
    index = eta + 1j * k
    t = np.sqrt(1 - (1 - c * c) / index**2)
    r_s, r_p = (c - index * t) / (c + index * t), (index * c - t) / (index * c + t)
    R = (np.abs(r_s) ** 2 + np.abs(r_p) ** 2) / 2
    np.testing.assert_allclose(image, R * sky(reflected(w, n)), rtol=RAY)


# --- glass ---


@pytest.mark.parametrize("max_depth", [2, 3, 4, 5, 10])
def test_glass_slab(max_depth):
    """A red light behind a slab and a green one beside the eye: T^2 sum R^2j and R + T^2 R sum R^2j, cut at max_depth.

    The ray that passes 2 j times more through the slab has 3 + 2 j rays, or 4 + 2 j when it comes back; the factors
    1 / eta^2 of the two boundaries cancel.
    """
    glass = d.Dielectric(1.6, 1.0)

    def plane(z, sign, **what):
        return d.Rectangle(to_world=moved(0, 0, z, 300, sign * 300, sign), **what)

    shapes = (
        plane(0.1, 1, front=glass, back=glass.inside),
        plane(-0.1, -1, front=glass, back=glass.inside),
        plane(-3.0, 1, front=None, radiance=np.array([2.0, 0.0, 0.0])),
        plane(3.0, -1, front=None, radiance=np.array([0.0, 3.0, 0.0])),
    )
    cam = eye((0.0, -2.0, 2.0), (0.0, 0.0, 0.0), size(12, 3), fov=50.0)
    image = picture(*shapes, cam=cam, max_depth=max_depth)
    R, _ = boundary(-directions(cam)[..., 2], 1.6)
    T = 1.0 - R
    through = sum((T**2 * R ** (2 * j) for j in range((max_depth - 3) // 2 + 1)), np.zeros_like(R))
    back = sum((T**2 * R ** (2 * j + 1) for j in range((max_depth - 4) // 2 + 1)), R)
    np.testing.assert_allclose(image[..., 0], 2.0 * through, rtol=RAY, atol=1e-12)
    np.testing.assert_allclose(image[..., 1], 3.0 * back, rtol=RAY, atol=1e-12)
    assert np.all(image[..., 2] == 0.0)
    if max_depth == 10:  # both series are (1 - R)^2 / (1 - R^2) and 1 minus that, but for what was cut off
        assert np.abs(image[..., 0] / 2 - (1 - R) ** 2 / (1 - R**2)).max() < (R**8).max()


def test_a_lamp_shines_on_one_side_only_behind_glass_too():
    glass = d.Dielectric(1.6, 1.0)
    slab = d.Rectangle(to_world=moved(0, 0, 0, 300, 300, 1), front=glass, back=glass.inside)
    for side in (-1, 1):
        lamp = d.Rectangle(to_world=moved(0, 0, -3, 300, side * 300, side), front=None, radiance=np.ones(3))
        image = picture(slab, lamp, cam=eye((0.0, -2.0, 2.0), (0.0, 0.0, 0.0), 2))
        assert np.all(image > 0.1) if side == 1 else np.all(image == 0.0)


def ball_light(w, n, eta, max_depth, light):
    """Radiance against w from a glass ball hit at normal n: every meeting with the surface has the same angles.

    R light(w_r) + sum_k T^2 R^k light(w_k): in the plane of incidence the ray turns by 2 theta_t at each bounce.
    A path that is mirrored k times inside has k + 3 rays.
    """
    c = -(w * n).sum(-1, keepdims=True)
    R, _ = boundary(c, eta)
    total = R * light(reflected(w, n)) if max_depth >= 2 else 0.0 * R
    inside, at = refracted(w, n, eta), n
    for k in range(max_depth - 2):
        at = at - 2.0 * (at * inside).sum(-1, keepdims=True) * inside  # the far end of the chord, for radius 1
        total = total + (1 - R) ** 2 * R**k * light(refracted(inside, -at, 1 / eta))
        inside = reflected(inside, -at)
    return total


@pytest.mark.parametrize("max_depth", [1, 2, 3, 4, 10])
def test_glass_ball_turns_the_world_upside_down(max_depth):
    glass = d.Dielectric(1.5, 1.0)
    cam = eye((0.0, -4.0, 0.5), (0.0, 0.0, 0.0), size(24, 5), fov=35.0)
    image = picture(d.Sphere(front=glass, back=glass.inside), environment=SKY, cam=cam, max_depth=max_depth)
    w, o = directions(cam), cam.to_world[:3, 3]
    b, c = w @ o, o @ o - 1.0
    hit = b * b - c > 0.0
    assert 0.2 < hit.mean() < 0.8
    n = o + (-b - np.sqrt(np.where(hit, b * b - c, 0.0)))[..., None] * w
    expected = sky(w)
    expected[hit] = ball_light(w[hit], n[hit], 1.5, max_depth, sky)
    # near its rim a ball spreads directions by 1 / cos(theta)
    cosine = np.where(hit, -(w * n).sum(-1), 1.0)[..., None]
    assert np.all(np.abs(image - expected) <= RAY * expected.max() * max_depth / cosine)


def test_energy_is_kept_but_for_what_is_cut_off():
    """Under a sky of radiance 1 a ball of glass shows 1 - T R^(max_depth - 2): it is invisible, to the last ray."""
    glass = d.Dielectric(2.4, 1.0)
    cam = eye((0.0, -4.0, 0.5), (0.0, 0.0, 0.0), size(16, 4), fov=20.0)
    w, o = directions(cam), cam.to_world[:3, 3]
    b = w @ o
    n = o + (-b - np.sqrt(b * b - o @ o + 1.0))[..., None] * w
    R, _ = boundary(-(w * n).sum(-1), 2.4)
    ball = d.Sphere(front=glass, back=glass.inside)
    for max_depth in (2, 5, 16):
        image = picture(ball, environment=d.GradientEnvironment(np.ones(3), np.zeros((3, 3))), cam=cam,
                        max_depth=max_depth)  # fmt: skip
        lost = (1.0 - R) * R ** (max_depth - 2)
        np.testing.assert_allclose(image[..., 0], 1.0 - lost, rtol=0.0, atol=2 * RAY)


def test_total_internal_reflection():
    """From within glass: beyond the critical angle a perfect mirror, else R L_r + (1 - R) eta^2 L_t."""
    glass = d.Dielectric(1.5, 1.0)  # above the disk is air
    cam = eye((0.0, 0.0, -1.0), (0.0, 1.0, -0.2), size(24, 5), fov=70.0)
    image = picture(
        d.Disk(to_world=moved(0, 0, 0, 100, 100, 1), front=glass, back=glass.inside), environment=SKY, cam=cam
    )
    w, n = directions(cam), np.array([0.0, 0.0, -1.0])
    up = w[..., 2] > 0.02
    R, _ = boundary(w[..., 2:], 1 / 1.5)
    total = R[..., 0] == 1.0
    assert (up & total).sum() >= 4
    assert (up & ~total).sum() >= 4
    assert np.abs(w[up][:, 2] - math.sqrt(1 - 1 / 1.5**2)).min() > 1e-5  # no pixel at the critical angle
    with np.errstate(invalid="ignore"):
        through = (1 - R) * 1.5**2 * sky(refracted(w, n, 1 / 1.5))
    expected = R * sky(reflected(w, n)) + np.where(R < 1.0, through, 0.0)
    slope = 1.0 / np.abs(w[..., 2] ** 2 - (1 - 1 / 1.5**2))[..., None]  # of R and of the refracted direction
    assert np.all((np.abs(image - expected) <= RAY * slope * 4)[up])


# --- everything else ---


def grey(reflectance=0.5):
    return d.Diffuse(np.full(3, reflectance))


def test_one_shadow_ray_for_every_point_light():
    """k_d I cos(theta) / r^2 for each, or nothing behind the ball: hard shadows."""
    positions, intensities = np.array([[2.0, 1.0, 4.0], [-3.0, 0.5, 2.0]]), np.array([[9.0, 8, 7], [3, 4, 5]])
    lights = tuple(d.PointLight(p, i) for p, i in zip(positions, intensities, strict=True))
    cam = eye((0.0, -6.0, 4.0), (0.0, 0.0, 0.0), size(24, 6), fov=40.0)
    ball = d.Sphere(center=np.array([0.0, 0.0, 1.0]), radius=0.5, front=d.Conductor())
    image = picture(d.Disk(to_world=moved(0, 0, 0, 40, 40, 1), front=grey()), ball, lights=lights, cam=cam)
    w, o = directions(cam), cam.to_world[:3, 3]

    def meets(p, v, reach):
        b, c = ((p - ball.center) * v).sum(-1), ((p - ball.center) ** 2).sum(-1) - 0.25
        near = np.abs(b * b - c) < 1e-4
        return (b * b - c > 0) & (b < 0) & (-b < reach), near

    x = o - w * (o[2] / w[..., 2:])
    blocked, near = meets(o + 0 * w, w, np.inf)
    floor = ~blocked & ~near
    expected = np.zeros_like(x)
    for p, i in zip(positions, intensities, strict=True):
        r2 = ((p - x) ** 2).sum(-1, keepdims=True)
        L = (p - x) / np.sqrt(r2)
        dark, near = meets(x, L, np.sqrt(r2[..., 0]))
        floor &= ~near
        expected += np.where(dark[..., None], 0.0, 0.5 / math.pi * i * L[..., 2:] / r2)
    shadows = {tuple(np.round(v / expected.max(), 3)) for v in expected[floor]}
    assert len(shadows) > 4
    np.testing.assert_allclose(image[floor], expected[floor], rtol=1e-5)


def test_an_area_light_is_a_point_light_in_its_middle():
    """Slide "Illumination as integration", step 1: I = L A cos(theta_s), and the same hard shadow for every seed."""
    centre, half = np.array([1.0, -1.0, 3.0]), np.array([0.7, 0.4])
    lamp = d.Rectangle(to_world=moved(*centre, half[0], -half[1], -1), radiance=np.array([4.0, 5, 6]), front=None)
    cam = eye((0.0, -5.0, 2.0), (0.0, 0.0, 0.0), size(12, 4), fov=40.0)
    image = picture(d.Rectangle(to_world=moved(0, 0, 0, 40, 40, 1), front=grey()), lamp, cam=cam)
    w, o = directions(cam), cam.to_world[:3, 3]
    x = o - w * (o[2] / w[..., 2:])
    to = centre - x
    r2 = (to**2).sum(-1, keepdims=True)
    cosine = to[..., 2:] / np.sqrt(r2)
    intensity = np.array([4.0, 5, 6]) * (4 * half[0] * half[1]) * cosine
    np.testing.assert_allclose(image, 0.5 / math.pi * intensity * cosine / r2, rtol=1e-5)


def test_max_depth_is_checked():
    for rays in (0, -1, 17, 2.5):
        with pytest.raises(SceneError, match="max_depth must be a whole number from 1 to 16"):
            Scene(d.SceneDescription(camera=camera(2), max_depth=rays))


def test_the_centre_needs_one_sample():
    scene = Scene(d.SceneDescription(camera=camera(2), sampler="centre", spp=16))
    image = render(scene, "basic")
    assert np.all(image.samples == 1)
    assert np.all(np.isnan(image.standard_error))  # unknown, not zero
    for budget in ({"spp": 2}, {"seconds": 1.0}, {"relative_error": 0.1}):
        with pytest.raises(UserError, match="takes one sample of each pixel"):
            render(scene, "basic", **budget)
