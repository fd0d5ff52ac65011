"""The leaderboard: variance times rays, of right submissions only, whatever a submission claims.

Statistical bounds: z = 5, a false alarm of 6e-7 for each of the two comparisons.
"""

from __future__ import annotations

import csv
import math
from dataclasses import replace

import numpy as np
import pytest

from raylab import trials
from raylab.grading import course
from raylab.grading.assignment import load
from raylab.grading.course import Entry, write_gradebook
from raylab.grading.dashboard import leaderboard, write_dashboard
from raylab.grading.faults import Fault, GraderFault
from raylab.grading.judge import Judge
from raylab.grading.judged import Judged
from raylab.grading.ranking import SAMPLES, column
from raylab.grading.results import Results, problems
from raylab.grading.source import InProcess

A1, TASK = load("a1"), "a1.diffuse"
VARIANCE = next(p for p in A1.properties if p.claim == "variance")
PASSED = [Judged(p.task, p.name, "PASS", p.points, p.points, p.says) for p in A1.properties]


class Claims:
    """Normal samples of the right mean and a part of the right variance; it claims any number of rays."""

    def __init__(self, rays, part=1.0):
        self.claimed, self.part = rays, part

    def samples(self, task, trial, trial_seed, seed, first, n):
        answer = trials.make(trial, trial_seed).answer("area_diffuse")
        spread = np.sqrt(self.part * answer.variance)
        return answer.truth + spread * np.random.default_rng(seed + first).normal(size=(n, 3))

    def rays(self, task, trial, trial_seed, seed, n):
        if isinstance(self.claimed, Exception):
            raise self.claimed
        return self.claimed * n


def value(source, judged=PASSED):
    judge = Judge(A1, source, 7)
    judge._variance(VARIANCE)
    judge.judged = list(judged)
    rows = judge.leaderboard()
    assert all((name, order) == (column(TASK), "asc") for name, _, order in rows)
    assert problems(Results(leaderboard=rows, not_graded="-").as_json()) == []
    return rows[0][1] if rows else None


def test_variance_times_rays():
    """The variance of n normal samples has the relative standard error sqrt(2 / n); three digits are shown."""
    off = 5.0 * math.sqrt(2.0 / SAMPLES) + 0.005
    assert value(Claims(1.0)) == pytest.approx(1.0, rel=off)
    assert value(Claims(3.0, part=0.25)) == pytest.approx(0.75, rel=off)


@pytest.mark.parametrize("claim", [0.0, -1e9, 1e-300, 1.0])
def test_no_claim_counts_for_less_than_a_ray(claim):
    assert value(Claims(claim)) == value(Claims(1.0))


@pytest.mark.parametrize("claim", [math.nan, math.inf, Fault("crash", "gone"), GraderFault("no worker")])
def test_a_claim_that_is_no_number_has_no_value(claim):
    assert value(Claims(claim)) is None


@pytest.mark.parametrize("outcome", ["FAIL", "INCONCLUSIVE", "ERROR"])
def test_only_right_submissions_have_a_value_whatever_their_variance(outcome):
    for i, judged in enumerate(PASSED):
        changed = [*PASSED[:i], replace(judged, outcome=outcome), *PASSED[i + 1 :]]
        assert (value(Claims(1.0), changed) is None) == (judged.name != VARIANCE.name)
    assert value(Claims(1.0), PASSED[:1]) is None


@pytest.mark.compiled
def test_the_slides_technique_traces_a_ray_for_each_lamp_that_faces_x():
    """Slide "Area source by Monte Carlo (diffuse)": one lamp in plain sight, the others dark below the horizon; then
    three, of which each sample sees the face."""
    own = InProcess({TASK: "area_diffuse"})
    assert own.rays(TASK, "lesson_area_plain", 3, 5, 1000) == 1000.0
    assert own.rays(TASK, "lesson_area_several", 3, 5, 1000) == 3000.0
    assert own.rays(TASK, "lesson_area_plain", 3, 5, 10) == 10.0


@pytest.mark.compiled
def test_the_slides_technique_has_the_value_one():
    """Its samples are not normal: the standard error of their variance follows from their fourth moment."""
    judge = Judge(A1, InProcess({TASK: "area_diffuse"}), 7)
    judge._variance(VARIANCE)
    judge.judged = list(PASSED)
    asked, _, seed = judge._scattered[TASK]
    x = asked.sample(seed, SAMPLES)[:, 1]
    kurtosis = ((x - x.mean()) ** 4).mean() / x.var() ** 2
    off = 5.0 * math.sqrt((kurtosis - 1.0) / SAMPLES) + 0.005
    assert judge.leaderboard()[0][1] == pytest.approx(1.0, rel=off)


def test_gradebook_and_dashboard_show_it(tmp_path, monkeypatch):
    values = {"ann": 0.97, "bob <b>": 0.01, "eve": None}
    every = [Entry(name, tmp_path / "x.py", tmp_path / str(i)) for i, name in enumerate(values)]

    def results(entry):
        found = values[entry.name]
        rows = [] if found is None else [{"name": column(TASK), "value": found, "order": "asc"}]
        return {"tests": [], "extra_data": {"status": "graded"}, "leaderboard": rows}

    monkeypatch.setattr(course.Entry, "results", property(results))
    write_gradebook(A1, every, tmp_path / "gradebook.csv")
    rows = list(csv.DictReader((tmp_path / "gradebook.csv").read_text().splitlines()))
    assert [row[column(TASK)] for row in rows] == ["0.97", "0.01", ""]
    write_dashboard(A1, every, tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text().partition("<h2>Leaderboard</h2>")[2]
    assert page.index("<tr class=none><td>1</td><td>bob &lt;b&gt;</td>") < page.index("<tr><td>2</td><td>ann</td>")
    assert leaderboard([]) == []
