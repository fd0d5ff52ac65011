"""Trials: every built-in shade() passes the trials of its slide, and mistakes that students make do not.

Each run has random numbers of its own; a failing test prints the token that replays it (RAYLAB_ENTROPY=token).
All tests of this file together raise a false alarm with probability at most 1e-6.
"""

from __future__ import annotations

import os

import numpy as np
import pytest
import students

from raylab import trials
from raylab.errors import UserError
from raylab.stats import Budget
from raylab.strategies import BUILT_IN
from raylab.testing import Examiner, Source
from raylab.trials import CATALOGUE

pytestmark = pytest.mark.compiled(reason="a hundred thousand samples each")
EXAMINER = Examiner(Budget.replay(os.environ["RAYLAB_ENTROPY"]) if "RAYLAB_ENTROPY" in os.environ else Budget())
ALL = [(name, technique) for name in CATALOGUE for technique in trials.make(name, 0).answers]
QUICK = {
    "points_and_suns": ("point_light", "directional_light", "basic"),
    "polygons": ("area_diffuse", "area", "mis_power", "one_light_uniform", "one_light_power"),
    "gradient_sky": ("env_uniform", "env_cosine", "env_brdf", "env_brightness"),
    "ball_before_sky": ("env_uniform", "env_cosine", "env_brdf", "env_brightness"),
    "glossy_sky": ("glossy_phong", "glossy_jitter", "glossy_normal", "env_brdf"),
    "glossy_gradient": ("glossy_phong", "glossy_jitter", "glossy_normal", "env_brdf"),
    "rising_light": ("area_diffuse",),
    "crossing_edge": ("direct",),
    "lens_before_focus": ("direct",),
    "lens_behind_focus": ("direct",),
}


def test_every_built_in_shade_has_two_trials():
    for name in BUILT_IN:
        assert len([trial for trial, technique in ALL if technique == name]) >= 2, name


@pytest.mark.parametrize("name", CATALOGUE)
def test_a_trial_is_generic(name):
    """No two channels alike, no right angles, another scene for each seed; truth below the bound."""
    one, two = trials.make(name, 1), trials.make(name, 2)
    again = trials.make(name, 1)
    for technique, answer in one.answers.items():
        assert np.all(answer.truth < answer.bound)
        assert np.all(answer.truth > 0.0)
        assert len(set(np.round(answer.truth, 6))) == 3
        np.testing.assert_array_equal(answer.truth, again.answer(technique).truth)
        assert not np.isin(answer.truth, two.answer(technique).truth).any()
    assert np.abs(np.diag(one.description.camera.to_world)[:3] - 1.0).max() > 1e-3


@pytest.mark.parametrize(("name", "technique"), [(n, t) for n, group in QUICK.items() for t in group])
def test_built_in_shades_pass(name, technique):
    report = EXAMINER.unbiased(technique, trial=name, delta=0.03)
    assert report.outcome == "PASS", report


@pytest.mark.certify
@pytest.mark.parametrize(("name", "technique"), ALL)
def test_built_in_shades_pass_at_one_percent(name, technique):
    report = Examiner(EXAMINER.budget).unbiased(technique, technique, trial=trials.make(name, 3), delta=0.01)
    assert report.outcome == "PASS", report


# --- mistakes ---


@pytest.mark.parametrize(
    ("technique", "shade", "trial"),
    [
        ("area_diffuse", students.without_shadow, "polygons"),
        ("area_diffuse", students.one_over_r, "polygons"),
        ("env_cosine", students.cosine_twice, "gradient_sky"),
        ("env_uniform", students.half_the_hemisphere, "gradient_sky"),
    ],
)
def test_mistakes_fail(technique, shade, trial):
    report = EXAMINER.unbiased(technique, shade, trial=trial)
    assert report.outcome == "FAIL", report


def test_other_claims_about_the_same_estimator():
    assert EXAMINER.same_mean("env_uniform", "env_cosine", trial="gradient_sky", delta=0.03).outcome == "PASS"
    assert EXAMINER.shrinks("env_uniform", trial="gradient_sky").outcome == "PASS"
    assert EXAMINER.independent("env_uniform", trial="gradient_sky").outcome == "PASS"
    assert EXAMINER.variance("direct", trial="lens_before_focus").outcome == "PASS"
    # right on average, but it is the other technique
    other = EXAMINER.variance("env_uniform", "env_cosine", trial="gradient_sky")
    assert other.outcome == "FAIL", other


def test_what_a_trial_does_not_know_is_named():
    with pytest.raises(UserError, match="unknown trial 'nothing'"):
        trials.make("nothing", 1)
    with pytest.raises(UserError, match="has no answer for 'env_cosine'"):
        EXAMINER.unbiased("env_cosine", trial="polygons")


# --- samples from elsewhere ---


class Elsewhere:
    """As if the samples of a shade() came from another process."""

    def __init__(self, shade):
        self.shade = shade

    def draws(self, trial, seed):
        return trial.probe(self.shade, 1).draws(seed)


class Dim(Elsewhere):
    def draws(self, trial, seed):
        draw = super().draws(trial, seed)
        return lambda n: 0.8 * draw(n)


def test_any_source_of_samples_can_be_examined():
    right, dim, sky = Elsewhere("env_uniform"), Dim("env_uniform"), {"trial": "gradient_sky"}
    assert isinstance(right, Source)
    examiner = Examiner(Budget(tests=1000))  # a budget of its own: the names are those of the classes
    assert examiner.unbiased("env_uniform", right, delta=0.03, **sky).outcome == "PASS"
    report = examiner.unbiased("env_uniform", dim, **sky)
    assert report.outcome == "FAIL"
    assert "unbiased env_uniform Dim gradient_sky" in report.name
    assert examiner.same_mean("env_uniform", "env_cosine", right, delta=0.03, **sky).outcome == "PASS"
    assert examiner.same_mean("env_uniform", "env_cosine", dim, delta=0.03, **sky).outcome == "FAIL"
    assert examiner.variance("env_uniform", right, **sky).outcome == "PASS"
    assert examiner.variance("env_uniform", dim, **sky).outcome == "FAIL"
    for claim in (examiner.shrinks, examiner.independent, lambda *a, **k: examiner.more_rays(*a, delta=0.05, **k)):
        assert claim("env_uniform", right, **sky).outcome == "PASS"
    for relation in ("times_8", "rotated", "exposure_3"):
        assert examiner.relation(relation, "env_uniform", right, delta=0.03, **sky).outcome == "PASS"
    with pytest.raises(UserError, match="Elsewhere: expected a function"):
        examiner.well_behaved("env_uniform", right, **sky)
