"""Slide "Creating glossy reflections": which BRDF each of the three jitters has, and where they agree.

Rendered are one-pixel pictures of a small mirror-like plate under a gradient sky and a triangle light, either of which
may be dark, so that each shade needs one kernel.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import ALPHA, array, squares
from scenes import look_at, moved
from scipy import integrate, stats

import raylab
from raylab import description as d
from raylab import glossy, ladders
from raylab.brdf import reflect
from raylab.closed_forms import glossy as forms
from raylab.closed_forms import phong, variances
from raylab.errors import UserError
from raylab.sampling import pdf_phong_lobe, sample_phong_lobe
from raylab.vec3 import Vec3

compiled = pytest.mark.compiled(reason="many samples")
SAMPLES = 1 << 16
K_S = np.array([0.2, 0.5, 0.8])
N = Vec3(0.0, 0.0, 1.0)
CHECKS = 40  # statistical checks in this file, each of three channels that share their samples
SIGMAS = float(stats.norm.isf(ALPHA / (2 * CHECKS)))
GEOMETRY = 2.0**-20  # directions are rounded to float32, and all integrands are smooth
TRIANGLE = np.array([(-0.3, -0.5, 0.6), (0.9, -0.1, 1.1), (0.1, 0.8, 0.7)])


def view(cosine):
    """V at that cosine to N, so that R . N is the same."""
    return np.array([-math.sqrt(1.0 - cosine**2), 0.0, cosine])


def render(shade, n, V, sky=(0.0, 0.0), light=0.0, others=()):
    """A plate seen along -V under L(w) = sky[0] + sky[1] w . N and a triangle light of that radiance."""
    plate = d.Rectangle(to_world=moved(0, 0, 0, 0.01, 0.01, 1), front=d.Phong(np.zeros(3), K_S, n))
    corners = TRIANGLE if light else TRIANGLE - np.array([0.0, 0.0, 3.0])  # a dark light must not hide the sky
    lamp = d.Mesh(vertices=corners, faces=np.array([[0, 2, 1]]), radiance=np.full(3, light), front=None)
    up = (0.0, 1.0, 0.0)
    camera = d.Camera(to_world=look_at(0.1 * np.asarray(V), (0, 0, 0), up), fov=0.01, width=1, height=1)
    gradient = np.tile(np.array([0.0, 0.0, sky[1]]), (3, 1))
    scene = raylab.Scene(
        d.SceneDescription(
            camera=camera,
            shapes=(plate, lamp, *others),
            environment=d.GradientEnvironment(np.full(3, sky[0]), gradient),
        )
    )
    return raylab.render(scene, shade, sampler="independent", spp=SAMPLES, seed=1, threads=1)


def check(image, truth):
    """The mean of each channel within SIGMAS standard errors of K_S * truth."""
    error = SIGMAS * image.standard_error[0, 0] + GEOMETRY * K_S * truth
    assert image.invalid_samples == image.invalid_rays == 0
    assert np.all(np.abs(image.mean[0, 0] - K_S * truth) <= error), (image.mean[0, 0] / K_S, truth, error / K_S)


# --- the densities ---


def jitter(V, u):
    return glossy.sample_jitter(reflect(V, N), 0.7, u)


def pdf_jitter(V, w):
    return glossy.pdf_jitter(reflect(V, N), 0.7, w)


def normal(V, u):
    return reflect(V, sample_phong_lobe(N, 9.0, u))


def pdf_normal(V, w):
    return glossy.pdf_normal(V, N, 9.0, w)


@pytest.mark.parametrize(("sample", "pdf"), [(jitter, pdf_jitter), (normal, pdf_normal)])
@pytest.mark.parametrize("cosine", [1.0, 0.8, 0.3])
def test_pdf_is_one_over_the_jacobian(sample, pdf, cosine):
    """p |dw/du1 x dw/du2| = 1, by central differences: their error is h^2 times third derivatives, below 1e3 here."""
    V, h = Vec3(*view(cosine)), 1e-5
    for u1, u2 in squares(50, seed=2):
        u1 = 0.05 + 0.9 * u1
        a = (array(sample(V, (u1 + h, u2))) - array(sample(V, (u1 - h, u2)))) / (2.0 * h)
        b = (array(sample(V, (u1, u2 + h))) - array(sample(V, (u1, u2 - h)))) / (2.0 * h)
        p = pdf(V, sample(V, (u1, u2)))
        assert p * np.linalg.norm(np.cross(a, b)) == pytest.approx(1.0, abs=1e-6)


def test_offsets_stay_in_their_disk():
    R, a = reflect(Vec3(*view(0.6)), N), 0.5
    inside, outside = (Vec3(*(array(R) + t * np.array([0.0, 1.0, 0.0])) / math.hypot(1.0, t)) for t in (0.49, 0.51))
    assert glossy.pdf_jitter(R, a, inside) > 0.0
    assert glossy.pdf_jitter(R, a, outside) == 0.0
    assert glossy.pdf_jitter(R, a, -R) == 0.0


@pytest.mark.parametrize("n", [2.0, 20.0, 300.0])
def test_radius_gives_the_spread_of_phongs_lobe(n):
    """Mean of tan^2 alpha in the disk, a^2 / 2, and of sin^2 alpha in the lobe, 2 / (n + 3), by quadrature."""
    lobe, _ = integrate.quad(lambda c: (n + 1.0) * c**n * (1.0 - c * c), 0.0, 1.0, epsabs=1e-13)
    assert glossy.jitter_radius(n) ** 2 / 2.0 == pytest.approx(lobe, rel=1e-10)


# --- where they agree, and where they do not ---


@pytest.mark.parametrize("n", [20.0, 200.0])
def test_a_jittered_normal_agrees_with_phong_at_normal_incidence(n):
    """log(p_normal / p_phong) = log((2 n + 1) / (2 n + 2)) + n alpha^4 / 16 + O(n alpha^6) at the angle alpha from R.

    So within alpha <= 2 / sqrt(n), nine tenths of the lobe, the two differ by less than 1 / n.
    """
    for alpha in np.linspace(0.0, 2.0, 9) / math.sqrt(n):
        w = Vec3(math.sin(alpha), 0.0, math.cos(alpha))
        ratio = math.log(glossy.pdf_normal(N, N, glossy.normal_exponent(n), w) / pdf_phong_lobe(N, n, w))
        series = math.log((2.0 * n + 1.0) / (2.0 * n + 2.0)) + n * alpha**4 / 16.0
        # the next term: 4 n log cos(alpha / 2) has -n alpha^6 / 720, n log cos(alpha) has -n alpha^6 / 45
        assert ratio == pytest.approx(series, abs=n * alpha**6 * (1 / 45 - 1 / 720) * 1.5 + 1e-12)
        assert abs(ratio) < 1.0 / n


@pytest.mark.parametrize("cosine", [1.0, 0.5, 0.25])
def test_a_jittered_normal_is_narrower_across_the_plane_of_incidence(cosine):
    """Where the density falls to exp(-1/2): the angle across is cos(theta) times that in the plane, up to O(1 / n)."""
    n, V = 1e6, Vec3(*view(cosine))
    R, e, widths = reflect(V, N), glossy.normal_exponent(1e6), []
    for side in (np.array([R.z, 0.0, -R.x]), np.array([0.0, 1.0, 0.0])):
        s = 1e-4  # a tenth of the width 1 / sqrt(n)
        w = [Vec3(*(math.cos(t) * array(R) + math.sin(t) * side)) for t in (-s, 0.0, s)]
        p = [math.log(glossy.pdf_normal(V, N, e, w_)) for w_ in w]
        widths.append(math.sqrt(-(s**2) / (p[0] - 2.0 * p[1] + p[2])))
    assert widths[0] == pytest.approx(1.0 / math.sqrt(n), rel=1e-3)  # as Phong's exp(-n alpha^2 / 2)
    assert widths[1] / widths[0] == pytest.approx(cosine, rel=1e-3)


def test_only_phong_is_reciprocal():
    """f_r(v, w) = f_r(w, v)? For the jitters f_r = p(w) / (w . N), so that f_r differs by the ratio of the cosines."""
    V, w = Vec3(*view(0.9)), Vec3(0.6, 0.0, 0.8)
    assert pdf_phong_lobe(reflect(V, N), 20.0, w) == pytest.approx(pdf_phong_lobe(reflect(w, N), 20.0, V), rel=1e-14)
    there = glossy.pdf_normal(V, N, 81.0, w) / w.z
    back = glossy.pdf_normal(w, N, 81.0, V) / V.z
    assert there / back == pytest.approx(0.9 / 0.8, rel=1e-14)


# --- rendered: what each reflects ---


@compiled
@pytest.mark.parametrize(("n", "cosine"), [(1, 1.0), (10, 1.0), (50, 1.0), (2, 0.6), (20, 0.6), (20, 0.1)])  # F1, F3
def test_phong_under_a_constant_sky(n, cosine):
    check(render("glossy_phong", n, view(cosine), (1.0, 0.0)), phong.constant_sky(n, cosine))


@compiled
def test_phong_under_a_gradient_sky():  # F4
    check(render("glossy_phong", 10, view(1.0), (1.1, 0.5)), phong.gradient_sky(10, 1.1, 0.5))


@compiled
def test_a_lobe_among_other_kinds_of_surface():
    mirror = d.Rectangle(to_world=moved(0, 0, -4, 1, 1, 1), front=d.Conductor())
    check(render("glossy_phong", 10, view(1.0), (1.1, 0.5), others=(mirror,)), phong.gradient_sky(10, 1.1, 0.5))


@compiled
@pytest.mark.parametrize("n", [1, 2, 7, 20])  # F5
def test_phong_under_a_triangle(n):
    R = np.array([0.36, 0.48, 0.8])
    check(render("glossy_phong", n, R * [-1, -1, 1], light=1.0), phong.polygon(TRIANGLE, n, R))


@compiled
def test_phong_has_the_variance_of_its_own_sampling():  # V9
    """One sample under a constant sky, R = N: 1 / ((n + 1) (n + 3)).

    Samples lie in [0, (n + 2) / (n + 1)] with mean 1: the kurtosis is at most 1 / variance, and the relative standard
    error of the sample variance sqrt((kurtosis - 1) / samples).
    """
    image, exact = render("glossy_phong", 20, view(1.0), (1.0, 0.0)), variances.phong_brdf(20)
    measured = (image.standard_error[0, 0] / K_S) ** 2 * SAMPLES
    np.testing.assert_allclose(measured, exact, rtol=SIGMAS * math.sqrt((1.0 / exact - 1.0) / SAMPLES))


@compiled
@pytest.mark.parametrize(("n", "cosine"), [(20, 1.0), (20, 0.3), (2, 0.2)])
def test_jitter_loses_what_the_horizon_cuts_off(n, cosine):
    exact = forms.jitter_constant_sky(glossy.jitter_radius(n), cosine)
    assert (exact < 1.0) == (cosine < 1.0)
    check(render("glossy_jitter", n, view(cosine), (1.0, 0.0)), exact)


@compiled
def test_jitter_under_a_gradient_sky():
    exact = forms.jitter_gradient_sky(glossy.jitter_radius(2), 1.1, 0.5)
    assert abs(exact - phong.gradient_sky(2, 1.1, 0.5)) > 0.01  # another lobe than Phong's
    check(render("glossy_jitter", 2, view(1.0), (1.1, 0.5)), exact)


@compiled
@pytest.mark.parametrize(("n", "cosine"), [(1, 1.0), (20, 0.3), (2, 0.2)])
def test_normals_lose_what_the_horizon_cuts_off(n, cosine):
    exact = forms.normal_constant_sky(glossy.normal_exponent(n), cosine)
    check(render("glossy_normal", n, view(cosine), (1.0, 0.0)), exact)


@compiled
def test_normals_under_a_gradient_sky():
    exact = forms.normal_gradient_sky(glossy.normal_exponent(1), 1.1, 0.5)
    check(render("glossy_normal", 1, view(1.0), (1.1, 0.5)), exact)


@compiled
def test_all_three_see_the_same_light_where_it_fills_the_lobe():
    """A constant sky over a narrow lobe, seen from above: k_s, to the last digit of the two that only look.

    Phong's weight (w . N) (n + 2) / (n + 1) differs from 1 by its own small noise."""
    for shade in ("glossy_jitter", "glossy_normal"):
        np.testing.assert_allclose(render(shade, 300, view(1.0), (1.0, 0.0)).mean[0, 0], K_S, rtol=1e-14)
    check(render("glossy_phong", 300, view(1.0), (1.0, 0.0)), 1.0)


@pytest.mark.parametrize("n", [2, 20])
def test_closed_forms_are_integrals_of_the_densities(n):
    """Of the normals' p(w) over the hemisphere; of the disk, whose p has a rim, over the part of it that counts."""
    V, e, a = Vec3(*view(0.3)), glossy.normal_exponent(n), glossy.jitter_radius(n)

    def p(w):
        flat = [glossy.pdf_normal(V, N, e, Vec3(*row)) / row[2] for row in w.reshape(-1, 3).tolist()]
        return np.reshape(flat, w.shape[:-1])

    assert ladders.environment(array(N), 1.0, p) == pytest.approx(forms.normal_constant_sky(e, 0.3), rel=1e-10)
    h = min(1.0, 0.3 / (a * math.sqrt(1.0 - 0.3**2)))
    part, _ = integrate.quad(lambda s: 2.0 / math.pi * math.sqrt(1.0 - s * s), -h, 1.0, epsabs=1e-12)
    assert forms.jitter_constant_sky(a, 0.3) == pytest.approx(part, rel=1e-9)


def test_a_scene_without_a_lobe_is_refused():
    scene = raylab.Scene(d.SceneDescription(camera=d.Camera(), shapes=(d.Rectangle(),)))
    with pytest.raises(UserError, match="needs glossy BRDF"):
        raylab.render(scene, "glossy_phong", spp=1)
