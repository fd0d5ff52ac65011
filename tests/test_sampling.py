"""Maps from the square: known points, inverses, densities as Jacobians, unit integrals, chi-square, extremes."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import mpmath
import numpy as np
import pytest
from helpers import ALPHA, U53, around, array, chi_square_p, composite, size, squares, unit

from raylab import sampling as s
from raylab.vec3 import Vec3, cross, dot, length

PI = math.pi
AXIS = unit(0.3, -0.5, 0.7)
LAST, FIRST = 1.0 - 2.0**-53, 2.0**-53
EXTREME = [(u, v) for u in (0.0, FIRST, 0.5, LAST) for v in (0.0, FIRST, 0.25, 0.5, LAST)]
# Directions are sums of three products of rounded numbers: 16 roundings bound the error of each component.
ROUNDING = 16 * U53


class Map(NamedTuple):
    """A map from the square to the sphere: its three functions, and what we know of it from elsewhere."""

    name: str
    sample: Any
    pdf: Any
    invert: Any
    cdf: Any  # of z = cos(theta) over the axis: the share of directions nearer to the axis
    lowest: float  # the least z
    slope: float  # the largest |d u1 / d theta|

    def __repr__(self):
        return self.name


def phong(n):
    return Map(
        f"phong {n:g}",
        lambda u: s.sample_phong_lobe(AXIS, n, u),
        lambda w: s.pdf_phong_lobe(AXIS, n, w),
        lambda w: s.invert_phong_lobe(AXIS, n, w),
        lambda z: 1.0 - z ** (n + 1.0),
        0.0,
        math.sqrt(n + 1.0),  # of 1 - cos^(n+1): (n + 1) cos^n sin <= sqrt(n + 1)
    )


def cone(sin_max):
    cap = 1.0 - math.sqrt(1.0 - sin_max**2)
    return Map(
        f"cone {sin_max:g}",
        lambda u: s.sample_cone(AXIS, sin_max, u),
        lambda w: s.pdf_cone(AXIS, sin_max, w),
        lambda w: s.invert_cone(AXIS, sin_max, w),
        lambda z: (1.0 - z) / cap,
        1.0 - cap,
        2.0 / sin_max,
    )


def about_axis(name, cdf, lowest, slope):
    sample, pdf, invert = (getattr(s, f"{verb}_{name}") for verb in ("sample", "pdf", "invert"))
    return Map(name, lambda u: sample(AXIS, u), lambda w: pdf(AXIS, w), lambda w: invert(AXIS, w), cdf, lowest, slope)


MAPS = [
    about_axis("hemisphere", lambda z: z, 0.0, 1.0),  # u1 = z: counted from the horizon
    about_axis("cos_hemisphere", lambda z: 1.0 - z * z, 0.0, 1.0),
    Map("sphere", s.sample_sphere, s.pdf_sphere, s.invert_sphere, lambda z: (1.0 - z) / 2.0, -1.0, 0.5),
    phong(0.0),
    phong(1.0),
    phong(30.0),
    phong(1000.0),
    cone(1.0),
    cone(0.5),
    cone(0.01),
]


def axis_of(m):
    return Vec3(0.0, 0.0, 1.0) if m.name == "sphere" else AXIS


def dot_exact(a, b):
    return float(mpmath.fdot(zip([*a], [*b], strict=True)))


@pytest.mark.parametrize("m", MAPS, ids=repr)
def test_directions_have_unit_length_and_lie_where_they_should(m):
    for u in EXTREME + squares(200):
        w = m.sample(u)
        assert abs(length(w) - 1.0) <= ROUNDING
        assert dot(axis_of(m), w) >= m.lowest - ROUNDING


@pytest.mark.parametrize("m", MAPS, ids=repr)
def test_the_share_nearer_to_the_axis_is_u1(m):
    for u in squares(200, seed=1):
        z = dot_exact(axis_of(m), m.sample(u))
        slope_in_z = m.slope / math.sqrt(max(1.0 - z * z, 1e-12))
        assert m.cdf(z) == pytest.approx(u[0], abs=ROUNDING * (1.0 + slope_in_z))


@pytest.mark.parametrize("m", MAPS, ids=repr)
def test_invert_undoes_sample(m):
    for u in EXTREME + squares(200, seed=2):
        w = m.sample(u)
        u1, u2 = m.invert(w)
        assert abs(u1 - u[0]) <= ROUNDING * (1.0 + m.slope)
        assert 0.0 <= u2 < 1.0
        sine = length(cross(axis_of(m), w))
        turns = abs(u2 - u[1])
        assert min(turns, 1.0 - turns) <= ROUNDING * (1.0 + 1.0 / (2.0 * PI * max(sine, 1e-300)))


@pytest.mark.parametrize("m", MAPS, ids=repr)
def test_pdf_is_one_over_the_jacobian(m):
    h = 1e-5
    for u1 in np.linspace(0.1, 0.9, 9):
        for u2 in np.linspace(0.05, 0.95, 7):
            along = (array(m.sample((u1 + h, u2))) - array(m.sample((u1 - h, u2)))) / (2 * h)
            across = (array(m.sample((u1, u2 + h))) - array(m.sample((u1, u2 - h)))) / (2 * h)
            jacobian = np.linalg.norm(np.cross(along, across))
            # truncation: h^2 (2 pi)^2 / 6 around, at most h^2 / (8 u^2) along; rounding: ROUNDING / h of either
            bound = h * h * (7.0 + 13.0) + ROUNDING / h * (1 / np.linalg.norm(along) + 1 / np.linalg.norm(across))
            assert abs(m.pdf(m.sample((u1, u2))) * jacobian - 1.0) <= bound


@pytest.mark.parametrize("m", MAPS, ids=repr)
def test_pdf_integrates_to_one(m):
    """Gauss-Legendre over theta, times five azimuths."""
    total = 0.0
    reach = math.acos(max(m.lowest, -1.0))
    cuts = np.linspace(0.0, 1.0, 9) ** 2 * reach  # the narrowest lobe, n = 1000, is as wide as the first piece
    for theta, weight in zip(*composite(16, cuts), strict=True):
        sine, cosine = math.sin(theta), math.cos(theta)
        for phi in 2.0 * PI * (np.arange(5) + 0.3) / 5:
            w = around(axis_of(m), sine * math.cos(phi), sine * math.sin(phi), cosine)
            total += m.pdf(w) * weight * sine * 2.0 * PI / 5
    exponent = float(m.name.split()[1]) if "phong" in m.name else 1.0
    assert total == pytest.approx(1.0, abs=1e-12 + exponent * ROUNDING)


@pytest.mark.parametrize("m", MAPS, ids=repr)
def test_pdf_is_zero_where_nothing_is_sampled(m):
    if m.name == "sphere":
        assert m.pdf(AXIS) == pytest.approx(0.25 / PI, rel=U53)
        return
    beyond = math.acos(m.lowest) + 1e-3
    for theta in (beyond, 2.5, PI):
        assert m.pdf(around(AXIS, math.sin(theta), 0.0, math.cos(theta))) == 0.0


@pytest.mark.parametrize("m", MAPS, ids=repr)
def test_samples_have_the_distribution_that_the_pdf_claims(m):
    n, rings, sectors = size(20_000, 4_000), size(8, 4), size(16, 6)
    axis = axis_of(m)
    a, b = array(around(axis, 1, 0, 0)), array(around(axis, 0, 1, 0))
    w = np.array([[*m.sample(u)] for u in squares(n, seed=3)])
    ring = np.clip(m.cdf(np.clip(w @ array(axis), m.lowest, 1.0)), 0.0, 1.0)
    sector = np.arctan2(w @ b, w @ a)
    counts, *_ = np.histogram2d(ring, sector, bins=(rings, sectors), range=[[0, 1], [-PI, PI]])
    assert chi_square_p(counts, np.full(rings * sectors, n / rings / sectors)) > ALPHA


@pytest.mark.parametrize("m", [*MAPS, phong(1e7), cone(1e-8), cone(1e-6)], ids=repr)
def test_a_sample_has_a_positive_finite_pdf(m):
    """u1 = 0 and 1 - 2^-53 may lie on the edge, where the density of a lobe or of the horizon is truly zero."""
    edge = 1e-12 if "phong" in m.name or "hemisphere" in m.name else 0.0
    for u in [*EXTREME, (1.0 - 1e-9, 0.3), (1e-9, 0.6)]:
        p = m.pdf(m.sample(u))
        assert math.isfinite(p)
        assert p > 0.0 or min(u[0], 1.0 - u[0]) < edge


# --- disk and triangle ---


def test_the_disk():
    n, rings, sectors = size(20_000, 4_000), size(8, 4), size(16, 6)
    for u in EXTREME + squares(200):
        x, y = s.sample_disk(u)
        u1, u2 = s.invert_disk(x, y)
        assert abs(u1 - u[0]) <= ROUNDING
        turns = abs(u2 - u[1])
        assert min(turns, 1.0 - turns) <= ROUNDING or u[0] == 0.0
    p = np.array([s.sample_disk(u) for u in squares(n, seed=4)])
    counts, *_ = np.histogram2d((p**2).sum(axis=1), np.arctan2(*p.T), bins=(rings, sectors), range=[[0, 1], [-PI, PI]])
    assert chi_square_p(counts, np.full(rings * sectors, n / rings / sectors)) > ALPHA
    assert s.pdf_disk(0.6, 0.8) == s.pdf_disk(0.0, 0.0) == 1.0 / PI
    assert s.pdf_disk(0.7, 0.8) == 0.0


SERIES = 2.0**-37  # what sin_cos_eighth leaves out


def test_sin_and_cos_by_their_series():
    for t in np.linspace(-1.5, 1.5, 241):
        sine, cosine = s.sin_cos_turns(t)
        assert abs(sine - math.sin(2 * math.pi * t)) <= SERIES
        assert abs(cosine - math.cos(2 * math.pi * t)) <= SERIES


def test_the_concentric_disk():
    """Squares become circles: |r| = max(|2 u1 - 1|, |2 u2 - 1|); each quarter of the square stays a quarter."""
    n, rings, sectors = size(20_000, 4_000), size(8, 4), size(16, 6)
    for u in EXTREME + squares(200):
        x, y = s.sample_concentric_disk(u)
        a, b = 2 * u[0] - 1, 2 * u[1] - 1
        assert abs(math.hypot(x, y) - max(abs(a), abs(b))) <= SERIES
        assert x * a >= -ROUNDING
        assert y * b >= -ROUNDING
        assert s.invert_concentric_disk(x, y) == pytest.approx(u, abs=2 * SERIES)
    p = np.array([s.sample_concentric_disk(u) for u in squares(n, seed=6)])
    counts, *_ = np.histogram2d((p**2).sum(axis=1), np.arctan2(*p.T), bins=(rings, sectors), range=[[0, 1], [-PI, PI]])
    assert chi_square_p(counts, np.full(rings * sectors, n / rings / sectors)) > ALPHA
    assert s.pdf_concentric_disk(0.6, 0.8) == 1.0 / PI
    assert s.pdf_concentric_disk(0.7, 0.8) == 0.0


def test_the_triangle():
    n, side = size(20_000, 3_600), size(12, 6)
    for u in EXTREME + squares(200):
        b1, b2 = s.sample_triangle(u)
        assert min(b1, b2) >= 0.0
        assert b1 + b2 <= 1.0 + U53
        u1, u2 = s.invert_triangle(b1, b2)
        assert abs(u1 - u[0]) <= ROUNDING
        assert abs(u2 - u[1]) <= ROUNDING or u[0] == 0.0
    b = np.array([s.sample_triangle(u) for u in squares(n, seed=5)])
    # Uniform in the triangle: (1 - b1)^2 and b2 / (1 - b1) are uniform and independent (another vertex than the map's).
    counts, *_ = np.histogram2d((1 - b[:, 0]) ** 2, b[:, 1] / (1 - b[:, 0]), bins=side, range=[[0, 1], [0, 1]])
    assert chi_square_p(counts, np.full(side**2, n / side**2)) > ALPHA
    assert s.pdf_triangle(0.25, 0.5) == 2.0
    assert s.pdf_triangle(0.5, 0.75) == s.pdf_triangle(-0.1, 0.5) == s.pdf_triangle(0.5, -0.1) == 0.0


@pytest.mark.parametrize(("sample", "density"), [(s.sample_disk, 1.0 / PI), (s.sample_triangle, 2.0)])
def test_area_maps_have_the_jacobian_of_their_density(sample, density):
    h = 1e-5
    for u1 in np.linspace(0.1, 0.9, 5):
        for u2 in np.linspace(0.05, 0.95, 5):
            along = np.subtract(sample((u1 + h, u2)), sample((u1 - h, u2))) / (2 * h)
            across = np.subtract(sample((u1, u2 + h)), sample((u1, u2 - h))) / (2 * h)
            assert abs(abs(np.linalg.det([along, across])) * density - 1.0) <= 20 * h * h + ROUNDING / h * 10


# --- extremes, against fifty digits ---

Z = Vec3(0.0, 0.0, 1.0)  # frame(Z) is the identity, so nothing but the map itself rounds


@pytest.mark.parametrize("n", [1.0, 1e3, 1e5, 1e7])
@pytest.mark.parametrize("u", [FIRST, 1e-9, 0.3, 0.9, LAST])
def test_narrow_lobes_are_sampled_to_the_last_digits(n, u):  # C02
    with mpmath.workdps(50):
        cosine = (1 - mpmath.mpf(u)) ** (1 / (mpmath.mpf(n) + 1))
        w = s.sample_phong_lobe(Z, n, (u, 0.0))
        assert float(abs(w.x / mpmath.sqrt(1 - cosine**2) - 1)) <= 1e-14
        assert float(abs(w.z / cosine - 1)) <= 4 * U53 if cosine > 0.1 else w.z < 0.2


@pytest.mark.parametrize("n", [1e3, 1e5, 1e7])
def test_narrow_lobes_are_evaluated_to_the_last_digits(n):  # C01
    with mpmath.workdps(50):
        sine = 1.0 / math.sqrt(n)
        w = Vec3(sine, 0.0, math.sqrt((1.0 - sine) * (1.0 + sine)))
        cosine = mpmath.sqrt(1 - mpmath.mpf(sine) ** 2)
        assert float(abs(s.cos_power(Z, n, w) / cosine ** mpmath.mpf(n) - 1)) <= 1e-13
        density = (n + 1) / (2 * mpmath.pi) * cosine ** mpmath.mpf(n)
        assert float(abs(s.pdf_phong_lobe(Z, n, w) / density - 1)) <= 1e-13


def test_far_from_a_narrow_lobe_the_density_is_zero():  # C04
    assert s.pdf_phong_lobe(Z, 1e7, unit(math.sqrt(3.0), 0.0, 1.0)) == 0.0
    assert s.cos_power(Z, 1e7, -Z) == 0.0


@pytest.mark.parametrize(("n", "want"), [(0.0, 1.0), (5.0, 0.0)])
def test_a_lobe_at_a_right_angle(n, want):
    """cos = 1e-9: sin^2 rounds to 1, cos^n is 1 for n = 0 and below 1e-44 for n = 5."""
    w = unit(1.0, 0.0, 1e-9)
    assert s.cos_power(Z, n, w) == pytest.approx(want, abs=1e-44)
    u1, _ = s.invert_phong_lobe(Z, n, w)
    assert u1 == pytest.approx(1.0, abs=2e-9)


@pytest.mark.parametrize("sin_max", [1e-3, 1e-4, 1e-6, 1e-8])
def test_small_cones_are_exact(sin_max):  # B01, B02
    with mpmath.workdps(50):
        cap = 1 - mpmath.sqrt(1 - mpmath.mpf(sin_max) ** 2)
        assert float(abs(s.one_minus_cos(sin_max) / cap - 1)) <= 4 * U53
        assert float(abs(s.pdf_cone(Z, sin_max, Z) * 2 * mpmath.pi * cap - 1)) <= 6 * U53
        for u in (FIRST, 0.3, LAST):
            cosine = 1 - mpmath.mpf(u) * cap
            w = s.sample_cone(Z, sin_max, (u, 0.0))
            assert float(abs(w.x / mpmath.sqrt(1 - cosine**2) - 1)) <= 1e-15


def test_the_solid_angle_of_a_small_sphere():
    # B01: s = 2^-20, 2.8572618735693209e-12 sr (fifty-digit arithmetic)
    assert 1.0 / s.pdf_cone(Z, 2.0**-20, Z) == pytest.approx(2.8572618735693209e-12, rel=6 * U53)


# --- frames and turns ---

NORMALS = [
    Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0.0), Vec3(0, -1, -0.0), unit(6e-3, 8e-3, -0.99995), unit(1e-9, 0, -1),
    unit(1e-200, 1e-200, -1), AXIS, unit(-1, 2, -3), unit(1, 1, 1e-17), unit(1, 1, -1e-17),
]  # fmt: skip


@pytest.mark.parametrize("n", NORMALS, ids=repr)
def test_frames_are_orthonormal_and_right_handed(n):  # C11, C12
    a, b = s.frame(n)
    matrix = np.array([[*a], [*b], [*n]])
    assert np.abs(matrix @ matrix.T - np.eye(3)).max() <= 8 * U53  # 4 u, u = 2^-52
    assert np.linalg.det(matrix) == pytest.approx(1.0, abs=ROUNDING)
    w = s.from_frame(n, 0.1, 0.2, 0.3)
    assert np.abs(matrix @ array(w) - [0.1, 0.2, 0.3]).max() <= ROUNDING


TURNS = [(0.0, 1.0, 0.0), (1.0, 0.0, 0.25), (0.0, -1.0, 0.5), (-1.0, 0.0, 0.75)]


@pytest.mark.parametrize(("y", "x", "want"), [*TURNS, (-0.0, 1.0, 0.0), (-1e-20, 1.0, 0.0), (0.0, 0.0, 0.0)])
def test_a_turn_lies_below_one(y, x, want):  # D07
    assert s.turn(y, x) == want
