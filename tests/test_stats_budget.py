"""The budget of a suite: no more than the total is spent, and one token replays every test of a run."""

from __future__ import annotations

import re

import pytest

from raylab.stats.budget import Budget


def test_the_shares_of_a_full_suite_add_up_to_the_total_and_no_more():
    budget = Budget(1e-6, tests=10)
    shares = [budget.test("heavy", weight=4.0), *(budget.test(f"test {i}") for i in range(6))]
    assert sum(share.alpha for share in shares) == pytest.approx(1e-6, rel=1e-12)
    assert budget.false_alarm == pytest.approx(1e-6, rel=1e-12)
    with pytest.raises(ValueError, match="used up"):
        budget.test("one too many")


def test_a_second_look_under_the_same_name_is_refused():
    budget = Budget()
    budget.test("area")
    with pytest.raises(ValueError, match="another test"):
        budget.test("area")


@pytest.mark.parametrize("more", [{}, {"tests": 20}, {"total": 0.1 + 0.2, "tests": 7.5}])
def test_a_token_replays_alphas_and_seeds_in_any_order(more):
    names = [f"test {i}" for i in range(5)]
    first = Budget(**more)
    again = Budget.replay(first.token)
    shares = {name: first.test(name) for name in names}
    assert {name: again.test(name) for name in reversed(names)} == shares
    assert again.token == first.token


def test_fresh_budgets_differ_and_so_do_names_and_children():
    seeds = [Budget().test("a").seed for _ in range(50)]
    one = Budget(entropy=5)
    shares = [one.test(str(i)) for i in range(50)]
    seeds += [share.seed for share in shares] + [shares[0].child(i) for i in range(50)]
    assert len(set(seeds)) == 150  # equal by chance with probability 150^2 / 2^64
    assert all(0 <= seed < 1 << 63 for seed in seeds)


@pytest.mark.parametrize("token", ["", "hello", "12/3", "12/3/4/5", "12/1e-6/none", "-5", "12/2/300"])
def test_what_is_no_token_is_named(token):
    with pytest.raises(ValueError, match=re.escape("expected a replay token such as 1f03a9")):
        Budget.replay(token)


@pytest.mark.parametrize("bad", [{"total": 0.0}, {"total": 1.0}, {"tests": 0}, {"entropy": -1}])
def test_bad_budgets_are_refused(bad):
    with pytest.raises(ValueError, match="expected"):
        Budget(**bad)
    with pytest.raises(ValueError, match="positive weight"):
        Budget().test("nothing", weight=0.0)
