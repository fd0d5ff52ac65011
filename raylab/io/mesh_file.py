"""Triangle meshes from OBJ and PLY files through trimesh."""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from raylab.errors import SceneError
from raylab.triangles import directions

Array = npt.NDArray[np.float64]
Faces = npt.NDArray[np.uint32]


class MeshData(NamedTuple):
    """`vertices` (n, 3), `faces` (m, 3), unit `normals` (n, 3) or None, `uv` (n, 2) or None."""

    vertices: Array
    faces: Faces
    normals: Array | None
    uv: Array | None


def read_mesh(path: str | Path) -> MeshData:
    """The triangles of an OBJ or PLY file as one mesh; polygons become fans, corners are split if they must.

    Raises SceneError for files that cannot be read, indices out of range and vertices that are not finite.
    """
    file = Path(path)
    readers = {".obj": _read_obj, ".ply": _read_ply}
    if file.suffix.lower() not in readers:
        raise SceneError(f'a mesh file must end in .obj or .ply, got "{file}"')
    try:
        data = file.read_bytes()
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # numpy only warns of text that it stopped reading half-way
            fields = readers[file.suffix.lower()](data)
    except OSError as error:
        raise SceneError(f'cannot read the mesh "{file}": {error.strerror}') from None
    except SceneError as error:
        raise SceneError(f'cannot read the mesh "{file}": {error}') from None
    except Exception as error:  # trimesh raises whatever its parser trips over
        raise SceneError(f'cannot read the mesh "{file}": {type(error).__name__}: {error}') from error
    try:
        return _checked(file, fields)
    except SceneError:
        raise
    except (ValueError, TypeError, IndexError) as error:  # rows of different lengths, which trimesh lets through
        raise SceneError(f'cannot read the mesh "{file}": {type(error).__name__}: {error}') from error


def _read_obj(data: bytes) -> dict[str, Any]:
    """One mesh whatever groups, objects and materials the file names."""
    from io import BytesIO

    from trimesh.exchange.obj import load_obj

    data = re.sub(rb"#.*|(?m:^ +)", b"", data.replace(b"\t", b" ").replace(b"\r\n", b"\n"))
    data = re.sub(rb"(?m)^(?:usemtl|mtllib|o|g|s)(?: .*)?$", b"", data)
    if re.search(rb"(?m)^f .*(?:-|(?<!\d)0+(?!\d))", data):
        data = _absolute_indices(data)
    loaded = load_obj(BytesIO(data), skip_materials=True)
    if not loaded.get("geometry"):
        raise SceneError("the file has no faces")
    (fields,) = loaded["geometry"].values()
    for name, key, corner in (
        ("texture coordinates", "visual", rb"\d/\d"),
        ("normals", "vertex_normals", rb"/\d*/\d"),
    ):
        if fields.get(key) is None and re.search(rb"(?m)^f .*" + corner, data):
            raise SceneError(f"some faces have {name} and others have none, or their indices are out of range")
    return dict(fields)


def _absolute_indices(data: bytes) -> bytes:
    """OBJ text whose negative indices, which count back from the face that uses them, became positive."""
    counts = {b"v": 0, b"vt": 0, b"vn": 0}
    lines = data.splitlines()
    for number, line in enumerate(lines):
        words = line.split()
        if words and words[0] in counts:
            counts[words[0]] += 1
        elif words and words[0] == b"f":
            corners = [_absolute(word, list(counts.values()), number + 1) for word in words[1:]]
            lines[number] = b"f " + b" ".join(corners)
    return b"\n".join(lines)


def _absolute(corner: bytes, counts: list[int], line: int) -> bytes:
    indices = [int(index) if index else None for index in corner.split(b"/")]
    for place, (index, count) in enumerate(zip(indices, counts, strict=False)):
        if index is not None and index < 0:
            indices[place] = index = index + count + 1
        if index is not None and index < 1:
            raise SceneError(f"line {line}: index {corner.decode()} is out of range, {count} given so far")
    return b"/".join(b"" if index is None else str(index).encode() for index in indices)


def _read_ply(data: bytes) -> dict[str, Any]:
    """Texture coordinates are read where they belong to vertices, which is how Mitsuba 3 has them."""
    from io import BytesIO

    from trimesh.exchange.ply import load_ply

    fields = dict(load_ply(BytesIO(data), skip_materials=True, fix_texture=False))
    elements = fields["metadata"]["_ply_raw"]
    faces = elements.get("face", {})
    if fields.get("faces") is None or not faces.get("length"):
        raise SceneError("the file has no faces")
    for name, rows in (("face", fields["faces"]), ("vertex", fields["vertices"])):
        if len(rows) < elements[name]["length"]:
            raise SceneError(f"it announces {elements[name]['length']} of the element {name}, but has {len(rows)}")
    if "texcoord" in faces["properties"]:
        raise SceneError("texture coordinates of face corners are not supported; store u and v with the vertices")
    for name in faces["properties"]:
        table = faces["data"]
        if isinstance(table, np.ndarray) and table.dtype.names and table[name].dtype.names:
            counts = table[name]["f0"]  # trimesh takes the length of the first list for that of all
            if (counts != counts[0]).any():
                raise SceneError("a binary file must have either triangles or quadrilaterals, not both")
    return fields


def _checked(file: Path, fields: dict[str, Any]) -> MeshData:
    """The arrays in their final types, after the checks."""
    from trimesh.geometry import triangulate_quads

    vertices = np.array(fields["vertices"], dtype=np.float64)
    faces = np.asarray(fields["faces"])
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise SceneError(f'the vertices of the mesh "{file}" need three coordinates, got {vertices.shape[-1]}')
    if min(len(face) for face in faces) < 3 if faces.dtype == object else faces.shape[1] < 3:
        raise SceneError(f'a face of the mesh "{file}" has less than three corners')
    if faces.dtype == object or faces.shape[1] != 3:
        faces = np.asarray(triangulate_quads(faces))
    _refuse(file, "vertices that are not finite", ~np.isfinite(vertices).all(axis=1))
    _refuse(file, f"faces with an index outside 0 to {len(vertices) - 1}",
            ((faces < 0) | (faces >= len(vertices))).any(axis=1))  # fmt: skip
    visual, normals = fields.get("visual"), fields.get("vertex_normals")
    uv = None if visual is None or visual.uv is None else np.array(visual.uv, dtype=np.float64)
    for name, rows, least in (("texture coordinates", uv, 2), ("normals", normals, 3)):
        if rows is not None and (np.ndim(rows) != 2 or len(rows) != len(vertices) or np.shape(rows)[1] < least):
            raise SceneError(f'each vertex of the mesh "{file}" needs {least} numbers for its {name}')
    if uv is not None:
        uv = uv[:, :2]
        _refuse(file, "texture coordinates that are not finite", ~np.isfinite(uv).all(axis=1))
    if normals is not None:
        normals = np.array(normals, dtype=np.float64)[:, :3]
        wrong = ~(np.isfinite(normals).all(axis=1) & normals.any(axis=1))
        _refuse(file, "normals that are zero or not finite", wrong)
        normals = directions(normals)
    return MeshData(vertices, faces.astype(np.uint32), normals, uv)


def _refuse(file: Path, what: str, wrong: npt.ArrayLike) -> None:
    wrong = np.asarray(wrong)
    if wrong.any():
        raise SceneError(f'the mesh "{file}" has {int(wrong.sum())} {what}, the first is number '
                         f"{int(np.argmax(wrong))} (counted from 0)")  # fmt: skip
