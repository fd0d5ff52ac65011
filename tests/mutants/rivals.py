"""The published test settings of other projects, re-implemented, on the same samples. True: the mistake is noticed.

Nori's t-test: 1e5 samples, alpha 1 %, variance floor 1e-5. Mitsuba 3's image test: a z-test for each of 48 x 48 pixels
with the reference's variance (floor 1e-4), 2e6 samples in all, alpha 1 % with Sidak's correction, 99.75 % of the pixels
must pass. pbrt-v4's analytic scenes: the mean of 10 x 10 pixels of 256 samples within 2.5 %. darts' comparison of
images: root mean square difference up to 2 / 255, here without its noise. Every one is given our scenes: what their own
scenes do not contain is not held against them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

NORI, MITSUBA, PIXELS, PBRT = 100_000, 2_000_000, 48 * 48, 25_600
DARTS = 2.0 / 255.0


def nori(x: Any) -> bool:
    from scipy.stats import t

    with np.errstate(all="ignore"):
        mean, variance = float(np.mean(x)), max(float(np.var(x, ddof=1)), 1e-5)
        p = 2.0 * float(t.sf(abs(mean - 1.0) * np.sqrt(len(x) / variance), len(x) - 1))
    return not p >= 0.01  # as there, a value that is no number is a rejection


def mitsuba(x: Any, variance: float) -> bool:
    from scipy.stats import norm

    per_pixel = len(x) // PIXELS
    with np.errstate(all="ignore"):
        means = x[: per_pixel * PIXELS].reshape(PIXELS, per_pixel).mean(axis=1)
        z = np.abs(means - 1.0) / np.sqrt(max(variance, 1e-4) / per_pixel)
    p = 2.0 * norm.sf(z)
    return not np.mean(p > 1.0 - 0.99 ** (1.0 / PIXELS)) >= 0.9975


def pbrt(x: Any) -> bool:
    return not abs(float(np.mean(x)) - 1.0) <= 0.025


def darts(x: Any, radiance: float) -> bool:
    return not abs(float(np.mean(x)) - 1.0) * radiance <= DARTS


def judge(draws: Callable[[int], Any], variance: float | None, radiance: float, spp: int = 1) -> dict[str, bool]:
    """What each would have said of draws, means of `spp` samples each; Mitsuba needs the variance of the right code."""
    x = draws(MITSUBA // spp)
    found = {"Nori": nori(x[: NORI // spp]), "pbrt": pbrt(x[: PBRT // spp]), "darts": darts(x[: NORI // spp], radiance)}
    return found if variance is None else found | {"Mitsuba": mitsuba(x, variance)}
