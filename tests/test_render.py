"""render(): the same bits for every number of threads, honest errors, nothing hidden, nothing lost."""

from __future__ import annotations

import math
import re
import sys
from dataclasses import replace

import numpy as np
import pytest
from scenes import GREY, camera, lamp, moved, outdoors, room
from scipy import stats

from raylab import description as d
from raylab.errors import InvalidSampleError, UserError
from raylab.image import estimate
from raylab.packet import LANES
from raylab.pixel_sample import PixelSample
from raylab.pixels import COLUMNS, COUNT
from raylab.plan import STREAMS
from raylab.point import facet_point, free_point
from raylab.render import render
from raylab.scene import Scene
from raylab.shadow import shadow
from raylab.strategies import strategy
from raylab.surface import DEGENERATE_SAMPLES
from raylab.vec3 import Vec3, black, is_finite

render_module = sys.modules["raylab.render"]  # raylab.render is the function


def test_another_seed_is_another_picture_of_the_same_scene():
    scene = room()
    a, b = (render(scene, "area", sampler="independent", spp=256, seed=k) for k in (1, 2))
    assert not np.array_equal(a.mean, b.mean)
    z = (a.image_mean - b.image_mean) / np.hypot(a.image_standard_error, b.image_standard_error)
    assert np.abs(z).max() < stats.norm.isf(1e-6 / 6)


@pytest.mark.parametrize("sampler", ["independent", "stratified", "sobol"])
def test_standard_error_is_honest(sampler):
    """Over 64 seeds the spread of the image mean is what a single picture says it is.

    The image mean adds many independent pixels, so it is nearly normal, and 63 s^2 / SE^2 is chi-square with 63
    degrees of freedom, up to the error of the average SE^2, which is taken five times its own standard error wide.
    """
    scene = room(8)
    pictures = [render(scene, "area", sampler=sampler, spp=16, seed=seed) for seed in range(64)]
    means = np.array([p.image_mean[0] for p in pictures])
    stated = np.array([p.image_standard_error[0] ** 2 for p in pictures])
    slack = 5 * stats.sem(stated) / stated.mean()
    low, high = stats.chi2.interval(1 - 1e-6, 63)
    assert low * (1 - slack) < 63 * means.var(ddof=1) / stated.mean() < high * (1 + slack)


def test_better_points_make_less_noise():
    scene = room(8)
    error = {
        s: render(scene, "area", sampler=s, spp=256).relative_error for s in ("independent", "stratified", "sobol")
    }
    assert error["sobol"] < error["stratified"] < error["independent"]


def test_one_sample_has_no_error_bar():
    image = render(room(4), "area", sampler="independent", spp=1)
    assert np.isnan(image.standard_error).all()
    assert np.isfinite(image.mean).all()


def test_black_pixels_have_error_zero():
    scene = Scene(d.SceneDescription(camera=camera(2), shapes=(lamp(),)))
    image = render(scene, "area", sampler="independent", spp=4)
    assert not image.standard_error.any()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"spp": 0}, "spp must be positive"),
        ({"spp": -3}, "spp must be positive"),
        ({"spp": 1.5}, "whole number"),
        ({"spp": 2**31}, "whole number"),
        ({"seconds": 0}, "seconds must be positive"),
        ({"seconds": math.nan}, "seconds must be positive"),
        ({"relative_error": -1.0}, "relative_error must be positive"),
        ({"spp": 4, "seconds": 1}, "one of spp, seconds and relative_error"),
        ({"sampler": "sobel"}, "unknown sampler"),
        ({"shade": "aera"}, "unknown shade"),
        ({"shade": "env_brdf"}, "needs environment"),
        ({"shade": "point_light"}, "needs point lights"),
        ({"threads": 0}, "threads must be at least 1"),
    ],
)
def test_bad_arguments_are_explained(arguments, words):
    with pytest.raises(UserError, match=words):
        render(room(4), **arguments)


def test_a_shade_with_other_arguments_is_explained():
    def shade(x, y):
        return x

    with pytest.raises(UserError, match=r"expected the arguments \(x, V, brdf, N, scene, rng\)"):
        render(room(4), shade)


def test_a_shade_of_ones_own():
    def shade(x, V, brdf, N, scene, rng):
        return Vec3(1.0, 2.0, 3.0)

    image = render(room(4), shade, spp=2)
    np.testing.assert_array_equal(image.mean[-1, 0], [1.0, 2.0, 3.0])
    scene = room(4)
    assert type(strategy(shade, scene)) is type(strategy(shade, scene))  # one type, so one kernel is compiled


def test_invalid_samples_are_counted_and_left_out():
    def shade(x, V, brdf, N, scene, rng):
        u = rng.number()
        return Vec3(math.nan if u < 0.25 else 1.0, 1.0, 1.0)

    scene = Scene(d.SceneDescription(camera=camera(8), shapes=(d.Rectangle(to_world=moved(0, 0, 0, 99, 99, 1)),)))
    image = render(scene, shade, sampler="independent", spp=64)
    total = 64 * 64
    assert image.invalid_samples + image.samples.sum() == total
    low, high = stats.binom.interval(1 - 1e-6, total, 0.25)
    assert low <= image.invalid_samples <= high
    np.testing.assert_array_equal(image.mean, 1.0)


def test_a_strict_render_says_which_sample_is_not_finite():
    """The same sample in plain Python is the one: with its random numbers, its predecessors are finite."""

    def shade(x, V, brdf, N, scene, rng):
        return Vec3(math.nan if rng.number() < 0.01 else 1.0, 1.0, 1.0)

    scene = Scene(d.SceneDescription(camera=camera(8), shapes=(d.Rectangle(to_world=moved(0, 0, 0, 99, 99, 1)),)))
    with pytest.raises(
        InvalidSampleError, match=r"not finite: pixel \(\d, \d\), stream \d, sample \d+, seed 7"
    ) as told:
        render(scene, shade, sampler="sobol", spp=64, seed=7, strict=True)
    sample = PixelSample.parse(re.search(r"raylab replay (\S+)", str(told.value))[1])
    assert not is_finite(sample.value(scene, shade))
    before = [replace(sample, sample=k).value(scene, shade) for k in range(sample.sample)]
    assert all(map(is_finite, before))


@pytest.mark.parametrize("token", ["area", "area/sobol/16/5/3/4/0", "area/sobol/16/5/3/x/0/7", ""])
def test_a_token_of_another_form_is_refused(token):
    with pytest.raises(UserError, match="expected a token SHADE/SAMPLER/CELLS/SEED"):
        PixelSample.parse(token)


def test_a_lamp_seen_edge_on_is_counted():
    """From a wall that faces the lamp, at the height of its plane; above it there is light, below it only its back."""
    flat = d.Rectangle(to_world=moved(0.5, 0, 0, 0.25, 0.25, 1), radiance=np.ones(3), front=None)
    scene = Scene(d.SceneDescription(camera=camera(4), shapes=(flat, d.Rectangle(to_world=moved(0, 0, -9)))))
    data = scene.data
    y, _ = next(iter(data.lights)).sample(free_point(black), (0.5, 0.5))
    for height, counted in ((0.0, 1), (0.1, 0), (-0.1, 0)):
        data.tally[DEGENERATE_SAMPLES] = 0
        x = facet_point(y.p + Vec3(-0.1, 0.0, height), Vec3(1.0, 0.0, 0.0), 0.0, black)
        assert shadow(data, x, y) == (height <= 0.0)
        assert data.tally[DEGENERATE_SAMPLES] == counted


def test_relative_error_is_reached():
    image = render(room(16), "area", relative_error=0.05)
    assert image.relative_error <= 0.05
    assert (image.samples == image.samples[0, 0]).all()


@pytest.mark.parametrize("how", [{"spp": 1 << 16}, {"seconds": 1e3}, {"relative_error": 1e-9}], ids=str)
def test_interrupt_keeps_what_is_done(how):
    calls = []

    def progress(state):
        calls.append(state)
        if state.done >= 2 * LANES * STREAMS:
            raise KeyboardInterrupt

    image = render(room(16), "area", **how, progress=progress)
    assert not image.complete
    assert np.isfinite(image.mean).all()
    assert 4 * STREAMS <= image.samples.max() < 1 << 16
    assert calls[-1].total == how.get("spp")


def test_spp_that_no_stream_divides():
    image = render(room(4), "area", sampler="sobol", spp=7)
    assert (image.samples == 7).all()


def test_pictures_of_a_pixel_do_not_depend_on_the_pass_schedule():
    """64 samples at once or in two renders of 1 and of 64: the first sample is the same."""
    first = render(room(4), "area", sampler="independent", spp=1, seed=9)
    accumulated = render(room(4), "area", sampler="independent", spp=2, seed=9)
    assert not np.array_equal(first.mean, accumulated.mean)
    again = render(room(4), "area", sampler="independent", spp=1, seed=9)
    np.testing.assert_array_equal(first.mean, again.mean)


def test_each_stream_counts_the_same_however_many_samples_it_has():
    accumulator = np.zeros((2, 1, 1, COLUMNS))
    accumulator[0, 0, 0, :3], accumulator[0, 0, 0, COUNT] = 1.0, 3
    accumulator[1, 0, 0, :3], accumulator[1, 0, 0, COUNT] = 5.0, 1
    mean, _, samples = estimate(accumulator, independent=False)
    assert mean[0, 0, 0] == 3.0
    assert samples[0, 0] == 4


def test_hidden_emitters_are_not_seen_but_shine():
    scene = Scene(
        d.SceneDescription(
            camera=d.Camera(width=4, height=4, fov=1.0),  # looks along +z from the origin
            shapes=(d.Rectangle(to_world=moved(0, 0, 2, 1, -1, -1), radiance=np.ones(3), front=GREY),),
            hide_emitters=True,
        )
    )
    assert not render(scene, spp=1).mean.any()


def test_counts_of_rays():
    image = render(room(8), "area", spp=4)
    assert image.report["rays"]["camera"] == 8 * 8 * 4
    assert 0 < image.report["rays"]["shadow"] <= 8 * 8 * 4


def test_two_strategies_agree_under_a_sky():
    sky = d.ConstantEnvironment(np.array([1.0, 2.0, 3.0]))
    scene = outdoors(sky, 8)
    a = render(scene, "env_uniform", sampler="independent", spp=1024)
    b = render(scene, "env_cosine", sampler="independent", spp=1024, seed=1)
    z = (a.image_mean - b.image_mean) / np.hypot(a.image_standard_error, b.image_standard_error)
    assert np.abs(z).max() < stats.norm.isf(1e-6 / 6)
