"""Each claim passes what is right and fails what is wrong; counts and tails say what they should."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats
from scipy.special import gammaln, logsumexp

from raylab.stats import (
    Claim,
    Counts,
    decide,
    mean_is,
    same_mean,
    shrinks_as,
    uncorrelated,
    variance_is,
    variance_ratio_is,
)  # fmt: skip
from raylab.stats.multinomial import STRENGTHS
from raylab.stats.tails import is_trusted, rule_of_three, tail_index, wilson

RNG = np.random.default_rng()  # a true claim fails, and a wrong one passes, once in 1000 runs or less


def uniform(n):
    """Mean 1, variance 1/3, in [0, 2]."""
    return 2.0 * RNG.random(n)


def narrow(n):
    """Mean 1, variance 1/12, in [0.5, 1.5]."""
    return 0.5 + RNG.random(n)


def mean_of_uniform(samples, n):
    return uniform(samples * n).reshape(n, samples).mean(axis=1)


def mean_of_same(samples, n):
    """Half of the samples are copies of the other half."""
    few = uniform(max(1, samples // 2) * n).reshape(n, -1)
    return few.mean(axis=1)


def pairs(n):
    return uniform(n), uniform(n)


def sharing_pairs(n):
    x, y = pairs(n)
    return x, np.where(RNG.random(n) < 0.2, x, y)


@pytest.mark.parametrize(
    ("right", "claim"),
    [
        (True, lambda: mean_is("mean", uniform, 1.0, high=2.0)),
        (False, lambda: mean_is("mean", lambda n: 1.05 * uniform(n), 1.0, high=2.1)),
        (True, lambda: mean_is("mean within its error", lambda n: 1.001 * uniform(n), 1.0, high=2.1, truth_error=2e-3)),
        (True, lambda: same_mean("two estimators", uniform, narrow, high_x=2.0, high_y=1.5)),
        (False, lambda: same_mean("two estimators", uniform, lambda n: 0.95 * narrow(n), high_x=2.0, high_y=1.5)),
        (True, lambda: variance_is("variance", uniform, 1 / 3, high=2.0)),
        (False, lambda: variance_is("averages two", lambda n: 0.5 * (uniform(n) + uniform(n)), 1 / 3, high=2.0)),
        (False, lambda: variance_is("the answer itself", lambda n: np.ones(n), 1 / 3, high=2.0)),
        (True, lambda: variance_ratio_is("ratio", uniform, narrow, 4.0, high_x=2.0, high_y=1.5)),
        (False, lambda: variance_ratio_is("ratio", uniform, narrow, 3.0, high_x=2.0, high_y=1.5)),
        (True, lambda: shrinks_as("1 / N", mean_of_uniform, 16, high=2.0)),
        (False, lambda: shrinks_as("1 / N", mean_of_same, 16, high=2.0)),
        (True, lambda: uncorrelated("calls", pairs, 1.0, high=2.0)),
        (False, lambda: uncorrelated("calls", sharing_pairs, 1.0, high=2.0)),
    ],
)  # fmt: skip
def test_claims(right, claim):
    verdict = claim()
    assert verdict.outcome == ("PASS" if right else "FAIL"), str(verdict)
    assert verdict.claim in str(verdict)


def test_patience_ends_as_inconclusive_and_says_what_would_have_been_caught():
    verdict = decide(Claim("uniform", 1.0, 0.0, 2.0, 0.001), uniform, 5000)
    assert verdict.outcome == "INCONCLUSIVE"
    assert verdict.samples == 5000
    # 0.577 sqrt(2 ln(2 / beta) / 5000) = 0.032 is the best that any interval could do; the bets pay for choosing
    assert 0.02 < verdict.detectable < 0.1


# --- counts ---


def test_evidence_is_the_likelihood_ratio_of_the_dirichlet_mixture():
    p, n = np.array([0.2, 0.3, 0.5]), np.array([5, 1, 9])
    counts = Counts(p)
    counts.add(np.repeat(np.arange(3), n))
    marginal = [
        gammaln(a) - gammaln(a + n.sum()) + (gammaln(a * p + n) - gammaln(a * p)).sum() - (n * np.log(p)).sum()
        for a in STRENGTHS
    ]
    assert counts.log_evidence() == pytest.approx(logsumexp(marginal) - math.log(len(STRENGTHS)), rel=1e-12)


def test_evidence_is_a_martingale_of_mean_one():
    """The exact mean over all outcomes of six draws from three cells is 1."""
    p, total = np.array([0.2, 0.3, 0.5]), 0.0
    for i in range(7):
        for j in range(7 - i):
            n = np.array([i, j, 6 - i - j])
            counts = Counts(p)
            counts.add(np.repeat(np.arange(3), n))
            total += stats.multinomial.pmf(n, 6, p) * math.exp(counts.log_evidence())
    rounding = 4 * 2.0**-53 * gammaln(STRENGTHS[-1] + 6)  # of the largest terms, which nearly cancel
    assert total == pytest.approx(1.0, rel=rounding)


def test_true_counts_raise_no_alarm_and_wrong_ones_do():
    p = np.full(128, 1 / 128)
    right, wrong = Counts(p), Counts(p)
    right.add(RNG.integers(0, 128, 200_000))
    wrong.add((RNG.random(200_000) ** 1.05 * 128).astype(int))
    assert right.log_evidence() < math.log(1e9)
    assert wrong.log_evidence() > math.log(1e9)


def test_what_cannot_happen_refutes_at_once():
    counts = Counts(np.array([0.5, 0.5]))
    counts.add(np.array([0, 1, -1]))
    assert counts.log_evidence() == math.inf
    missing = Counts(np.array([0.5, 0.4]))  # one in ten is elsewhere
    missing.add(np.array([0, 1, -1]))
    assert missing.log_evidence() < math.inf


def test_probabilities_are_checked():
    with pytest.raises(ValueError, match="sum of at most 1"):
        Counts(np.array([0.7, 0.7]))


# --- tails ---


@pytest.mark.parametrize("index", [1.2, 1.5, 3.0])
def test_hill_finds_the_index_of_a_pareto_tail(index):
    """Exactly Pareto: k / (sum of logs) with k = 1000; a / sqrt(k) is its standard error."""
    found, error = tail_index(RNG.pareto(index, 100_000) + 1.0)
    assert abs(found - index) < stats.norm.isf(1e-6 / 6) * error


def test_infinite_variance_is_not_trusted_and_bounded_values_are():
    assert not is_trusted(RNG.pareto(1.5, 100_000) + 1.0)
    assert is_trusted(uniform(100_000))
    assert is_trusted(np.ones(1000))


def test_intervals_of_rare_hits():
    """Wilson 1927: the roots of (p - hits / n)^2 = z^2 p (1 - p) / n."""
    low, high = wilson(3, 1000)
    z = stats.norm.isf(0.025)
    for p in (low, high):
        assert (p - 0.003) ** 2 == pytest.approx(z**2 * p * (1 - p) / 1000, rel=1e-9)
    assert (1.0 - rule_of_three(1000)) ** 1000 == pytest.approx(0.05, rel=1e-9)
