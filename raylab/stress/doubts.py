"""Doubts: when the scatter of samples says nothing of the error of their mean, and who says so."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.errors import UserError
from raylab.render import render
from raylab.scene import Scene
from raylab.stats.claims import mean_is
from raylab.stats.tails import rule_of_three, why_not_trusted, wilson
from raylab.stress.case import Found, case
from raylab.stress.nearness import WHITE, over_a_floor, seen

Array = npt.NDArray[np.float64]


@case(
    "G08", "1000 samples that are all 0.1, where the truth is 0.3 / 3", usual="|mean - truth| <= 4.5 standard errors",
    rule="a claim about a mean notices what is further off than 1 %", truth="the mean is right",
    unit="right means that are rejected", allowed=0.0,
)  # fmt: skip
def all_equal() -> Found:
    values, truth = np.full(1000, 0.1), 0.3 / 3.0
    verdict = mean_is("all equal", lambda n: np.full(n, 0.1), truth, high=1.0)
    spread = float(values.std(ddof=1)) / math.sqrt(len(values))
    return Found(float(verdict.outcome != "PASS"), float(not abs(0.1 - truth) <= 4.5 * spread))


def coverage(p: float, n: int, interval: Callable[[int], tuple[float, float]]) -> float:
    """How often the interval of a number of hits in n holds their probability p: a sum over the binomial law."""
    from scipy.stats import binom

    hits = np.arange(100)
    held = np.array([low <= p <= high for low, high in map(interval, hits.tolist())])
    return float(binom.pmf(hits, n, p)[held].sum())


@case(
    "G09", "the sun hit by chance: probability 2.16e-5, 1024 and 16384 samples", usual="p +- 1.96 sqrt(p (1 - p) / n)",
    rule="Wilson's interval; without a hit the rule of three", truth="95 %, a sum over the binomial law",
    unit="how far the share of intervals that hold p is below 95 %", allowed=0.02,
)  # fmt: skip
def rare_hits() -> Found:
    p = 2.16e-5
    error = usual = 0.0
    for n in (1024, 16384):

        def normal(hits: int, n: int = n) -> tuple[float, float]:
            share = hits / n
            reach = 1.96 * math.sqrt(share * (1.0 - share) / n)
            return share - reach, share + reach

        def ours(hits: int, n: int = n) -> tuple[float, float]:
            return wilson(hits, n) if hits else (0.0, max(wilson(0, n)[1], rule_of_three(n)))

        error, usual = max(error, 0.95 - coverage(p, n, ours)), max(usual, 0.95 - coverage(p, n, normal))
    return Found(error, usual)


@case(
    "G10", "20 means of 1024 and of 16384 samples by area of a wall light, 2^-10 from its foot",
    usual="mean +- 1.96 standard errors (holds the truth less often than 90 %)",
    rule="no interval where Hill's tail index is not above 2", truth="tail index 3/2",
    unit="of 40 intervals, those given", allowed=0.0, limit=60.0,
)  # fmt: skip
def heavy_tails() -> Found:
    epsilon = 2.0**-10
    wall = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 1], [0, 0, 0, 1]], float)
    g = math.pi * seen(over_a_floor(wall), "area", (epsilon, 0.0, 0.0), (1.0, 0.0, 1.0), 20 * 16384)
    r = math.hypot(epsilon, 2.0)
    truth = math.atan(1.0 / epsilon) - epsilon / r * math.atan(1.0 / r)
    given, held = 0, []
    for n in (1024, 16384):
        for values in g.reshape(20, -1)[:, :n]:
            given += not why_not_trusted(values)
            held.append(abs(values.mean() - truth) <= 1.96 * values.std() / math.sqrt(n))
    return Found(given, 40.0 if np.mean(held) < 0.9 else 0.0, note=f"usual: {np.mean(held):.0%} hold the truth")


@case(
    "G12", "pictures of 0 x 0 and 0 x 1 pixels, of 0 and of -1 samples, and one pixel",
    rule="refused with a sentence; a single pixel is a picture", truth="a sentence", unit="refusals missing",
    allowed=0.0,
)  # fmt: skip
def nothing_to_show() -> Found:
    floor = d.Rectangle(front=WHITE)
    described = d.SceneDescription(shapes=(floor,), environment=d.ConstantEnvironment(np.ones(3)))
    missing = 0
    for width, height in ((0, 0), (0, 1), (1, 0)):
        try:
            Scene(replace(described, camera=d.Camera(width=width, height=height)))
            missing += 1
        except UserError as refusal:
            missing += "at least one pixel" not in str(refusal)
    eye = np.diag([1.0, -1.0, -1.0, 1.0])
    eye[2, 3] = 2.0
    scene = Scene(replace(described, camera=d.Camera(eye, width=1, height=1)))
    for spp in (0, -1):
        try:
            render(scene, "env_cosine", spp=spp)
            missing += 1
        except UserError as refusal:
            missing += "must be positive" not in str(refusal)
    return Found(missing)
