"""Meshes come out of OBJ and PLY files as they were written, and broken files are refused."""

from __future__ import annotations

import struct
import time
from pathlib import Path

import numpy as np
import pytest
import trimesh

from raylab.errors import SceneError
from raylab.io.mesh_file import MeshData, read_mesh
from raylab.triangles import FLAT, degenerate_faces, vertex_normals

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
CORNERS = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
BINARY = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "<f4").tobytes()


def ply(faces: int, kind: str = "ascii", vertex: str = "", vertices: int = 4) -> str:
    """The header of a PLY file."""
    position = "".join(f"property float {c}\n" for c in "xyz")
    return (
        f"ply\nformat {kind} 1.0\nelement vertex {vertices}\n{position}{vertex}element face {faces}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )


def written(path: Path, data: str | bytes) -> Path:
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return path


def corners(mesh: MeshData) -> list[list[list[float]]]:
    """The corners of all faces, sorted, each face turned so that its smallest corner is first."""
    turned = []
    for face in mesh.vertices[mesh.faces].tolist():
        first = face.index(min(face))
        turned.append(face[first:] + face[:first])
    return sorted(turned)


TWO_TRIANGLES = [
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
    [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
]


@pytest.mark.parametrize(
    "faces",
    [
        "f 1 2 3\nf 1 3 4\n",
        "f 1 2 3 4\n",
        "f -4 -3 -2\nf -4 -2 -1\n",
        "f 1 2 3 \\\n 4\n",
        "o a\nusemtl red\nf 1 2 3\no b\ng c d\ns 1\nusemtl blue\nf 1 3 4\n",
        "  f 1 2 3 # f 7 8 9\r\nf\t1 3  4\r\n",
        "vt 0 0\nf 1/1 2/1 3/1 4/1\n",
        "vn 0 0 1\nf 1//1 2//1 3//1 4//1\n",
    ],
)
def test_obj_faces(faces: str, tmp_path: Path) -> None:
    mesh = read_mesh(written(tmp_path / "a.obj", SQUARE + faces))
    assert corners(mesh) == TWO_TRIANGLES
    assert mesh.vertices.dtype == np.float64
    assert mesh.faces.dtype == np.uint32


def test_negative_indices_count_back_from_their_own_line(tmp_path: Path) -> None:
    mesh = read_mesh(written(tmp_path / "a.obj", SQUARE + "f -4 -3 -2\nv 5 5 5\nf -5 -3 -2\n"))
    assert corners(mesh) == TWO_TRIANGLES


def test_polygons_become_fans(tmp_path: Path) -> None:
    mesh = read_mesh(written(tmp_path / "a.obj", SQUARE + "v -1 0.5 0\nf 1 2 3 4 5\nf 1 2 3\n"))
    area = np.linalg.norm(np.cross(*np.diff(mesh.vertices[mesh.faces], axis=1).swapaxes(0, 1)), axis=1) / 2
    assert len(mesh.faces) == 4
    assert area.sum() == pytest.approx(0.5 + 1.5, abs=8 * np.finfo(float).eps)


def test_obj_corners_with_several_normals_and_uv_are_split(tmp_path: Path) -> None:
    text = SQUARE + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 2\nvn 0 3 4\n"
    text += "f 1/1/1 2/2/1 3/3/1\nf 1/2/2 3/3/2 4/4/2\n"
    mesh = read_mesh(written(tmp_path / "a.obj", text))
    assert mesh.normals is not None
    assert mesh.uv is not None
    found = {(*mesh.vertices[i], *mesh.uv[i], *mesh.normals[i]) for face in mesh.faces.tolist() for i in face}
    assert found == {
        (0, 0, 0, 0, 0, 0, 0, 1), (1, 0, 0, 1, 0, 0, 0, 1), (1, 1, 0, 1, 1, 0, 0, 1),
        (0, 0, 0, 1, 0, 0, 0.6, 0.8), (1, 1, 0, 1, 1, 0, 0.6, 0.8), (0, 1, 0, 0, 1, 0, 0.6, 0.8),
    }  # fmt: skip


@pytest.mark.parametrize(
    "data",
    [
        ply(2) + CORNERS + "3 0 1 2\n3 0 2 3\n",
        ply(1) + CORNERS + "4 0 1 2 3\n",
        ply(2, "binary_little_endian").encode() + BINARY + struct.pack("<B3iB3i", 3, 0, 1, 2, 3, 0, 2, 3),
        ply(1, "binary_little_endian").encode() + BINARY + struct.pack("<B4i", 4, 0, 1, 2, 3),
        ply(1, "binary_big_endian").encode()
        + np.frombuffer(BINARY, "<f4").astype(">f4").tobytes()
        + struct.pack(">B4i", 4, 0, 1, 2, 3),
    ],
)
def test_ply_faces(data: str | bytes, tmp_path: Path) -> None:
    assert corners(read_mesh(written(tmp_path / "a.ply", data))) == TWO_TRIANGLES


@pytest.mark.parametrize("names", ["u v", "s t", "texture_u texture_v"])
def test_ply_normals_and_uv(names: str, tmp_path: Path) -> None:
    fields = "".join(f"property float {name}\n" for name in ["nx", "ny", "nz", *names.split()])
    rows = "0 0 0 0 0 2 0 0\n1 0 0 0 3 4 1 0\n1 1 0 0 0 1 1 1\n"
    mesh = read_mesh(written(tmp_path / "a.ply", ply(1, vertex=fields, vertices=3) + rows + "3 0 1 2\n"))
    assert mesh.normals is not None
    assert mesh.uv is not None
    assert mesh.normals.tolist() == [[0, 0, 1], [0, 0.6, 0.8], [0, 0, 1]]
    assert mesh.uv.tolist() == [[0, 0], [1, 0], [1, 1]]


@pytest.mark.parametrize(
    ("name", "data", "reason"),
    [
        ("a.stl", "", r"\.obj or \.ply"),
        ("a.obj", "", "no faces"),
        ("a.obj", SQUARE, "no faces"),
        ("a.obj", SQUARE + "f 1 2 9\n", "index 8"),
        ("a.obj", SQUARE + "f 0 1 2\n", "line 5: index 0"),
        ("a.obj", SQUARE + "f -5 1 2\n", "line 5: index -5"),
        ("a.obj", SQUARE + "f 1 2\n", "three corners"),
        ("a.obj", SQUARE + "f 1 2 x\n", "a.obj"),
        ("a.obj", SQUARE + "vt 0 0\nf 1/1 2/1 3/1\nf 1 3 4\n", "texture coordinates"),
        ("a.obj", SQUARE + "vt 0 0\nf 1/1 2/1 3/7\n", "texture coordinates"),
        ("a.obj", SQUARE + "vn 0 0 1\nf 1//1 2//1 3//1\nf 1 3 4\n", "normals"),
        ("a.obj", SQUARE + "vn 0 0 0\nf 1//1 2//1 3//1\n", "3 normals that are zero"),
        ("a.obj", SQUARE.replace("v 1 1 0", "v 1 nan 0") + "f 1 2 3\n", "1 vertices .* number 2"),
        ("a.obj", "v 0 0\nv 1 0\nv 1 1\nf 1 2 3\n", "three coordinates"),
        ("a.ply", "", "a.ply"),
        ("a.ply", "ply\nformat", "a.ply"),
        ("a.ply", ply(0) + CORNERS, "no faces"),
        ("a.ply", ply(5) + CORNERS + "3 0 1 2\n", "announces 5 .* has 1"),
        ("a.ply", ply(2) + CORNERS + "3 0 1 2\n3 0 1 4\n", "1 faces with an index outside 0 to 3.* number 1"),
        ("a.ply", ply(1) + CORNERS + "3 0 1 -1\n", "1 faces with an index outside 0 to 3"),
        ("a.ply", ply(1) + CORNERS.replace("1 1 0", "1 inf 0") + "3 0 1 2\n", "1 vertices .* number 2"),
        (
            "a.ply",
            ply(2, "binary_little_endian").encode() + BINARY + struct.pack("<B3i", 3, 0, 1, 2),
            "a.ply",
        ),
        (
            "a.ply",
            ply(3, "binary_little_endian").encode()
            + BINARY
            + struct.pack("<B4iB3iB5i", 4, 0, 1, 2, 3, 3, 0, 1, 2, 5, 0, 1, 2, 3, 0),
            "either triangles or quadrilaterals",
        ),
    ],
)
def test_broken_files_are_refused(name: str, data: str | bytes, reason: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=reason) as caught:
        read_mesh(written(tmp_path / name, data))
    assert name in str(caught.value)


def test_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"missing\.ply"):
        read_mesh(tmp_path / "missing.ply")


def test_vertex_normals_of_a_cube_corner_weigh_by_angle() -> None:
    # three faces of a cube meet at a corner, one of them cut in two: by angle each face counts the same
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0]], dtype=float)
    faces = np.array([[0, 4, 1], [0, 2, 4], [0, 3, 2], [0, 1, 3]], dtype=np.uint32)
    normals = vertex_normals(vertices, faces)
    assert normals[0] == pytest.approx(np.full(3, -(3.0**-0.5)), abs=8 * np.finfo(float).eps)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(5), abs=8 * np.finfo(float).eps)


def test_vertex_normals_of_a_sphere_point_outwards() -> None:
    ball = trimesh.creation.icosphere(2)
    normals = vertex_normals(np.asarray(ball.vertices), np.asarray(ball.faces))
    expected = trimesh.geometry.weighted_vertex_normals(
        len(ball.vertices), ball.faces, ball.face_normals, ball.face_angles
    )
    assert np.allclose(normals, expected, rtol=0, atol=1e-12)  # arc cosines near 60 degrees keep 12 digits


def test_vertex_without_faces_gets_a_normal() -> None:
    vertices = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [7, 7, 7]], dtype=float)
    assert vertex_normals(vertices, np.array([[0, 1, 2]])).tolist() == [[1, 0, 0]] * 4


def test_degenerate_faces_are_those_with_no_area_to_speak_of() -> None:
    height = FLAT * np.array([0.0, 0.99, 1.01])  # 2 A = height x 1, longest edge 1
    vertices = np.concatenate([[[0, 0, 0], [1, 0, 0]], np.column_stack([np.full(3, 0.5), height, 0 * height])])
    faces = np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4], [0, 0, 1], [1, 1, 1]])
    assert degenerate_faces(vertices, faces).tolist() == [True, True, False, True, True]
    assert degenerate_faces(vertices, faces[:0]).tolist() == []
    many = np.tile(faces, (50_000, 1))
    assert degenerate_faces(vertices, many).sum() == 4 * 50_000


def test_large_binary_ply_is_read_fast(tmp_path: Path) -> None:
    side = 354  # 250,632 triangles: a quarter of a million within half a second is a million within two
    grid = np.stack(np.meshgrid(*[np.arange(side + 1.0)] * 2, indexing="ij"), -1).reshape(-1, 2)
    vertices = np.column_stack([grid, np.sin(grid[:, 0])]).astype("<f4")
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    faces = np.zeros(2 * len(first), dtype=[("n", "u1"), ("i", "<i4", 3)])
    faces["n"] = 3
    faces["i"][::2] = np.column_stack([first, first + 1, first + side + 2])
    faces["i"][1::2] = np.column_stack([first, first + side + 2, first + side + 1])
    header = ply(len(faces), "binary_little_endian", vertices=len(vertices)).encode()
    path = written(tmp_path / "a.ply", header + vertices.tobytes() + faces.tobytes())
    start = time.perf_counter()
    mesh = read_mesh(path)
    seconds = time.perf_counter() - start
    assert np.array_equal(mesh.faces, faces["i"])
    assert np.array_equal(mesh.vertices, vertices)
    assert seconds < 0.5
