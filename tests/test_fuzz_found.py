"""What the fuzzers found, each as its smallest case."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import animation, moved, shutter, turned

from raylab import description as d
from raylab.errors import SceneError
from raylab.geometry import world_mesh
from raylab.io.mesh_file import read_mesh
from raylab.io.mitsuba_xml import read
from raylab.scene import Scene

WORLD = d.Rectangle(name="world")
SPECK = moved(0, 0, 0, 1e-170, 1e-170, 1e-170)


def test_a_square_whose_area_is_beyond_float64_has_no_normal():
    """It was divided by its area of 0."""
    scene = Scene(d.SceneDescription(shapes=(WORLD, d.Rectangle(to_world=SPECK, name="dust"))))
    assert any("'dust'" in warning and "too fine for float32" in warning for warning in scene.warnings)
    assert np.isfinite(scene.data.planes.array).all()


@pytest.mark.parametrize("faces", [2, 1], ids=["rectangle", "triangle"])
def test_a_lamp_whose_area_is_beyond_float64_is_refused(faces):
    """Its density 1 / A was infinite."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    triangle = d.Mesh(vertices=corners, faces=np.array([[0, 1, 2]]), to_world=SPECK, radiance=np.ones(3))
    square = d.Rectangle(to_world=SPECK, radiance=np.ones(3))
    with pytest.raises(SceneError, match="an area light needs an area"):
        Scene(d.SceneDescription(shapes=(WORLD, square if faces == 2 else triangle)))


@pytest.mark.parametrize(
    ("eye", "words"),
    [
        (d.Camera(principal_point_offset=(0.0, np.nan)), "principal_point_offset must be finite"),
        (d.Camera(filter=d.Filter("box", np.inf)), "positive radius"),
        (d.Camera(filter=d.Filter("gaussian", 4e-200, 1e-200)), "radius and stddev of a gaussian"),
        (d.Camera(filter=d.Filter("gaussian", 1.0, np.inf)), "radius and stddev of a gaussian"),
    ],
)
def test_a_camera_without_directions_is_refused(eye, words):
    """Each eye ray was NaN."""
    with pytest.raises(SceneError, match=words):
        Scene(d.SceneDescription(camera=eye))


@pytest.mark.parametrize("length", [1e200, 1e-200, 5e-324])
def test_the_direction_of_a_sun_has_any_length(length):
    """Its square over- or underflowed, and the sun was refused as infinite or as none."""
    sun = d.DirectionalLight(np.array([0.0, 0.0, -length]), np.ones(3))
    (found,) = Scene(d.SceneDescription(lights=(sun,))).data.suns
    assert [*found.w] == [0.0, 0.0, 1.0]


@pytest.mark.parametrize("far", [1e200, 1.7e308])
def test_a_camera_whose_distance_has_no_square_is_refused(far):
    """The square of its distance overflowed."""
    eye = d.Camera(to_world=moved(0, 0, far))
    with pytest.raises(SceneError, match="times the size of the scene away"):
        Scene(d.SceneDescription(camera=eye, shapes=(WORLD,)))


SLIDING = d.Rectangle(motion=animation(np.eye(4), moved(1, 0, 0)), name="sliding")


@pytest.mark.parametrize("times", [(-1e308, 1e308), (0.0, 1e300), (0.0, 5e-324)])
def test_a_shutter_open_for_longer_or_shorter_than_float64_can_divide_is_refused(times):
    """Its length was infinite, and no part of the motion was found in it."""
    scene = d.SceneDescription(camera=shutter(d.Camera(), *times), shapes=(WORLD, SLIDING))
    with pytest.raises(SceneError, match="the shutter must be open for no time or at least"):
        Scene(scene)


def test_keyframes_closer_than_float64_can_divide_are_refused():
    """The velocity between them was infinite."""
    sudden = d.Rectangle(motion=animation(np.eye(4), moved(1, 0, 0), times=(0.0, 5e-324)), name="sudden")
    with pytest.raises(SceneError, match="'sudden': the times of keyframes must be finite and increase, by"):
        Scene(d.SceneDescription(camera=shutter(d.Camera()), shapes=(WORLD, sudden)))


def test_a_shutter_may_be_as_short_as_the_rounding_of_its_time():
    """A part of a step of 2^-53 in time was lost in rounding, and then no motion was found in it."""
    brief = (1.0 - 2.0**-53, 1.0)
    turning = d.Rectangle(motion=animation(np.eye(4), turned(170.0), times=brief), name="turning")
    scene = Scene(d.SceneDescription(camera=shutter(d.Camera(), *brief), shapes=(WORLD, turning)))
    assert "motion" in scene.features


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e200])
def test_a_moving_ball_whose_centre_is_no_number_is_refused(bad):
    """How far it moves was computed before that was noticed."""
    ball = d.Sphere(center=np.array([0.0, bad, 0.0]), motion=animation(np.eye(4), turned(90.0)), name="ball")
    with pytest.raises(SceneError, match="'ball': center must be finite"):
        Scene(d.SceneDescription(camera=shutter(d.Camera()), shapes=(WORLD, ball)))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_texture_map_that_is_no_map_is_refused(bad):
    """Each of its colours was NaN."""
    board = d.Bitmap(np.ones((1, 1, 3)), to_uv=np.diag([bad, 1.0, 1.0]))
    with pytest.raises(SceneError, match="to_uv must be a finite"):
        Scene(d.SceneDescription(shapes=(d.Rectangle(front=d.Diffuse(board)),)))


def test_texture_coordinates_beyond_float32_are_refused():
    """They became infinite."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    mesh = d.Mesh(vertices=corners, faces=np.array([[0, 1, 2]]), uv=np.full((3, 2), 1e39), name="far")
    with pytest.raises(SceneError, match="shape 'far': uv must be finite in float32"):
        Scene(d.SceneDescription(shapes=(mesh,)))


@pytest.mark.parametrize(("size", "position", "intensity"), [(2.0**-300, 0.0, 1e150), (1e-3, 1.7e308, 1.0)])
def test_a_point_light_beyond_float64_in_units_of_the_scene_is_refused(size, position, intensity):
    """Its radiance was infinite, or its place."""
    light = d.PointLight(np.full(3, position), np.full(3, intensity))
    world = d.Rectangle(to_world=moved(0, 0, 0, size, size, size))
    with pytest.raises(SceneError, match="beyond float64"):
        Scene(d.SceneDescription(shapes=(world,), lights=(light,)))


def test_a_lens_focused_closer_than_float64_can_divide_is_refused():
    """A division by zero was in the way."""
    eye = d.Camera(aperture_radius=5e-324, focus_distance=5e-324)
    with pytest.raises(SceneError, match="focus_distance must be at least"):
        Scene(d.SceneDescription(camera=eye, shapes=(d.Rectangle(to_world=moved(0, 0, 0, 4, 4, 4)),)))


@pytest.mark.parametrize(("place", "bad"), [((0, 3), np.nan), ((3, 0), np.inf), ((1, 1), np.nan), ((1, 1), 1e200)])
def test_a_sky_whose_matrix_is_no_rotation_is_refused(place, bad):
    """Where nothing reads it, what is no number went unnoticed; and the square of a large one overflowed."""
    matrix = np.eye(4)
    matrix[place] = bad
    sky = d.ImageEnvironment(np.ones((2, 2, 3)), matrix)
    with pytest.raises(SceneError, match="environment: to_world must be a finite"):
        Scene(d.SceneDescription(shapes=(WORLD,), environment=sky))


PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
"""


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0\nvt 1\nvt 0\nf 1/1 2/2 3/3\n", "needs 2 numbers for its texture"),
        ("a.ply", f"{PLY} 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "cannot read the mesh"),
    ],
)
def test_a_mesh_file_with_too_few_numbers_is_refused(tmp_path, name, text, words):
    """They ended in an IndexError and a ValueError, far from the reader."""
    (tmp_path / name).write_text(text)
    with pytest.raises(SceneError, match=words):
        read_mesh(tmp_path / name)


def test_vertices_of_triangles_that_are_left_out_may_be_anywhere():
    """They overflowed in float32, though no triangle was left there."""
    corners = np.array([[1e45, 0.0, 0.0], [1.0, 0, 0], [0, 1, 0]])
    needle = d.Mesh(vertices=corners, faces=np.array([[0, 1, 2]]), name="needle")
    assert any("left out" in warning for warning in Scene(d.SceneDescription(shapes=(WORLD, needle))).warnings)


@pytest.mark.parametrize("size", ["1e200", "1e-200", "5e-324"])
def test_normals_of_a_mesh_file_may_have_any_length(tmp_path, size):
    """The square of 1e200 overflowed, and that of 1e-200 was 0."""
    (tmp_path / "a.obj").write_text(f"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn {size} 0 {size}\nf 1//1 2//1 3//1\n")
    assert np.abs(read_mesh(tmp_path / "a.obj").normals - [0.5**0.5, 0.0, 0.5**0.5]).max() <= 2.0**-52


@pytest.mark.parametrize("name", ["1" * 300 + ".obj", "1" * 5000])
def test_a_file_name_too_long_for_a_file_is_refused(tmp_path, name):
    """It ended in an OSError."""
    scene = tmp_path / "scene.xml"
    scene.write_text(
        f'<scene version="3.0.0"><shape type="obj"><string name="filename" value="{name}"/></shape></scene>'
    )
    with pytest.raises(SceneError, match="no file"):
        read(scene)


def test_normals_of_a_mesh_may_have_any_length():
    """The same from Python."""
    corners, face = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
    meshes = [d.Mesh(vertices=corners, faces=face, normals=size * np.eye(3)) for size in (1.0, 2.0**100, 2.0**-600)]
    assert all(np.array_equal(world_mesh(mesh, []).normals, np.eye(3)) for mesh in meshes)
