"""Studies: every render is a row, truths, refusals, and files that need nothing else."""

from __future__ import annotations

import csv
import dataclasses
import json
import re
from pathlib import Path

import numpy as np
import pytest
from scene_text import LAMP_OVER_FLOOR

import raylab
from raylab.errors import UserError
from raylab.image import Image
from raylab.study import find_truth, measure, plots, study
from raylab.study.look import figure
from raylab.study.results import COLUMNS
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


# --- measuring ----------------------------------------------------------------------------------------------------


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
