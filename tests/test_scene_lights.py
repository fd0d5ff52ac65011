"""What a valid scene file means: emitters and colours, against Mitsuba 3.9.1."""

# ruff: noqa: E501 (XML in strings)

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scene_text import EPS, SIX_DIGITS, load, shape

from raylab.description import (
    ConstantEnvironment,
    DirectionalLight,
    ImageEnvironment,
    PointLight,
)
from raylab.io.image_file import write_exr

# --- emitters ---


def test_point_lights(tmp_path: Path) -> None:
    body = """<emitter type="point"><point name="position" x="1" y="2" z="3"/><rgb name="intensity" value="4 5 6"/></emitter>
    <emitter type="point"><transform name="to_world"><scale value="3"/><translate y="7"/></transform></emitter>"""
    first, second = load(tmp_path, body).lights
    assert isinstance(first, PointLight)
    assert isinstance(second, PointLight)
    assert first.position.tolist() == [1, 2, 3]
    assert first.intensity.tolist() == [4, 5, 6]
    assert second.position.tolist() == [0, 7, 0]
    assert second.intensity.tolist() == [1, 1, 1]


def test_directional_lights(tmp_path: Path) -> None:
    body = """<emitter type="directional"><vector name="direction" x="0" y="-3" z="4"/><float name="irradiance" value="2"/></emitter>
    <emitter type="directional"><transform name="to_world"><rotate y="1" angle="90"/></transform></emitter>
    <emitter type="directional"/>"""
    lights = load(tmp_path, body).lights
    expected = [[0, -0.6, 0.8], [1, 0, 0], [0, 0, 1]]
    for light, direction in zip(lights, expected, strict=True):
        assert isinstance(light, DirectionalLight)
        assert np.allclose(light.direction, direction, rtol=0, atol=4 * EPS)
    assert isinstance(lights[0], DirectionalLight)
    assert lights[0].irradiance.tolist() == [2, 2, 2]


def test_environments(tmp_path: Path) -> None:
    constant = load(tmp_path, '<emitter type="constant"><rgb name="radiance" value="1 2 3"/></emitter>').environment
    assert isinstance(constant, ConstantEnvironment)
    assert constant.radiance.tolist() == [1, 2, 3]
    pixels = np.arange(24).reshape(2, 4, 3) * 1e3
    write_exr(tmp_path / "sky.exr", {"": pixels}, {})
    image = load(
        tmp_path,
        """<emitter type="envmap"><string name="filename" value="sky.exr"/><float name="scale" value="0.5"/>
        <transform name="to_world"><rotate x="1" angle="90"/></transform></emitter>""",
    ).environment
    assert isinstance(image, ImageEnvironment)
    assert np.array_equal(image.pixels, pixels / 2)
    assert image.to_world[2, 1] == 1
    assert load(tmp_path, "").environment is None


# --- colours ---

# element, as an emitter, as a reflectance; None where it is not allowed. Numbers with six digits: Mitsuba 3.9.1,
# scalar_rgb, mi.traverse of a point light and of a diffuse BSDF.
COLOURS = [
    ('<rgb name="{}" value="0.1 0.2 0.3"/>', (0.1, 0.2, 0.3), (0.1, 0.2, 0.3)),
    ('<rgb name="{}" value="0.5"/>', (0.5, 0.5, 0.5), (0.5, 0.5, 0.5)),
    ('<float name="{}" value="0.25"/>', (0.25, 0.25, 0.25), (0.25, 0.25, 0.25)),
    ('<integer name="{}" value="1"/>', (1, 1, 1), (1, 1, 1)),
    ('<spectrum name="{}" value="0.7"/>', (0.843356, 0.663804, 0.636241), (0.7, 0.7, 0.7)),
    (
        '<spectrum name="{}" value="400:0.1, 500:0.2, 700:0.9"/>',
        (0.81508, 0.325279, 0.105922),
        (0.702163, 0.34068, 0.122439),
    ),
    (
        '<spectrum name="{}" filename="table.spd"/>',
        (0.81508, 0.325279, 0.105922),
        (0.702163, 0.34068, 0.122439),
    ),
    ('<spectrum name="{}" value="500:1, 510:1"/>', (0, 0.0712441, 0.0133142), (0, 0.0781108, 0.0146232)),
    (
        '<spectrum name="{}" value="300:1, 900:1"/>',
        (1.20488, 0.948228, 0.909267),
        (0.998985, 0.998874, 0.998802),
    ),
    ('<spectrum type="d65" name="{}"/>', (1, 1, 1), (1, 1, 1)),
    ('<spectrum type="d65" name="{}"><float name="scale" value="0.6"/></spectrum>', (0.6,) * 3, (0.6,) * 3),
    (
        '<spectrum type="d65" name="{}"><rgb name="color" value="0.1 0.2 0.3"/><float name="scale" value="2"/></spectrum>',
        (0.2, 0.4, 0.6),
        (0.2, 0.4, 0.6),
    ),
    (
        '<spectrum type="uniform" name="{}"><float name="value" value="0.6"/></spectrum>',
        (0.6,) * 3,
        (0.6,) * 3,
    ),
    (
        '<spectrum type="srgb" name="{}"><rgb name="color" value="0.1 0.2 0.3"/></spectrum>',
        (0.1, 0.2, 0.3),
        (0.1, 0.2, 0.3),
    ),
    ('<rgb name="{}" value="3 4 500"/>', (3, 4, 500), None),
    ('<spectrum name="{}" value="1.5"/>', (1.80719, 1.42244, 1.36337), None),
    # IEC 61966-2-1: 128/255 decodes to 0.2158605
    ('<srgb name="{}" value="#ff8000"/>', (1, 0.2158605, 0), (1, 0.2158605, 0)),
    ('<srgb name="{}" value="1, 0.5019607843137255, 0"/>', (1, 0.2158605, 0), (1, 0.2158605, 0)),
]


@pytest.mark.parametrize(("element", "emitter", "reflectance"), COLOURS)
def test_colours(
    element: str, emitter: tuple[float, ...], reflectance: tuple[float, ...] | None, tmp_path: Path
) -> None:
    (tmp_path / "table.spd").write_text("# nm, value\n400 0.1\n500 0.2\n700 0.9\n")
    (light,) = load(tmp_path, f'<emitter type="point">{element.format("intensity")}</emitter>').lights
    assert isinstance(light, PointLight)
    assert light.intensity == pytest.approx(np.array(emitter), abs=SIX_DIGITS * max(emitter))
    if reflectance is not None:
        front = shape(tmp_path, f'<bsdf type="diffuse">{element.format("reflectance")}</bsdf>').front
        assert front.reflectance == pytest.approx(np.array(reflectance), abs=SIX_DIGITS * max(reflectance))


def test_blackbody_emitter(tmp_path: Path) -> None:
    # No RGB variant of Mitsuba has it; the integral of Planck's law times the colour matching functions over 360 to
    # 830 nm with Mitsuba 3.9.1's own tables (scalar_spectral, 4000 steps of the midpoint kind) is this
    element = '<spectrum type="blackbody" name="intensity"><float name="temperature" value="5000"/></spectrum>'
    (light,) = load(tmp_path, f'<emitter type="point">{element}</emitter>').lights
    assert isinstance(light, PointLight)
    # its unit has 1000 steps for 999 intervals, the integral 4000 for 3999
    expected = np.array([15274.485, 12091.63, 9599.738]) * (999 / 1000) / (3999 / 4000)
    assert light.intensity == pytest.approx(expected, rel=2e-5)  # rounded constants of nature, float32


def test_colours_out_of_gamut_are_clamped_with_a_warning(tmp_path: Path) -> None:
    body = '<emitter type="point">\n<spectrum name="intensity" value="500:1, 510:1"/></emitter>'
    (warning,) = load(tmp_path, body).warnings
    assert 'test.xml:5: <spectrum name="intensity">' in warning
    assert "gamut" in warning
