"""Stopping at a noise level: who looks at his own noise gets pictures that are too dark, two halves do not."""

from __future__ import annotations

import math

import numpy as np

from raylab.image import Image, estimate
from raylab.pixels import COLUMNS, COUNT, MEAN, SQUARES
from raylab.stopping import Halves

TARGET, CHANCE, LOOKS = 0.2, 0.05, tuple(2**k for k in range(3, 13))


def accumulated(values):
    """One pixel; values (streams, n)."""
    pixels = np.zeros((len(values), 1, 1, COLUMNS))
    mean = values.mean(axis=1)
    pixels[:, 0, 0, MEAN : MEAN + 3] = mean[:, None]
    pixels[:, 0, 0, SQUARES : SQUARES + 3] = ((values - mean[:, None]) ** 2).sum(axis=1)[:, None]
    pixels[:, 0, 0, COUNT] = values.shape[1]
    return pixels


def stopped(values, stop):
    """The mean where `stop` says so; every prefix in LOOKS is looked at."""
    for n in LOOKS:
        pixels = accumulated(values[:, :n])
        if stop(pixels):
            return pixels
    raise AssertionError("never stopped")


def by_own_noise(pixels):
    return Image(*estimate(pixels, independent=True)).relative_error <= TARGET


def deviation(means):
    """Of the mean of means from 1, in its standard errors."""
    return (np.mean(means) - 1.0) / (np.std(means) / math.sqrt(len(means)))


def test_two_halves_stop_without_a_bias_and_one_look_at_oneself_does_not():
    """Light of 1 / CHANCE, rarely: the mean is 1. 4.9 standard errors are exceeded with probability 1e-6."""
    rng, honest, usual = np.random.default_rng(0), [], []
    for _ in range(3000):
        values = (rng.random((2, LOOKS[-1])) < CHANCE) / CHANCE
        halves = Halves(TARGET, independent=True)
        pixels = stopped(values, halves.stop)
        honest.append(estimate(halves.picture(pixels), independent=True)[0][0, 0, 0])
        usual.append(estimate(stopped(values, by_own_noise), independent=True)[0][0, 0, 0])
    assert abs(deviation(honest)) < 4.9
    assert deviation(usual) < -4.9


def test_a_half_is_kept_as_it_was_when_the_other_said_so():
    """The second half is noisy, so the first goes on; the first is calm, so the second stops."""
    calm, noisy = np.tile([1.0, 1.01], 32), np.tile([0.0, 0.0, 0.0, 4.0], 16)
    halves = Halves(0.05, independent=True)
    assert not halves.stop(accumulated(np.stack([calm, noisy])))
    later = accumulated(np.stack([np.tile(calm, 64), np.tile(noisy, 64)]))
    assert halves.stop(later)
    kept = halves.picture(later)
    assert kept[:, 0, 0, COUNT].tolist() == [64.0 * 64, 64.0]
