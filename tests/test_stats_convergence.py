"""Convergence, efficiency and heavy tails: raylab's samplers have the slopes of the theory, errors are honest."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest
from scipy import stats
from vectors import random_points

from raylab.stats import shrinks_as
from raylab.stats.betting import Claim
from raylab.stats.claims import decide, mean_is, variance_is
from raylab.stats.convergence import (
    EXPECTED,
    fit,
    honest_error,
    median_error_at_most,
    variance_at_most,
    variance_slope,
)  # fmt: skip
from raylab.stats.efficiency import Blocks, compare, interleave
from raylab.stats.intervals import mean_interval, quantile, variance_interval
from raylab.stats.tails import why_not_trusted
from raylab.study.words import number

ENTROPY = np.random.SeedSequence().entropy  # fresh in each run; 1e-6 and less are the chances of a false alarm
RNG = np.random.default_rng(ENTROPY)
SAMPLES, REPEATS = (16, 64, 256, 1024), 300
Z = stats.norm.isf(0.5e-6)


def linear(u):
    return 2.0 * u[..., 0]


def smooth(u):
    """A square light of side 2 at distance 1: cos^2 / r^2 of its points."""
    r2 = 1.0 + (2.0 * u[..., 0] - 1.0) ** 2 + (2.0 * u[..., 1] - 1.0) ** 2
    return 1.0 / r2**2


def edge(u):
    """The shadow of a slanted half-plane."""
    return (u[..., 0] + 0.6 * u[..., 1] < 0.9).astype(float)


def means(sampler, integrand, samples, repeats):
    seed = int(RNG.integers(1 << 62))
    return integrand(random_points(sampler, seed, repeats, samples)).mean(axis=1)


def exact_jitter(integrand, samples, fine=32):
    """Variance of the mean of one point in each of `samples` square cells, by midpoints in each."""
    m = math.isqrt(samples)
    x = (np.arange(m * fine) + 0.5) / (m * fine)
    values = integrand(np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1)).reshape(m, fine, m, fine)
    return values.var(axis=(1, 3)).sum() / samples**2


# What the exact slope may differ from the exponent at 16 to 1024 points, by d = change of log(variance) / log(64):
# nothing; a term of relative size 1 / N, d = log(1 + 1 / 16) / log(64); one power of log N; a factor 2 in how many
# cells an edge cuts. For the jittered grid the exact variances of such cells are fitted instead.
D = 1.0 / math.log(64)
OFF = {
    "exact": (0.0, 0.0), "1 / N": (-D * math.log(17 / 16), D * math.log(17 / 16)),
    "log": (0.0, D * math.log(math.log(1024) / math.log(16))), "edge": (-D * math.log(2), D * math.log(2)),
}  # fmt: skip
LINES = [
    ("independent", linear, "smooth", "exact"), ("independent", edge, "edge", "exact"),
    ("stratified", linear, "smooth", "exact"), ("stratified", smooth, "smooth", "1 / N"),
    ("stratified", edge, "edge", "cells"),
    ("latin", linear, "additive", "exact"), ("latin", edge, "edge", "1 / N"),
    ("sobol", smooth, "smooth", "log"), ("sobol", edge, "edge", "edge"),
]  # fmt: skip


@pytest.mark.parametrize(("sampler", "integrand", "kind", "off"), LINES)
def test_raylabs_samplers_converge_as_theory_says(sampler, integrand, kind, off):
    fitted = variance_slope(SAMPLES, [means(sampler, integrand, n, REPEATS) for n in SAMPLES])
    error = (fitted.high - fitted.low) / 2.0 / quantile(REPEATS - 1)
    expected = EXPECTED[sampler, kind]
    if off == "cells":
        exact = [exact_jitter(integrand, n) for n in SAMPLES]
        expected = float(np.polyfit(np.log(SAMPLES), np.log(exact), 1)[0])
        below = above = abs(expected - EXPECTED[sampler, kind])  # the points do not lie on a line
        assert above < 0.1
    else:
        below, above = OFF[off]
    assert expected - abs(below) - Z * error <= fitted.value <= expected + above + Z * error, fitted


def test_slope_interval_covers_as_often_as_it_says():
    """Slope -1 of means of exponential numbers (kurtosis 9 for one, 3 for many): inside in about 95 of 100."""
    held, trials = 0, 300
    for _ in range(trials):
        fitted = variance_slope((4, 16, 64), [RNG.gamma(n, 1.0 / n, 200) for n in (4, 16, 64)])
        held += fitted.low <= -1.0 <= fitted.high
    assert held >= stats.binom.isf(1.0 - 1e-6, trials, 0.93)  # skewed variances cost two in a hundred


def test_the_error_of_a_stratified_mean_is_honest_only_from_randomisations():
    points = linear(random_points("stratified", int(RNG.integers(1 << 62)), 400, 64))
    honest = honest_error(points.mean(axis=1))
    truth = 1.0 / math.sqrt(3.0) / 64 / math.sqrt(400)
    assert honest.value == pytest.approx(truth, rel=Z * math.sqrt(2.0 / 400) / 2)
    naive = points.std() / math.sqrt(points.size)
    assert naive > 7.0 * honest.value  # sqrt(64) = 8 times too large


# --- verdicts ---


def test_independent_samples_shrink_as_1_over_n():
    def one_over(samples, n):
        return means("independent", linear, samples, n)

    assert shrinks_as("independent", one_over, 16, high=2.0).outcome == "PASS"


@pytest.mark.parametrize(("sampler", "outcome"), [("stratified", "PASS"), ("sobol", "PASS"), ("independent", "FAIL")])
def test_the_gate_of_stratification(sampler, outcome):
    """Var 3 N^2 <= 4 for 2 u1; a mean over 8 x 8 cells is within 1 / 8 of the truth."""
    verdict = variance_at_most(
        sampler, lambda n, r: means(sampler, linear, n, r), 64, 4.0 / (3.0 * 64**2), reach=2.0 / 8.0
    )
    assert verdict.outcome == outcome, str(verdict)
    if outcome == "FAIL":
        assert verdict.samples <= 3 * 128


def test_the_offsets_of_strata_must_not_be_shared():
    """C4: one jitter for all cells; each point is right, the mean has N times the variance."""

    def shared(samples, n):
        m = math.isqrt(samples)
        return linear((np.stack([np.repeat(np.arange(m), m)] * 2, axis=-1) + RNG.random((n, 1, 2))) / m).mean(axis=1)

    verdict = variance_at_most("shared", shared, 64, 4.0 / (3.0 * 64**2), reach=2.0 / 8.0)
    assert verdict.outcome == "FAIL"
    assert verdict.samples <= 3 * 2000


def test_the_gate_lets_in_all_up_to_the_limit_and_nothing_from_twice_the_limit():
    """+-s: (X - X')^2 / 2 is 0 or 2 s^2, with the mean s^2, exactly. Ten runs each."""

    def two_valued(variance):
        return lambda samples, n: math.sqrt(variance) * (2.0 * RNG.integers(0, 2, n) - 1.0)

    def outcomes(variance, reach=4.0):
        draw, more = two_valued(variance), {"reach": reach, "beta": 1e-9, "cap": 1 << 14}
        return {variance_at_most("gate", draw, 16, 1.0, **more).outcome for _ in range(10)}

    assert outcomes(0.2) == outcomes(0.5) == outcomes(1.0) == {"PASS"}
    assert outcomes(2.0) <= {"FAIL", "INCONCLUSIVE"}
    assert outcomes(2.5) == {"FAIL"}
    assert outcomes(1.2, reach=1.9) == {"FAIL"}  # two means are further apart than strata allow


@pytest.mark.parametrize(("width", "outcome"), [(1.0, "PASS"), (0.9, "FAIL")])
def test_strata_are_filled_to_their_edges(width, outcome):
    """Jitter over 0.9 of a cell leaves the mean alone, and 0.81 of the variance: too little is wrong as well."""

    def draw(n):
        own = means("stratified", linear, 64, n)
        cells = 2.0 * (np.arange(8) + 0.5) / 8
        return own if width == 1.0 else (cells[:, None] + width * (RNG.random((n, 8, 8)) - 0.5) / 4).mean(axis=(1, 2))

    verdict = variance_is("jitter", draw, 1.0 / (3.0 * 64**2), low=1.0 - 0.125, high=1.0 + 0.125)
    assert verdict.outcome == outcome, str(verdict)


def test_the_sign_test_of_heavy_errors():
    """Owen-scrambled Sobol' points: half of the errors are below what random points reach only with N^1.5 samples."""
    limit = 1.0 / math.sqrt(3.0) / 64  # the standard error of a jittered grid
    good = median_error_at_most("sobol", lambda n, r: means("sobol", linear, n, r), 64, 1.0, limit)
    assert good.outcome == "PASS", str(good)
    bad = median_error_at_most("independent", lambda n, r: means("independent", linear, n, r), 64, 1.0, limit)
    assert bad.outcome == "FAIL", str(bad)


# --- efficiency ---


def test_efficiency_ratio_of_a_known_cost():
    """Four times the variance at the same cost: a quarter of the efficiency, whatever the machine does meanwhile."""
    blocks = 200
    drift = np.exp(RNG.normal(0.0, 1.0, blocks))
    one, other = (
        Blocks(scale**2 * RNG.chisquare(999, blocks) / 999, drift * np.exp(RNG.normal(0.0, 0.05, blocks)))
        for scale in (2.0, 1.0)
    )
    ratio = compare(one, other)
    error = Z * math.hypot(math.sqrt(4.0 / 999 / blocks), 1.2533 * 0.05 * math.sqrt(2.0) / math.sqrt(blocks))
    assert abs(math.log(4.0 * ratio.value)) <= error
    assert math.log(ratio.high / ratio.low) < 4.0 * error


def test_blocks_take_turns():
    order = []

    def draw(name, n):
        order.append(name)
        time.sleep(1e-4)
        return RNG.random(n)

    one, other = interleave([lambda n: draw("A", n), lambda n: draw("B", n)], 500, blocks=4)
    assert "".join(order) == "AB" + "ABBAABBA"
    assert one.variances.shape == other.seconds.shape == (4,)
    assert (one.seconds >= 1e-4).all()
    assert compare(one, one).value == 1.0


# --- heavy tails ---


def pareto(index, n):
    return RNG.pareto(index, n) + 1.0


def test_no_interval_where_the_variance_is_infinite():
    heavy = mean_interval(pareto(1.2, 100_000))
    assert (heavy.low, heavy.high) == (0.0, math.inf)
    assert any("the variance looks infinite (tail index 1." in d for d in heavy.doubts)
    assert number(heavy).endswith("(interval not trusted)")
    light = mean_interval(RNG.random(100_000))
    assert light.doubts == ()
    assert math.isfinite(light.high)
    assert variance_interval(RNG.normal(0.0, 1.0, 100_000)).doubts == ()
    assert why_not_trusted(pareto(1.2, 100)) == ""  # too few to know


def test_no_efficiency_where_the_variance_is_infinite():
    one, other = interleave([lambda n: pareto(1.2, n), RNG.random], 2000, blocks=10)
    ratio = compare(one, other)
    assert "not trusted" in ratio.doubts[0]
    assert (ratio.low, ratio.high) == (0.0, math.inf)


def test_a_bet_on_a_bounded_heavy_tail_stays_valid_and_says_why_it_takes_so_long():
    high, index = 1e6, 1.2
    truth = index / (index - 1) * (1 - high ** (1 - index)) / (1 - high**-index)  # of a Pareto law cut at `high`

    def cut(n):
        return (1.0 - RNG.random(n) * (1.0 - high**-index)) ** (-1.0 / index)

    verdict = decide(Claim("cut Pareto", truth, 0.0, high * (1 + 1e-9), 0.01 * truth), cut, 200_000)
    assert verdict.outcome == "INCONCLUSIVE"
    assert "the variance looks infinite" in verdict.reason
    assert mean_is("uniform", lambda n: 2.0 * RNG.random(n), 1.0, high=2.0).reason == ""


def test_a_fit_needs_two_points():
    assert fit([16.0], [variance_interval(RNG.random(100))], 100) is None
