"""Lessons: the built-in shade() of each slide has the mean, the bound and the variance that its lesson says."""

from __future__ import annotations

import numba
import numpy as np
import pytest

from raylab import trials
from raylab.stats.budget import Budget
from raylab.testing import Examiner
from raylab.trials import LESSONS

ANSWERS = [(name, technique) for name in LESSONS for technique in trials.make(name, 0).answers]
SELECTED = [  # one kernel for each of these families
    (name, technique)
    for name, technique in ANSWERS
    if (name.startswith("lesson_area_") and "glossy" not in name and technique == "area_diffuse")
]
OTHERS = [pair for pair in ANSWERS if pair not in SELECTED]
BUDGET = Budget(tests=2 * len(ANSWERS))


@pytest.fixture(scope="module")
def examiner():
    return Examiner(BUDGET)


def look(examiner, name, technique):
    """What is found of its mean, and of its variance where that is known."""
    reports = [examiner.unbiased(technique, trial=name, delta=0.03)]
    if trials.make(name, 0).answers[technique].variance is not None:
        reports.append(examiner.variance(technique, trial=name, tolerance=0.1))
    return reports


@pytest.mark.xdist_group("lessons")
@pytest.mark.parametrize(("name", "technique"), SELECTED)
def test_a_lesson_knows_the_answer(examiner, name, technique):
    assert [str(r) for r in look(examiner, name, technique) if r.outcome != "PASS"] == []


@pytest.mark.certify
@pytest.mark.xdist_group("lessons")
@pytest.mark.parametrize(("name", "technique"), OTHERS)
def test_every_lesson_knows_the_answer(examiner, name, technique):
    assert [str(r) for r in look(examiner, name, technique) if r.outcome != "PASS"] == []


@pytest.mark.parametrize("family", ["area", "area_glossy", "sky", "sky_glossy", "mix", "mix_glossy"])
def test_one_kernel_serves_a_family(family):
    """So that a submission is compiled once."""
    names = [n for n in LESSONS if n.rpartition("_")[0] == f"lesson_{family}"]
    assert len(names) >= 3
    assert len({numba.typeof(trials.make(name, seed).scene.data) for name in names for seed in (1, 2)}) == 1


@pytest.mark.parametrize("name", LESSONS)
def test_lessons_differ_by_seed_and_by_channel(name):
    first, second = (next(iter(trials.make(name, seed).answers.values())) for seed in (1, 2))
    assert np.all(first.truth > 0.0)
    assert np.all(np.abs(first.truth / second.truth - 1.0) > 1e-6)
    assert len(set(first.truth)) == 3
    assert np.all(first.bound >= first.truth)
