"""What a valid scene file means: materials and textures, against Mitsuba 3.9.1."""

# ruff: noqa: E501 (XML in strings)

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scene_text import EPS, SIX_DIGITS, bitmap, shape

from raylab.description import (
    Conductor,
    Dielectric,
    Phong,
)
from raylab.io.image_file import decode_srgb, write_exr, write_png
from raylab.io.indices import METALS


def test_twosided(tmp_path: Path) -> None:
    def diffuse(value: float) -> str:
        return f'<bsdf type="diffuse"><float name="reflectance" value="{value}"/></bsdf>'

    same = shape(tmp_path, f'<bsdf type="twosided">{diffuse(0.25)}</bsdf>')
    assert same.front is same.back
    assert np.array_equal(same.front.reflectance, [0.25] * 3)
    two = shape(tmp_path, f'<bsdf type="twosided">{diffuse(0.25)}{diffuse(0.75)}</bsdf>')
    assert two.front.reflectance[0] == 0.25
    assert two.back.reflectance[0] == 0.75
    one = shape(tmp_path, diffuse(0.25))
    assert one.front.reflectance[0] == 0.25
    assert one.back is None


def test_phong(tmp_path: Path) -> None:
    plain = shape(tmp_path, '<bsdf type="phong"/>').front
    assert isinstance(plain, Phong)
    assert plain.exponent == 30
    assert np.array_equal(plain.diffuse_reflectance, [0.5] * 3)
    assert np.array_equal(plain.specular_reflectance, [0.2] * 3)
    given = shape(
        tmp_path,
        """<bsdf type="phong"><rgb name="diffuse_reflectance" value="0.1 0.2 0.3"/>
        <rgb name="specular_reflectance" value="0.4"/><float name="exponent" value="0"/></bsdf>""",
    ).front
    assert given.diffuse_reflectance.tolist() == [0.1, 0.2, 0.3]
    assert given.specular_reflectance.tolist() == [0.4] * 3
    assert given.exponent == 0


def test_conductor(tmp_path: Path) -> None:
    """A perfect mirror unless told otherwise; names and numbers as in Mitsuba 3."""
    mirror = shape(tmp_path, '<bsdf type="conductor"/>')
    assert isinstance(mirror.front, Conductor)
    assert mirror.back is None
    assert [*mirror.front.eta, *mirror.front.k, *mirror.front.specular_reflectance] == [0, 0, 0, 1, 1, 1, 1, 1, 1]
    none = shape(tmp_path, '<bsdf type="conductor"><string name="material" value="none"/></bsdf>').front
    assert [*none.eta, *none.k] == [0, 0, 0, 1, 1, 1]
    gold = shape(tmp_path, '<bsdf type="conductor"><string name="material" value="Au"/></bsdf>').front
    assert (tuple(gold.eta), tuple(gold.k)) == METALS["Au"]
    tiN = shape(tmp_path, '<bsdf type="conductor"><string name="material" value="TiN_palik"/></bsdf>').front
    assert tuple(tiN.eta) == METALS["TiN"][0]
    numbers = '<rgb name="eta" value="0.2,1.4,3"/><float name="k" value="2.5"/>'
    own = shape(
        tmp_path,
        f'<bsdf type="twosided"><bsdf type="conductor">{numbers}<rgb name="specular_reflectance" value="0.9"/></bsdf></bsdf>',
    )
    assert own.front is own.back
    assert [*own.front.eta, *own.front.k, *own.front.specular_reflectance] == [
        0.2,
        1.4,
        3,
        2.5,
        2.5,
        2.5,
        0.9,
        0.9,
        0.9,
    ]
    spectra = '<spectrum name="eta" value="400:2, 500:1.5, 800:2"/><spectrum name="k" value="0.5"/>'
    tabulated = shape(tmp_path, f'<bsdf type="conductor">{spectra}</bsdf>').front
    assert tabulated.eta == pytest.approx([1.75371, 1.54494, 1.73808], rel=SIX_DIGITS)  # Mitsuba 3.9.1
    assert [*tabulated.k] == [0.5, 0.5, 0.5]


def test_dielectric(tmp_path: Path) -> None:
    """BK7 in air; on the back stands the same boundary the other way round."""
    default = shape(tmp_path, '<bsdf type="dielectric"/>')
    assert isinstance(default.front, Dielectric)
    assert (default.front.int_ior, default.front.ext_ior) == (1.5046, 1.000277)
    assert (default.back.int_ior, default.back.ext_ior) == (1.000277, 1.5046)
    inside = """<string name="int_ior" value="diamond"/><float name="ext_ior" value="1.2"/>
        <rgb name="specular_reflectance" value="0.1,0.2,0.3"/><float name="specular_transmittance" value="0.5"/>"""
    glass = shape(tmp_path, f'<bsdf type="dielectric">{inside}</bsdf>').front
    assert (glass.int_ior, glass.ext_ior) == (2.419, 1.2)
    assert [*glass.specular_reflectance, *glass.specular_transmittance] == [0.1, 0.2, 0.3, 0.5, 0.5, 0.5]


def test_bitmap_rows_stand_where_mitsuba_has_them(tmp_path: Path) -> None:
    # Mitsuba 3.9.1, nearest: uv (0.1, 0.1) reads the first texel of the first row of the file, uv (0.1, 0.9) the
    # first texel of its last row; in a Bitmap row 0 is at v = 1
    pixels = np.arange(12).reshape(2, 2, 3) / 16
    write_exr(tmp_path / "t.exr", {"": pixels}, {})
    found = bitmap(tmp_path)
    assert np.array_equal(found.pixels[-1], pixels[0])
    assert np.array_equal(found.pixels[0], pixels[-1])
    assert (found.filter, found.wrap) == ("bilinear", "repeat")
    assert np.array_equal(found.to_uv, np.eye(3))


def test_bitmap_parameters(tmp_path: Path) -> None:
    pixels = np.full((2, 2, 3), 0.25)
    write_png(tmp_path / "t.png", decode_srgb(pixels))
    assert np.allclose(bitmap(tmp_path, name="t.png").pixels, decode_srgb(64 / 255), rtol=16 * EPS)
    options = """<boolean name="raw" value="true"/><string name="filter_type" value="nearest"/>
    <string name="wrap_mode" value="mirror"/>
    <transform name="to_uv"><scale x="2" y="3" z="7"/><translate x="0.5" y="0.25" z="9"/></transform>"""
    found = bitmap(tmp_path, options, "t.png")
    assert np.array_equal(found.pixels, np.full((2, 2, 3), 64 / 255))
    assert (found.filter, found.wrap) == ("nearest", "mirror")
    assert found.to_uv.tolist() == [[2, 0, 0.5], [0, 3, 0.25], [0, 0, 1]]
