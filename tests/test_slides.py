"""The slide table is complete and true."""

from __future__ import annotations

import importlib
import inspect
import re
from pathlib import Path

import pytest

from raylab import shade, slides

# How often each title heads a slide of the lecture, in order of first appearance.
LECTURE = {
    "Advanced Ray Tracing": 1, "Basic ray tracing": 1, "Basic ray traced image": 1, "Discontinuities in basic RT": 1,
    "Soft shadows": 1, "Cause of soft shadows": 2, "Glossy reflection": 1, "Cause of glossy reflection": 2,
    "Depth of field": 2, "Cause of focusing effects": 3, "Motion blur": 2, "Cause of motion blur": 1,
    "Creating soft shadows": 1, "Illumination as integration": 4, "Area source by Monte Carlo": 4,
    "Diffuse surface in env. by Monte Carlo": 2, "Arbitrary surface in env. by Monte Carlo": 2,
    "Creating glossy reflections": 1, "The Blue Umbrella": 1,
    "After the last slide": 2,
}  # fmt: skip


# Slides without scene, figure or test, each for a reason; everything else must have all of them.
PICTURES_ONLY = {"Advanced Ray Tracing", "The Blue Umbrella"}
# Rows whose parts are still to come. This list only shrinks.
TO_COME: set[str] = set()


def resolve(name: str):
    module, _, attribute = name.rpartition(".")
    return getattr(importlib.import_module(module), attribute)


def test_every_slide_of_the_lecture_is_in_the_table():
    counts: dict[str, int] = {}
    for slide in slides.TABLE:
        title = re.sub(r" \([^)]*\)$", "", slide.title)
        counts[title] = counts.get(title, 0) + 1
    assert counts == LECTURE


@pytest.mark.parametrize("slide", slides.TABLE, ids=lambda slide: slide.title)
def test_slide_has_its_functions_or_says_why_not(slide):
    assert slide.functions or slide.note
    for name in slide.functions:
        assert callable(resolve(name)), name


@pytest.mark.parametrize("slide", slides.TABLE, ids=lambda slide: slide.title)
def test_slide_has_scene_figure_and_test(slide):
    parts = (slide.functions, slide.scene, slide.figure, slide.test)
    if slide.title in PICTURES_ONLY:
        assert slide.note
    elif slide.title in TO_COME:
        assert not all(parts), "complete: take it off the list"
    else:
        assert all(parts), parts


@pytest.mark.parametrize("slide", slides.TABLE, ids=lambda slide: slide.title)
def test_scene_and_test_of_slide_exist(slide):
    root = Path(__file__).parents[1]
    assert not slide.scene or (root / "reference_scenes" / slide.scene / "scene.xml").is_file()
    if slide.test:
        file, _, name = slide.test.partition("::")
        assert f"\ndef {name}(" in (root / "tests" / file).read_text()


def test_every_shade_is_in_the_table_and_names_its_slide():
    listed = {name for slide in slides.TABLE for name in slide.functions}
    titles = set(LECTURE)
    own = {
        name: member
        for name, member in vars(shade).items()
        if getattr(member, "__module__", "") == shade.__name__ and not name.startswith("_") and callable(member)
    }
    assert own
    for name, function in own.items():
        assert f"raylab.shade.{name}" in listed
        assert any(title in inspect.getdoc(function) for title in titles), name


def test_shades_stand_in_slide_order():
    source = inspect.getsource(shade)
    order = [
        "point_light", "area_diffuse", "area", "area_solid_angle", "directional_light",
        "env_uniform", "env_cosine", "env_brightness", "env_brdf",
    ]  # fmt: skip
    assert re.findall(r"^def (\w+)\(", source, re.MULTILINE) == order


def test_scenes_that_notes_name_exist():
    root = Path(__file__).parents[1]
    named = [n for slide in slides.TABLE for n in re.findall(r"reference_scenes/\w+", slide.note)]
    assert named
    assert all((root / name).is_dir() for name in named)


def test_page_shows_the_table():
    page = Path(__file__).parents[1] / "docs" / "slides.md"
    assert slides.markdown() in page.read_text()
