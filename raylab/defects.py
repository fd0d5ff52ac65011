"""Defects: what is wrong with the geometry of a scene, counted, listed, and refused or said in a sentence each.

Refused: what is not finite or beyond 2^500. Left out: triangles without area. Kept, with a warning: slivers, triangles
that coincide, detail below 2^-18 of the scene, and a scene so far from the origin that float64 rounds it more than
float32 will. (Meshes are `MeshArrays` of `raylab.geometry`.)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab.errors import SceneError
from raylab.triangles import FLAT, face_keys

Array = npt.NDArray[np.float64]

SLIVER = 2.0**-12  # twice the area over the square of the longest edge, below which the offset is 1e-3 of that edge
FINE = 2.0**-18  # of the scene's size: float32 leaves six bits to such an edge, and shadow rays start as far off
FAR = 2.0**29  # times its size from the origin: there float64 keeps of a scene what float32 does, 24 bits
RANGE = 2.0**500  # 3e150; so that products of two lengths neither overflow nor vanish
LISTED = 8


def numbers(flags: npt.NDArray[np.bool_]) -> str:
    """The first few places that are set, counted from 0."""
    found = np.flatnonzero(flags)
    return ", ".join(map(str, found[:LISTED])) + (", ..." if len(found) > LISTED else "")


def _of(some: Any, count: int, kind: str = "") -> str:
    """How many of how many triangles."""
    return f"{some} {kind}triangle{'' if some == 1 else 's'} of {count}"


def kept(name: str, thickness: Array, warnings: list[str]) -> npt.NDArray[np.bool_]:
    """(m,) which triangles have an area, by their `proportions`; says which have none to speak of, and which little."""
    flat = thickness <= FLAT
    sliver = (thickness <= SLIVER) & ~flat
    if flat.any():
        warnings.append(
            f"shape {name!r}: {_of(flat.sum(), len(flat), 'degenerate ')} left out (number {numbers(flat)})"
        )
    if sliver.any():
        warnings.append(
            f"shape {name!r}: {_of(sliver.sum(), len(flat), 'sliver ')} up to "
            f"{1.0 / thickness[sliver].min():.2g} times as long as high (number {numbers(sliver)}); shadow rays start "
            "visibly off them"
        )
    return ~flat


def coincident(meshes: Sequence[Any]) -> list[str]:
    """A warning for each shape that has triangles where an earlier triangle stands; a ray meets either of them."""
    resting = [m for m in meshes if m.segments == 0]
    keys = np.concatenate([face_keys(m.vertices, m.faces) for m in resting]) if resting else np.zeros(0, np.uint64)
    if len(keys) < 2 or not (np.diff(np.sort(keys)) == 0).any():
        return []
    order = np.argsort(keys, kind="stable")
    again = np.zeros(len(keys), bool)
    again[order[1:]] = np.diff(keys[order]) == 0
    said, start = [], 0
    for m in resting:
        own = again[start : start + len(m.faces)]
        start += len(m.faces)
        if own.any():
            corner = ", ".join(f"{x:g}" for x in m.vertices[m.faces[np.argmax(own), 0]])
            said.append(
                f"shape {m.shape.name!r}: {_of(own.sum(), len(own), 'duplicate ')}, the first with a corner at "
                f"({corner}); where triangles coincide a ray may meet either"
            )
    return said


def check_range(boxes: Sequence[tuple[Array, Array]]) -> None:
    """Raise SceneError for a scene too large, or too small, to be computed with."""
    if not boxes:
        return
    lower, upper = np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)
    reach = float(np.max(np.abs([lower, upper])))
    if not reach <= RANGE:
        raise SceneError(f"the shapes reach {reach:.3g} from the origin; at most {RANGE:.2g} can be computed with")
    size = float(np.max(upper - lower))
    if not size >= 1.0 / RANGE:
        raise SceneError(f"the shapes together are {size:.3g} large; at least {1.0 / RANGE:.2g} can be computed with")


def of_size(
    centre: Array, scale: float, meshes: Sequence[Any], others: Sequence[tuple[str, Array, Array]]
) -> list[str]:
    """Warnings about shapes that are too fine for the scene, `others` given by name and box, and about its place."""
    said = []
    what = "of the scene's size: too fine for float32. Split the scene, or leave out what makes it so large"
    for m in meshes:
        small = m.finest * scale < FINE
        if small.any():
            said.append(
                f"shape {m.shape.name!r}: {_of(small.sum(), len(m.faces))} with an edge, the shortest "
                f"{m.finest.min():.3g} long, that is smaller than 2^-18 {what}"
            )
    for name, lower, upper in others:
        size = float(np.max(upper - lower))
        if size * scale < FINE:
            said.append(f"shape {name!r}: it is {size:.3g} large, smaller than 2^-18 {what}")
    away, size = float(np.max(np.abs(centre))), 1.0 / scale
    if (meshes or others) and away > FAR * size:
        said.append(
            f"the scene is about {size:.3g} large and stands {away:.3g} from the origin, where float64 steps by "
            f"{np.spacing(away):.2g}: move it there"
        )
    return said
