"""Studies of estimators without a variance: no interval; their cures keep theirs, and what is bounded is no tail."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scene_text import LAMP_ON_FLOOR

import raylab
from raylab.stats.tails import infinite_variance
from raylab.study import study
from raylab.study.results import Estimator


@pytest.fixture(scope="module")
def touching(tmp_path_factory):
    """Points by area on a light that touches the floor: tail index 3/2. By solid angle and combined: bounded."""
    path = tmp_path_factory.mktemp("touching") / "scene.xml"
    path.write_text(LAMP_ON_FLOOR)
    shades = ["area", "area_solid_angle", "mis_balance"]
    return study(raylab.load(path), shades, spp=[1, 4], repeats=12, threads=1, seed=3)


def test_an_estimator_without_variance_gets_no_interval(touching, tmp_path):
    area, *cures = touching.estimators
    said = touching.infinite[area]
    assert said.startswith("infinite variance: the interval is not trusted (tail index 1.")
    for level in touching.measured[area]:
        assert [e.high for e in (level.variance, level.rmse)] == [math.inf, math.inf]
    assert touching.variance_slope(area) is None
    assert math.isinf(touching.relative_efficiency(cures[0]).high)
    assert f"{area.label}: {said}." in touching.notes()
    assert touching.summary().count("(interval not trusted)") == 3  # all are relative to the first
    page = touching.write(tmp_path).read_text()
    assert page.count("(interval not trusted)") > 4
    assert said in page.replace("&#43;", "+")


def test_its_cures_keep_their_intervals(touching):
    for cure in touching.estimators[1:]:
        assert touching.infinite[cure] == ""
        assert all(np.isfinite(level.variance.high) for level in touching.measured[cure])
        assert not any(note.startswith(cure.label) and "infinite" in note for note in touching.notes())
    assert touching.disagreements() == []


def test_the_reference_is_by_an_estimator_with_a_variance(touching):
    """`direct` samples the light by area, as the first estimator does."""
    assert touching.infinite[Estimator("direct", "sobol")]
    assert "shade area_solid_angle" in touching.truth.source
    assert touching.reference_doubt == ""


def pareto(index, n=1 << 18):
    return np.random.default_rng(8).pareto(index, n) + 1.0


@pytest.mark.parametrize(("index", "infinite"), [(1.2, True), (1.5, True), (2.5, False), (4.0, False)])
def test_infinite_variance_of_a_power_law(index, infinite):
    assert bool(infinite_variance(pareto(index))) == infinite


@pytest.mark.parametrize("share", [1e-2, 1e-3, 4e-4, 1e-4, 1e-5])
def test_a_sun_that_is_rarely_hit_has_a_variance(share):
    """1e5 or something below 1: bounded, though Hill's index is below 2 on one scale or another."""
    rng = np.random.default_rng(1)
    values = np.where(rng.random(1 << 18) < share, 1e5, rng.random(1 << 18))
    assert infinite_variance(values) == ""


@pytest.mark.parametrize("n", [1e2, 1e3, 1e4, 1e5])
def test_a_narrow_lobe_has_a_variance(n):
    """cos^n, uniform in solid angle: the logarithm is linear in the rank."""
    assert infinite_variance(np.random.default_rng(2).random(1 << 18) ** n) == ""


def test_lights_that_are_seen_are_no_tail():
    """A power law that ends at the brightest light."""
    values = np.minimum(pareto(1.0), 1e5)
    assert infinite_variance(values)
    assert infinite_variance(values, bound=1e5) == ""
