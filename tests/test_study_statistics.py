"""Statistics of a study: intervals that cover as often as stated, slopes, ratios, and doubts that are said."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from raylab.stats import intervals as st
from raylab.stats.convergence import fit
from raylab.stats.efficiency import efficiency_ratio
from raylab.stats.intervals import Estimate
from raylab.study.look import spread


def interval_of(shares):
    """99.9 % interval for the number of successes in trials of the given probability."""
    trials, probability = shares
    return stats.binom.interval(0.999, trials, probability)


@pytest.mark.parametrize(("size", "coverage"), [(1, 0.916), (3, 0.934), (300, 0.946)])
def test_interval_of_a_variance_covers_as_often_as_stated(size, coverage):
    """20 repeats of `size` normal numbers with variance 1; `coverage` was measured in 4000 other trials."""
    rng, trials, held = np.random.default_rng(11), 1000, 0
    for _ in range(trials):
        values = rng.standard_normal((20, size))
        deviations = ((values - values.mean(axis=0)) ** 2).mean(axis=1) * 20 / 19
        estimate = st.mean_interval(deviations)
        held += estimate.low <= 1.0 <= estimate.high
    low, high = interval_of((trials, coverage))
    assert low <= held <= high


@pytest.mark.parametrize("exponent", [-1.0, -0.5, -1.5])
def test_slope_of_a_power_law(exponent):
    x = [1.0, 4.0, 16.0, 64.0]
    y = [Estimate(3.0 * a**exponent, 2.7 * a**exponent, 3.3 * a**exponent) for a in x]
    fitted = fit(x, y, repeats=20)
    assert fitted is not None
    assert fitted.value == pytest.approx(exponent, abs=1e-12)
    assert fitted.low < exponent < fitted.high
    assert fitted.doubts == ()


def test_interval_of_a_slope_covers_the_truth():
    """Variances of normal pictures at four sizes; the slope -1 must be inside in 95 % of the trials."""
    rng, trials, held, x = np.random.default_rng(2), 400, 0, [1.0, 4.0, 16.0, 64.0]
    for _ in range(trials):
        y = []
        for n in x:
            values = rng.standard_normal((20, 50)) / np.sqrt(n)
            y.append(st.mean_interval(((values - values.mean(axis=0)) ** 2).mean(axis=1) * 20 / 19))
        fitted = fit(x, y, 20)
        held += fitted.low <= -1.0 <= fitted.high
    assert held >= interval_of((trials, 0.95))[0]


def test_slope_says_when_there_is_no_line():
    x = [1.0, 4.0, 16.0, 64.0]
    y = [Estimate(v, 0.99 * v, 1.01 * v) for v in (1.0, 0.9, 0.2, 0.001)]
    fitted = fit(x, y, repeats=20)
    assert "do not lie on a line" in " ".join(fitted.doubts)
    assert fit(x[:1], y[:1], 20) is None


def test_efficiency_ratio_of_known_costs():
    rng = np.random.default_rng(4)
    drift = np.exp(rng.normal(0.0, 1.0, 40))  # a machine with slow spells, the same for both in each block
    fast, slow = 0.1 * drift, 0.3 * drift
    ratio = efficiency_ratio(Estimate(1.0, 0.9, 1.1), fast, Estimate(2.0, 1.8, 2.2), slow)
    assert ratio.value == pytest.approx(6.0)
    assert ratio.low < 6.0 < ratio.high
    assert ratio.high < 8.0  # times are compared within blocks, so the drift of e^1 cancels


def test_doubts_are_said():
    assert "only 3 repeats" in st.mean_interval(np.array([1.0, 1.1, 0.9])).doubts
    heavy = np.r_[np.full(29, 1e-3), 1.0]
    assert any("heavy tail" in d for d in st.mean_interval(heavy).doubts)
    crowded = np.r_[np.ones(999), 500.0]
    assert "one pixel carries 33 %" in st.crowding(crowded)
    assert st.crowding(np.ones(1000)) == ""


def test_error_below_that_of_the_reference_is_not_a_number():
    estimate = st.mean_interval(np.full(20, 1.9), less=1.0)
    assert (estimate.value, estimate.low) == (0.0, 0.0)
    assert "below the reference's own error" in estimate.doubts
    assert st.mean_interval(np.linspace(4.0, 6.0, 20), less=1.0).value == pytest.approx(4.0)


def test_labels_are_spread():
    placed = spread(np.array([0.1, 0.11, 0.12, 0.9]), 0.1)
    assert np.all(np.diff(placed) >= 0.1 - 1e-12)
    np.testing.assert_allclose(placed, [0.01, 0.11, 0.21, 0.9])
