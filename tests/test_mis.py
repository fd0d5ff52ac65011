"""After the last slide: weights of several techniques, their variance by quadrature, and one light of many."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers import ALPHA, U53, chi_square_p, size
from receiver import (
    LIGHT,
    RHO,
    WHITE,
    N,
    Z,
    check,
    check_variance,
    image_sky,
    render,
    scene,
    sky_scene,
    sphere,
)  # fmt: skip
from scipy import integrate

import raylab
from raylab import description as d
from raylab import light_choice, mis
from raylab.closed_forms import irradiance as forms
from raylab.errors import SceneError, UserError
from raylab.jit import njit
from raylab.ladders import frame
from raylab.strategies import strategy

compiled = pytest.mark.compiled(reason="a quarter of a million samples each")
DENSITIES = [0.0, 1e-300, 1e-160, 1e-20, 0.3, 1.0, 7.0, 1e20, 1e160, 1e300, math.inf]


# --- weights ---


@pytest.mark.parametrize("weight", [mis.balance, mis.power])
def test_the_weights_of_two_techniques_add_up_to_one(weight):  # B22
    for p in DENSITIES:
        for q in DENSITIES:
            if p == q == 0.0:
                assert weight(p, q) == 0.0
            else:
                assert weight(p, q) + weight(q, p) == pytest.approx(1.0, abs=4 * U53)
                assert (weight(p, q) > weight(q, p)) == (p > q) or min(weight(p, q), weight(q, p)) == 0.5


@pytest.mark.parametrize(("weight", "beta"), [(mis.balance_of, 1), (mis.power_of, 2)])
def test_the_weights_of_many_techniques_add_up_to_one(weight, beta):
    for p in ((1.0, 2.0, 5.0), (0.0, 3.0, 0.0), (1e-160, 1.0, 1e160)):
        weights = [weight(i, p) for i in range(3)]
        assert math.fsum(weights) == pytest.approx(1.0, abs=8 * U53)
    assert weight(1, (1.0, 2.0, 5.0)) == pytest.approx(2.0**beta / (1.0 + 2.0**beta + 5.0**beta), abs=4 * U53)
    assert weight(0, (0.0, 0.0, 0.0)) == 0.0


def test_the_heuristics_have_their_names():
    assert mis.balance(3.0, 1.0) == 0.75
    assert mis.power(3.0, 1.0) == pytest.approx(0.9, rel=2 * U53)


# --- a lobe around the normal, a round light above: all densities depend on the angle alone ---

CASES = {"light smaller": (50.0, 0.02), "of a size": (50.0, 0.15), "lobe smaller": (2000.0, 0.5)}


def moments(exponent, half_angle, weight):
    """Mean, variance and maximum of weight f / p, summed over one sample of the light and one of the lobe."""
    one_minus_c = 2.0 * math.sin(half_angle / 2.0) ** 2
    p_light = 1.0 / (2.0 * math.pi * one_minus_c)

    def lobe(t):  # t = 1 - cos
        return (exponent + 1.0) / (2.0 * math.pi) * (1.0 - t) ** exponent

    def f(t):
        return (exponent + 2.0) / (2.0 * math.pi) * (1.0 - t) ** (exponent + 1.0)

    def over(g):
        scale = [k / exponent for k in (0.5, 2.0, 8.0) if k / exponent < one_minus_c]
        return 2.0 * math.pi * integrate.quad(g, 0.0, one_minus_c, points=scale, epsabs=0.0, epsrel=1e-12)[0]

    mean, variance, largest = 0.0, 0.0, 0.0
    for p, q in ((lambda t: p_light, lobe), (lobe, lambda t: p_light)):
        part = over(lambda t, p=p, q=q: weight(p(t), q(t)) * f(t))
        second = over(lambda t, p=p, q=q: (weight(p(t), q(t)) * f(t)) ** 2 / p(t))
        mean, variance = mean + part, variance + second - part**2
        t = np.linspace(0.0, one_minus_c, 2000)
        largest += max(weight(p(s), q(s)) * f(s) / p(s) for s in t)
    return mean, variance, largest


@compiled
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize(
    ("shade", "weight"),
    [("mis_balance", lambda p, q: p / (p + q)), ("mis_power", lambda p, q: p * p / (p * p + q * q))],
    ids=["balance", "power"],
)
def test_variance_of_the_combination(case, shade, weight):
    exponent, half_angle = CASES[case]
    mean, variance, largest = moments(exponent, half_angle, weight)
    mirror = d.Phong(np.zeros(3), WHITE, exponent)
    image = render(scene([sphere(2.5 * N, 2.5 * math.sin(half_angle), WHITE)], mirror, n=N, view=N), shade)
    check(image, mean, variance)
    check_variance(image, variance, mean, largest)


def test_neither_technique_alone_is_safe_but_both_together_are():
    """The question with which the lecture ends: by light or by BRDF? Relative variances, extremes S4 and S5."""
    both = {case: moments(*CASES[case], lambda p, q: p / (p + q))[1] for case in CASES}
    light, lobe = ({case: alone(*CASES[case], which) for case in CASES} for which in ("light", "lobe"))
    assert light["lobe smaller"] > 50.0
    assert lobe["light smaller"] > 50.0
    assert max(both.values()) < 0.25


def alone(exponent, half_angle, which):
    """Relative variance of one technique: S4 and S5 of the theory, with the cosine of the surface."""
    c = math.cos(half_angle)
    n, omega = exponent, 2.0 * math.pi * (1.0 - c)
    mean = 1.0 - c ** (n + 2.0)
    if which == "light":
        second = omega * (n + 2.0) ** 2 / (2.0 * math.pi) * (1.0 - c ** (2.0 * n + 3.0)) / (2.0 * n + 3.0)
    else:
        second = (n + 2.0) ** 2 / (n + 1.0) * (1.0 - c ** (n + 3.0)) / (n + 3.0)
    return second / mean**2 - 1.0


# --- one light of many ---


def test_an_alias_table_holds_exactly_the_shares():
    rng = np.random.default_rng(4)
    for weights in (rng.random(1000), 10.0 ** -rng.uniform(0, 12, 5000), [0.0, 1.0, 0.0, 3.0], [2.0], np.ones(7)):
        thresholds, aliases, shares = light_choice.alias_table(weights)
        n = len(shares)
        real = thresholds + np.bincount(aliases, 1.0 - thresholds, minlength=n)
        w = np.asarray(weights, float)
        assert math.fsum(shares) == pytest.approx(1.0, abs=2 * n * U53)
        assert shares == pytest.approx(w / math.fsum(w), rel=2 * n * U53)
        assert real == pytest.approx(n * shares, rel=4 * n * U53, abs=0.0)  # the smallest light too: B21
        assert np.all((thresholds >= 0.0) & (thresholds <= 1.0))


@njit
def picks(table, u, counts):
    for i in range(len(u)):
        k, q = table.choose((u[i, 0], u[i, 1]))
        counts[k] += 1 if q == table.shares[k] else 1_000_000


def test_lights_are_chosen_by_their_power():
    power = np.random.default_rng(6).random(100) ** 3
    power[[3, 50]] = 0.0
    table = light_choice.make_choice(power)
    n = size(1_000_000, 100_000)
    counts = np.zeros(100, np.int64)
    picks(table, np.random.default_rng(7).random((n, 2)), counts)
    assert counts[3] == counts[50] == 0
    assert chi_square_p(counts, n * power / power.sum()) > ALPHA


def test_dark_lights_are_chosen_uniformly():
    assert light_choice.make_choice(np.zeros(4)).shares.array.tolist() == [0.25] * 4
    assert light_choice.choose_uniform(4, (1.0 - U53, 0.3)) == (3, 0.25)


@pytest.mark.parametrize("weights", [[1.0, -1.0], [1.0, math.nan], [0.0, 0.0], [[1.0]], []])
def test_what_is_no_power_is_refused(weights):
    with pytest.raises(SceneError, match="powers of lights must be"):
        light_choice.alias_table(weights)


@compiled
@pytest.mark.parametrize("shade", ["one_light_uniform", "one_light_power"])
def test_variance_of_one_light_of_two(shade):
    """sum x_i^2 / q_i - (sum x_i)^2: contributions 1 : 4, powers 1 : 3, hence .03 of (.3 + 1.2)^2 by power.

    The lights' own variance, of far spheres by their cones, is below 1e-4 of that.
    """
    radius, cosines, radiances = 0.004, (0.75, 1.0), (1.0, 3.0)
    side = frame(Z)[0]
    lamps = [
        sphere(2.0 * (c * Z + math.sqrt(1.0 - c * c) * side), radius, radiance * WHITE)
        for c, radiance in zip(cosines, radiances, strict=True)
    ]
    x = np.array(cosines) * radiances * (radius / 2.0) ** 2
    q = np.array([0.5, 0.5] if shade == "one_light_uniform" else [0.25, 0.75])
    variance = (x * x / q).sum() - x.sum() ** 2
    assert shade == "one_light_uniform" or variance / x.sum() ** 2 == pytest.approx(0.03 / 1.5**2, rel=1e-12)
    image = render(scene(lamps, d.Diffuse(WHITE)), shade)
    check(image, x.sum(), variance)
    check_variance(image, variance, x.sum(), (x / q).max())


@compiled
@pytest.mark.parametrize("exponent", [None, 5.0])
def test_direct_takes_one_of_many_lights(exponent):
    """A hundred spheres, more than MANY: the sum of their closed forms; on a lobe, what the loop over all gets."""
    rng = np.random.default_rng(8)
    lamps, total = [], np.zeros(3)
    for k in range(100):
        z, phi = rng.uniform(0.2, 1.0), rng.uniform(0.0, 2.0 * math.pi)
        r = math.sqrt(1.0 - z * z)
        radius, distance, colour = rng.uniform(0.01, 0.1), rng.uniform(2.0, 4.0) + 0.01 * k, LIGHT * rng.random() ** 4
        lamps.append(sphere(distance * np.array([r * math.cos(phi), r * math.sin(phi), z]), radius, colour))
        total += colour * forms.sphere(radius, distance, z)
    assert len(lamps) > light_choice.MANY
    if exponent is None:
        check(render(scene(lamps), "direct"), RHO / math.pi * total)
        return
    many = scene(lamps, d.Phong(RHO / 2.0, WHITE / 2.0, exponent))
    one, all_ = render(many, "direct"), raylab.render(many, "mis_balance", spp=1 << 13, seed=2)
    error = np.hypot(one.standard_error, all_.standard_error)
    assert np.all(np.abs(one.mean - all_.mean) <= 4.5 * error + 1e-6 * all_.mean)


# --- an image of the sky ---


def sky(compensation):
    """`test_image_sky` of the closed forms: the upper three of nine rows are lit, one texel brightly."""
    pixels = np.zeros((9, 16, 3))
    pixels[:3] = np.random.default_rng(7).random((3, 16, 3)) ** 3
    pixels[1, 5] = (40.0, 10.0, 20.0)
    n = np.array([0.2, -0.3, math.sqrt(0.87)])
    v, _ = forms.texels(9, 16)
    truth = RHO / math.pi * np.einsum("ijc,ijk,k->c", pixels, v, n)
    return sky_scene(replace(image_sky(pixels), mis_compensation=compensation), n=n), truth


@compiled
@pytest.mark.parametrize("shade", ["direct", "mis_balance", "mis_power"])
@pytest.mark.parametrize("compensation", [False, True])
def test_the_combination_under_an_image_sky(shade, compensation):
    """Compensated, most texels are out of the sky's own reach: the BRDF's samples find them, and nothing is lost."""
    there, truth = sky(compensation)
    check(render(there, shade), truth)


def test_compensation_needs_the_combination():
    with pytest.raises(UserError, match="would miss what mis_compensation leaves to the BRDF"):
        strategy("env_brightness", sky(True)[0])
    assert strategy("env_brightness", sky(False)[0])
