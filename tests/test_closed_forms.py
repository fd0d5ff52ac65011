"""Every closed form against adaptive quadrature that shares nothing with it, and against published numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import integrate

from raylab.closed_forms import irradiance as forms
from raylab.closed_forms import phong, variances
from raylab.ladders import frame

Z = np.array([0.0, 0.0, 1.0])
TRIANGLE = np.array([(-0.3, -0.5, 0.6), (0.9, -0.1, 1.1), (0.1, 0.8, 0.7)])
CENTRED = np.array([(-1, -0.5, 1), (1, -0.5, 1), (1, 0.5, 1), (-1, 0.5, 1.0)])
LOW = np.array([(-1, -0.5, 0.7), (1, -0.5, 0.7), (1, 0.9, 0.7), (-1, 0.9, 0.7)])
UPRIGHT = np.array([(0.7, -0.5, -0.8), (0.7, 0.5, -0.8), (0.7, 0.5, 0.6), (0.7, -0.5, 0.6)])
EDGE = forms.behind_edge((0.0, 0.0, 0.0), (0.1, 0.0, 0.5), (0.1, 1.0, 0.5), (-1.0, 0.0, 1.0))
N = np.array([0.48, 0.6, 0.64])
ROUNDING = 64 * 2.0**-53  # of some sixty operations


def agrees(value: float, integral: tuple[float, float]) -> bool:
    """Whether a closed form and an integral differ by no more than the error that the quadrature reports."""
    expected, error = integral
    return bool(abs(value - expected) <= 4.0 * error + ROUNDING * abs(expected))


# --- quadrature, by other coordinates than the closed forms ---


def over_polygon(corners, n, weight=lambda w: 1.0):
    """Integral of weight(w) max(0, n . w) |n_y . w| / r^2 over a triangle or a parallelogram with these corners."""
    p, e1, e2 = corners[0], corners[1] - corners[0], corners[-1] - corners[0]
    normal = np.cross(e1, e2)

    def element(v, u):
        y = p + u * e1 + v * e2
        r2 = y @ y
        w = y / math.sqrt(r2)
        return weight(w) * max(0.0, n @ w) * abs(normal @ w) / r2

    last = (lambda u: 1.0 - u) if len(corners) == 3 else (lambda u: 1.0)
    return integrate.dblquad(element, 0.0, 1.0, 0.0, last, epsabs=1e-9, epsrel=1e-9)


def over_cone(half_angle, function, first=0.0):
    """Integral of function(theta, phi) d sigma between two angles from +z."""
    return integrate.dblquad(
        lambda phi, t: function(t, phi) * math.sin(t),
        first,
        half_angle,
        0.0,
        2.0 * math.pi,
        epsabs=1e-10,
        epsrel=1e-10,
    )


def over_disk(radius, element):
    return integrate.dblquad(
        lambda phi, r: element(r * math.cos(phi), r * math.sin(phi)) * r, 0.0, radius, 0.0, 2.0 * math.pi
    )


# --- polygons ---


@pytest.mark.parametrize("n", [Z, N, np.array([0.6, 0.0, 0.8])], ids=["up", "oblique", "tilted"])
@pytest.mark.parametrize(
    "corners", [TRIANGLE, CENTRED, LOW, UPRIGHT], ids=["triangle", "centred", "low", "through the horizon"]
)
def test_polygon_is_the_integral_over_its_area(corners, n):
    assert agrees(forms.polygon(corners, n=n), over_polygon(corners, n))


def test_polygon_takes_many_receivers_and_any_place():
    shift = np.array([3.0, -1.0, 2.0])
    x, n = np.array([shift, shift, shift]), np.array([Z, N, Z])
    expected = [forms.polygon(LOW, n=m, keep=[EDGE]) for m in n]
    normal, offset = EDGE
    np.testing.assert_allclose(
        forms.polygon(LOW + shift, x, n, [(normal, offset + normal @ shift)]), expected, rtol=1e-13
    )


def test_polygon_below_the_horizon_gives_nothing():
    assert forms.polygon(CENTRED, n=-Z) == 0.0
    assert forms.polygon(CENTRED, keep=[((0.0, 0.0, 1.0), 2.0)]) == 0.0


def test_polygon_behind_an_edge_is_the_rest_of_the_rectangle():
    visible = CENTRED.copy()
    visible[1:3, 0] = 0.2
    assert agrees(forms.polygon(CENTRED, keep=[EDGE]), over_polygon(visible, Z))


def test_polygon_does_not_depend_on_order_or_first_corner():
    expected = forms.polygon(UPRIGHT, n=N)
    for corners in (
        UPRIGHT[::-1],
        np.roll(UPRIGHT, 1, axis=0),
        np.roll(UPRIGHT, 2, axis=0),
        np.roll(UPRIGHT, 3, axis=0),
    ):
        np.testing.assert_allclose(forms.polygon(corners, n=N), expected, rtol=1e-14)


def test_polygon_of_a_tiny_light_does_not_cancel():
    """A square of edge 2^-14 with its corner at (1/4, 1/8, 1): 3.2048185549430369e-9, computed with 50 digits."""
    for size, exact in ((2.0**-7, None), (2.0**-10, None), (2.0**-14, 3.2048185549430369e-9)):
        corners = np.array([0.25, 0.125, 1.0]) + size * np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0.0)])
        expected = over_polygon(corners, Z)[0] if exact is None else exact
        assert abs(forms.polygon(corners) / expected - 1.0) <= 64.0 * 2.0**-53  # some thirty roundings on either side


def test_polygon_has_no_step_where_it_changes_its_formula():
    """Just below and above SMALL of the distance: Lambert's sum cancels to 8 * 2^-53 / size^2 there."""
    for size in (0.019, 0.021):
        corners = np.array([0.0, 0.0, math.sqrt(2.0)]) + size * np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0.0)])
        small = size * math.sqrt(2.0) < forms.SMALL * np.linalg.norm(corners[0])
        assert small == (size < 0.02)
        assert abs(forms.polygon(corners) / over_polygon(corners, Z)[0] - 1.0) <= 8.0 * 2.0**-53 / size**2


def test_rectangle_formulas_are_polygons():
    parallel = np.array([(0, 0, 1.5), (1, 0, 1.5), (1, 2, 1.5), (0, 2, 1.5)])
    upright = np.array([(0.7, 0, 0), (0.7, 2, 0), (0.7, 2, 1), (0.7, 0, 1.0)])
    assert forms.rectangle_parallel(1.0, 2.0, 1.5) == pytest.approx(forms.polygon(parallel), rel=1e-14)
    assert forms.rectangle_perpendicular(1.0, 2.0, 0.7) == pytest.approx(forms.polygon(upright), rel=1e-14)


# --- disks, spheres, skies ---


def test_disks_are_integrals_over_their_area():
    assert agrees(forms.disk_coaxial(1.5, 1.0), over_disk(1.5, lambda a, b: 1.0 / (1.0 + a * a + b * b) ** 2))
    assert forms.disk_parallel(0.8, 1.0, 0.0) == pytest.approx(forms.disk_coaxial(0.8, 1.0), rel=1e-14)
    assert agrees(
        forms.disk_parallel(0.8, 1.0, 0.6),
        over_disk(0.8, lambda a, b: 1.0 / (1.0 + (a + 0.6) ** 2 + b * b) ** 2),
    )
    upright = over_disk(0.8, lambda a, b: (1.2 + a) / (1.0 + (1.2 + a) ** 2 + b * b) ** 2)
    assert agrees(forms.disk_perpendicular(0.8, 1.0, 1.2), upright)


@pytest.mark.parametrize("cosine", [1.0, 0.8, 0.41, 0.4, 0.2, 0.0, -0.2, -0.39, -0.4, -0.7])
def test_sphere_is_the_integral_over_its_cone(cosine):
    sine = math.sqrt(1.0 - cosine**2)
    cone = over_cone(
        math.asin(1.0 / 2.5),
        lambda t, phi: max(0.0, cosine * math.cos(t) + sine * math.sin(t) * math.cos(phi)),
    )
    value = float(forms.sphere(1.0, 2.5, cosine))
    assert agrees(value, cone)
    assert float(forms.sphere_before_sky(1.0, 2.5, cosine)) == pytest.approx(math.pi - value, rel=1e-15)


def test_skies_are_integrals_over_the_hemisphere():
    half = 0.5 * math.pi
    b = np.array([0.3, -0.2, 0.5])
    s, t, n = frame(N)

    def gradient(theta, phi):
        w = math.sin(theta) * (math.cos(phi) * s + math.sin(phi) * t) + math.cos(theta) * n
        return (1.1 + b @ w) * math.cos(theta)

    assert agrees(forms.constant_sky(), over_cone(half, lambda t, phi: math.cos(t)))
    assert agrees(float(forms.gradient_sky(1.1, b, N)), over_cone(half, gradient))
    assert agrees(forms.overcast_sky(), over_cone(half, lambda t, phi: (1.0 + 2.0 * math.cos(t)) / 3.0 * math.cos(t)))
    assert agrees(forms.cap_sky(0.4), over_cone(0.4, lambda t, phi: math.cos(t)))


def test_texels_are_integrals_over_their_cells():
    v, solid_angle = forms.texels(64, 128)
    theta, phi = np.pi * np.array([10, 11]) / 64, 2.0 * np.pi * np.array([37, 38]) / 128

    def cell(function):
        return integrate.dblquad(lambda f, t: function(t, f) * math.sin(t), *theta, *phi, epsabs=1e-12)

    assert agrees(solid_angle[10, 37], cell(lambda t, f: 1.0))
    assert agrees(v[10, 37, 0], cell(lambda t, f: math.sin(t) * math.cos(f)))
    assert agrees(v[10, 37, 1], cell(lambda t, f: math.sin(t) * math.sin(f)))
    assert agrees(v[10, 37, 2], cell(lambda t, f: math.cos(t)))
    assert solid_angle.sum() == pytest.approx(4.0 * math.pi, rel=1e-13)


# --- Phong ---


@pytest.mark.parametrize("cosine", [0.3, 0.6, 1.0])
@pytest.mark.parametrize("n", [0, 1, 2, 5, 10, 20])
def test_lune_moments_are_integrals_around_the_mirror_direction(n, cosine):
    """In polar coordinates around r, cut where the horizon of N begins to show."""
    sine = math.sqrt(1.0 - cosine**2)

    def integral(weight):
        def element(phi, t):
            z = cosine * math.cos(t) + sine * math.sin(t) * math.cos(phi)
            return weight(z) * math.cos(t) ** n * math.sin(t)

        def reach(t):  # where N . w = 0; symmetric in phi
            return math.acos(max(-1.0, -cosine / (sine * math.tan(t)))) if sine * math.tan(t) > cosine else math.pi

        edge = math.pi / 2.0 - math.acos(cosine)
        parts = [integrate.dblquad(element, a, b, 0.0, reach) for a, b in ((0.0, edge), (edge, math.pi / 2.0)) if b > a]
        return 2.0 * sum(p[0] for p in parts), 2.0 * sum(p[1] for p in parts) + 1e-8

    single, double = phong.lune_moments(n, cosine)
    assert agrees(single, integral(lambda z: 1.0))
    assert agrees(double, integral(lambda z: z))


@pytest.mark.parametrize("n", [1, 10, 50])
def test_a_phong_lobe_around_the_normal_reflects_everything(n):
    assert phong.constant_sky(n, 1.0) == pytest.approx(1.0, rel=1e-12)
    assert agrees(
        phong.gradient_sky(n, 1.1, 0.5),
        integrate.quad(lambda z: (n + 2) * z ** (n + 1) * (1.1 + 0.5 * z), 0.0, 1.0),
    )


@pytest.mark.parametrize("n", [0, 1, 2, 7, 20])
@pytest.mark.parametrize("r", [(0.36, 0.48, 0.8), (0.8, 0.0, 0.6), (-0.6, 0.0, 0.8)])
def test_polygon_moments_are_integrals_over_the_area(n, r):
    r = np.array(r)
    _, double = phong.polygon_moments(TRIANGLE, n, r)
    assert agrees(double, over_polygon(TRIANGLE, Z, lambda w: max(0.0, r @ w) ** n))
    assert phong.polygon_moments(TRIANGLE[::-1], n, r)[1] == pytest.approx(double, rel=1e-12)


def test_polygon_moments_clip_at_both_horizons():
    r = np.array([0.6, 0.0, -0.8])  # the lobe of a grazing view reaches below the surface
    exact = over_polygon(UPRIGHT, Z, lambda w: max(0.0, r @ w) ** 3)
    assert agrees(phong.polygon_moments(UPRIGHT, 3, r)[1], exact)
    assert phong.polygon_moments(CENTRED, 3, -Z) == (0.0, 0.0)


# --- variances: integral of f^2 / p minus the square of the mean, in z = cos(theta) ---


def variance(f, p, low=0.0):
    """f(z) is 2 x the integrand of the mean, since d sigma / pi = 2 dz; p(z) the density of z."""
    mean, _ = integrate.quad(f, low, 1.0)
    square, error = integrate.quad(lambda z: f(z) ** 2 / p(z), low, 1.0)
    return square - mean**2, error


def test_variances_are_integrals():
    a, b, angle = 1.1, 0.7, math.radians(20.0)
    c = math.cos(angle)

    def gradient(z):
        return 2.0 * (a + b * z) * z

    def lobe(z):
        return 22.0 * z**21

    cases = [
        (variances.env_uniform_gradient(a, b), variance(gradient, lambda z: 1.0)),
        (variances.env_cosine_gradient(b), variance(gradient, lambda z: 2.0 * z)),
        (variances.env_brightness_gradient(a, b), variance(gradient, lambda z: (a + b * z) / (a + b / 2.0))),
        (
            variances.env_brightness_gradient_sphere(a, b),
            variance(gradient, lambda z: (a + b * z) / (2.0 * a)),
        ),
        (variances.env_uniform_cap(angle), variance(lambda z: 2.0 * z, lambda z: 1.0, c)),
        (variances.env_cosine_cap(angle), variance(lambda z: 2.0 * z, lambda z: 2.0 * z, c)),
        (variances.cone_cap(angle), variance(lambda z: 2.0 * z, lambda z: 1.0 / (1.0 - c), c)),
        (variances.phong_brdf(20), variance(lobe, lambda z: 21.0 * z**20)),
        (variances.phong_uniform(20), variance(lobe, lambda z: 1.0)),
        (variances.phong_cosine(20), variance(lobe, lambda z: 2.0 * z)),
        (
            variances.area_disk(3.0, 1.0),
            variance(lambda z: 2.0 * z, lambda z: 2.0 / (9.0 * z**3), 1.0 / math.sqrt(10.0)),
        ),
    ]
    for value, (expected, error) in cases:
        assert abs(value - expected) <= 4.0 * error + 1e-13, (value, expected)


@pytest.mark.parametrize("height", [1e-1, 1e-2, 1e-3])
def test_a_near_disk_has_the_variance_of_its_limit(height):
    """Relative variance R^2 / (3 h^2), the next term of the series being -1/3."""
    mean = forms.disk_coaxial(1.0, height) / math.pi
    assert variances.area_disk(1.0, height) / mean**2 * 3.0 * height**2 == pytest.approx(1.0, rel=1.5 * height**2)


# --- published numbers ---

TABLE = [  # name, value, the digits printed in the project's table of closed forms
    ("P1", lambda: forms.polygon(TRIANGLE), "0.715161708337"),
    ("P2", lambda: forms.rectangle_parallel(1.0, 2.0, 1.5), "0.384404214111"),
    ("P2b", lambda: 4.0 * forms.rectangle_parallel(1.0, 0.5, 1.0), "1.1332902241"),
    ("P3", lambda: forms.rectangle_perpendicular(1.0, 2.0, 0.7), "0.323787105037"),
    ("P5", lambda: forms.polygon(LOW, n=(0.6, 0.0, 0.8)), "1.52641851858"),
    ("P6", lambda: forms.polygon(LOW, n=(0.6, 0.48, 0.64)), "1.35966030484"),
    ("P7", lambda: forms.polygon(CENTRED, keep=[EDGE]), "0.735207288657"),
    ("P8", lambda: forms.polygon(CENTRED, keep=[((-0.8, -0.6, 0.25), 0.0)]), "0.807062335515"),
    ("horizon", lambda: forms.polygon(UPRIGHT), "0.242950211429"),
    ("D1", lambda: forms.disk_coaxial(1.5, 1.0), "2.17494876018"),
    ("D2", lambda: forms.disk_parallel(0.8, 1.0, 0.6), "0.926196999"),
    ("D3", lambda: forms.disk_perpendicular(0.8, 1.0, 1.2), "0.365079756464"),
    ("S1", lambda: forms.sphere(1.0, 2.5, 0.8), "0.402123859659"),
    ("S2", lambda: forms.sphere(1.0, 2.5, 0.2), "0.109716687599"),
    ("S3", lambda: forms.sphere(1.0, 2.5, -0.2), "0.00918572268391"),
    ("S4", lambda: forms.sphere(1.0, 2.5, 0.0), "0.044910790471"),
    ("S5", lambda: forms.sphere_before_sky(1.0, 2.5, 0.8), "2.73946879393"),
    ("E2", lambda: forms.gradient_sky(1.1, (0.3, -0.2, 0.5), N), "4.17622383417"),
    ("E3", forms.overcast_sky, "2.44346095279"),
    ("E4", lambda: forms.cap_sky(math.radians(25.0)), "0.56110791059"),
    ("E6", lambda: forms.texels(64, 128)[0][10, 37, 2], "0.00103296420808"),
    ("E6c", lambda: forms.texels(64, 128)[1][10, 37], "0.00118755414329"),
    ("F2", lambda: phong.lune_moments(2, 0.6)[0], "1.79619829039"),
    ("F3", lambda: phong.lune_moments(10, 0.6)[1], "0.314925391736"),
    ("F4", lambda: phong.gradient_sky(10, 1.1, 0.5), "1.56153846154"),
    ("F5", lambda: phong.polygon_moments(TRIANGLE, 7, (0.36, 0.48, 0.8))[1], "0.25444272273"),
    ("M(.3)", lambda: phong.constant_sky(10, 0.3), "0.325269419696"),
    ("V2", lambda: variances.env_uniform_gradient(1.0, 1.0), "1.35555555556"),
    ("V4", lambda: variances.env_brightness_gradient(1.0, 1.0), "0.722222222222"),
    ("V5", lambda: variances.area_disk(3.0, 1.0), "2.187"),
    ("V6", lambda: variances.env_uniform_cap(math.radians(20.0)), "0.213290245232"),
    ("V8", lambda: variances.cone_cap(math.radians(20.0)), "4.40920781024e-06"),
    ("V10b", lambda: variances.phong_cosine(20), "4.7619047619"),
    ("S1 near a sphere", lambda: forms.sphere(1.0, 1.001, 1.0), "3.13532"),
    ("S2 wall, 2^-3", lambda: 2.0 * forms.rectangle_perpendicular(2.0, 1.0, 2.0**-3), "1.4175683986682410"),
    ("S2 wall, 2^-7", lambda: 2.0 * forms.rectangle_perpendicular(2.0, 1.0, 2.0**-7), "1.5611728880004733"),
    ("S2 wall, 2^-10", lambda: 2.0 * forms.rectangle_perpendicular(2.0, 1.0, 2.0**-10), "1.5695933742215258"),
    ("albedo of a lobe, 60 degrees", lambda: phong.constant_sky(100, 0.5), "0.5000"),
    ("albedo of a lobe, 85 degrees", lambda: phong.constant_sky(100, math.cos(math.radians(85.0))), "0.09761"),
    ("albedo of a lobe, 90 degrees", lambda: phong.constant_sky(100, 0.0), "0.03979"),
    ("CS667 sphere, normal", lambda: 0.5 / math.pi * 20.0 * forms.sphere(1.0, 5.0, 1.0), "0.4"),
    ("CS667 sphere, grazing", lambda: 0.5 / math.pi * 200.0 * forms.sphere(1.0, 5.0, 0.0), "0.171847"),
]


@pytest.mark.parametrize(("value", "digits"), [row[1:] for row in TABLE], ids=[row[0] for row in TABLE])
def test_published_number(value, digits):
    mantissa, _, exponent = digits.partition("e")
    unit = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))  # of the last digit printed
    assert abs(float(value()) - float(digits)) <= max(0.51 * unit, ROUNDING * float(digits))


def test_published_number_of_the_cs667_triangle():
    """Its light has four digits, (+-.8660, 5, -.5); with cos 30 degrees it would be 0.162168."""
    light = [(0.0, 1.0, 5.0), (-0.8660, -0.5, 5.0), (0.8660, -0.5, 5.0)]
    assert abs(0.5 / math.pi * 20.0 * forms.polygon(light) - 0.162163) <= 0.51e-6
