"""What a valid scene file means: camera, film, sampler, integrator, against Mitsuba 3.9.1."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scene_text import EPS, SENSOR, camera_scene, load

from raylab.description import (
    Filter,
    SceneDescription,
)
from raylab.io.mitsuba_xml import read


def test_camera_defaults_are_mitsubas(tmp_path: Path) -> None:
    camera = camera_scene(tmp_path, "").camera
    assert (camera.width, camera.height) == (768, 576)
    assert camera.filter == Filter("gaussian", radius=2.0, stddev=0.5)
    assert (camera.near_clip, camera.far_clip) == (0.01, 10000.0)
    # a 50 mm lens sees the diagonal of a 36 mm x 24 mm frame under 46.79 degrees
    assert camera.fov_axis == "diagonal"
    assert np.tan(np.radians(camera.fov) / 2) == pytest.approx(np.hypot(36, 24) / 100, rel=8 * EPS)
    assert np.array_equal(camera.to_world, np.eye(4))
    assert camera.principal_point_offset == (0.0, 0.0)


def test_camera_parameters(tmp_path: Path) -> None:
    camera = camera_scene(
        tmp_path,
        """<float name="fov" value="40"/><string name="fov_axis" value="Y"/>
        <float name="near_clip" value="0.5"/><integer name="far_clip" value="20"/>
        <float name="principal_point_offset_x" value="0.1"/><float name="principal_point_offset_y" value="-0.2"/>
        <float name="shutter_close" value="1"/><transform name="to_world"><translate x="1"/></transform>""",
    ).camera
    assert (camera.fov, camera.fov_axis, camera.near_clip, camera.far_clip) == (40, "y", 0.5, 20)
    assert camera.principal_point_offset == (0.1, -0.2)
    assert camera.to_world[0, 3] == 1


def test_focal_length(tmp_path: Path) -> None:
    # number: Mitsuba 3.9.1, x_fov of a 20 x 10 film with focal_length="35mm"
    film = '<film type="hdrfilm"><integer name="width" value="20"/><integer name="height" value="10"/></film>'
    camera = camera_scene(tmp_path, f'<string name="focal_length" value="35mm"/>{film}').camera
    width = 2 * np.tan(np.radians(camera.fov) / 2) / np.sqrt(1 + (10 / 20) ** 2)
    assert np.degrees(2 * np.arctan(width / 2)) == pytest.approx(57.871192932128906, rel=2.0**-23)


@pytest.mark.parametrize(
    ("rfilter", "expected"),
    [
        ('<rfilter type="box"/>', Filter("box", radius=0.5)),
        ('<rfilter type="tent"/>', Filter("tent", radius=1.0)),
        ('<rfilter type="tent"><float name="radius" value="1.5"/></rfilter>', Filter("tent", radius=1.5)),
        ('<rfilter type="gaussian"/>', Filter("gaussian", radius=2.0, stddev=0.5)),
        (
            '<rfilter type="gaussian"><float name="stddev" value="0.25"/></rfilter>',
            Filter("gaussian", 1.0, 0.25),
        ),
        ("", Filter("gaussian", radius=2.0, stddev=0.5)),
    ],
)
def test_film_and_filter(rfilter: str, expected: Filter, tmp_path: Path) -> None:
    camera = camera_scene(
        tmp_path,
        f"""<film type="hdrfilm"><integer name="width" value="20"/><integer name="height" value="10"/>
        <string name="pixel_format" value="rgba"/><string name="component_format" value="float32"/>
        <string name="file_format" value="openexr"/><boolean name="sample_border" value="true"/>{rfilter}</film>""",
    ).camera
    assert (camera.width, camera.height, camera.filter) == (20, 10, expected)


@pytest.mark.parametrize(
    ("plugin", "expected"),
    [
        ("independent", "independent"),
        ("stratified", "stratified"),
        ("multijitter", "stratified"),
        ("orthogonal", "sobol"),
        ("ldsampler", "sobol"),
    ],
)
def test_samplers(plugin: str, expected: str, tmp_path: Path) -> None:
    counts = '<integer name="sample_count" value="9"/><integer name="seed" value="7"/>'
    scene = camera_scene(tmp_path, f'<sampler type="{plugin}">{counts}</sampler>')
    assert (scene.sampler, scene.spp, scene.seed) == (expected, 9, 7)
    assert camera_scene(tmp_path, f'<sampler type="{plugin}"/>').spp == 4


def test_without_a_sampler_raylab_chooses(tmp_path: Path) -> None:
    default = SceneDescription()
    scene = camera_scene(tmp_path, "")
    assert (scene.sampler, scene.spp, scene.seed) == (default.sampler, default.spp, default.seed)


@pytest.mark.parametrize(
    ("integrator", "warnings", "hidden"),
    [
        ('<integrator type="direct"/>', 0, False),
        ('<integrator type="direct"><boolean name="hide_emitters" value="true"/></integrator>', 0, True),
        ('<integrator type="path"><integer name="max_depth" value="8"/></integrator>', 1, False),
        ('<integrator type="path"><boolean name="hide_emitters" value="TRUE"/></integrator>', 1, True),
        ('<integrator type="aov"><integrator type="direct"/></integrator>', 1, False),
        ("", 1, False),
    ],
)
def test_integrators(integrator: str, warnings: int, hidden: bool, tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    path.write_text(f'<scene version="3.0.0">\n{integrator}{SENSOR}</scene>')
    scene = read(path)
    assert len(scene.warnings) == warnings
    assert scene.hide_emitters == hidden
    assert all(f"{path}:" in text and "direct light" in text for text in scene.warnings)
    assert (scene.name, scene.path) == ("a", path)


def test_the_first_of_several_sensors_is_used(tmp_path: Path) -> None:
    scene = load(tmp_path, '<sensor type="perspective"><float name="fov" value="3"/></sensor>')
    assert scene.camera.fov_axis == "diagonal"
    assert "test.xml:4: " in scene.warnings[0]


def test_basic_ray_tracing_is_asked_for_by_depth_and_by_one_sample_at_the_centre(tmp_path: Path) -> None:
    for rays, expected, warnings in ((3, 3, 1), (-1, SceneDescription().max_depth, 1), (1000, 16, 2)):
        path = tmp_path / "a.xml"
        integrator = f'<integrator type="path"><integer name="max_depth" value="{rays}"/></integrator>'
        path.write_text(f'<scene version="3.0.0">\n{integrator}{SENSOR}</scene>')
        scene = read(path)
        assert scene.max_depth == expected
        assert len(scene.warnings) == warnings
    one = '<integer name="sample_count" value="1"/><boolean name="jitter" value="false"/>'
    assert camera_scene(tmp_path, f'<sampler type="stratified">{one}</sampler>').sampler == "centre"


def test_animation_and_shutter_are_read(tmp_path):
    path = tmp_path / "moving.xml"
    path.write_text("""<scene version="3.0.0">
        <sensor type="thinlens">
            <float name="aperture_radius" value="0.25"/><float name="focus_distance" value="inf"/>
            <integer name="aperture_blades" value="6"/><float name="aperture_rotation" value="15"/>
            <float name="shutter_open" value="0.25"/><float name="shutter_close" value="0.75"/>
            <animation name="to_world">
                <transform time="0"><translate x="1"/></transform><transform time="2"><translate x="2"/></transform>
            </animation>
        </sensor>
        <shape type="sphere">
            <animation name="to_world">
                <transform time="0"/>
                <transform time="0.5"><scale value="2"/><rotate z="1" angle="90"/></transform>
                <transform time="1"><translate y="3"/></transform>
            </animation>
        </shape>
    </scene>""")
    scene = read(path)
    eye, ball = scene.camera, scene.shapes[0]
    assert (eye.aperture_radius, eye.focus_distance, eye.aperture_blades, eye.aperture_rotation) == (
        0.25,
        np.inf,
        6,
        15,
    )
    assert (eye.shutter_open, eye.shutter_close) == (0.25, 0.75)
    assert eye.motion.times.tolist() == [0.0, 2.0]
    assert eye.motion.matrices[:, 0, 3].tolist() == [1.0, 2.0]
    assert ball.motion.times.tolist() == [0.0, 0.5, 1.0]
    assert np.allclose(ball.motion.matrices[1][:3, :3], [[0, -2, 0], [2, 0, 0], [0, 0, 2]], atol=1e-15)
    assert ball.motion.matrices[2][1, 3] == 3.0
