"""What a valid scene file means: parameters, references, includes, versions."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
from scene_text import SENSOR, load

from raylab.description import (
    Bitmap,
    Diffuse,
    Disk,
    Sphere,
)
from raylab.io.image_file import write_exr
from raylab.io.mitsuba_xml import read


def test_parameters(tmp_path: Path) -> None:
    body = """<default name="r" value="2"/><default name="radius" value="3"/><default name="r" value="9"/>
    <shape type="sphere" id="a$r"><float name="radius" value="$radius"/></shape>
    <shape type="sphere" id="\\$r"><float name="radius" value="$r"/></shape>
    <shape type="sphere"><point name="center" value="$r $r 1${suffix}"/></shape>""".replace("${suffix}", "e$r")
    first, second, third = load(tmp_path, body).shapes
    assert isinstance(first, Sphere)
    assert isinstance(second, Sphere)
    assert isinstance(third, Sphere)
    assert (first.name, first.radius, second.name, second.radius) == ("a2", 3, "$r", 2)
    assert third.center.tolist() == [2, 2, 100]
    given, *_ = load(tmp_path, body, {"radius": "5"}).shapes
    assert isinstance(given, Sphere)
    assert given.radius == 5


def test_parameters_inside_transforms(tmp_path: Path) -> None:
    assert (
        load(
            tmp_path,
            '<shape type="disk"><transform name="to_world"><scale value="$s"/></transform></shape>',
            {"s": "4"},
        )
        .shapes[0]
        .to_world[0, 0]
        == 4
    )


def test_references_share_one_object_wherever_it_stands(tmp_path: Path) -> None:
    body = """<shape type="sphere"><ref id="red"/></shape>
    <bsdf type="diffuse" id="red"><ref id="noise" name="reflectance"/></bsdf>
    <shape type="disk"><ref id="other" name="bsdf"/></shape>
    <texture type="bitmap" id="noise"><string name="filename" value="t.exr"/></texture>
    <alias id="red" as="scarlet"/>
    <bsdf type="twosided" id="other"><ref id="scarlet"/></bsdf>"""
    write_exr(tmp_path / "t.exr", {"": np.zeros((2, 2, 3))}, {})
    ball, lid = load(tmp_path, body).shapes
    assert isinstance(ball.front, Diffuse)
    assert isinstance(ball.front.reflectance, Bitmap)
    assert ball.front is lid.front is lid.back
    assert ball.back is None


def test_an_area_light_may_be_referred_to(tmp_path: Path) -> None:
    scene = load(tmp_path, '<emitter type="area" id="glow"/><shape type="disk"><ref id="glow"/></shape>')
    assert scene.shapes[0].radiance is not None
    assert not scene.lights


def test_includes(tmp_path: Path) -> None:
    parts = tmp_path / "parts"
    parts.mkdir()
    (parts / "materials.xml").write_text(
        """<scene version="3.0.0"><default name="grey" value="0.25"/>
        <bsdf type="diffuse" id="wall"><float name="reflectance" value="$grey"/></bsdf>
        <shape type="disk"><ref id="floor"/></shape><ref id="ball"/></scene>"""
    )
    (parts / "red.xml").write_text(
        """<bsdf version="3.0.0" type="diffuse"><texture type="bitmap" name="reflectance">
        <string name="filename" value="t.exr"/></texture></bsdf>"""
    )
    write_exr(parts / "t.exr", {"": np.zeros((2, 2, 3))}, {})
    body = """<include filename="parts/materials.xml"/><shape type="cube"><ref id="wall"/></shape>
    <bsdf type="diffuse" id="floor"/><shape type="sphere"><include filename="parts/red.xml"/></shape>
    <bsdf type="twosided"><bsdf type="diffuse" id="ball"/></bsdf>"""
    disk, cube, sphere = load(tmp_path, body).shapes
    assert isinstance(cube.front, Diffuse)
    assert cube.front.reflectance[0] == 0.25
    assert isinstance(disk, Disk)
    assert isinstance(disk.front, Diffuse)
    assert isinstance(sphere.front, Diffuse)
    assert isinstance(sphere.front.reflectance, Bitmap)


def test_versions_and_encodings(tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    for version in ("2.0.0", "3.0.0", "3.9.1"):
        text = f'<?xml version="1.0" encoding="iso-8859-1"?><scene version="{version}"><!-- \xe9 -->{SENSOR}</scene>'
        path.write_bytes(text.encode("latin-1"))
        assert read(str(path)).name == "a"


def test_reading_a_plain_scene_imports_no_heavy_module(tmp_path: Path) -> None:
    load(tmp_path, '<shape type="sphere"/><emitter type="point"/>')
    heavy = ["colour", "OpenImageIO", "trimesh", "matplotlib", "skimage", "PIL"]
    code = "import sys; from raylab.io.mitsuba_xml import read; read(sys.argv[1]); "
    code += f"print([name for name in {heavy} if name in sys.modules])"
    result = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "test.xml")], capture_output=True, text=True, check=True
    )
    assert result.stdout.strip() == "[]"
