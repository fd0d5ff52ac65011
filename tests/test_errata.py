"""docs/errata.md: every number of what goes wrong when a slide is copied, computed again; every row has one."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from scipy import integrate

from raylab import glossy, ladders
from raylab.brdf import reflect
from raylab.closed_forms import irradiance, phong, variances
from raylab.figures import errata, registry
from raylab.sampling import pdf_phong_lobe
from raylab.vec3 import Vec3

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "docs" / "errata.md").read_text()
ROWS = [line.replace("\\|", "!") for line in TEXT.splitlines() if line.startswith("| ")][1:]
X, Z = np.zeros(3), np.array([0.0, 0.0, 1.0])


def numbers(words: str) -> set[str]:
    """The numbers in the last column of the one row with `words` in its first columns."""
    (row,) = (row.split("|") for row in ROWS if words in " ".join(row.split("|")[1:4]))
    return set(re.findall(r"-?\d+(?:\.\d+)?", row[5]))


@pytest.mark.parametrize("row", ROWS)
def test_every_row_has_a_number(row):
    assert re.search(r"\d\.\d|\d{3}", row.split("|")[5])


def test_every_picture_is_shown():
    linked = set(re.findall(r"figures/(\w+)\.png", TEXT))
    assert linked == {name for name in registry.all_figures() if name.startswith("errata_")}


# The upright rectangle x = 0.7, y in [-0.5, 0.5], z in [-0.8, 0.6], which faces the receiver at the origin.
UPRIGHT = np.array([(0.7, -0.5, -0.8), (0.7, 0.5, -0.8), (0.7, 0.5, 0.6), (0.7, -0.5, 0.6)])


def upright(product):
    """Irradiance of the upright rectangle with a product of two cosines as given, in pieces above and below."""

    def element(y, z):
        r2 = 0.49 + y * y + z * z
        return product(z / math.sqrt(r2), 0.7 / math.sqrt(r2)) / r2

    pieces = [integrate.dblquad(element, *ends, -0.5, 0.5, epsabs=1e-10)[0] for ends in ((-0.8, 0.0), (0.0, 0.6))]
    return sum(pieces)


def test_slide_cosines_unclamped():
    right = float(irradiance.polygon(UPRIGHT))
    assert upright(lambda a, b: max(0.0, a) * max(0.0, b)) == pytest.approx(right, abs=1e-9)
    assert {f"{upright(lambda a, b: a * b):.4f}", f"{right:.4f}"} <= numbers("`dot(L, N) * dot(-L, light.normal)`")


def test_slide_cosines_absolute():
    wrong, right = upright(lambda a, b: abs(a) * abs(b)), float(irradiance.polygon(UPRIGHT))
    assert {f"{wrong:.4f}", f"{right:.4f}"} <= numbers("!n_x . w!")


def test_slide_one_normal_for_a_light():
    """The part of a sphere that is seen from below, u = cos of the angle from its lowest point, with normal -z.

    dA = 2 pi R^2 du, r^2 = d^2 + R^2 - 2 d R u, and both cosines are (d - R u) / r.
    """
    R, distance = 0.5, 1.5

    def element(u, cos_y):
        r2 = distance**2 + R**2 - 2.0 * distance * R * u
        cos_x = (distance - R * u) / math.sqrt(r2)
        return 2.0 * math.pi * R * R * cos_x * cos_y(u, cos_x, math.sqrt(r2)) / r2

    right, _ = integrate.quad(element, R / distance, 1.0, (lambda u, c, r: (distance * u - R) / r,))
    assert right == pytest.approx(float(irradiance.sphere(R, distance, 1.0)), rel=1e-10)
    wrong, _ = integrate.quad(element, R / distance, 1.0, (lambda u, c, r: c,))
    assert {f"{wrong / right:.2f}"} <= numbers("one normal for each light")
    assert f"{wrong / right:.2f}" in registry.all_figures()["errata_light_normal"].caption


def test_slide_without_an_equals_sign():
    """E g^2 = variance + mean^2 of g for the 2 by 1 rectangle at height 1, by quadrature."""
    y, n_y, weights = ladders.area_parts((-1.0, -0.5, 1.0), (0.0, 1.0, 0.0), (2.0, 0.0, 0.0), 400)
    g = ladders.small_area_source(X, Z, y, n_y, 2.0, 1.0, 1.0)
    mean, square = (float((v * weights).sum() / 2.0) for v in (g, g * g))  # the sums' error is below 1e-5
    corners = np.array([(-1, -0.5, 1), (1, -0.5, 1), (1, 0.5, 1), (-1, 0.5, 1.0)])
    assert mean == pytest.approx(float(irradiance.polygon(corners)), abs=1e-5)
    assert {f"{square:.3f}", f"{mean:.3f}"} <= numbers("without a second")


def test_slide_captions_swapped():
    by_brightness, by_brdf = variances.env_brightness_gradient(1.0, 1.0), variances.env_cosine_gradient(1.0)
    assert {f"{by_brightness:.4f}", f"{by_brdf:.4f}"} <= numbers('captions "sampling by BRDF"')


def test_slide_sample_without_v():
    V = Vec3(-math.sqrt(0.75), 0.0, 0.5)
    N = Vec3(*Z)
    R = reflect(V, N)
    times = pdf_phong_lobe(R, 20.0, R) / pdf_phong_lobe(reflect(N, N), 20.0, R)
    assert times == pytest.approx(2.0**20, rel=1e-12)
    assert {f"{2**20}"} <= numbers("`brdf.sample(N)`")


def test_slide_without_v_the_variance_is_infinite():
    """E g^2 = integral of (f_r cos)^2 / p: towards the horizon p falls like cos^20: each decade of angle adds more."""

    def decade(low, high):  # in the plane of incidence, where R is
        r = np.array([math.sqrt(0.75), 0.0, 0.5])

        def element(c):
            w = np.array([math.sqrt(1.0 - c * c), 0.0, c])
            return (w @ r) ** 40 * c * c / c**20

        return integrate.quad(element, low, high)[0]

    assert decade(1e-4, 1e-3) > 1e6 * decade(1e-3, 1e-2) > 1e12 * decade(1e-2, 1e-1)


def test_slide_lobe_below_the_horizon():
    """The share of p = (n + 1) / (2 pi) cos^n that is not over the lune above the horizon."""
    above = 21.0 / (2.0 * math.pi) * phong.lune_moments(20, math.cos(math.radians(85.0)))[0]
    assert {f"{100.0 * (1.0 - above):.1f}"} <= numbers("is followed by `dot(w, N)`")


def test_slide_environment_below_the_horizon():
    """L = 1 + w_z / 2 over the whole sphere: E = 2 pi times the integral of L z dz, and the share of samples below."""
    wrong, _ = integrate.quad(lambda z: 2.0 * math.pi * (1.0 + 0.5 * z) * z, -1.0, 1.0)
    below, _ = integrate.quad(lambda z: (1.0 + 0.5 * z) / 2.0, -1.0, 0.0)
    right = float(irradiance.gradient_sky(1.0, (0.0, 0.0, 0.5)))
    assert {f"{wrong:.3f}", f"{right:.3f}", f"{100.0 * below:.1f}"} <= numbers("`environment.sample(N)`")


def test_slide_p_proportional_to_f_r():
    assert variances.env_cosine_gradient(0.0) == 0.0
    assert {f"{variances.env_uniform_gradient(1.0, 0.0):.4f}"} <= numbers("p proportional to f_r")


def test_slide_shadow_of_a_point_and_of_a_direction():
    """A black ball of radius 1 at the distance 2.5, its centre at a cosine of 0.8: nothing of it within one unit."""
    right = float(irradiance.sphere_before_sky(1.0, 2.5, 0.8))
    assert {f"{irradiance.constant_sky():.3f}", f"{right:.3f}"} <= numbers("`shadow(x, y)` and")
    assert errata.ball_in_the_air().placement.scale == errata.UNIT


def test_slide_k_d_is_not_a_reflectance():
    right = ladders.environment(Z, 1.0, 0.5 / math.pi)
    wrong = ladders.environment(Z, 1.0, 0.5)
    assert right == pytest.approx(0.5, rel=1e-13)
    assert {f"{wrong / right:.3f}", f"{wrong:.3f}"} <= numbers("`k_d`")


def test_slide_jittered_normal_needs_another_exponent():
    """The bend of log p at R, for light and eye overhead, is that of Phong's lobe of exponent (20 - 1) / 4."""
    N, s = Vec3(*Z), 1e-3
    p = [math.log(glossy.pdf_normal(N, N, 20.0, Vec3(math.sin(t), 0.0, math.cos(t)))) for t in (-s, 0.0, s)]
    exponent = -(p[0] - 2.0 * p[1] + p[2]) / s**2
    assert exponent == pytest.approx(4.75, abs=1e-5)  # the next term is s^2
    assert {f"{exponent:.2f}"} <= numbers("jittering the normal")
