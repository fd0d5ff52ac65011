"""Scene files with `roughconductor` and `roughplastic`: what is read, what is refused, and Mitsuba's picture."""

# ruff: noqa: E501 (the rows of the tables are XML)

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from crosscheck import FILM, agree

from raylab import cli
from raylab.description import Bitmap, RoughConductor, RoughPlastic
from raylab.errors import SceneError
from raylab.io.image_file import write_exr
from raylab.io.indices import METALS
from raylab.io.mitsuba_xml import read


def shape(folder: Path, bsdf: str) -> Any:
    path = folder / "scene.xml"
    path.write_text(
        f'<scene version="3.0.0"><sensor type="perspective"/><shape type="rectangle">\n{bsdf}</shape></scene>'
    )
    (result,) = read(path).shapes
    return result


def test_rough_conductor(tmp_path: Path) -> None:
    plain = shape(tmp_path, '<bsdf type="roughconductor"/>')
    assert plain.back is None
    assert isinstance(plain.front, RoughConductor)
    assert (plain.front.eta.tolist(), plain.front.k.tolist()) == ([0.0] * 3, [1.0] * 3)  # a perfect mirror
    assert (plain.front.alpha_u, plain.front.alpha_v, plain.front.distribution) == (0.1, 0.1, "beckmann")
    given = shape(
        tmp_path,
        """<bsdf type="roughconductor"><string name="material" value="Au"/><float name="alpha" value="0.3"/>
        <string name="distribution" value="GGX"/><boolean name="sample_visible" value="false"/>
        <rgb name="specular_reflectance" value="0.9 0.8 0.7"/></bsdf>""",
    ).front
    assert (tuple(given.eta), tuple(given.k)) == METALS["Au"]
    assert (given.alpha_u, given.alpha_v, given.distribution) == (0.3, 0.3, "ggx")
    assert given.specular_reflectance.tolist() == [0.9, 0.8, 0.7]
    own = shape(
        tmp_path,
        """<bsdf type="roughconductor"><rgb name="eta" value="0.2 0.9 1.1"/><rgb name="k" value="3.9 2.5 2.1"/>
        <float name="alpha_u" value="0.05"/><float name="alpha_v" value="0.05"/></bsdf>""",
    ).front
    assert (own.eta.tolist(), own.k.tolist()) == ([0.2, 0.9, 1.1], [3.9, 2.5, 2.1])
    assert (own.alpha_u, own.alpha_v) == (0.05, 0.05)


def test_rough_plastic(tmp_path: Path) -> None:
    plain = shape(tmp_path, '<bsdf type="roughplastic"/>').front
    assert isinstance(plain, RoughPlastic)
    assert (plain.int_ior, plain.ext_ior, plain.alpha) == (1.49, 1.000277, 0.1)
    assert (plain.distribution, plain.nonlinear) == ("beckmann", False)
    assert isinstance(plain.diffuse_reflectance, np.ndarray)
    assert (plain.diffuse_reflectance.tolist(), plain.specular_reflectance.tolist()) == ([0.5] * 3, [1.0] * 3)
    write_exr(tmp_path / "t.exr", {"": np.full((2, 2, 3), 0.25)}, {})
    given = shape(
        tmp_path,
        """<bsdf type="roughplastic"><string name="int_ior" value="diamond"/><float name="ext_ior" value="1.2"/>
        <float name="alpha" value="0.4"/><string name="distribution" value="ggx"/><boolean name="nonlinear" value="true"/>
        <texture type="bitmap" name="diffuse_reflectance"><string name="filename" value="t.exr"/></texture></bsdf>""",
    ).front
    assert (given.int_ior, given.ext_ior, given.alpha) == (2.419, 1.2, 0.4)
    assert (given.distribution, given.nonlinear) == ("ggx", True)
    assert isinstance(given.diffuse_reflectance, Bitmap)


def metal(inside: str) -> str:
    return f'<bsdf type="roughconductor">\n{inside}</bsdf>'


def plastic(inside: str) -> str:
    return f'<bsdf type="roughplastic">\n{inside}</bsdf>'


BAD = [  # line, XML from line 2 on, words of the message
    (3, metal('<float name="alpha" value="0"/>'), 'roughness "alpha" must be greater than 0', "got 0; for a smooth surface"),
    (3, metal('<float name="alpha" value="-0.1"/>'), "must be greater than 0, at most 10, got -0.1"),
    (3, plastic('<float name="alpha" value="11"/>'), "at most 10, got 11"),
    (3, metal('<float name="alpha_u" value="0.1"/>'), '"alpha_u" is given but "alpha_v" is not'),
    (3, metal('<float name="alpha_v" value="0.1"/>'), '"alpha_v" is given but "alpha_u" is not'),
    (5, metal('<float name="alpha_u" value="0.1"/>\n<float name="alpha_v" value="0.1"/>\n<float name="alpha" value="0.1"/>'), 'give either "alpha" or "alpha_u" and "alpha_v", not both'),
    (4, metal('<float name="alpha_u" value="0.1"/>\n<float name="alpha_v" value="-1"/>'), 'roughness "alpha_v"', "got -1"),
    (4, metal('<float name="alpha_u" value="0.1"/>\n<float name="alpha_v" value="0.2"/>'), '"alpha_u" and "alpha_v" must be equal, got 0.1 and 0.2'),
    (3, metal('<string name="distribution" value="ggy"/>'), 'unknown distribution "ggy"; expected beckmann, ggx', 'did you mean "ggx"?'),
    (3, metal('<string name="material" value="Aux"/>'), 'unknown material "Aux"', 'did you mean "Au"?'),
    (3, metal('<string name="material" value="Au"/><rgb name="eta" value="1"/><rgb name="k" value="1"/>'), 'give either "material" or "eta" and "k"'),
    (3, metal('<float name="alfa" value="0.1"/>'), 'no parameter "alfa"', 'did you mean "alpha"?'),
    (3, metal('<texture type="bitmap" name="alpha"><string name="filename" value="t.exr"/></texture>'), '"alpha" must be given as <float>'),
    (3, metal('<rgb name="specular_reflectance" value="1.5"/>'), "a reflectance must lie in [0, 1]"),
    (3, plastic('<float name="int_ior" value="-1.5"/>'), '"int_ior" must be greater than 0', "got -1.5"),
    (3, plastic('<string name="int_ior" value="watre"/>'), 'unknown material "watre"', 'did you mean "water"?'),
    (3, plastic('<float name="int_ior" value="1.000277"/>'), '"int_ior" and "ext_ior" must differ'),
    (3, plastic('<float name="alpha_u" value="0.1"/>'), 'no parameter "alpha_u"'),
    (3, plastic('<rgb name="diffuse_reflectance" value="-1"/>'), "a reflectance must lie in [0, 1]"),
]  # fmt: skip


@pytest.mark.parametrize(("line", "xml", "words"), [(line, xml, words) for line, xml, *words in BAD])
def test_what_is_refused(tmp_path: Path, line: int, xml: str, words: list[str]) -> None:
    with pytest.raises(SceneError) as caught:
        shape(tmp_path, xml)
    message = str(caught.value)
    assert f"scene.xml:{line}: " in message
    for word in words:
        assert word in message


def test_a_negative_roughness_ends_with_code_2(tmp_path, monkeypatch, capsys):
    path = tmp_path / "scene.xml"
    path.write_text(f'<scene version="3.0.0"><sensor type="perspective"/>\n{BAD[1][1]}</scene>')
    monkeypatch.setattr("sys.argv", ["raylab", "render", str(path), "-o", str(tmp_path / "x.png")])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1


ROUGH = (
    """
<scene version="3.0.0">
    <integrator type="direct"/>
    <sensor type="perspective">
        <float name="fov" value="34"/>
        <transform name="to_world"><lookat origin="0.5,-6,3" target="0,0,0.6" up="0,0,1"/></transform>
        """
    + FILM
    + """
    </sensor>
    <shape type="rectangle">
        <transform name="to_world"><scale value="6"/></transform>
        <bsdf type="twosided"><bsdf type="roughplastic">
            <texture type="bitmap" name="diffuse_reflectance">
                <string name="filename" value="{board}"/><transform name="to_uv"><scale value="6"/></transform>
            </texture>
            <float name="alpha" value="0.15"/>
        </bsdf></bsdf>
    </shape>
    <shape type="sphere">
        <point name="center" x="-1.5" y="0" z="0.7"/><float name="radius" value="0.7"/>
        <bsdf type="roughconductor">
            <string name="material" value="Cu"/><float name="alpha" value="0.2"/>
            <string name="distribution" value="ggx"/>
        </bsdf>
    </shape>
    <shape type="sphere">
        <point name="center" x="0" y="0.4" z="0.7"/><float name="radius" value="0.7"/>
        <bsdf type="roughconductor">
            <rgb name="eta" value="1.6,0.9,0.5"/><rgb name="k" value="9,6,5"/><float name="alpha" value="0.4"/>
            <rgb name="specular_reflectance" value="0.9,0.8,0.7"/>
        </bsdf>
    </shape>
    <shape type="cube">
        <transform name="to_world">
            <scale value="0.5"/><rotate z="1" angle="30"/><translate x="1.5" y="-0.2" z="0.51"/>
        </transform>
        <bsdf type="roughplastic">
            <rgb name="diffuse_reflectance" value="0.1,0.3,0.6"/><boolean name="nonlinear" value="true"/>
            <string name="int_ior" value="diamond"/><float name="alpha" value="0.3"/>
            <string name="distribution" value="ggx"/>
        </bsdf>
    </shape>
    <shape type="sphere">
        <point name="center" x="0.4" y="-1.5" z="0.3"/><float name="radius" value="0.3"/><bsdf type="diffuse"/>
    </shape>
    <shape type="disk">
        <transform name="to_world">
            <scale value="0.7"/><rotate x="1" angle="150"/><translate x="-1" y="-1" z="3"/>
        </transform>
        <emitter type="area"><rgb name="radiance" value="10,9,8"/></emitter>
    </shape>
    <emitter type="point"><point name="position" x="3" y="-3" z="4"/><rgb name="intensity" value="8,8,4"/></emitter>
    <emitter type="constant"><rgb name="radiance" value="0.3,0.4,0.6"/></emitter>
</scene>
"""
)


@pytest.mark.crosscheck
def test_rough_metal_and_plastic_give_mitsuba_s_picture(mitsuba, tmp_path):
    path = tmp_path / "rough.xml"
    board = Path(__file__).parents[1] / "reference_scenes" / "still_life" / "board.png"
    path.write_text(ROUGH.format(board=board))
    agree(mitsuba, path, spp=256)
