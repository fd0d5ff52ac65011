"""What a valid scene file means: every element of the subset, against numpy and Mitsuba 3.9.1."""

# ruff: noqa: E501 (XML in strings)

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from raylab.description import (
    Bitmap,
    Conductor,
    ConstantEnvironment,
    Cube,
    Cylinder,
    Dielectric,
    Diffuse,
    DirectionalLight,
    Disk,
    Filter,
    ImageEnvironment,
    Mesh,
    Phong,
    PointLight,
    Rectangle,
    SceneDescription,
    Shape,
    Sphere,
)
from raylab.io.image_file import decode_srgb, write_exr, write_png
from raylab.io.indices import METALS
from raylab.io.mitsuba_xml import read
from raylab.triangles import vertex_normals

EPS = np.finfo(float).eps
SIX_DIGITS = 0.5e-5  # Mitsuba prints six significant digits
SENSOR = '<sensor type="perspective"/>'


def load(folder: Path, body: str, parameters: dict[str, str] | None = None, sensor: str = SENSOR) -> SceneDescription:
    path = folder / "test.xml"
    path.write_text(f'<scene version="3.0.0">\n<integrator type="direct"/>\n{sensor}\n{body}\n</scene>\n')
    return read(path, parameters)


def shape(folder: Path, body: str, kind: str = "rectangle") -> Any:
    (result,) = load(folder, f'<shape type="{kind}">{body}</shape>').shapes
    return result


def matrix(folder: Path, operations: str) -> np.ndarray:
    """The to_world that `operations` make."""
    result: np.ndarray = shape(folder, f'<transform name="to_world">{operations}</transform>').to_world
    return result


# --- transforms ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("operation", "expected"),
    [
        ('<translate x="1" y="-2.5" z="3e1"/>', [[1, 0, 0, 1], [0, 1, 0, -2.5], [0, 0, 1, 30], [0, 0, 0, 1]]),
        ('<translate value="1 2 3"/>', [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]),
        ('<translate z="4"/>', [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 4], [0, 0, 0, 1]]),
        ('<scale value="2"/>', np.diag([2, 2, 2, 1])),
        ('<scale x="2" z="-3"/>', np.diag([2, 1, -3, 1])),
        ('<scale value="1, 2, 3"/>', np.diag([1, 2, 3, 1])),
        ('<matrix value="1 2 0 4, 0 1 0 8, 9 0 1 2, 0 0 0 1"/>', [[1, 2, 0, 4], [0, 1, 0, 8], [9, 0, 1, 2], [0, 0, 0, 1]]),
        ('<matrix value="1 2 0 0 1 0 9 0 1"/>', [[1, 2, 0, 0], [0, 1, 0, 0], [9, 0, 1, 0], [0, 0, 0, 1]]),
        ("", np.eye(4)),
    ],
)  # fmt: skip
def test_transform(operation: str, expected: Any, tmp_path: Path) -> None:
    assert np.array_equal(matrix(tmp_path, operation), expected)


@pytest.mark.parametrize(("axis", "angle"), [((1, 0, 0), 90), ((0, 0, 1), -30), ((0.6, -0.64, 0.48), 200.5)])
def test_rotate_is_counterclockwise_in_degrees(axis: tuple[float, ...], angle: float, tmp_path: Path) -> None:
    from scipy.spatial.transform import Rotation

    x, y, z = axis
    found = matrix(tmp_path, f'<rotate x="{x}" y="{y}" z="{z}" angle="{angle}"/>')
    expected = Rotation.from_rotvec(np.radians(angle) * np.array(axis)).as_matrix()
    assert np.allclose(found[:3, :3], expected, rtol=0, atol=8 * EPS)
    assert np.array_equal(found[:, 3], [0, 0, 0, 1])


def test_lookat_turns_z_to_the_target_and_y_up(tmp_path: Path) -> None:
    origin, target, up = np.array([1.0, 2, 5]), np.array([0.3, -0.2, 0.1]), np.array([0.1, 3, 0])
    words = [" ".join(map(str, v)) for v in (origin, target, up)]
    found = matrix(tmp_path, '<lookat origin="{}" target="{}" up="{}"/>'.format(*words))
    linear, forward = found[:3, :3], target - origin
    assert np.allclose(linear.T @ linear, np.eye(3), rtol=0, atol=8 * EPS)
    assert np.linalg.det(linear) > 0
    assert np.allclose(linear[:, 2], forward / np.linalg.norm(forward), rtol=0, atol=8 * EPS)
    assert abs(linear[:, 0] @ up) <= 16 * EPS
    assert linear[:, 1] @ up > 0
    assert np.array_equal(found[:3, 3], origin)


def test_lookat_without_up_is_mitsubas(tmp_path: Path) -> None:
    # number: Mitsuba 3.9.1, to_world of <lookat origin="1 0 0" target="1 3 4"/>
    found = matrix(tmp_path, '<lookat origin="1 0 0" target="1 3 4"/>')
    expected = [[0, 1, 0, 1], [-0.8, 0, 0.6, 0], [0.6, 0, 0.8, 0], [0, 0, 0, 1]]
    assert np.allclose(found, expected, rtol=0, atol=4 * EPS)


def test_the_first_transform_is_applied_first(tmp_path: Path) -> None:
    found = matrix(tmp_path, '<scale x="2"/><rotate z="1" angle="90"/><translate x="10"/>')
    assert found @ [1, 0, 0, 1] == pytest.approx([10, 2, 0, 1], abs=8 * EPS)


# --- camera, film, filter, sampler, integrator --------------------------------------------------------------------


def camera_scene(folder: Path, inside: str) -> SceneDescription:
    return load(folder, "", sensor=f'<sensor type="perspective">{inside}</sensor>')


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


# --- shapes -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("plugin", "kind"), [("rectangle", Rectangle), ("cube", Cube), ("disk", Disk), ("sphere", Sphere), ("cylinder", Cylinder)]
)  # fmt: skip
def test_shapes_have_mitsubas_defaults(plugin: str, kind: type[Shape], tmp_path: Path) -> None:
    plain = shape(tmp_path, "", plugin)
    assert type(plain) is kind
    assert np.array_equal(plain.to_world, np.eye(4))
    assert not plain.flip_normals
    assert isinstance(plain.front, Diffuse)
    assert np.array_equal(plain.front.reflectance, [0.5] * 3)
    assert plain.back is None
    assert plain.radiance is None
    assert shape(tmp_path, '<boolean name="flip_normals" value="true"/>', plugin).flip_normals
    glowing = shape(tmp_path, '<emitter type="area"/>', plugin)
    assert np.array_equal(glowing.radiance, [1, 1, 1])
    assert glowing.front is None
    default = kind() if kind is not Mesh else None
    for name in ("center", "radius", "p0", "p1"):
        assert np.array_equal(getattr(plain, name, None), getattr(default, name, None))


def test_shape_parameters(tmp_path: Path) -> None:
    ball = shape(tmp_path, '<point name="center" x="1" y="2" z="3"/><integer name="radius" value="2"/>', "sphere")
    assert ball.center.tolist() == [1, 2, 3]
    assert ball.radius == 2
    points = '<point name="p0" value="1 2 3"/><point name="p1" value="1, 2, 5"/><float name="radius" value=".5"/>'
    tube = shape(tmp_path, points, "cylinder")
    assert (tube.p0.tolist(), tube.p1.tolist(), tube.radius) == ([1, 2, 3], [1, 2, 5], 0.5)
    assert load(tmp_path, '<shape type="disk" id="lid"/>').shapes[0].name == "lid"


def test_mirrored_spheres_turn_inside_out_as_in_mitsuba(tmp_path: Path) -> None:
    # Mitsuba 3.9.1: the normal of a sphere under <scale x="-1"/> points inwards, with flip_normals outwards; that of
    # a cylinder stays outwards
    mirror = '<transform name="to_world"><scale x="-1"/></transform>'
    flip = '<boolean name="flip_normals" value="true"/>'
    assert shape(tmp_path, mirror, "sphere").flip_normals
    assert not shape(tmp_path, mirror + flip, "sphere").flip_normals
    assert not shape(tmp_path, mirror, "cylinder").flip_normals


def test_round_shapes_may_be_scaled_where_they_stay_round(tmp_path: Path) -> None:
    upright = '<point name="p1" x="0" y="2" z="0"/><transform name="to_world"><scale x="3" y="5" z="3"/></transform>'
    assert shape(tmp_path, upright, "cylinder").to_world[1, 1] == 5
    turned = '<transform name="to_world"><scale value="1e-9"/><rotate x="1" angle="33"/></transform>'
    assert isinstance(shape(tmp_path, turned, "sphere"), Sphere)


ROOF = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nvt 0 0.25\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"


def mesh(folder: Path, inside: str, text: str = ROOF) -> Mesh:
    (folder / "roof.obj").write_text(text)
    result = shape(folder, f'<string name="filename" value="roof.obj"/>{inside}', "obj")
    assert isinstance(result, Mesh)
    return result


def test_mesh_normals_are_computed_in_world_space(tmp_path: Path) -> None:
    to_world = '<transform name="to_world"><scale x="2" y="3" z="-0.5"/><rotate y="1" angle="20"/></transform>'
    found = mesh(tmp_path, to_world)
    linear = found.to_world[:3, :3]
    assert found.normals is not None
    world = found.normals @ np.linalg.inv(linear)  # normals transform with the inverse transpose
    world /= np.linalg.norm(world, axis=1, keepdims=True)
    assert np.allclose(world, vertex_normals(found.vertices @ linear.T, found.faces), rtol=0, atol=32 * EPS)
    assert np.allclose(np.linalg.norm(found.normals, axis=1), 1, rtol=0, atol=8 * EPS)


def test_face_normals_and_normals_of_the_file(tmp_path: Path) -> None:
    assert mesh(tmp_path, '<boolean name="face_normals" value="true"/>').normals is None
    normals = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 3 4\nf 1//1 2//1 3//1\n"
    found = mesh(tmp_path, '<transform name="to_world"><scale x="9"/></transform>', normals)
    assert found.normals is not None
    assert found.normals.tolist() == [[0, 0.6, 0.8]] * 3


def test_obj_turns_v_upside_down_unless_told_not_to(tmp_path: Path) -> None:
    flipped, kept = (
        mesh(tmp_path, f'<boolean name="flip_tex_coords" value="{word}"/>').uv for word in ("true", "false")
    )
    plain = mesh(tmp_path, "").uv
    assert plain is not None
    assert flipped is not None
    assert kept is not None
    assert np.array_equal(plain, flipped)
    assert np.array_equal(flipped, np.column_stack([kept[:, 0], 1 - kept[:, 1]]))
    assert 0.25 in kept[:, 1]


def test_ply_keeps_v(tmp_path: Path) -> None:
    rows = "0 0 0 0 0.25\n1 0 0 1 0\n1 1 0 1 1\n3 0 1 2\n"
    fields = "".join(f"property float {name}\n" for name in ("x", "y", "z", "u", "v"))
    header = f"ply\nformat ascii 1.0\nelement vertex 3\n{fields}element face 1\n"
    (tmp_path / "a.ply").write_text(header + "property list uchar int vertex_index\nend_header\n" + rows)
    found = shape(tmp_path, '<string name="filename" value="a.ply"/>', "ply")
    assert found.uv.tolist() == [[0, 0.25], [1, 0], [1, 1]]
    assert found.vertices.tolist()[1] == [1, 0, 0]


# --- materials and textures ---------------------------------------------------------------------------------------


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


def bitmap(folder: Path, inside: str = "", name: str = "t.exr") -> Bitmap:
    texture = f'<texture type="bitmap" name="reflectance"><string name="filename" value="{name}"/>{inside}</texture>'
    result = shape(folder, f'<bsdf type="diffuse">{texture}</bsdf>').front.reflectance
    assert isinstance(result, Bitmap)
    return result


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


# --- emitters -----------------------------------------------------------------------------------------------------


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


# --- colours ------------------------------------------------------------------------------------------------------

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


# --- parameters, references, includes -----------------------------------------------------------------------------


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
