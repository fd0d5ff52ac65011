"""Probes: what a shade() returns at a point or in a pixel is what the renderer adds up there."""

from __future__ import annotations

import numpy as np
import pytest
from helpers import size
from scenes import room

import raylab
from raylab.errors import UserError
from raylab.probe import BLOCK, Pixel, Place, Probe
from raylab.vec3 import Vec3

PLACE = Place.seen((0, -5, 3), (0.3, -1.5, 0))
SCENE = room(8)


def dim(x, k_d, N, scene, rng):
    """A student's shade() of the short signature: k_d times a number."""
    return k_d * rng.number()


def normal(x, V, brdf, N, scene, rng):
    """What a shade() is told: the normal, and the view in two numbers."""
    return Vec3(N.z, V.y, V.z)


def test_a_place_is_the_first_hit_of_its_ray():
    point, n = Probe(SCENE, "area_diffuse", PLACE).found()
    # float32 rays in a scene of extent 8: origin and direction are off by 2^-24 of that, and it stretches along the ray
    np.testing.assert_allclose(point, (0.3, -1.5, 0), atol=8 * 8 * 2.0**-24)
    np.testing.assert_array_equal(n, (0, 0, 1))
    near = Place.at(SCENE, (0.3, -1.5, 0), (0.2, -0.5, 1.0))
    point, n = Probe(SCENE, "area_diffuse", near).found()
    np.testing.assert_allclose(point, (0.3, -1.5, 0), atol=8 * 8 * 2.0**-24)


def test_shade_is_told_the_normal_and_the_view():
    values = Probe(SCENE, normal, PLACE).sample(1, 3)
    view = np.array([-0.3, -3.5, 3.0]) / np.linalg.norm([-0.3, -3.5, 3.0])
    np.testing.assert_allclose(values, [[1.0, view[1], view[2]]] * 3, atol=2.0**-23)


def test_samples_depend_on_seed_and_number_alone():
    probe = Probe(SCENE, "area_diffuse", PLACE, threads=2)
    n = size(4 * BLOCK + 5, 40)
    values = probe.sample(7, n)
    draw = probe.draws(7)
    np.testing.assert_array_equal(np.concatenate([draw(3), draw(n - 3)]), values)
    np.testing.assert_array_equal(probe.draws(7, channel=1)(5), values[:5, 1])
    np.testing.assert_array_equal(probe.sample(7, 4, first=n - 4), values[-4:])
    assert not np.isin(probe.sample(8, 30)[:, 0], values[:30, 0]).any()
    means = probe.means(7, 0)(4, 5)
    np.testing.assert_allclose(means, values[:20, 0].reshape(5, 4).mean(axis=1), rtol=1e-15)


def test_a_students_function_is_sampled_with_either_signature():
    values = Probe(SCENE, dim, PLACE).sample(3, size(4000, 400))
    k_d = 0.5 / np.pi
    assert values.min() >= 0.0
    assert values.max() < k_d
    # the mean of n uniform numbers: standard error k_d / sqrt(12 n), false alarm 1e-6 two-sided
    assert abs(values[:, 0].mean() - k_d / 2) <= 4.9 * k_d / np.sqrt(12 * len(values))


def test_a_pixel_is_what_the_renderer_puts_there():
    """Pixel 0 of a picture has the streams of a probe with the same seed: the same samples, summed in another order."""
    image = raylab.render(SCENE, "area_diffuse", sampler="independent", spp=size(256, 32), seed=11)
    values = Probe(SCENE, "area_diffuse", Pixel(0, 0)).sample(11, size(256, 32))
    np.testing.assert_allclose(values.mean(axis=0), image.mean[0, 0], rtol=256 * 2.0**-53, atol=1e-300)
    error = values.std(axis=0, ddof=1) / np.sqrt(len(values))
    np.testing.assert_allclose(error, image.standard_error[0, 0], rtol=1e-9)
    inside = Probe(SCENE, "area_diffuse", Pixel(4, 5)).sample(11, 64)
    assert inside.mean() > 0.0


def test_a_probe_that_meets_nothing_says_so():
    with pytest.raises(UserError, match="met no surface"):
        Probe(SCENE, "area_diffuse", Place.seen((0, -5, 3), (0, -9, 9))).sample(1, 5)
    with pytest.raises(UserError, match="needs environment"):
        Probe(SCENE, "env_cosine", PLACE).sample(1, 5)
    with pytest.raises(UserError, match="single point"):
        Probe(SCENE, "area_diffuse", Pixel(0, 0)).found()
