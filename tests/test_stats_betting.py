"""The bets: a capital that is never overstated, false alarms as rare as promised, intervals that cover."""

from __future__ import annotations

import math

import numpy as np
import pytest
from mutants import alarms
from scipy import stats

from raylab.stats.betting import SIZES, Claim, Test, interval, upward
from raylab.stats.histogram import Histogram, edges_for


def exact_log_capital(values, mean, bets):
    return np.log1p(np.outer(bets, values - mean)).sum(axis=1)


@pytest.mark.parametrize("draw", ["uniform", "bernoulli", "narrow", "heavy"])
def test_the_histogram_never_overstates_the_capital_and_hardly_understates_it(draw):
    rng = np.random.default_rng(1)
    values, high = {
        "uniform": (2 * rng.random(5000), 2.0),
        "bernoulli": (100.0 * (rng.random(5000) < 0.01), 100.0),
        "narrow": (1 + 1e-3 * rng.standard_normal(5000).clip(-5, 5), 10.0),
        "heavy": (rng.pareto(2.5, 5000).clip(0, 1e4), 1e4),
    }[draw]
    histogram = Histogram(edges_for(0.0, high, 1.0, float(values.std())))
    for part in np.split(values, 10):
        histogram.add(part)
    for mean in (0.9, 1.0, 1.1):
        for bets in (SIZES / mean, -SIZES / (high - mean)):
            exact, bound = exact_log_capital(values, mean, bets), histogram.log_capital(mean, bets)
            rounding = 2.0**-40 * np.abs(np.log1p(np.outer(bets, values - mean))).sum(axis=1)
            assert (bound <= exact + rounding).all()
            # a chord over a width w lies at most w^2 / 8 times the curvature (l / (1 + l (y - m)))^2 below the arc
            widths = np.diff(histogram.edges)[histogram.counts > 0]
            least = np.minimum(1 + bets * (values.min() - mean), 1 + bets * (values.max() - mean))
            worst = len(values) * (bets * widths.max()) ** 2 / 8 / least**2
            assert (exact - bound <= worst + rounding).all()


def test_false_alarms_at_a_billionth_by_change_of_measure():
    """P0(capital ever >= 1 / alpha) = E_Q[1 / E at that time], whose standard error the bound allows for."""
    alpha = 3.3e-9
    weights = alarms.weights_at_the_crossing(alpha, runs=200)
    assert np.mean(weights) + stats.norm.isf(1e-6) * stats.sem(weights) <= alpha
    assert np.mean(weights) > alpha / 1000  # the bound is of use


@pytest.mark.parametrize("bias", [0.0, 0.02, -0.02])
def test_wrong_verdicts_are_as_rare_as_promised(bias):
    """At alpha = beta = 5 %, 300 runs: the number of wrong verdicts is no larger than the binomial allows."""
    rng, wrong, right = np.random.default_rng(), 0, 0
    for _ in range(300):
        test = Test(Claim("uniform", 1.0, 0.0, 2.04, 0.02, alpha=0.05, beta=0.05))
        while test.outcome == "INCONCLUSIVE":
            test.update((1 + bias) * 2.0 * rng.random(512))
        wrong += test.outcome == ("FAIL" if bias == 0 else "PASS")
        right += test.outcome == ("PASS" if bias == 0 else "FAIL")
    assert wrong + right == 300
    assert wrong <= stats.binom.isf(1e-6, 300, 0.05)


def test_power_is_as_predicted():
    """statistics: N_PASS about 23 cv^2 / delta^2, N_FAIL about 47 cv^2 / bias^2; the worst seen is 2.2 times that."""
    rng, cv2 = np.random.default_rng(), 1 / 3
    for bias, predicted, outcome in ((0.0, 23 * cv2 / 1e-4, "PASS"), (0.05, 47 * cv2 / 0.05**2, "FAIL")):
        test = Test(Claim("uniform", 1.0, 0.0, 2.2, 0.01))
        while test.outcome == "INCONCLUSIVE":
            test.update((1 + bias) * 2.0 * rng.random(256))
        assert test.outcome == outcome
        assert test.samples < 3 * predicted


def test_the_interval_covers():
    """300 intervals at 90 %, each looked at once: at most as many misses as the binomial allows."""
    rng, missed = np.random.default_rng(), 0
    for _ in range(300):
        histogram = Histogram(edges_for(0.0, 1.0, 0.5, 0.2))
        histogram.add(rng.beta(2, 5, 2000))
        low, high = interval(histogram, 0.1)
        missed += not low <= 2 / 7 <= high
        assert high - low < 0.04
    assert missed <= stats.binom.isf(1e-6, 300, 0.1)


def test_a_sample_out_of_range_fails_at_once():
    test = Test(Claim("bounded", 1.0, 0.0, 2.0, 0.01))
    assert test.update(np.full(10, 1.0)) == "INCONCLUSIVE"
    assert test.update(np.array([1.0, 2.5])) == "FAIL"
    assert "2.5 is outside [0, 2]" in str(test.verdict())


@pytest.mark.parametrize("bad", [math.nan, math.inf, -1e-9])
def test_nan_infinity_and_negative_light_are_out_of_range(bad):
    test = Test(Claim("bounded", 1.0, 0.0, 2.0, 0.01))
    assert test.update(np.array([1.0, bad])) == "FAIL"


def test_few_observations_decide_nothing():
    test = Test(Claim("uniform", 1.0, 0.0, 2.0, 0.01))
    test.update(np.linspace(0.5, 1.5, 100))
    verdict = test.verdict()
    assert verdict.outcome == "INCONCLUSIVE"
    assert verdict.samples == 100
    assert verdict.interval[0] < 1.0 < verdict.interval[1]


def test_a_constant_that_is_right_passes_and_one_that_is_wrong_fails():
    for value, outcome in ((1.0, "PASS"), (1.02, "FAIL")):
        test = Test(Claim("constant", 1.0, 0.0, 2.0, 0.01))
        for _ in range(40):
            test.update(np.full(1000, value))
        assert test.outcome == outcome


def test_a_test_does_not_forget_what_it_said():
    test = Test(Claim("constant", 1.0, 0.0, 2.0, 0.01))
    test.update(np.full(20000, 1.5))
    assert test.outcome == "FAIL"
    assert test.update(np.full(100000, 0.9)) == "FAIL"


def test_capital_against_an_impossible_mean_is_not_made():
    histogram = Histogram(edges_for(0.0, 1.0, 0.5, 0.1))
    assert upward(histogram, 0.0, 0.0) == 0.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"truth": 3.0}, "low <= truth <= high"), ({"delta": 0.0}, "delta above"), ({"alpha": 0.0}, "between 0 and 1"),
        ({"truth_error": 0.02}, "delta above"), ({"high": math.nan}, "low <= truth"),
    ],
)  # fmt: skip
def test_a_claim_that_makes_no_sense_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        Claim(**({"name": "x", "truth": 1.0, "low": 0.0, "high": 2.0, "delta": 0.01} | change))


@pytest.mark.parametrize("delta", [1e-300, 1e-170, 1e-150])
def test_a_claim_about_next_to_nothing_is_judged(delta):
    """Black where black is due, however small what is looked for: squares of it are 0."""
    test = Test(Claim("black", 0.0, -1.0, 1.0, np.float64(delta), alpha=1e-6))
    test.update(np.zeros(1000))
    assert test.outcome != "FAIL"
