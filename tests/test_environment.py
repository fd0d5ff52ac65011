"""Environments: none, constant, and linear in the direction."""

from __future__ import annotations

import numpy as np
import pytest
from helpers import U53, array, composite, same_bits, squares
from skies import LAST, LUMINANCE, PI, N, directions, look, sample, two_worlds

from raylab import description as d
from raylab.errors import SceneError
from raylab.sky import make_environment
from raylab.vec3 import black

# --- constant and none ---


def test_no_environment_is_black():
    sky = make_environment(None)
    assert sky.eval(N) == black
    assert sky.pdf(N, N) == 0.0
    assert not sky.present()


def test_a_constant_sky_samples_the_hemisphere():
    sky = make_environment(d.ConstantEnvironment(np.array([1.0, 2.0, 3.0])))
    u = [*squares(100), (0.0, 0.3), (2.0**-53, 0.5), (LAST, LAST)]
    w, p, pdf, L = sample(sky, u)
    assert np.all(L == [1.0, 2.0, 3.0])
    assert np.all(w @ array(N) >= -16 * U53)
    assert np.all(p == 0.5 / PI)
    assert np.all(pdf[:100] == p[:100])  # above the horizon
    assert sky.pdf(N, -N) == 0.0


def test_a_constant_sky_must_be_radiance():
    with pytest.raises(SceneError, match="not negative"):
        make_environment(d.ConstantEnvironment(np.array([1.0, -2.0, 3.0])))
    with pytest.raises(SceneError, match="expected an environment"):
        make_environment("blue")  # type: ignore[arg-type]


# --- gradient ---

SLOPE = np.array([[0.3, 0.1, -0.2], [0.0, -0.5, 0.1], [0.2, 0.2, 0.9]])
RADIANCE = np.array([1.0, 0.6, 1.2])
SKIES = {
    "steep": (RADIANCE, SLOPE),
    "flat": (RADIANCE, np.zeros((3, 3))),
    "black at one end": (np.ones(3), np.tile([0.6, 0.0, 0.8], (3, 1))),
    "black": (np.zeros(3), np.zeros((3, 3))),
}


def gradient(name):
    return make_environment(d.GradientEnvironment(*SKIES[name]))


def test_a_gradient_is_linear_in_the_direction():
    w = np.random.default_rng(1).normal(size=(50, 3))
    w /= np.linalg.norm(w, axis=1, keepdims=True)
    L, _ = look(gradient("steep"), w)
    assert np.allclose(L, RADIANCE + w @ SLOPE.T, rtol=0, atol=8 * U53)


@pytest.mark.parametrize("name", SKIES)
def test_a_gradient_is_sampled_in_proportion_to_its_luminance(name):
    sky = gradient(name)
    radiance, slope = SKIES[name]
    u = squares(200, seed=1) + [(a, b) for a in (0.0, 2.0**-53, LAST) for b in (0.0, 0.5, LAST)]
    w, p, pdf, L = sample(sky, u)
    assert np.abs(np.linalg.norm(w, axis=1) - 1.0).max() <= 16 * U53
    assert np.array_equal(p, pdf)
    if name == "black":
        assert np.allclose(p, 0.25 / PI, rtol=8 * U53)
    else:
        assert np.allclose(p, L @ LUMINANCE / (4 * PI * (LUMINANCE @ radiance)), rtol=0, atol=32 * U53)
    steep = LUMINANCE @ slope
    if np.any(steep != 0.0):  # the share of sky with a lower w . axis than this, of density (a + b z) / 2 a
        b, a = np.linalg.norm(steep), LUMINANCE @ radiance
        z = np.clip(w @ (steep / b), -1.0, 1.0)
        share = ((z + 1.0) + b / a * (z * z - 1.0) / 2.0) / 2.0
        assert np.abs(share - np.array(u)[:, 0]).max() <= 32 * U53


@pytest.mark.parametrize("name", SKIES)
def test_the_density_of_a_gradient_integrates_to_one(name):
    z, weight = composite(8, [-1.0, 1.0])
    turns = (np.arange(8) + 0.5) / 8
    zz, tt = np.meshgrid(z, turns, indexing="ij")
    _, pdf = look(gradient(name), directions(zz, tt).reshape(-1, 3))
    assert (pdf.reshape(8, 8) * weight[:, None]).sum() * 2 * PI / 8 == pytest.approx(1.0, rel=64 * U53)


@pytest.mark.parametrize("slope", [SLOPE * 2, np.eye(2), np.full((3, 3), np.nan)])
def test_a_gradient_that_is_negative_somewhere_is_refused(slope):
    with pytest.raises(SceneError, match="negative somewhere"):
        make_environment(d.GradientEnvironment(RADIANCE, slope))


def test_methods_in_plain_python_give_what_the_kernel_gets():
    assert same_bits(*two_worlds(gradient("steep")))
