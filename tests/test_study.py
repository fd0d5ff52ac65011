"""Studies: honest intervals, slopes, truths, and files that need nothing else."""

from __future__ import annotations

import csv
import dataclasses
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from scene_text import LAMP_ON_FLOOR, LAMP_OVER_FLOOR
from scipy import stats

import raylab
from raylab.errors import UserError
from raylab.image import Image
from raylab.stats import intervals as st
from raylab.stats.convergence import fit
from raylab.stats.efficiency import efficiency_ratio
from raylab.stats.intervals import Estimate
from raylab.stats.tails import infinite_variance
from raylab.study import find_truth, measure, plots, study
from raylab.study.look import figure, spread
from raylab.study.results import COLUMNS, Estimator
from raylab.study.truth import Truth

SIZE, SPP, REPEATS = 4, [1, 4, 16], 12


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scene")
    (folder / "scene.xml").write_text(LAMP_OVER_FLOOR)
    return folder


@pytest.fixture(scope="module")
def result(folder):
    scene = raylab.load(folder / "scene.xml")
    return study(scene, ["direct", "area"], spp=SPP, repeats=REPEATS, threads=1, seed=5)


def interval_of(shares):
    """99.9 % interval for the number of successes in trials of the given probability."""
    trials, probability = shares
    return stats.binom.interval(0.999, trials, probability)


# --- statistics ---------------------------------------------------------------------------------------------------


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


def test_deviations_average_to_the_sample_variance(result):
    """The column "deviation" is the unbiased variance, found again from the means of a one-channel quantity."""
    values = np.random.default_rng(3).random((7, 30)).astype(np.float32)
    e = result.estimators[0]
    other = measure.Study.empty(result.scene, [e], [1], 7, 0, 1)
    rows = [measure.Row(**{**vars(result.rows[0]), "repeat": r, "estimator": e.label}) for r in range(7)]
    measure._close_level(other, 1, rows, {e: list(values)})
    expected = values.astype(float).var(axis=0, ddof=1).mean()
    np.testing.assert_allclose(
        np.mean([row.deviation for row in other.rows]), expected, rtol=30 * np.finfo(np.float32).eps
    )


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


# --- measuring ----------------------------------------------------------------------------------------------------


def test_every_render_is_a_row(result):
    assert len(result.rows) == 2 * len(SPP) * REPEATS
    assert len({row.seed for row in result.rows}) == len(result.rows)
    for row in result.rows:
        assert row.camera_rays == SIZE * SIZE * row.spp
        assert row.seconds > 0.0
        assert np.isfinite([row.squared_error, row.deviation]).all()
    blocks = {(row.spp, row.repeat, row.place): row.shade for row in result.rows}
    for n in SPP:
        assert [blocks[n, r, 0] for r in range(4)] == ["direct", "area", "direct", "area"]  # ABBA


def test_variance_falls_like_one_over_n(result):
    for e in result.estimators:
        slope = result.variance_slope(e)
        half = (slope.high - slope.low) / 2.0
        assert abs(slope.value + 1.0) < 2.5 * half  # five standard errors
    assert result.disagreements() == []
    assert "Stopped" not in " ".join(result.notes())


def test_the_same_estimator_twice_is_equally_efficient(result):
    """direct and area are the same function here; their variances must agree."""
    one, other = (result.measured[e][-1].variance for e in result.estimators)
    assert abs(np.log(one.value / other.value)) < 2.5 * np.hypot(one.log_error, other.log_error)


def test_a_wrong_truth_is_noticed(result, folder):
    scene = raylab.load(folder / "scene.xml")
    wrong = Truth(result.truth.value * 1.2, result.truth.standard_error, "wrong on purpose")
    spoiled = study(scene, ["area"], spp=[64], repeats=10, threads=1, truth=wrong)
    assert "standard errors away from the truth" in spoiled.disagreements()[0]


def test_a_closed_form_of_the_mean(folder, result):
    scene, mean = raylab.load(folder / "scene.xml"), result.truth.value.mean(axis=(0, 1)).tolist()
    (folder / "truth.json").write_text(json.dumps({"mean": mean, "source": "a test"}))
    closed = study(scene, ["area"], spp=[4], repeats=3, threads=1, truth=find_truth(scene))
    assert closed.truth.source == "closed form of the mean of the whole image: a test"
    row = closed.rows[0]
    expected = np.mean((np.array([row.mean_r, row.mean_g, row.mean_b]) - mean) ** 2)
    assert row.squared_error == pytest.approx(expected, rel=1e-9)


def test_which_truth_beside_the_scene_fits(folder, result):
    scene, value = raylab.load(folder / "scene.xml"), result.truth.value
    np.savez(folder / "reference.npz", mean=value, standard_error=result.truth.standard_error)
    content = {"reference": "reference.npz", "mean": [1.0, 2.0, 3.0], "standard_error": [0.1, 0.1, 0.1], "source": "s"}
    (folder / "truth.json").write_text(json.dumps(content))
    assert find_truth(scene).source == "closed form in each pixel, reference.npz: s"
    assert find_truth(scene, {"width": 4}).of_pixels
    assert find_truth(scene, {"radiance": 4}) is None
    np.savez(folder / "reference.npz", mean=np.ones((8, 8, 3)), standard_error=np.zeros((8, 8, 3)))
    assert find_truth(scene).value.tolist() == [1.0, 2.0, 3.0]
    np.savez(folder / "reference.npz", mean=np.ones((8, 9, 3)), standard_error=np.zeros((8, 9, 3)))
    assert find_truth(scene) is None
    for wrong in ("{}", "[1]", '{"mean": [1, 2]}', '{"reference": "none.npz"}', "{"):
        (folder / "truth.json").write_text(wrong)
        with pytest.raises(UserError, match=r"truth\.json|none\.npz"):
            find_truth(scene)


@pytest.mark.parametrize("path", sorted(Path(__file__).parents[1].glob("reference_scenes/*/truth.json")), ids=str)
def test_truths_of_the_reference_scenes(path):
    told = json.loads(path.read_text())
    scene = raylab.load(path.parent / "scene.xml", told["parameters"])
    if "shade" in told:  # the picture of that shade, not of all light
        assert find_truth(scene, told["parameters"]) is None
    else:
        assert find_truth(scene, told["parameters"]).of_pixels


def test_ctrl_c_keeps_the_measurements(folder, monkeypatch, tmp_path):
    scene, renders, real = raylab.load(folder / "scene.xml"), [], measure.render

    def interrupted(*arguments, **named):
        renders.append(named["spp"])
        if len(renders) == 14:
            raise KeyboardInterrupt
        return real(*arguments, **named)

    monkeypatch.setattr(measure, "render", interrupted)
    stopped = study(scene, ["area", "direct"], spp=[1, 4], repeats=5, threads=1)
    assert not stopped.complete
    assert len(stopped.rows) == 14 - 1 - 2  # one was interrupted, two compiled
    page = stopped.write(tmp_path)
    assert "Stopped by Ctrl-C" in page.read_text()


@pytest.mark.parametrize(
    ("named", "said"),
    [
        ({"shades": ["aera"]}, "unknown shade"),
        ({"shades": []}, "at least one shade"),
        ({"shades": ["area", "area"]}, "different estimators"),
        ({"samplers": ["halton"]}, "unknown sampler"),
        ({"spp": [0, 4]}, "positive numbers of samples"),
        ({"repeats": 1}, "at least 2"),
    ],
)
def test_bad_arguments(folder, named, said):
    scene = raylab.load(folder / "scene.xml")
    shades = named.pop("shades", ["area"])
    with pytest.raises(UserError, match=said):
        study(scene, shades, **named)


def test_estimators_of_different_light_are_refused(tmp_path, monkeypatch):
    both = LAMP_OVER_FLOOR.replace("</scene>", '<emitter type="constant"/></scene>')
    (tmp_path / "scene.xml").write_text(both)
    scene = raylab.load(tmp_path / "scene.xml")
    with pytest.raises(UserError, match="compute different light"):
        study(scene, ["area", "env_cosine"])
    asked = []

    def reference(result, whole, step):
        asked.append(whole)
        raise KeyboardInterrupt

    monkeypatch.setattr(measure, "_reference", reference)
    monkeypatch.setattr(measure, "watch", lambda *arguments: "")
    monkeypatch.setattr(
        measure, "_render", lambda *arguments: Image(*np.zeros((3, 1, 1, 3)), report={"seconds": {"compile": 0.0}})
    )
    truth = Truth(np.ones(3), np.zeros(3), "of all light", all_light=True)
    assert study(scene, ["area"], truth=truth).truth is None
    assert asked == [False]  # a truth of all light does not hold for a part of it, nor would `direct`


# --- no variance ---------------------------------------------------------------------------------------------------


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


# --- files --------------------------------------------------------------------------------------------------------


def test_files(result, tmp_path):
    page = result.write(tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    plots = {f"{name}.{kind}" for name in ("variance_samples", "error_time", "efficiency") for kind in ("png", "svg")}
    assert names == {"index.html", "measurements.csv", "summary.csv", "columns.txt"} | plots
    with open(tmp_path / "measurements.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == list(COLUMNS)
    assert len(rows) == len(result.rows)
    assert float(rows[-1]["squared_error"]) == result.rows[-1].squared_error
    text = page.read_text()
    assert not re.search(r"https?:|src=\"(?!data:)|<script|<link|@import|url\(", text)
    assert text.count("data:image/svg+xml;base64,") == 3


def test_the_page_escapes_what_users_write(result, monkeypatch, tmp_path):
    monkeypatch.setattr(result, "truth", Truth(result.truth.value, result.truth.standard_error, "<b>bold</b>"))
    assert "&lt;b&gt;bold&lt;/b&gt;" in result.write(tmp_path).read_text()


def changed(result, **fields):
    """The same study with other measurements."""
    rows = [dataclasses.replace(row, **fields) for row in result.rows]
    return dataclasses.replace(result, rows=rows)


def test_nearly_equal_times_are_drawn(result):
    """An axis of hardly any length would have ticks without end."""
    same = changed(result)
    for row in same.rows:
        row.seconds = 1e-4 * (1.0 + 1e-9 * row.spp)
    for drawing in (plots.error_time, plots.efficiency):
        with figure() as (_, axes):
            drawing(same, axes)
            assert axes.get_xlim()[1] > 1.5 * axes.get_xlim()[0]
            assert len(axes.xaxis.get_minorticklocs()) < 100


def test_no_variance_at_all_is_drawn_and_said(result, tmp_path):
    still = changed(result, deviation=0.0, squared_error=0.0)
    text = still.write(tmp_path).read_text()
    assert "inf" in text
    assert still.variance_slope(still.estimators[0]) is None
