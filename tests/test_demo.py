"""The demo, with small exhibits: its page, what it skips, how it stops."""

from __future__ import annotations

import re

import pytest
from scene_text import LAMP_OVER_FLOOR

import raylab
from raylab.demo import demo
from raylab.demo.exhibits import EXHIBITS, Exhibit, Experiment, Picture, matte
from raylab.description import Diffuse, Phong, Rectangle, SceneDescription
from raylab.errors import UserError
from raylab.slides import TABLE

PARTS = (
    Exhibit(
        "A slide", "A <title>", "Words.", (Picture("One", "here", "area", 2), Picture("None", "gone", "area", 2)), True
    ),
    Exhibit("A slide", "Another", "Words.", (), experiment=Experiment("here", ("area",), (1, 4), repeats=3)),
)  # fmt: skip


@pytest.fixture
def scenes(tmp_path):
    (tmp_path / "scenes" / "here").mkdir(parents=True)
    (tmp_path / "scenes" / "here" / "scene.xml").write_text(LAMP_OVER_FLOOR)
    return tmp_path / "scenes"


def test_page_needs_nothing_else(scenes, tmp_path, capsys):
    assert demo(tmp_path / "out", scenes, 1, PARTS) is True
    said = capsys.readouterr().out
    assert "skipped, not there: gone" in said
    assert "Done: open" in said
    text = (tmp_path / "out" / "index.html").read_text()
    assert not re.search(r"https?:|src=\"(?!data:)|<script|<link|@import|url\(", text)
    assert "A &lt;title&gt;" in text
    assert text.count("data:image/png;base64,") == 3  # picture, error map, colour scale
    assert text.count("data:image/svg+xml;base64,") == 1
    assert "2 samples a pixel in" in text
    assert (tmp_path / "out" / "study_here" / "measurements.csv").is_file()


def test_ctrl_c_keeps_what_is_done(scenes, tmp_path, monkeypatch):
    def interrupted(*arguments, **named):
        raise KeyboardInterrupt

    monkeypatch.setattr("raylab.demo.study", interrupted)
    assert demo(tmp_path / "out", scenes, 1, PARTS) is False
    text = (tmp_path / "out" / "index.html").read_text()
    assert "Stopped by Ctrl-C" in text
    assert "2 samples a pixel in" in text


def test_no_scenes_is_said(tmp_path):
    with pytest.raises(UserError, match="no folder"):
        demo(tmp_path / "out", tmp_path / "nothing")


def test_exhibits_name_slides_and_shades_that_exist():
    titles = " / ".join(slide.title for slide in TABLE)
    for exhibit in EXHIBITS:
        assert exhibit.slide in titles
        for p in exhibit.pictures:
            assert p.shade in raylab.strategies.NAMES


def test_matte_keeps_the_albedo():
    glossy = Rectangle(front=Phong())
    (dull,) = matte(SceneDescription(shapes=(glossy,))).shapes
    assert isinstance(dull.front, Diffuse)
    expected = glossy.front.diffuse_reflectance + glossy.front.specular_reflectance
    assert dull.front.reflectance.tolist() == expected.tolist()
