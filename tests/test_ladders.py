"""Slides "Illumination as integration": each step against the one before it, and step 4 against closed forms.

"Order" is the exponent of the error in n, fitted by least squares in log-log.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from raylab import ladders
from raylab.closed_forms import irradiance, phong
from raylab.figures.panels import slope

X, Z = np.zeros(3), np.array([0.0, 0.0, 1.0])
N = np.array([0.48, 0.6, 0.64])
P, E1, E2 = np.array([-1.0, -0.5, 1.0]), np.array([0.0, 1.0, 0.0]), np.array([2.0, 0.0, 0.0])
CORNERS = np.array([P, P + E1, P + E1 + E2, P + E2])
R = np.array([0.36, 0.48, 0.8])
EXPONENT = 7
GRADIENT = np.array([0.3, -0.2, 0.5])
K_D = 0.4
ROUNDING = 256 * 2.0**-53  # of sums over up to 2^16 parts, pairwise, of terms with some sixty operations
MORE_PARTS = np.array([16, 32, 64, 128])


def lobe(w):
    return (EXPONENT + 2) / (2.0 * np.pi) * np.maximum(0.0, w @ R) ** EXPONENT


def upright_lobe(w):
    return (EXPONENT + 2) / (2.0 * np.pi) * np.maximum(0.0, w @ N) ** EXPONENT


def sky(w):
    return 1.1 + w @ GRADIENT


def sky_about_n(w):
    return 1.1 + 0.5 * (w @ N)


OVER_THE_LIGHT = {
    "Lambertian": (K_D, K_D * float(irradiance.polygon(CORNERS))),
    "any BRDF": (lobe, phong.polygon(CORNERS, EXPONENT, R)),
}
OVER_DIRECTIONS = {
    "Lambertian": (sky, K_D, K_D * float(irradiance.gradient_sky(1.1, GRADIENT, N))),
    "any BRDF": (sky_about_n, upright_lobe, phong.gradient_sky(EXPONENT, 1.1, 0.5)),
    "any BRDF, lobe cut by the horizon": (1.0, None, None),
}


def tilted_lobe(cosine, n):
    """A lobe around a mirror direction with that cosine to N, and what it reflects of a constant sky."""
    r = cosine * N + math.sqrt(1.0 - cosine**2) * ladders.frame(N)[0]
    return lambda w: phong.lobe(n, 1.0) * np.maximum(0.0, w @ r) ** n, phong.constant_sky(n, cosine)


OVER_DIRECTIONS["any BRDF, lobe cut by the horizon"] = (1.0, *tilted_lobe(0.6, EXPONENT))


# --- over the light source ---


def test_step_1_point_source():
    """I k_d cos / r^2 with I = 5 at (1, 2, 2), k_d = 0.4: 5 * 0.4 * (2/3) / 9."""
    assert ladders.point_source(X, Z, (1.0, 2.0, 2.0), 5.0, K_D) == pytest.approx(4.0 / 27.0, rel=1e-15)
    assert 2.0 * irradiance.point_light((1.0, 2.0, 2.0)) == pytest.approx(4.0 / 27.0, rel=1e-15)
    assert ladders.point_source(X, Z, (1.0, 2.0, -2.0), 5.0, K_D) == 0.0


@pytest.mark.parametrize("f_r", [K_D, lobe], ids=["Lambertian", "any BRDF"])
def test_step_2_is_step_1_with_the_intensity_of_a_small_area(f_r):
    """I = L_s A cos(theta_s); a source that is turned away shines nowhere."""
    y, n_y = np.array([0.6, 0.0, 0.8]) * 2.0, np.array([0.0, 0.6, -0.8])
    cos_s = 0.64
    point = ladders.point_source(X, Z, y, 3.0 * 0.01 * cos_s, f_r)
    assert ladders.small_area_source(X, Z, y, n_y, 0.01, 3.0, f_r) == pytest.approx(float(point), rel=1e-15)
    assert ladders.small_area_source(X, Z, y, -n_y, 0.01, 3.0, f_r) == 0.0


@pytest.mark.parametrize("name", OVER_THE_LIGHT)
def test_step_4_over_the_light_is_the_closed_form(name):
    f_r, exact = OVER_THE_LIGHT[name]
    assert ladders.area_source(X, Z, P, E1, E2, 2.0, f_r) == pytest.approx(2.0 * exact, rel=ROUNDING)
    assert ladders.area_source(X, Z, P, E2, E1, 2.0, f_r) == 0.0  # the other side does not shine


@pytest.mark.parametrize("name", OVER_THE_LIGHT)
def test_step_4_of_a_small_source_tends_to_step_2(name):
    """Over a source of side s the integrand differs from its middle by O(s^2): order 2 in s."""
    f_r, _ = OVER_THE_LIGHT[name]
    sides, y = np.array([0.1, 0.05, 0.025]), P + (E1 + E2) / 3.0
    errors = []
    for s in sides:
        e1, e2 = s * E1, s * E2 / 2.0
        small = float(ladders.small_area_source(X, Z, y, -Z, s * s, 1.0, f_r))
        errors.append(abs(ladders.area_source(X, Z, y - (e1 + e2) / 2.0, e1, e2, 1.0, f_r) / small - 1.0))
    assert slope(sides, errors) == pytest.approx(2.0, abs=0.02)  # the next term is s^2 <= 1 % of this one


@pytest.mark.parametrize("name", OVER_THE_LIGHT)
def test_step_3_over_the_light_tends_to_step_4_with_order_1(name):
    """A smooth integrand: error c h^2 (1 + O(h^2)) = c / n; with h <= 1/16 the rest is below 1 % or so."""
    f_r, exact = OVER_THE_LIGHT[name]
    errors = [abs(ladders.area_sources(X, Z, *ladders.area_parts(P, E1, E2, m), 1.0, f_r) - exact) for m in MORE_PARTS]
    assert -1.02 < slope(MORE_PARTS**2, errors) < -0.98


# --- over incoming directions ---


def test_step_1_directional_source():
    """I k_d cos with I = 3 from (0.6, 0, 0.8)."""
    assert ladders.directional_source(Z, (0.6, 0.0, 0.8), 3.0, K_D) == pytest.approx(0.96, rel=1e-15)
    assert 1.2 * irradiance.directional_light((0.6, 0.0, 0.8)) == pytest.approx(0.96, rel=1e-15)
    assert ladders.directional_source(Z, (0.6, 0.0, -0.8), 3.0, K_D) == 0.0


@pytest.mark.parametrize("f_r", [K_D, lobe], ids=["Lambertian", "any BRDF"])
def test_step_2_is_step_1_with_the_irradiance_of_a_small_solid_angle(f_r):
    w = np.array([0.6, 0.0, 0.8])
    direct = ladders.directional_source(Z, w, sky(w) * 0.01, f_r)
    assert ladders.small_solid_angle(Z, w, 0.01, sky, f_r) == pytest.approx(float(direct), rel=1e-15)


@pytest.mark.parametrize("name", OVER_DIRECTIONS)
def test_step_4_over_directions_is_the_closed_form(name):
    L_i, f_r, exact = OVER_DIRECTIONS[name]
    # The cut lobe has EXPONENT - 1 continuous derivatives across its own horizon: Gauss' error falls like NODES^-8.
    tolerance = ROUNDING if "cut" not in name else float(ladders.NODES) ** -(EXPONENT + 1) * 1e3
    assert ladders.environment(N, L_i, f_r) == pytest.approx(exact, rel=tolerance)


@pytest.mark.parametrize("name", OVER_DIRECTIONS)
def test_step_3_over_directions_tends_to_step_4_with_order_1(name):
    """Smooth in cos(theta) and phi: as over the light."""
    L_i, f_r, exact = OVER_DIRECTIONS[name]
    errors = [abs(ladders.solid_angles(N, *ladders.direction_parts(N, m), L_i, f_r) - exact) for m in MORE_PARTS]
    assert -1.02 < slope(4 * MORE_PARTS**2, errors) < -0.98


def cap(axis, cosine):
    return lambda w: (w @ axis > cosine) * 1.0


def test_step_3_at_an_edge_along_the_parts_has_order_1_2():
    """A sun around n whose edge runs through the middles of a ring of parts: the sum has all of the ring or nothing.

    The half ring is missing: 2 pi k_d times the integral of z from 1/2 to (1 + h) / 2; the rest of the sum is exact.
    """
    m = np.array([17, 33, 65, 129])
    sun = cap(Z, 0.5)
    exact = K_D * math.pi * 0.75
    errors = [exact - ladders.solid_angles(Z, *ladders.direction_parts(Z, int(k)), sun, K_D) for k in m]
    np.testing.assert_allclose(errors, 2.0 * np.pi * K_D * (0.25 / m + 0.125 / m**2), rtol=ROUNDING * m.max())
    assert -0.52 < slope(4 * m**2, errors) < -0.48


def sun_errors(m, places=400):
    """Root mean square error of step 3 over random places of a sun of half angle 0.3 that is all above the horizon."""
    rng = np.random.default_rng(7)
    z, phi = rng.uniform(0.4, 0.9, places), rng.uniform(0.0, 2.0 * np.pi, places)
    r = np.sqrt(1.0 - z * z)
    axes = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)
    exact = K_D * irradiance.cap_sky(0.3) * z
    errors = []
    for k in m:
        w, dsigma = ladders.direction_parts(Z, int(k))
        w, weight = w.reshape(-1, 3), K_D * w.reshape(-1, 3)[:, 2] * dsigma.reshape(-1)
        sums = np.array([weight[w @ axis > math.cos(0.3)].sum() for axis in axes])
        errors.append(math.sqrt(np.mean((sums - exact) ** 2)))
    return errors


def test_step_3_at_an_edge_across_the_parts_has_order_3_4():
    """1/h parts along the edge err by about h^2 each, to random sides: h^(3/2) = n^-3/4.

    An error known from 400 places is good to about 1/sqrt(800) = 4 %; over a factor 64 in n that is a slope good to
    about 0.04 sqrt(2) / ln 64 = 0.014, and five times that is allowed.
    """
    m = np.array([8, 16, 32, 64])
    assert -0.82 < slope(4 * m**2, sun_errors(m)) < -0.68


# --- Monte Carlo, for comparison: slide "Area source by Monte Carlo" ---


def test_monte_carlo_has_order_1_2_whatever_the_integrand():
    """g(y) is step 2 with the whole area, at a random y: its mean over N has the variance of one, over N."""
    u = np.random.default_rng(3).random((4000, 64, 2))
    y = P + u[..., :1] * E1 + u[..., 1:] * E2
    g = ladders.small_area_source(X, Z, y, -Z, 2.0, 1.0, 1.0)
    # mean 1.13329022410, variance 0.194078193348 of this rectangle, from quadrature
    variance = g.mean(axis=1).var(ddof=1) * 64
    assert variance == pytest.approx(0.194078193348, rel=4.9 * math.sqrt(2.0 / 3999))  # two-sided 1e-6, normal means
    assert abs(g.mean() - float(irradiance.polygon(CORNERS))) < 4.9 * math.sqrt(0.194078193348 / g.size)
