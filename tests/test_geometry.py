"""From described shapes to world-space arrays: orientation, degenerate triangles, bounding boxes, placement."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import U53
from scipy.spatial.transform import Rotation

from raylab import description as d
from raylab import quadrics
from raylab.errors import SceneError
from raylab.geometry import CENTRE_BITS, Placement, gather, quadric_box, quadric_row, world_mesh
from raylab.triangles import CHUNK, degenerate_faces

SKEW = np.array([[2.0, 0.3, 0.0, 1.0], [0.0, 0.5, -0.2, -2.0], [0.1, 0.0, 1.0, 0.5], [0, 0, 0, 1]])
MIRROR = np.diag([-1.0, 1.0, 1.0, 1.0])


def mesh(shape):
    warnings: list[str] = []
    made = world_mesh(shape, warnings)
    assert not warnings
    return made


def face_normals(made):
    """Twice the area times the normal of each face (n, 3), and the centres (n, 3)."""
    v = made.vertices[made.faces]
    return np.cross(v[:, 1] - v[:, 0], v[:, 2] - v[:, 0]), v.mean(axis=1)


def turned(n=3):
    for k in range(n):
        m = SKEW.copy()
        m[:3, :3] = m[:3, :3] @ Rotation.from_rotvec([k, 2.0 * k, -k]).as_matrix()
        yield m


@pytest.mark.parametrize("flip", [False, True])
@pytest.mark.parametrize("mirrored", [False, True])
def test_the_sides_of_a_cube_face_outwards(mirrored, flip):
    for m in turned():
        made = mesh(d.Cube(to_world=m @ MIRROR if mirrored else m, flip_normals=flip))
        n, centre = face_normals(made)
        outwards = np.einsum("ij,ij->i", n, centre - m[:3, 3])
        assert made.faces.shape == (12, 3)
        assert np.all(outwards < 0.0 if flip else outwards > 0.0)
        assert made.kind == "cube"


def test_a_cube_is_closed_has_its_area_and_a_square_of_texture_on_each_side():
    made = mesh(d.Cube())
    n, centre = face_normals(made)
    assert np.all(np.linalg.norm(n, axis=1) / 2 == 2.0)  # twelve halves of a square of area 4
    assert np.all(n.sum(axis=0) == 0.0)
    assert (np.einsum("ij,ij->i", n, centre) / 6).sum() == pytest.approx(8.0, rel=8 * U53)  # divergence theorem
    assert np.abs(made.vertices).max() == np.abs(made.vertices).min() == 1.0
    for side in range(6):
        assert sorted(map(tuple, made.uv[4 * side : 4 * side + 4])) == [(0, 0), (0, 1), (1, 0), (1, 1)]
        assert len(np.unique(made.vertices[4 * side : 4 * side + 4], axis=0)) == 4


@pytest.mark.parametrize("flip", [False, True])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_rectangle_faces_plus_z(mirrored, flip):
    for m in turned():
        made = mesh(d.Rectangle(to_world=m @ MIRROR if mirrored else m, flip_normals=flip))
        front = np.linalg.inv(m[:3, :3]).T @ [0, 0, 1.0]  # normals go with the inverse transpose
        n, _ = face_normals(made)
        assert np.all((n @ front > 0.0) != flip)
        for size in np.linalg.norm(n, axis=1):
            assert size == pytest.approx(4 * np.linalg.norm(np.cross(m[:3, 0], m[:3, 1])), rel=16 * U53)
    assert mesh(d.Rectangle()).uv.tolist() == [[0, 0], [1, 0], [1, 1], [0, 1]]


def tetrahedron(**more):
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    return d.Mesh(vertices=vertices, faces=np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]), **more)


def test_a_mesh_goes_to_world_with_its_normals():
    normals = np.array([[1.0, 2.0, 2.0], [0, 0, 1], [0, 3, 4], [1, 0, 0]])
    made = mesh(tetrahedron(to_world=SKEW, normals=normals))
    assert np.allclose(made.vertices, tetrahedron().vertices @ SKEW[:3, :3].T + SKEW[:3, 3], rtol=0, atol=8 * U53)
    inverse = np.linalg.inv(SKEW[:3, :3])
    for n, local in zip(made.normals, normals, strict=True):
        assert np.linalg.norm(n) == pytest.approx(1.0, abs=8 * U53)
        for tangent in (np.cross(local, [0.3, 0.4, 0.5]), np.cross(local, [1.0, -1.0, 0.3])):
            assert n @ (SKEW[:3, :3] @ tangent) == pytest.approx(0.0, abs=64 * U53 * np.linalg.norm(local) ** 2)
        assert n @ (inverse.T @ local) > 0.0
    assert made.faces.tolist() == tetrahedron().faces.tolist()


def test_flip_normals_turns_faces_and_vertex_normals():
    normals = np.tile([0.0, 0.0, 1.0], (4, 1))
    plain, flipped = (mesh(tetrahedron(normals=normals, flip_normals=flip)) for flip in (False, True))
    assert np.array_equal(face_normals(flipped)[0], -face_normals(plain)[0])
    assert np.array_equal(flipped.normals, -plain.normals)


@pytest.mark.parametrize("flip", [False, True])
def test_faces_and_vertex_normals_agree_in_a_mirror(flip):
    """A mirrored mesh: whichever side its faces show, the normals of its vertices are on the same one."""
    n, _ = face_normals(mesh(tetrahedron()))
    corner = (n / np.linalg.norm(n, axis=1, keepdims=True))[[3, 3, 3, 3]]
    one = {"vertices": tetrahedron().vertices, "faces": np.array([[1, 2, 3]]), "normals": corner}
    made = mesh(d.Mesh(**one, to_world=MIRROR, flip_normals=flip))
    assert np.all(face_normals(made)[0] @ made.normals.T > 0.0)


def test_a_zero_normal_stays_zero():
    assert np.all(mesh(tetrahedron(normals=np.zeros((4, 3)))).normals == 0.0)


# --- degenerate triangles ---


def test_triangles_without_area_are_left_out_and_counted():  # A18
    low = [[0.5, 2.0**-22, 0], [0.5, 2.0**-18, 0]]
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0], [1, 0, 0], *low])
    faces = np.array([[0, 1, 2], [0, 1, 3], [1, 4, 2], [0, 0, 0], [0, 1, 5], [0, 1, 6]])
    keep = [True, False, False, False, False, True]  # the last: 2 A = 2^-18 of the longest edge squared
    assert degenerate_faces(vertices, faces).tolist() == [not k for k in keep]
    meshes, _, warnings = gather([d.Mesh(name="sliver", vertices=vertices, faces=faces)])
    assert meshes[0].faces.tolist() == faces[keep].tolist()
    assert warnings[0] == "shape 'sliver': 4 degenerate triangles of 6 left out (number 1, 2, 3, 4)"


@pytest.mark.parametrize("scale", [1e-150, 2.0**-60, 1.0, 2.0**60, 1e150])
def test_degeneracy_does_not_depend_on_scale(scale):
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0.3, 2.0**-19, 0], [0.3, 2.0**-21, 0]]) * scale
    faces = np.array([[0, 1, 2], [1, 2, 0], [0, 1, 3], [3, 0, 1]])
    assert degenerate_faces(vertices, faces).tolist() == [False, False, True, True]


def test_many_triangles_are_checked_in_pieces():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    faces = np.tile([[0, 1, 2]], (2 * CHUNK + 3, 1))
    faces[[5, CHUNK, -1]] = [0, 1, 1]
    assert np.flatnonzero(degenerate_faces(vertices, faces)).tolist() == [5, CHUNK, 2 * CHUNK + 2]


def test_a_mesh_without_faces():
    made = mesh(d.Mesh(vertices=np.zeros((3, 3)), faces=np.zeros((0, 3), int)))
    assert made.faces.shape == (0, 3)


# --- quadrics ---

QUADRICS = [
    d.Sphere(center=np.array([1.0, 2.0, 3.0]), radius=0.5),
    d.Sphere(to_world=SKEW),
    d.Disk(to_world=SKEW),
    d.Cylinder(p0=np.array([1.0, 2.0, 3.0]), p1=np.array([-1.0, 2.5, 4.0]), radius=0.25),
    d.Cylinder(to_world=SKEW, p0=np.array([0.0, 0.0, -1.0])),
]


def surface(q, n=20_000):
    """Random points of a quadric in world coordinates, by numpy."""
    rng = np.random.default_rng(1)
    local = rng.normal(size=(n, 3))
    if q.kind == quadrics.SPHERE:
        local /= np.linalg.norm(local, axis=1, keepdims=True)
    else:
        local[:, :2] /= np.linalg.norm(local[:, :2], axis=1, keepdims=True)
        local[:, 2] = rng.integers(0, 2, n) if q.kind == quadrics.CYLINDER else 0.0
    return local @ q.to_world[:3, :3].T + q.to_world[:3, 3]


@pytest.mark.parametrize("shape", QUADRICS)
def test_the_box_of_a_quadric_is_the_smallest(shape):
    _, (q,), _ = gather([shape])
    points, (low, high) = surface(q), quadric_box(q)
    size = np.abs(points).max()
    assert np.all(points.min(axis=0) >= low - 16 * U53 * size)
    assert np.all(points.max(axis=0) <= high + 16 * U53 * size)
    # The highest of n random points of a curve (a surface) lies below the top by 1/n^2 (1/n) of the size.
    assert np.all(points.min(axis=0) - low <= 20.0 / len(points) * size)
    assert np.all(high - points.max(axis=0) <= 20.0 / len(points) * size)


@pytest.mark.parametrize("shape", QUADRICS[3:])
def test_a_cylinder_stands_on_p0_around_the_axis_to_p1(shape):
    _, (q,), _ = gather([shape])
    back = np.linalg.inv(shape.to_world)
    for x in surface(q, 50):
        at = back[:3, :3] @ x + back[:3, 3] - shape.p0
        axis = shape.p1 - shape.p0
        along = at @ axis / (axis @ axis)
        assert min(abs(along), abs(along - 1.0)) <= 64 * U53 * 10
        assert np.linalg.norm(at - along * axis) == pytest.approx(shape.radius, abs=64 * U53 * 10)
    assert np.linalg.det(q.to_world[:3, :3]) > 0.0


@pytest.mark.parametrize("shape", QUADRICS)
def test_the_row_of_a_quadric_maps_normalised_points_to_local_ones(shape):
    _, (q,), _ = gather([shape])
    placement = Placement(np.array([0.5, -1.0, 2.0]), 0.25)
    row = quadric_row(q, placement)
    local = (placement.points(surface(q, 50)) - row[1:4]) @ row[4:13].reshape(3, 3).T
    radius = np.linalg.norm(local if q.kind == quadrics.SPHERE else local[:, :2], axis=1)
    assert radius == pytest.approx(1.0, abs=1e3 * U53)
    assert (row[0], row[13]) == (q.kind, 1.0)
    flipped = type(shape)(**(vars(shape) | {"flip_normals": True}))
    assert quadric_row(gather([flipped])[1][0], placement)[13] == -1.0


# --- placement ---


@pytest.mark.parametrize("extent", [1.0, 0.75, 0.5, 1e-30, 3e20, 2.0**-60, 1.0 - 2.0**-53])
def test_a_placement_is_a_power_of_two_that_brings_everything_into_the_unit_box(extent):
    centre = np.array([4.0, -2.0, 1.0]) * extent
    reach = np.array([1.0, 0.25, 0.5]) * extent
    placement = Placement.around([(centre - reach, centre), (centre, centre + reach)])
    assert math.frexp(placement.scale)[0] == 0.5  # a power of two
    corner = placement.points(np.array([centre - reach, centre + reach]))
    assert 0.5 <= np.abs(corner).max() <= 1.0
    assert corner[0] == pytest.approx(-corner[1], abs=2.0**-CENTRE_BITS)


def test_scaling_a_scene_by_a_power_of_two_changes_no_bit():
    box = (np.array([0.1, -0.7, 3.0]), np.array([0.9, 2.1, 5.5]))
    x = np.random.default_rng(2).normal(size=(50, 3))
    plain = Placement.around([box]).points(x)
    for k in (-60, 3, 60):
        scaled = Placement.around([(box[0] * 2.0**k, box[1] * 2.0**k)]).points(x * 2.0**k)
        assert np.array_equal(scaled, plain)


@pytest.mark.parametrize("shift", [1.0, -1024.0, 2.0**29, [1e9, 0.7e9, -0.4e9]])
def test_moving_a_scene_changes_no_bit_of_what_float64_has_for_it(shift):  # A11
    """Wherever the middle of its box is rounded to."""
    rng = np.random.default_rng(4)
    for _ in range(200):
        x = np.round(rng.normal(size=(8, 3)) * 2.0**22) * 2.0**-22  # so that the sum with the shift is exact
        boxes = [(x.min(axis=0), x.max(axis=0))]
        moved = [(low + shift, high + shift) for low, high in boxes]
        assert np.array_equal(Placement.around(moved).points(x + shift), Placement.around(boxes).points(x))


def test_the_placement_of_nothing_and_of_one_point():
    point = np.array([1.0, 2.0, 3.0])
    for boxes, centre in (([], [0, 0, 0]), ([(point, point)], [1, 2, 3])):
        placement = Placement.around(boxes)
        assert (placement.centre.tolist(), placement.scale) == (centre, 1.0)


# --- bad input ---

TRI, ONE = np.eye(3), np.array([[0, 1, 2]])
FLAT = np.diag([1.0, 1.0, 0.0, 1.0])
BAD = [
    (d.Mesh(name="m", vertices=TRI, faces=np.array([[0, 1, 77]])), "'m'.*vertices 0 to 77, there are 3"),  # A19
    (d.Mesh(name="m", vertices=TRI, faces=np.array([[0, 1, -1]])), "vertices -1 to 1"),
    (d.Mesh(name="m", vertices=TRI[:, :2], faces=ONE), r"vertices \(n, 3\) and faces \(m, 3\), got \(3, 2\)"),
    (d.Mesh(name="m", vertices=TRI, faces=ONE[0]), r"got \(3, 3\) and \(3,\)"),
    (d.Mesh(name="m", vertices=TRI * [[1.0], [np.nan], [1.0]], faces=ONE), "vertex 1 is not finite"),
    (d.Mesh(name="m", vertices=TRI, faces=ONE, normals=np.full((3, 3), np.nan)), "normals must be finite"),
    (
        d.Mesh(name="m", vertices=TRI, faces=ONE, uv=np.zeros((2, 2))),
        r"uv must be finite in float32 and \(3, 2\), got \(2, 2\)",
    ),
    (d.Cube(name="c", to_world=FLAT), "'c'.*singular"),
    (d.Cube(name="c", to_world=np.full((4, 4), np.inf)), "finite affine"),
    (d.Cube(name="c", to_world=np.eye(3)), "finite affine"),
    (d.Cube(name="c", to_world=np.array([*np.eye(4)[:3], [0, 0, 1, 1.0]])), "finite affine"),
    (d.Sphere(name="s", radius=0.0), "'s': radius must be positive and finite, got 0"),
    (d.Cylinder(name="s", radius=-1.0), "radius"),
    (d.Cylinder(name="s", p0=np.ones(3), p1=np.ones(3)), "two different finite points"),
    (d.Shape(name="s"), "expected a shape of raylab.description, got Shape"),
]


@pytest.mark.parametrize(("shape", "message"), BAD)
def test_what_is_no_shape_is_refused(shape, message):
    with pytest.raises(SceneError, match=message):
        gather([shape])
