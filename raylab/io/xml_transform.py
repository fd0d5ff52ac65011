"""Transforms as matrices: the children of `<transform>`, the first applied first."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np

from raylab.description import Array
from raylab.io.xml_tag import Tag, choices
from raylab.io.xml_values import coordinates, number, numbers

RIGID = 1e-3  # how far a rotation may be from orthogonal, as in Mitsuba 3 (Transform::has_scale)
_AXES = ("x", "y", "z", "value")


def compose(operations: Iterable[Tag]) -> Array:
    """The (4, 4) product M_n ... M_2 M_1 of the operations in file order."""
    matrix = np.eye(4)
    for tag in operations:
        if tag.name not in OPERATIONS:
            raise tag.error("unknown transform; " + choices(tag.name, OPERATIONS))
        operation = OPERATIONS[tag.name](tag)
        if np.linalg.matrix_rank(operation[:3, :3]) < 3:
            raise tag.error("this matrix is singular: it flattens space to a plane, a line or a point")
        with np.errstate(over="ignore", invalid="ignore"):
            matrix = operation @ matrix
        if not np.isfinite(matrix).all():
            raise tag.error("the product of the transforms up to here is not finite")
    return matrix


def _affine(linear: Array, offset: Array | None = None) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3] = linear
    if offset is not None:
        matrix[:3, 3] = offset
    return matrix


def _translate(tag: Tag) -> Array:
    tag.check_attributes(optional=_AXES)
    return _affine(np.eye(3), coordinates(tag, 0.0))


def _scale(tag: Tag) -> Array:
    tag.check_attributes(optional=_AXES)
    return _affine(np.diag(coordinates(tag, 1.0)))


def _rotate(tag: Tag) -> Array:
    """Rodrigues: cos(a) I + (1 - cos(a)) n n^T + sin(a) [n]_x, `angle` in degrees, counterclockwise.

    Mitsuba 3 does not normalise the axis n but scales and shears with a long one: that is refused.
    """
    tag.check_attributes(("angle",), _AXES)
    n = coordinates(tag, 0.0)
    if not n.any():
        raise tag.error("the rotation axis must not be zero; give x, y or z")
    length = math.hypot(*n)
    if abs(length - 1) > RIGID:
        unit = ", ".join(f"{v:.6g}" for v in _unit(n))
        raise tag.error(f"the rotation axis must have length 1, got {length:g}; give ({unit})")
    angle = np.radians(number(tag, tag.attributes["angle"]))
    cross = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    return _affine(np.cos(angle) * np.eye(3) + (1 - np.cos(angle)) * np.outer(n, n) + np.sin(angle) * cross)


def _lookat(tag: Tag) -> Array:
    """Columns left, up, forward, origin: local +z looks from `origin` to `target`, +y is up, +x is left."""
    tag.check_attributes(("origin", "target"), ("up",))
    origin, target = (numbers(tag, tag.attributes[key], 3) for key in ("origin", "target"))
    up = numbers(tag, tag.attributes["up"], 3) if "up" in tag.attributes else np.zeros(3)
    if not (target - origin).any():
        raise tag.error("origin and target must not be the same point")
    forward = _unit(target - origin)
    left = np.cross(_unit(up) if up.any() else _perpendicular(forward), forward)
    if np.linalg.norm(left) <= 8 * np.finfo(float).eps:  # no more than the rounding of the cross product
        raise tag.error("up must not be parallel to the line from origin to target")
    left = _unit(left)
    return _affine(np.column_stack([left, np.cross(forward, left), forward]), origin)


def _unit(v: Array) -> Array:
    v = v / np.abs(v).max()  # first, so that no square overflows or vanishes
    return v / np.linalg.norm(v)


def _perpendicular(n: Array) -> Array:
    """Mitsuba's unit vector at right angles to `n` (Duff et al. 2017, "Building an Orthonormal Basis")."""
    sign = np.copysign(1.0, n[2])
    a = -1 / (sign + n[2])
    return np.array([1 + sign * n[0] * n[0] * a, sign * n[0] * n[1] * a, -sign * n[0]])


def _matrix(tag: Tag) -> Array:
    """16 numbers row by row, or 9 for the linear part."""
    tag.check_attributes(("value",))
    values = numbers(tag, tag.attributes["value"], 16, 9)
    if values.size == 9:
        return _affine(values.reshape(3, 3))
    matrix = values.reshape(4, 4)
    if not np.array_equal(matrix[3], [0, 0, 0, 1]):
        raise tag.error(f"the last row must be 0 0 0 1, got {' '.join(f'{v:g}' for v in matrix[3])}")
    return matrix


OPERATIONS: dict[str, Callable[[Tag], Array]] = {
    "translate": _translate,
    "rotate": _rotate,
    "scale": _scale,
    "lookat": _lookat,
    "matrix": _matrix,
}


def is_rigid(matrix: Array) -> bool:
    """Whether the linear part only rotates and mirrors: |A A^T - I| <= `RIGID`."""
    linear = matrix[:3, :3]
    if np.abs(linear).max() > 2:  # before a square can overflow
        return False
    return bool((np.abs(linear @ linear.T - np.eye(3)) <= RIGID).all())


def similarity_error(matrix: Array, axes: int = 3) -> float:
    """How far the first `axes` columns are from orthogonal and equally long, over that length squared."""
    columns = matrix[:3, :3] / np.abs(matrix[:3, :3]).max()
    gram = columns.T @ columns
    square = np.trace(gram[:axes, :axes]) / axes
    expected = np.diag(np.where(np.arange(3) < axes, square, np.diag(gram)))
    return float(np.abs(gram - expected).max() / square)
