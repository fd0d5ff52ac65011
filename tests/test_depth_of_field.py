"""Slides "Depth of field" and "Cause of focusing effects": a thin lens, ray by ray and in closed forms."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from helpers import ALPHA, U53, array, chi_square_p, eye_ray, squares
from scenes import moved
from scipy import integrate, stats

from raylab import description as d
from raylab.camera import DiskAperture, PolygonAperture, make_aperture
from raylab.closed_forms import blur
from raylab.errors import SceneError
from raylab.geometry import Placement
from raylab.render import render
from raylab.scene import Scene
from raylab.sensor import make_camera

U24 = 2.0**-24
HERE = Placement(np.zeros(3), 1.0)
APERTURE, FOCUS, DEPTH = 0.1, 4.0, 2.5  # case C1


class Fixed:
    """A stream that gives its points one after the other."""

    def __init__(self, *points):
        self.points = iter(points)

    def square(self):
        return next(self.points)


def lens(**changes):
    return d.Camera(**({"aperture_radius": APERTURE, "focus_distance": FOCUS, "width": 32, "height": 32} | changes))


def at_depth(o, ray, z):
    """Where the ray meets the plane at depth z of the camera at the origin; o lies at depth near_clip."""
    o, ray = array(o), array(ray)
    return o + ray * (z - o[2]) / ray[2]


# --- rays ---


@pytest.mark.parametrize("blades", [0, 3, 6])
@pytest.mark.parametrize("pixel", [(0, 0), (17, 4), (31, 31)])
def test_all_rays_of_a_film_point_meet_on_the_focus_plane(blades, pixel):
    """On the plane at depth f, where the pinhole's ray meets it, not on the sphere of radius f."""
    c = lens(aperture_blades=blades)
    eye, straight = make_camera(c, HERE), make_camera(lens(aperture_radius=0.0), HERE)
    want = at_depth(*eye_ray(straight, *pixel, Fixed((0.3, 0.6)))[:2], FOCUS)
    for u in squares(50):
        o, ray, _ = eye_ray(eye, *pixel, Fixed((0.3, 0.6), u))
        assert np.abs(at_depth(o, ray, FOCUS) - want).max() <= 8 * U24 * FOCUS  # six numbers rounded to float32


@pytest.mark.parametrize("blades", [0, 5])
def test_rays_start_at_points_uniform_on_the_aperture(blades):
    c = lens(aperture_blades=blades, aperture_rotation=20.0, near_clip=1e-9)
    eye, opening = make_camera(c, HERE), make_aperture(APERTURE, blades, 20.0)
    for u in squares(50):
        o, _, _ = eye_ray(eye, 3, 5, Fixed((0.5, 0.5), u))
        x, y = opening.sample(u)
        assert array(o) == pytest.approx([x, y, 0.0], abs=2 * U24 * APERTURE + 2e-9)


def test_clip_planes_are_planes():
    """As in Mitsuba: near_clip and far_clip are depths, not lengths along the ray."""
    eye = make_camera(lens(near_clip=0.5, far_clip=7.0), HERE)
    for u in squares(20):
        o, ray, far = eye_ray(eye, 2, 30, Fixed((0.5, 0.5), u))
        assert o.z == pytest.approx(0.5, abs=U24)
        assert o.z + far * ray.z == pytest.approx(7.0, abs=16 * U24)


# --- apertures ---


def test_a_disk_aperture_is_sampled_uniformly():
    x, y = np.array([DiskAperture(2.0).sample(u) for u in squares(20_000)]).T
    rings, sectors = np.linspace(0, 4, 7), np.linspace(-np.pi, np.pi, 11)
    counts, *_ = np.histogram2d(x * x + y * y, np.arctan2(y, x), bins=(rings, sectors))
    assert counts.sum() == 20_000
    assert chi_square_p(counts, np.full(counts.shape, 20_000 / counts.size)) > ALPHA


def corner_of(opening):
    return opening.radius


@pytest.mark.parametrize("blades", [3, 5, 8])
def test_a_polygonal_aperture_is_sampled_uniformly(blades):
    """Sectors, and within a sector shells of equal area: the share below the height h of a sector is (h / H)^2."""
    opening = make_aperture(2.0, blades, 30.0)
    assert isinstance(opening, PolygonAperture)
    x, y = np.array([opening.sample(u) for u in squares(20_000, seed=blades)]).T
    turn = (np.arctan2(y, x) - math.radians(30.0)) % (2 * np.pi)
    sector, within = np.divmod(turn, 2 * np.pi / blades)
    middle = within - np.pi / blades
    r = np.hypot(x, y)
    height = r * np.cos(middle) / (corner_of(opening) * math.cos(math.pi / blades))
    across = np.tan(middle) / math.tan(math.pi / blades)  # uniform in [-1, 1] at each height
    assert height.max() <= 1.0 + 2.0**-36  # twice what the series of sine and cosine leave out
    counts, _ = np.histogramdd(
        np.stack([sector, height**2, across], axis=1), bins=(np.arange(blades + 1), np.linspace(0, 1 + 1e-9, 5), 4)
    )
    assert chi_square_p(counts, np.full(counts.shape, 20_000 / counts.size)) > ALPHA


@pytest.mark.parametrize("blades", [3, 4, 6, 100])
def test_a_polygon_has_the_area_of_its_disk(blades):
    opening = make_aperture(0.3, blades, 0.0)
    area = blades / 2 * corner_of(opening) ** 2 * math.sin(2 * math.pi / blades)
    assert area == pytest.approx(math.pi * 0.3**2, rel=1e-14)


# --- extremes ---


def test_focus_at_infinity_keeps_all_directions_of_a_film_point():
    eye, straight = make_camera(lens(focus_distance=math.inf), HERE), make_camera(lens(aperture_radius=0.0), HERE)
    for u in squares(20):
        assert eye_ray(eye, 3, 4, Fixed((0.1, 0.2), u))[1] == eye_ray(straight, 3, 4, Fixed((0.1, 0.2)))[1]
    far = make_camera(lens(focus_distance=1e300), HERE)
    ray = eye_ray(far, 3, 4, Fixed((0.1, 0.2), (0.9, 0.4)))[1]
    assert [*ray] == [*eye_ray(straight, 3, 4, Fixed((0.1, 0.2)))[1]]


@pytest.mark.parametrize("radius", [1e3, 1e6])
def test_rays_from_a_huge_aperture_still_meet(radius):
    """They are advanced to the scene before they are rounded, so that float32 resolves the focus point."""
    eye = make_camera(lens(aperture_radius=radius, focus_distance=1.0), HERE)
    for u in [v for v in squares(50) if abs(v[0] - 0.5) + abs(v[1] - 0.5) > 0.1]:
        o, ray, far = eye_ray(eye, 16, 16, Fixed((0.0, 0.0), u))
        o, ray = array(o), array(ray)
        t = ((np.array([0.0, 0.0, 1.0]) - o) @ ray) / (ray @ ray)
        assert 0 < t < far
        assert np.linalg.norm(o + t * ray - [0, 0, 1]) <= 16 * U24 + 16 * U53 * radius


BAD = [
    ({"aperture_radius": -0.1}, "aperture_radius must be finite and not negative, got -0.1"),
    ({"aperture_radius": math.nan}, "aperture_radius"),
    ({"aperture_radius": math.inf}, "aperture_radius"),
    ({"focus_distance": 0.0}, "focus_distance must be positive, or inf, got 0.0"),
    ({"focus_distance": -1.0}, "focus_distance"),
    ({"focus_distance": math.nan}, "focus_distance"),
    ({"focus_distance": 1e-300}, "must not be below 1e-12 of aperture_radius, got 1e-300"),
    ({"aperture_blades": 2}, "aperture_blades must be 0, a disk, or at least 3, got 2"),
    ({"aperture_rotation": math.nan}, "aperture_rotation"),
]


@pytest.mark.parametrize(("change", "message"), BAD)
def test_a_lens_that_focuses_nothing_is_refused(change, message):
    with pytest.raises(SceneError, match=message):
        make_camera(lens(**change), HERE)


# --- case C1: the edge of a shining half-plane, out of focus ---


def edge(x0=0.03, size=32, fov=1e-6, **changes):
    """Each pixel is aimed at x0 from the edge on the focus plane: they are all one measurement, again and again."""
    x = -x0 * DEPTH / FOCUS  # here the plane ends: seen through the centre of the lens, x0 beside the axis
    plane = d.Rectangle(to_world=moved(x - 50.0, 0, DEPTH, -50, 50, -1), radiance=np.ones(3), front=None)
    return Scene(d.SceneDescription(camera=lens(fov=fov, width=size, height=size, **changes), shapes=(plane,)))


EXPECTED = float(blur.half_plane_through_lens(0.03, APERTURE, FOCUS, DEPTH))
PLACE = 0.03 * DEPTH / FOCUS


def test_closed_forms_of_blur():
    """Case C1, and the same by quadrature over the disk; the circle of confusion in both of its places."""
    s = -0.03 * DEPTH / ((FOCUS - DEPTH) * APERTURE)
    share, _ = integrate.quad(lambda x: 2 * math.sqrt(1 - x * x) / math.pi, -1, s, epsabs=1e-13)
    assert pytest.approx(share, abs=1e-12) == EXPECTED
    assert pytest.approx(0.195501109478, abs=5e-13) == EXPECTED
    assert blur.circle_of_confusion(0.1, 4.0, 2.5) == pytest.approx(0.06, rel=1e-15)
    assert blur.circle_of_confusion(0.1, 4.0, 4.0) == 0.0


def cell_shares(n):
    """How much of each cell of an n x n grid sees the light: by a fine grid through our own concentric map."""
    fine = 4096
    u = (np.arange(fine) + 0.5) / fine * 2 - 1
    a, b = np.meshgrid(u, u, indexing="ij")
    with np.errstate(divide="ignore", invalid="ignore"):
        x = np.where(np.abs(a) > np.abs(b), a * np.cos(np.pi / 4 * b / a), b * np.sin(np.pi / 4 * a / b))
    # The focus point is (0, 0, f): the ray from (x, .) on the lens stands at x (1 - z / f) at depth z.
    seen = APERTURE * x * (1 - DEPTH / FOCUS) < -PLACE
    return seen.reshape(n, fine // n, n, fine // n).mean(axis=(1, 3))


def variances():
    """Of the mean of N samples: independent F (1 - F) / N; stratified sum of p (1 - p) / N^2 over the cells."""
    table = {("independent", n): EXPECTED * (1 - EXPECTED) / n for n in (16, 256)}
    for n in (16, 256):
        side = round(math.sqrt(n))
        p = cell_shares(side)
        table["stratified", n] = float((p * (1 - p)).sum()) / n**2
    return table


@pytest.mark.parametrize("sampler", ["independent", "stratified", "sobol"])
def test_depth_of_field_blurs_an_edge_as_the_formula_says(sampler):
    """The mean within its bound, and for random and stratified points the variance of a pixel too.

    The variances are known: N^-1 for independent points, and N^-1.5 for stratified ones, of which only the cells on
    the edge count. Family error 1e-6.
    """
    scene, theory = edge(), variances()
    order = math.log(theory["stratified", 256] / theory["stratified", 16]) / math.log(16)
    assert order == pytest.approx(-1.5, abs=0.1)
    assert scene.features >= {"lens"}
    measured = {}
    for n in (16, 256):
        image = render(scene, sampler=sampler, spp=n if sampler == "independent" else 2 * n, seed=11)
        pixels = image.mean[..., 0].ravel()
        streams = 1 if sampler == "independent" else 2
        assert abs(pixels.mean() - EXPECTED) < stats.norm.isf(ALPHA / 8) * stats.sem(pixels) + 1e-6
        measured[n] = float(((pixels - EXPECTED) ** 2).mean()) * streams
        if (sampler, n) in theory:
            ratio = len(pixels) * measured[n] / theory[sampler, n]
            low, high = stats.chi2.ppf([ALPHA / 8, 1 - ALPHA / 8], len(pixels))
            assert low < ratio < high, (sampler, n, measured[n], theory[sampler, n])
    if sampler == "sobol":  # its variance has no closed form, but it is below that of random points
        assert measured[256] < 0.5 * theory["independent", 256]


def test_a_picture_out_of_focus_is_the_closed_form_in_each_pixel():
    """A row of pixels across the blurred edge, each the mean of F over the pixel, in the room of two apertures."""
    scene = edge(0.0, 32, fov=2.5)
    image = render(scene, sampler="independent", spp=256, seed=3)
    half = FOCUS * math.tan(math.radians(1.25))
    x = np.linspace(half, -half, 33)  # the film's left is +x
    exact = np.array([
        integrate.quad(
            lambda v: float(blur.half_plane_through_lens(v, APERTURE, FOCUS, DEPTH)), b, a,
            points=[p for p in (-0.06, 0.06) if b < p < a] or None,
        )[0] / (a - b)
        for a, b in pairwise(x)
    ])  # fmt: skip
    column = image.mean[..., 0].mean(axis=0)
    error = np.sqrt(exact * (1 - exact) / (32 * 256))
    assert exact[0] == 0.0
    assert exact[-1] == 1.0
    assert np.all(np.abs(column - exact) <= stats.norm.isf(ALPHA / 64) * error + 1e-4 * (error > 0))


def test_in_focus_an_edge_is_sharp():
    """Focused on the plane itself, each pixel beside the edge is all dark or all bright, whatever the aperture."""
    scene = edge(0.03, 8, focus_distance=DEPTH, fov=0.1)
    assert set(np.unique(render(scene, sampler="independent", spp=16).mean)) == {0.0}
