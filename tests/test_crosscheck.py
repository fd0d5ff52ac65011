"""The same files in Mitsuba 3 and in raylab: each pixel agrees within the joint standard error.

Needs the extra [crosscheck]; run by `make crosscheck`. Mitsuba's `scalar_rgb` variant is used, which needs no LLVM.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from crosscheck import FILM, agree

from raylab.io.image_file import write_exr
from raylab.io.indices import DIELECTRICS, METALS

pytestmark = pytest.mark.crosscheck
SCENES = Path(__file__).parents[1] / "reference_scenes"
SHAPES = (
    """
<scene version="3.0.0">
    <integrator type="direct"/>
    <sensor type="perspective">
        <float name="fov" value="40"/>
        <float name="principal_point_offset_x" value="0.05"/>
        <transform name="to_world"><lookat origin="1,-5,3" target="0,0,0.7" up="0,0,1"/></transform>
        """
    + FILM
    + """
    </sensor>
    <shape type="rectangle">
        <transform name="to_world"><scale value="6"/></transform>
        <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.6,0.5,0.4"/></bsdf></bsdf>
    </shape>
    <shape type="sphere">
        <point name="center" x="0" y="0" z="0.8"/><float name="radius" value="0.8"/>
        <bsdf type="diffuse"><rgb name="reflectance" value="0.2,0.5,0.8"/></bsdf>
    </shape>
    <shape type="cylinder">
        <point name="p0" value="1.5,0,0"/><point name="p1" value="1.5,0.4,1.2"/><float name="radius" value="0.3"/>
        <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.8,0.2,0.2"/></bsdf></bsdf>
    </shape>
    <shape type="cube">
        <transform name="to_world">
            <scale value="0.4"/><rotate z="1" angle="30"/><translate x="-1.6" y="-0.4" z="0.41"/>
        </transform>
        <bsdf type="diffuse"/>
    </shape>
    <shape type="disk">
        <transform name="to_world">
            <scale value="0.7"/><rotate x="1" angle="150"/><translate x="-1" y="-1" z="3"/>
        </transform>
        <emitter type="area"><rgb name="radiance" value="10,9,8"/></emitter>
    </shape>
    <shape type="sphere">
        <point name="center" x="2" y="-2" z="3"/><float name="radius" value="0.4"/>
        <emitter type="area"><rgb name="radiance" value="5,9,15"/></emitter>
    </shape>
    <emitter type="point"><point name="position" x="-3" y="-3" z="4"/><rgb name="intensity" value="8,8,4"/></emitter>
    <emitter type="directional">
        <vector name="direction" value="0.5,0.3,-1"/><rgb name="irradiance" value="0.5"/>
    </emitter>
</scene>
"""
)

SKY = (
    """
<scene version="3.0.0">
    <integrator type="direct"/>
    <sensor type="perspective">
        <float name="fov" value="35"/><string name="fov_axis" value="y"/>
        <transform name="to_world"><lookat origin="1,2.5,5" target="0,0.6,0" up="0,1,0"/></transform>
        """
    + FILM
    + """
    </sensor>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="-90"/><scale value="3"/></transform>
        <bsdf type="twosided"><bsdf type="diffuse">
            <texture type="bitmap" name="reflectance">
                <string name="filename" value="{board}"/><transform name="to_uv"><scale value="2"/></transform>
            </texture>
        </bsdf></bsdf>
    </shape>
    <shape type="ply">
        <string name="filename" value="{knot}"/>
        <transform name="to_world"><scale value="0.8"/><translate y="0.9"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="0.7,0.5,0.3"/></bsdf>
    </shape>
    <shape type="cube">
        <transform name="to_world">
            <scale value="0.3"/><rotate y="1" angle="25"/><translate x="1.2" y="0.31" z="0.5"/>
        </transform>
        <bsdf type="diffuse">
            <texture type="bitmap" name="reflectance"><string name="filename" value="{board}"/></texture>
        </bsdf>
    </shape>
    <emitter type="envmap">
        <string name="filename" value="{sky}"/><float name="scale" value="0.7"/>
        <transform name="to_world"><rotate y="1" angle="40"/></transform>
    </emitter>
</scene>
"""
)

# Balls of gold, glass and mirror, a block of water; {floor} stands below them.
SMOOTH = (
    """
<scene version="3.0.0">
    {integrator}
    <sensor type="perspective">
        <float name="fov" value="38"/>
        <transform name="to_world"><lookat origin="1,-5,2.5" target="0.1,0,0.6" up="0,0,1"/></transform>
        """
    + FILM
    + """
    </sensor>
    {floor}
    <shape type="sphere">
        <point name="center" x="-1.3" y="0" z="0.8"/><float name="radius" value="0.8"/>
        <bsdf type="dielectric">
            <rgb name="specular_transmittance" value="0.9,1,0.8"/><rgb name="specular_reflectance" value="0.8,0.9,1"/>
        </bsdf>
    </shape>
    <shape type="sphere">
        <point name="center" x="0.5" y="0.6" z="0.8"/><float name="radius" value="0.8"/>
        <bsdf type="conductor"><string name="material" value="Au"/></bsdf>
    </shape>
    <shape type="cube">
        <transform name="to_world">
            <scale value="0.5"/><rotate z="1" angle="30"/><translate x="1.2" y="-1.1" z="0.52"/>
        </transform>
        <bsdf type="dielectric"><string name="int_ior" value="water"/><float name="ext_ior" value="1"/></bsdf>
    </shape>
    <shape type="rectangle">
        <transform name="to_world">
            <rotate x="1" angle="90"/><rotate z="1" angle="20"/><translate x="0.3" y="2.5" z="1"/>
        </transform>
        <bsdf type="twosided"><bsdf type="conductor"><float name="specular_reflectance" value="0.8"/></bsdf></bsdf>
    </shape>
    <shape type="rectangle">
        <transform name="to_world">
            <scale value="0.7"/><rotate x="1" angle="150"/><translate x="-1" y="-1" z="3"/>
        </transform>
        <emitter type="area"><rgb name="radiance" value="4,3,2"/></emitter>
    </shape>
    <emitter type="envmap"><string name="filename" value="{sky}"/></emitter>
</scene>
"""
)
FLOOR = """<shape type="rectangle"><transform name="to_world"><scale value="6"/></transform>
    {inside}</shape>"""


@pytest.mark.parametrize(
    "name", ["soft_shadows", "cornell_box", "light_below_horizon", "ball_under_sky", "edge_occluder", "many_lights"]
)
def test_reference_scene(mitsuba, name):
    agree(mitsuba, SCENES / name / "scene.xml", spp=256)


@pytest.mark.parametrize("pixel_filter", ["box", "tent", "gaussian"])
def test_all_shapes_lights_and_filters(mitsuba, tmp_path, pixel_filter):
    path = tmp_path / "shapes.xml"
    path.write_text(SHAPES.replace('"box"', f'"{pixel_filter}"'))
    agree(mitsuba, path, spp=256)


def test_sky_texture_and_smooth_normals(mitsuba, tmp_path):
    path = tmp_path / "sky.xml"
    files = {"board": "still_life/board.png", "knot": "hdr_sky/knot.ply", "sky": "hdr_sky/sky.exr"}
    path.write_text(SKY.format(**{name: SCENES / file for name, file in files.items()}))
    agree(mitsuba, path, spp=256)


def test_thin_lens(mitsuba, tmp_path):
    """The same scene out of focus, its clip planes within the scene."""
    lens = """<float name="aperture_radius" value="0.25"/><float name="focus_distance" value="5.2"/>
        <float name="near_clip" value="4.4"/><float name="far_clip" value="8"/>"""
    text = SHAPES.replace('"perspective"', '"thinlens"')
    text = text.replace('<float name="principal_point_offset_x" value="0.05"/>', lens)
    path = tmp_path / "lens.xml"
    path.write_text(text)
    agree(mitsuba, path, spp=256)


def smooth(folder: Path, integrator: str, inside: str) -> Path:
    """The scene SMOOTH under a dim sky, with a floor; its file."""
    write_exr(folder / "sky.exr", {"": np.random.default_rng(1).random((8, 16, 3))}, {})
    path = folder / "smooth.xml"
    path.write_text(SMOOTH.format(integrator=integrator, sky=folder / "sky.exr", floor=FLOOR.format(inside=inside)))
    return path


@pytest.mark.parametrize("hide", ["false", "true"])
def test_mirrors_and_glass_in_direct_light(mitsuba, tmp_path, hide):
    integrator = f'<integrator type="direct"><boolean name="hide_emitters" value="{hide}"/></integrator>'
    agree(mitsuba, smooth(tmp_path, integrator, '<bsdf type="diffuse"/>'), spp=256)


@pytest.mark.parametrize("max_depth", [3, 8])
def test_basic_ray_tracing_is_exact_where_all_else_shines(mitsuba, tmp_path, max_depth):
    """Slide "Basic ray tracing": a path tracer with the same depth, where no surface but mirrors and glass reflects."""
    integrator = f"""<integrator type="path"><integer name="max_depth" value="{max_depth}"/>
        <integer name="rr_depth" value="1000"/></integrator>"""
    floor = '<emitter type="area"><rgb name="radiance" value="0.2,0.4,0.6"/></emitter>'
    agree(mitsuba, smooth(tmp_path, integrator, floor), spp=256, shade="basic")


def test_every_named_index_is_mitsubas(mitsuba):
    """To the six digits that the table has."""
    for name, (eta, k) in METALS.items():
        theirs = mitsuba.traverse(mitsuba.load_dict({"type": "conductor", "material": name}))
        assert np.array(theirs["eta.value"]) == pytest.approx(eta, rel=1e-6, abs=1e-8), name
        assert np.array(theirs["k.value"]) == pytest.approx(k, rel=1e-6, abs=1e-8), name
    for name, index in DIELECTRICS.items():
        glass = mitsuba.load_dict({"type": "dielectric", "int_ior": name, "ext_ior": 1.0})
        assert mitsuba.traverse(glass)["eta"] == pytest.approx(index, rel=2**-23), name
