"""Fresnel's formulas against mpmath, which takes them as they stand in textbooks."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from helpers import U53, array, unit

from raylab import fresnel
from raylab.vec3 import Vec3, dot

ETAS = [1.5, 1 / 1.5, 1.33, 2.4, 1 / 2.4, 1.0003, 1.0 + 2.0**-30, 100.0]
METALS = [(0.2, 3.9), (1.1, 6.8), (0.0, 1.0), (3.1, 3.3), (1.5, 0.0), (0.5, 1e-6), (1.0, 1e-3)]
COSINES = [1.0, 0.9, 0.8, 0.5, 0.2, 0.05, 1e-3, 1e-8, 1e-12]


def textbook(c, eta):
    """R by r_s = (cos i - eta cos t) / (cos i + eta cos t), r_p with eta on the other cosine; 60 digits."""
    with mpmath.workdps(60):
        c, eta = mpmath.mpf(c), mpmath.mpmathify(eta)
        t = mpmath.sqrt(1 - (1 - c * c) / eta**2)
        if mpmath.im(eta * t) < 0:  # the wave inside a metal must fade
            t = -t
        r_s, r_p = (c - eta * t) / (c + eta * t), (eta * c - t) / (eta * c + t)
        return (abs(r_s) ** 2 + abs(r_p) ** 2) / 2


@pytest.mark.parametrize("eta", ETAS)
def test_dielectric_reflectance_and_transmittance(eta):
    """R to a few roundings of itself; T, which is 1 - R without the cancellation, also at grazing angles.

    The only ill-conditioned number is g^2 = eta^2 - 1 + c^2 near the critical angle, whose error is that of c.
    """
    for c in COSINES:
        R, T, _ = fresnel.dielectric(c, eta)
        expected = textbook(c, eta)
        gg = (eta - 1) * (eta + 1) + c * c
        condition = (abs((eta - 1) * (eta + 1)) + c * c) / abs(gg)
        assert float(R) == pytest.approx(float(expected), rel=16 * U53 * condition, abs=1e-24)
        assert float(T) == pytest.approx(float(1 - expected), rel=16 * U53 * condition, abs=1e-24)


@pytest.mark.parametrize(("n", "k"), METALS)
def test_conductor_reflectance(n, k):
    for c in COSINES:
        (r, _, _) = fresnel.conductor(c, Vec3(n, n, n), Vec3(k, k, k))
        # beyond the critical angle of a nearly clear medium the fading part of g is small beside its square's rounding
        assert r == pytest.approx(float(textbook(c, mpmath.mpc(n, k))), rel=64 * U53)


def test_the_three_colours_of_a_conductor_are_its_own():
    r = fresnel.conductor(0.7, Vec3(0.2, 1.1, 3.1), Vec3(3.9, 6.8, 3.3))
    for value, (n, k) in zip(r, ((0.2, 3.9), (1.1, 6.8), (3.1, 3.3)), strict=True):
        assert value == pytest.approx(float(textbook(0.7, mpmath.mpc(n, k))), rel=64 * U53)


@pytest.mark.parametrize(("n", "k"), METALS)
def test_normal_incidence(n, k):
    """R = ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2)"""
    assert fresnel.metal(1.0, n, k) == pytest.approx(((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2), rel=32 * U53)


def test_a_mirror_reflects_everything():
    """eta = 0, k = 1: the material "none"."""
    for c in COSINES:
        assert fresnel.metal(c, 0.0, 1.0) == pytest.approx(1.0, rel=16 * U53)


@pytest.mark.parametrize("eta", [1.5, 1.33, 2.4, 1 / 1.5])
def test_brewsters_angle(eta):
    """tan(theta) = eta: the parallel part is gone, so 2 R is r_s^2 = ((1 - eta^2) / (1 + eta^2))^2."""
    c = 1.0 / math.sqrt(1.0 + eta * eta)
    expected = ((1 - eta**2) / (1 + eta**2)) ** 2 / 2
    assert fresnel.dielectric(c, eta)[0] == pytest.approx(expected, rel=16 * U53)
    assert fresnel.metal(c, eta, 0.0) == pytest.approx(expected, rel=32 * U53)


def test_grazing_light_is_reflected():
    for eta in ETAS:
        assert fresnel.dielectric(0.0, eta)[:2] == (pytest.approx(1.0, rel=16 * U53), 0.0)
    for n, k in METALS:
        assert fresnel.metal(0.0, n, k) == pytest.approx(1.0, rel=16 * U53)


def test_total_internal_reflection():
    """From glass into air at 60 degrees, and at every angle beyond asin(1 / 1.5)."""
    assert fresnel.dielectric(0.5, 1 / 1.5) == (1.0, 0.0, 0.0)
    critical = math.sqrt(1.0 - 1.0 / 1.5**2)
    for c in np.linspace(0.0, critical * (1.0 - 1e-12), 50):
        assert fresnel.dielectric(float(c), 1 / 1.5) == (1.0, 0.0, 0.0)
        assert fresnel.metal(float(c), 1 / 1.5, 0.0) == pytest.approx(1.0, rel=16 * U53)
    assert fresnel.dielectric(critical * (1.0 + 1e-12), 1 / 1.5)[0] < 1.0


def test_no_boundary_reflects_nothing():
    for c in [0.0, *COSINES]:
        assert fresnel.dielectric(c, 1.0) == (0.0, 1.0, c)
        assert fresnel.metal(c, 1.0, 0.0) == 0.0


def test_known_transmittances_at_grazing_angles():
    """Cosines 1e-3, 1e-8, 1e-12 into eta = 1.5, by mpmath, where 1 - R has lost its digits."""
    for c, T in ((1e-3, 5.7944274914987233e-3), (1e-8, 5.8137765474994583e-8), (1e-12, 5.8137767414800532e-12)):
        assert fresnel.dielectric(c, 1.5)[1] == pytest.approx(T, rel=1e-14)


@pytest.mark.parametrize("eta", [1.5, 1.33, 2.4])
def test_reciprocity(eta):
    """The same light passes in both directions: T and R are those of the refracted ray, sent back."""
    for c in COSINES:
        R, T, cos_t = fresnel.dielectric(c, eta)
        back = fresnel.dielectric(cos_t, 1.0 / eta)
        # on the way back, c^2 = 1 - eta^2 + (eta cos t)^2 cancels: its error is that of cos t over c^2
        rel = 32 * U53 * max(1.0, eta * eta / c**2)
        if rel < 0.1:
            assert back[0] == pytest.approx(R, rel=rel)
            assert back[1] == pytest.approx(T, rel=rel)
            assert back[2] == pytest.approx(c, rel=rel)


@pytest.mark.parametrize("eta", ETAS)
def test_snells_law(eta):
    """sin(theta_i) = eta sin(theta_t), in the plane of V and N, on the other side, with unit length."""
    N = unit(0.2, -0.3, 0.9)
    for x, y in ((0.1, 0.2), (-0.5, 0.1), (0.0, 0.0), (0.3, -0.3)):
        V = unit(N.x + x, N.y + y, N.z)
        _, T, cos_t = fresnel.dielectric(dot(N, V), eta)
        if T == 0.0:
            continue
        w = array(fresnel.refract(V, N, eta, cos_t))
        sine_in, sine_out = np.cross(array(N), array(V)), np.cross(array(N), w)
        assert sine_out * eta == pytest.approx(-sine_in, abs=8 * U53 * max(1.0, eta))
        assert w @ array(N) < 0.0
        assert np.linalg.norm(w) == pytest.approx(1.0, abs=16 * U53 * max(1.0, 1.0 / eta**2))
