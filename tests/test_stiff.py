"""The stiff scenes of docs/stiff.md: all of S1 to S12, and what is said of them."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from raylab.errors import UserError
from raylab.probe import Place
from raylab.scene import Scene
from raylab.strategies import strategy
from raylab.stress import stiff_report
from raylab.stress.stiff_scenes import TABLE
from raylab.study.results import Estimator

PAGE = Path(__file__).parents[1] / "docs" / "stiff.md"


def test_there_is_a_scene_for_each_case():
    named = {id for stiff in TABLE for id in re.findall(r"S\d\d", stiff.id)}
    assert named == {f"S{n:02}" for n in range(1, 13)}


@pytest.mark.parametrize("stiff", TABLE, ids=lambda stiff: stiff.id)
def test_a_scene_can_be_rendered_by_each_strategy(stiff):
    scene = Scene(stiff.make())
    assert scene.warnings == []
    assert all(strategy(shade, scene) for shade in stiff.shades)
    assert len(stiff.shades) * len(stiff.samplers) > 1
    camera = scene.description.camera
    assert np.allclose(camera.to_world[:3, 2], (0, 0, -1))  # straight down
    assert isinstance(Place.at(scene, (*camera.to_world[:2, 3], 0.0), (0, 0, 1)), Place)


@pytest.mark.parametrize("stiff", TABLE, ids=lambda stiff: stiff.id)
def test_the_page_has_its_table(stiff):
    text = PAGE.read_text(encoding="utf-8")
    own = text[text.index(f"## {stiff.id}: {stiff.title}") :].split("\n## ")[0]
    assert stiff.theory in own
    rows = [line for line in own.splitlines() if line.startswith("| `")]
    assert len(rows) == len(stiff.shades) * len(stiff.samplers)


def test_an_unknown_scene_is_named():
    with pytest.raises(UserError, match="no stiff scene is called 'S99'; expected one of S01"):
        stiff_report.chosen(["S99"])


@pytest.mark.compiled(reason="a study")
def test_what_has_no_variance_is_said_to_have_none(tmp_path, monkeypatch):
    """The foot of a light, by area: the sentence of the study, a slope without an interval of a variance."""
    foot = next(stiff for stiff in TABLE if stiff.id == "S02")
    monkeypatch.setattr(stiff_report, "INTERVALS", 256)
    few = replace(foot, shades=("area",), spp=(64, 256, 1024), repeats=8)
    (row,) = stiff_report.measure([few], lambda done, total, what: None)
    (e,) = row.study.estimators
    assert e == Estimator("area", "independent")
    assert row.study.rmse_slope(e) is None
    assert stiff_report.slope(row.study, e) is not None
    assert 0.0 < row.coverage[e] < 0.95
    text = stiff_report.markdown([row])
    assert "infinite variance: the interval is not trusted" in text
    assert "RMSE" in text
    stiff_report.write([row], tmp_path / "out", tmp_path / "page.md")
    assert (tmp_path / "page" / "error_time.png").read_bytes() == (tmp_path / "out" / "error_time.png").read_bytes()
    assert (tmp_path / "page.md").read_text(encoding="utf-8") == text
