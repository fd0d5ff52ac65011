"""What is wrong with the geometry of a scene is counted, listed, and refused or warned about; what is right is not."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from raylab import description as d
from raylab.defects import FAR, FINE, RANGE, SLIVER
from raylab.errors import SceneError
from raylab.scene import Scene
from raylab.triangles import FLAT, face_keys, proportions


def scene(*shapes):
    return Scene(d.SceneDescription(shapes=shapes))


def mesh(vertices, faces, name="m", **more):
    return d.Mesh(name=name, vertices=np.asarray(vertices, float), faces=np.asarray(faces), **more)


def scaled(size, at=(0.0, 0.0, 0.0)):
    m = np.diag([size, size, size, 1.0])
    m[:3, 3] = at
    return m


def ball(size=1.0, at=(0.0, 0.0, 0.0), name="ball"):
    made = trimesh.creation.icosphere(3)
    return mesh(made.vertices, made.faces, name, to_world=scaled(size, at))


BOX = d.Cube(name="box")


def test_good_meshes_are_not_spoken_of():
    assert scene(ball(), BOX, d.Rectangle(), d.Sphere()).warnings == []
    assert scene().warnings == []
    assert scene(mesh(np.zeros((3, 3)), np.zeros((0, 3), int))).warnings == []


def test_slivers_are_counted_and_listed_and_stay():  # A18
    low = SLIVER * np.array([0.99, 1.01])
    vertices = [[0, 0, 0], [1, 0, 0], *([0.5, h, 0] for h in low), [0.5, FLAT, 0]]
    made = scene(mesh(vertices, [[0, 1, 3], [0, 1, 2], [1, 0, 2], [0, 1, 4]]))
    assert made.triangles == 3
    assert made.warnings[0] == "shape 'm': 1 degenerate triangle of 4 left out (number 3)"
    assert made.warnings[1].startswith(
        "shape 'm': 2 sliver triangles of 4 up to 4.1e+03 times as long as high (number 1,"
    )


@pytest.mark.parametrize("copies", [2, 1000])
def test_coincident_triangles_are_counted(copies):  # A21
    """Whatever the order of their corners, and though each has vertices of its own."""
    one = np.array([[0.0, 0, 0], [1, 0, 0], [0, -0.0, 1]])
    vertices = np.concatenate([np.roll(one, k, axis=0)[:: 1 if k % 2 else -1] for k in range(copies)])
    made = scene(ball(at=(5, 0, 0)), mesh(vertices, np.arange(3 * copies).reshape(-1, 3)), mesh(one, [[0, 1, 2]], "n"))
    assert made.warnings[0].startswith(f"shape 'm': {copies - 1} duplicate triangle")
    assert made.warnings[1].startswith("shape 'n': 1 duplicate triangle of 1, the first with a corner at (0, 0, 0)")
    assert len(made.warnings) == 2


def test_triangles_that_share_an_edge_or_a_corner_are_no_duplicates():
    vertices = np.random.default_rng(1).integers(-2, 3, (40, 3)).astype(float)  # many of them coincide
    faces = np.array([f for f in np.random.default_rng(2).integers(0, 40, (3000, 3)) if len(set(f)) == 3])
    keys = face_keys(vertices, faces)
    sets = [frozenset(map(tuple, vertices[f])) for f in faces]
    multisets = [tuple(sorted(map(tuple, vertices[f]))) for f in faces]
    assert len(set(sets)) > 1000
    assert len(np.unique(keys)) == len(set(multisets))


@pytest.mark.parametrize("size", [0.9 * FINE, 1.1 * FINE])
def test_what_is_tiny_in_something_huge_is_warned_about(size):  # A27, A16
    small = scene(ball(0.75), d.Rectangle(name="r", to_world=scaled(size / 2, (0.5, 0, 0))))
    said = ["shape 'r': 2 triangles of 2 with an edge"] if size < FINE else []
    assert [w.split(",")[0] for w in small.warnings] == said
    assert all(f"the shortest {size:.3g} long" in w and "smaller than 2^-18" in w for w in small.warnings)
    quadric = scene(ball(0.75), d.Sphere(name="s", radius=size / 2))
    assert [w.split(":")[0] for w in quadric.warnings] == (["shape 's'"] if size < FINE else [])


def test_a_thin_plate_is_not_tiny():
    """The height of a disk is zero, and nobody minds."""
    assert scene(ball(), d.Disk(to_world=np.diag([1, 1, 1e-9, 1.0]))).warnings == []


@pytest.mark.parametrize("away", [0.9 * FAR, 1.1 * FAR])
def test_a_scene_far_from_the_origin_is_warned_about(away):  # A11
    made = scene(d.Rectangle(to_world=scaled(0.75, (away, 0, 0))))
    assert len([w for w in made.warnings if "from the origin" in w]) == (away > FAR)


@pytest.mark.parametrize(
    ("size", "words"),
    [
        (2 * RANGE, "reaches"),
        (0.9 * RANGE, "reach"),
        (1e300, "reach"),
        (0.4 / RANGE, "large; at least"),
        (1e-300, "large"),
    ],
)
@pytest.mark.parametrize("shape", [d.Cube, d.Sphere, d.Cylinder])
def test_a_scene_out_of_range_is_refused(shape, size, words):  # A17
    with pytest.raises(SceneError, match=words):
        scene(shape(to_world=scaled(size, (size, 0, 0))))


def test_what_overflows_is_refused():
    with pytest.raises(SceneError, match="vertex 0 is not finite"):
        scene(mesh(np.eye(3) * 1e300, [[0, 1, 2]], to_world=scaled(1e80)))
    with pytest.raises(SceneError, match="radius"):
        scene(d.Sphere(radius=1e300))


def test_a_scene_at_the_end_of_the_range_is_not():
    for size in (0.4 * RANGE, 2.0 / RANGE):
        made = scene(d.Cube(to_world=scaled(size)), d.Sphere(to_world=scaled(size)))
        assert made.warnings == []
        assert np.isfinite(made.data.planes.array).all()


def test_proportions_are_those_of_the_triangles():
    rng = np.random.default_rng(3)
    for size in (1e-150, 1.0, 1e150):
        corners = rng.normal(size=(200, 3, 3)) * size
        thickness, shortest = proportions(corners.reshape(-1, 3), np.arange(600).reshape(-1, 3))
        edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2) / size
        unit = corners / size
        area = np.linalg.norm(np.cross(unit[:, 1] - unit[:, 0], unit[:, 2] - unit[:, 0]), axis=1)
        assert np.allclose(shortest / size, edges.min(axis=1), rtol=1e-12, atol=0)
        assert np.allclose(thickness, area / edges.max(axis=1) ** 2, rtol=1e-9, atol=0)
    turned = Rotation.from_rotvec([1, 2, 3]).apply(np.eye(3))
    assert proportions(turned, np.array([[0, 1, 2]]))[0][0] == pytest.approx(3**0.5 / 2, rel=1e-14)
