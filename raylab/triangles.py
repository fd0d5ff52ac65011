"""What is computed from the triangles of a mesh: its vertex normals, and which of them are too thin to use."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

CHUNK = 1 << 16  # faces worked on at a time, so that temporary arrays stay small
FLAT = 2.0**-20  # twice the area over the square of the longest edge, below which Embree's own normal is noise


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
    length = np.linalg.norm(total, axis=1, keepdims=True)
    total[length[:, 0] == 0] = (1.0, 0.0, 0.0)
    normals: Array = total / np.where(length > 0, length, 1.0)
    return normals


def degenerate_faces(vertices: Array, faces: npt.NDArray[np.integer]) -> npt.NDArray[np.bool_]:
    """(m,) whether a triangle has no area to speak of: 2 A <= 2^-20 longest edge^2."""
    flags = []
    for _, edges in _chunks(vertices, faces):
        double_area = np.linalg.norm(np.cross(edges[0], -edges[2]), axis=1)
        longest = np.max([np.einsum("ij,ij->i", edge, edge) for edge in edges], axis=0)
        flags.append(double_area <= FLAT * longest)
    return np.concatenate(flags) if flags else np.zeros(0, dtype=bool)


def _chunks(vertices: Array, faces: npt.NDArray[np.integer]) -> Iterator[tuple[npt.NDArray[np.integer], list[Array]]]:
    """Some of the faces, and their edges 0 to 1, 1 to 2, 2 to 0, in units of the largest coordinate."""
    unit = np.abs(vertices).max(initial=0.0) or 1.0  # so that no product of three coordinates overflows
    for start in range(0, len(faces), CHUNK):
        some = faces[start : start + CHUNK]
        corners = [vertices[some[:, k]] / unit for k in range(3)]
        yield some, [corners[(k + 1) % 3] - corners[k] for k in range(3)]
