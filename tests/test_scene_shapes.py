"""What a valid scene file means: transforms and shapes, against numpy and Mitsuba 3.9.1."""

# ruff: noqa: E501 (XML in strings)

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scene_text import EPS, load, matrix, shape

from raylab.description import (
    Cube,
    Cylinder,
    Diffuse,
    Disk,
    Mesh,
    Rectangle,
    Shape,
    Sphere,
)
from raylab.triangles import vertex_normals

# --- transforms ---


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


# --- shapes ---


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
