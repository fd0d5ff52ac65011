"""What is computed from the triangles of a mesh: its vertex normals, how thin they are, and which coincide."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

CHUNK = 1 << 16  # faces worked on at a time, so that temporary arrays stay small
_GOLDEN = 0x9E3779B97F4A7C15  # 2^64 over the golden ratio
FLAT = 2.0**-20  # twice the area over the square of the longest edge, below which Embree's own normal is noise


def directions(vectors: Array) -> Array:
    """(n, 3) unit vectors, and 0 for those that are 0; of any length, whose square may be beyond float64."""
    largest = np.abs(vectors).max(axis=1, keepdims=True)
    scaled = np.divide(vectors, largest, out=np.zeros_like(vectors), where=largest > 0)
    unit: Array = scaled / np.where(largest > 0, np.linalg.norm(scaled, axis=1, keepdims=True), 1.0)
    return unit


def vertex_normals(vertices: Array, faces: npt.NDArray[np.integer]) -> Array:
    """(n, 3) unit normals: sum over the faces at a vertex of face normal x angle, normalised.

    Thürmer and Wüthrich 1998, "Computing Vertex Normals from Polygonal Facets", as Mitsuba 3 has it; a vertex
    without a face of positive area gets (1, 0, 0).
    """
    total = np.zeros_like(vertices)
    for some, edges in _chunks(vertices, faces):
        cross = np.cross(edges[0], -edges[2])
        double_area = np.linalg.norm(cross, axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            normal = np.where(double_area[:, None] > 0, cross / double_area[:, None], 0.0)
        for corner in range(3):
            cosine = np.einsum("ij,ij->i", edges[corner], -edges[corner - 1])
            weighted = normal * np.arctan2(double_area, cosine)[:, None]
            for axis in range(3):
                np.add.at(total[:, axis], some[:, corner], weighted[:, axis])
    total[~total.any(axis=1)] = (1.0, 0.0, 0.0)
    return directions(total)


def proportions(vertices: Array, faces: npt.NDArray[np.integer]) -> tuple[Array, Array]:
    """(m,) twice the area over the square of the longest edge, and (m,) the shortest edge, of each triangle."""
    unit, thickness, shortest = _unit(vertices), np.zeros(len(faces)), np.zeros(len(faces))
    for start, (_, edges) in zip(range(0, len(faces), CHUNK), _chunks(vertices, faces), strict=True):
        (ax, ay, az), (bx, by, bz) = edges[0].T, edges[2].T
        double_area = np.sqrt((ay * bz - az * by) ** 2 + (az * bx - ax * bz) ** 2 + (ax * by - ay * bx) ** 2)
        squares = [np.einsum("ij,ij->i", edge, edge) for edge in edges]
        longest = np.maximum(np.maximum(squares[0], squares[1]), squares[2])
        some = slice(start, start + CHUNK)
        np.divide(double_area, longest, out=thickness[some], where=longest > 0)
        np.sqrt(np.minimum(np.minimum(squares[0], squares[1]), squares[2]), out=shortest[some])
    return thickness, shortest * unit


def degenerate_faces(vertices: Array, faces: npt.NDArray[np.integer]) -> npt.NDArray[np.bool_]:
    """(m,) whether a triangle has no area to speak of: 2 A <= 2^-20 longest edge^2."""
    flags: npt.NDArray[np.bool_] = proportions(vertices, faces)[0] <= FLAT
    return flags


def face_keys(vertices: Array, faces: npt.NDArray[np.integer]) -> npt.NDArray[np.uint64]:
    """(m,) the same number for triangles with the same corners in any order, another, but for 2^-64, for all others.

    The sum over the corners of their bits, mixed as in SplitMix64 (Steele, Lea and Flood 2014).
    """
    bits = np.ascontiguousarray(vertices + 0.0).view(np.uint64)  # + 0.0: -0 and 0 are one place
    key = np.zeros(len(vertices), np.uint64)
    for axis, (factor, shift) in enumerate(((0xBF58476D1CE4E5B9, 27), (0x94D049BB133111EB, 31), (_GOLDEN, 29))):
        key = (key + bits[:, axis] + np.uint64(_GOLDEN)) * np.uint64(factor)
        key ^= key >> np.uint64(shift)
    key *= np.uint64(0xBF58476D1CE4E5B9)
    key ^= key >> np.uint64(32)
    total: npt.NDArray[np.uint64] = key[faces[:, 0]] + key[faces[:, 1]] + key[faces[:, 2]]
    return total


def _chunks(vertices: Array, faces: npt.NDArray[np.integer]) -> Iterator[tuple[npt.NDArray[np.integer], list[Array]]]:
    """Some of the faces, and their edges 0 to 1, 1 to 2, 2 to 0, in units of the largest coordinate."""
    unit = _unit(vertices)
    for start in range(0, len(faces), CHUNK):
        some = faces[start : start + CHUNK]
        corners = [vertices[some[:, k]] / unit for k in range(3)]
        yield some, [corners[(k + 1) % 3] - corners[k] for k in range(3)]


def _unit(vertices: Array) -> float:
    """The largest coordinate: in units of it no product of three overflows."""
    return float(np.abs(vertices).max(initial=0.0)) or 1.0
