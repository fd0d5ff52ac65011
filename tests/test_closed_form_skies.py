"""Every closed form of the lecture's environments, rendered: each estimator that applies against the exact value.

Truths lie within 4.5 standard errors, from the exact variance where it is known.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from receiver import (
    GRADIENT,
    LIGHT,
    RHO,
    SAMPLES,
    SKIES,
    WHITE,
    N,
    Z,
    agree,
    check,
    check_variance,
    glossy,
    gradient,
    half_plane,
    image_sky,
    render,
    scene,
    sky_scene,
    sphere,
    view_of,
)

from raylab import description as d
from raylab.closed_forms import irradiance as forms
from raylab.closed_forms import phong, variances

pytestmark = pytest.mark.compiled(reason="a quarter of a million samples each")

# --- environments ---


@pytest.mark.parametrize("shade", SKIES)
def test_constant_sky(shade):
    check(render(sky_scene(d.ConstantEnvironment(LIGHT), n=N), shade), RHO * LIGHT)


@pytest.mark.parametrize("shade", SKIES)
def test_ball_before_a_constant_sky(shade):
    truth = RHO / math.pi * LIGHT * forms.sphere_before_sky(1.0, 2.5, 0.8)
    check(render(sky_scene(d.ConstantEnvironment(LIGHT), sphere((1.5, 0, 2), 1.0)), shade), truth)
    truth = RHO / math.pi * LIGHT * forms.sphere_before_sky(1.0, 2.5, 0.2)
    check(render(sky_scene(d.ConstantEnvironment(LIGHT), sphere((0, 6**0.5, 0.5), 1.0)), shade), truth)


@pytest.mark.parametrize("shade", SKIES)
def test_gradient_sky(shade):
    a = np.array([1.1, 1.0, 0.5])
    truth = RHO / math.pi * np.array([forms.gradient_sky(c, row, N) for c, row in zip(a, GRADIENT, strict=True)])
    check(render(sky_scene(gradient(a, GRADIENT), n=N), shade), truth)


@pytest.mark.parametrize("shade", SKIES)
def test_image_sky(shade):
    """Nine rows of 20 degrees, light in the upper three: E = sum L n . V while no lit texel meets the horizon of n."""
    pixels = np.zeros((9, 16, 3))
    pixels[:3] = np.random.default_rng(7).random((3, 16, 3)) ** 3
    pixels[1, 5] = (40.0, 10.0, 20.0)
    n = np.array([0.2, -0.3, math.sqrt(0.87)])  # 21 degrees off the pole
    v, _ = forms.texels(9, 16)
    truth = RHO / math.pi * np.einsum("ijc,ijk,k->c", pixels, v, n)
    check(render(sky_scene(image_sky(pixels), n=n), shade), truth)


CAP = np.zeros((9, 16, 3))
CAP[0] = 1.0  # radiance 1 within 20 degrees of the pole
ANGLE = math.radians(20.0)
UPWARDS = 0.5 * np.array([Z, Z, Z])
EXACT = {  # environment, exact variance, mean, largest sample: all for reflectance 1
    ("constant", "env_uniform"): (variances.env_uniform_gradient(1.0, 0.0), 1.0, 2.0),
    ("constant", "env_brightness"): (variances.env_uniform_gradient(1.0, 0.0), 1.0, 2.0),
    ("gradient", "env_uniform"): (variances.env_uniform_gradient(1.1, 0.5), 1.1 + 1.0 / 3.0, 3.2),
    ("gradient", "env_cosine"): (variances.env_cosine_gradient(0.5), 1.1 + 1.0 / 3.0, 1.6),
    ("gradient", "env_brdf"): (variances.env_cosine_gradient(0.5), 1.1 + 1.0 / 3.0, 1.6),
    ("gradient", "env_brightness"): (
        variances.env_brightness_gradient_sphere(1.1, 0.5),
        1.1 + 1.0 / 3.0,
        4.4,
    ),
    ("cap", "env_uniform"): (variances.env_uniform_cap(ANGLE), math.sin(ANGLE) ** 2, 2.0),
    ("cap", "env_cosine"): (variances.env_cosine_cap(ANGLE), math.sin(ANGLE) ** 2, 1.0),
    ("cap", "env_brightness"): (
        variances.cone_cap(ANGLE),
        math.sin(ANGLE) ** 2,
        4.0 * math.sin(ANGLE / 2.0) ** 2,
    ),
}


@pytest.mark.parametrize(("kind", "shade"), EXACT)
def test_variance_under_a_sky(kind, shade):
    environment = {
        "constant": d.ConstantEnvironment(WHITE),
        "gradient": gradient(1.1 * WHITE, UPWARDS),
        "cap": image_sky(CAP),
    }[kind]
    exact, mean, largest = EXACT[kind, shade]
    image = render(sky_scene(environment, material=d.Diffuse(WHITE)), shade)
    check(image, mean, exact)
    check_variance(image, exact, mean, largest)


@pytest.mark.parametrize("shade", ["env_cosine", "env_brdf"])
def test_cosine_sampling_of_a_constant_sky_has_no_variance(shade):
    image = render(sky_scene(d.ConstantEnvironment(LIGHT)), shade)
    assert image.standard_error.max() <= 4 * 2.0**-53 * LIGHT.max()
    np.testing.assert_allclose(image.mean[0, 0], RHO * LIGHT, rtol=SAMPLES * 2.0**-53)


# --- Phong ---


@pytest.mark.parametrize("cosine", [1.0, 0.6, 0.3])
@pytest.mark.parametrize("shade", ["env_brightness", "env_brdf", "direct"])
def test_phong_under_a_constant_sky(shade, cosine):
    view, _ = view_of(N, cosine)
    material = glossy(10.0, 0.5 * RHO, 0.4 * RHO)
    truth = LIGHT * RHO * (0.4 + 0.5 * phong.constant_sky(10, cosine))
    check(render(sky_scene(d.ConstantEnvironment(LIGHT), material=material, n=N, view=view), shade), truth)


@pytest.mark.parametrize("shade", ["env_brdf", pytest.param("direct", marks=pytest.mark.certify)])
def test_phong_under_a_gradient_sky(shade):
    """A mixture of 0.4 diffuse and 0.5 of a lobe of exponent 10 under 1.1 + 0.5 z, seen along the normal."""
    material = glossy(10.0, 0.5 * RHO, 0.4 * RHO)
    truth = RHO * (0.4 * (1.1 + 1.0 / 3.0) + 0.5 * phong.gradient_sky(10, 1.1, 0.5))
    check(render(sky_scene(gradient(1.1 * WHITE, UPWARDS), material=material, view=Z), shade), truth)


@pytest.mark.parametrize("shade", ["env_brdf", "env_brightness"])
def test_variance_of_a_lobe_of_exponent_20(shade):
    """By itself 1 / ((n + 1)(n + 3)); by a uniform hemisphere, as constant skies are, (n + 2)^2 / (2 n + 3) - 1."""
    known = {
        "env_brdf": (variances.phong_brdf(20), 22.0 / 21.0),
        "env_brightness": (variances.phong_uniform(20), 22.0),
    }
    exact, largest = known[shade]
    image = render(sky_scene(d.ConstantEnvironment(WHITE), material=glossy(20.0, WHITE), view=Z), shade)
    check(image, 1.0, exact)
    check_variance(image, exact, 1.0, largest)


# --- two estimators of one scene ---


@pytest.mark.parametrize("shade", SKIES[1:])
def test_estimators_agree_behind_a_ball_and_a_plate(shade):
    """A lopsided sky behind a ball that the horizon cuts and a plate: no closed form."""
    blocked = scene(
        [sphere((0.6, 0.9, 0.7), 0.8), half_plane(-0.4, 0.0, (0, -1))],
        environment=gradient([1.1, 1.0, 0.5], GRADIENT),
    )
    agree(blocked, "env_uniform", shade)
