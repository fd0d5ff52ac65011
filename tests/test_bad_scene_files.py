"""Broken scene files: each gets one sentence with file, line and element, none a traceback."""

# ruff: noqa: E501 (the sample is XML)

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from broken_scenes import CASES, FILES, SENSOR, document

from raylab.errors import SceneError
from raylab.io.image_file import write_exr
from raylab.io.mitsuba_xml import read


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a few broken files to refer to."""
    pixels = np.full((2, 2, 3), 0.5)
    write_exr(tmp_path / "sky.exr", {"": pixels + 5}, {})
    write_exr(tmp_path / "half.exr", {"": pixels}, {})
    pixels[0, 1, 2] = np.nan
    write_exr(tmp_path / "nan.exr", {"": pixels}, {})
    pixels[0, 1, 2], pixels[1, 0] = 0, -1
    write_exr(tmp_path / "negative.exr", {"": pixels}, {})
    triangle = "v 0 0 0\nv 1 0 0\nv 1 {} 0\nf 1 2 {}\n"
    (tmp_path / "bad.obj").write_text(triangle.format(1, 7))
    (tmp_path / "nan.obj").write_text(triangle.format("nan", 3))
    return tmp_path


def complaint(folder: Path, text: str, parameters: dict[str, str] | None = None) -> str:
    path = folder / "test.xml"
    path.write_text(text)
    with pytest.raises(SceneError) as caught:
        read(path, parameters)
    return str(caught.value)


def check(message: str, folder: Path, line: int, words: tuple[str, ...]) -> None:
    assert message.startswith(f"{folder / 'test.xml'}:{line}: "), message
    assert all(word in message for word in words), message
    assert "\n" not in message
    assert "Traceback" not in message


@pytest.mark.parametrize("case", CASES, ids=lambda case: re.sub(r"\W+", "_", case[1])[:60])
def test_broken_scenes_are_refused(case: tuple[Any, ...], folder: Path) -> None:
    line, body, *words = case
    message = complaint(folder, document(body))
    check(message, folder, line, tuple(words))
    assert re.search(r":\d+: <\w+", message)  # it names the element


@pytest.mark.parametrize("case", FILES, ids=lambda case: re.sub(r"\W+", "_", case[1])[:60])
def test_broken_files_are_refused(case: tuple[Any, ...], folder: Path) -> None:
    line, text, *words = case
    check(complaint(folder, text), folder, line, tuple(words))


def test_there_are_enough_of_them() -> None:
    assert len(CASES) + len(FILES) >= 45


def test_unused_parameters_are_refused(folder: Path) -> None:
    text = f'<scene version="3.0.0"><default name="spp" value="4"/>{SENSOR}</scene>'
    message = complaint(folder, text, {"ssp": "16"})
    assert "test.xml" in message
    assert 'parameter "ssp" is not used' in message
    assert 'did you mean "spp"?' in message


def test_unreadable_files_are_refused(tmp_path: Path) -> None:
    for path in (tmp_path / "none.xml", tmp_path):
        with pytest.raises(SceneError, match=re.escape(str(path))):
            read(path)
    (tmp_path / "a.xml").write_bytes(b'<scene version="3.0.0">\xff\xfe</scene>')
    with pytest.raises(SceneError, match=r"a\.xml:1: not well-formed"):
        read(tmp_path / "a.xml")


def test_entities_do_not_blow_up(folder: Path) -> None:
    entities = "".join(f'<!ENTITY e{i} "{10 * f"&e{i - 1};"}">' for i in range(1, 12))
    text = f'<!DOCTYPE scene [<!ENTITY e0 "lol">{entities}]>\n<scene version="3.0.0" id="&e11;"/>'
    assert "test.xml:" in complaint(folder, text)


def test_errors_of_included_files_name_that_file(folder: Path) -> None:
    (folder / "part.xml").write_text('<scene version="3.0.0">\n<shape type="dsk"/></scene>')
    message = complaint(folder, f'<scene version="3.0.0">{SENSOR}<include filename="part.xml"/></scene>')
    assert message.startswith(f"{folder / 'part.xml'}:2: ")
    assert '"disk"' in message


SAMPLE = """<scene version="3.0.0">
<default name="r" value="2"/>
<sensor type="perspective"><float name="fov" value="40"/><transform name="to_world">
<lookat origin="0,0,5" target="0, 0, 0" up="0 1 0"/></transform>
<film type="hdrfilm"><integer name="width" value="20"/><rfilter type="tent"><float name="radius" value="1"/></rfilter></film>
<sampler type="multijitter"><integer name="sample_count" value="16"/></sampler></sensor>
<bsdf type="twosided" id="w"><bsdf type="diffuse"><spectrum name="reflectance" value="400:0.1, 500:0.2"/></bsdf></bsdf>
<shape type="rectangle"><ref id="w"/><transform name="to_world"><scale x="2"/><rotate x="1" angle="90"/>
<translate y="-1"/><matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"/></transform></shape>
<shape type="sphere"><point name="center" x="1" y="2" z="3"/><float name="radius" value="$r"/>
<emitter type="area"><rgb name="radiance" value="1 2 3"/></emitter></shape>
<emitter type="directional"><vector name="direction" x="1" y="2" z="3"/><srgb name="irradiance" value="#102030"/></emitter>
</scene>
"""


def outcome(path: Path, text: str) -> str:
    """What reading `text` ends in: nothing, or the message of a SceneError; every other error fails the test."""
    path.write_text(text)
    try:
        read(path)
    except SceneError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("value", ["", "nan", "-1", "x", "1e400", "0", "0 0 0", "1e200", "1e-320", "$q", "400:1", "w"])
def test_no_value_of_any_attribute_ends_in_another_error(value: str, tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    changed = [SAMPLE[: m.start(1)] + value + SAMPLE[m.end(1) :] for m in re.finditer(r'="([^"]*)"', SAMPLE)]
    messages = [message for message in (outcome(path, text) for text in changed) if message]
    assert len(messages) > 20
    assert all(re.match(rf"{re.escape(str(path))}:\d+: ", message) for message in messages)


def test_no_missing_piece_ends_in_another_error(tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    pieces = re.finditer(r'<[^>]*/>| \w+="[^"]*"|<[^>]*>', SAMPLE)
    messages = [outcome(path, SAMPLE[: piece.start()] + SAMPLE[piece.end() :]) for piece in pieces]
    assert all(re.match(rf"{re.escape(str(path))}:\d+: ", message) for message in messages if message)
