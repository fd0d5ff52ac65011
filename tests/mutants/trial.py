"""Trial: a point under a light, the light that leaves it by a closed form, and a bound that no correct sample passes.

All quantities are relative: a sample is the mean over the three channels of value / truth, so the truth is 1. Colours
differ between the channels, the normal is no axis, nothing is a unit square: what is generic hides no mistake.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from raylab import description as d

RHO, L = np.array([0.75, 0.5, 0.3]), np.array([3.0, 2.0, 4.0])
ERROR = 1e-4  # of a truth: lights and receiver stand where float32 puts them


@dataclass(frozen=True)
class Trial:
    """`shapes` above a small receiver at the origin with normal `n`; `truth` is the radiance of each channel."""

    shade: str
    truth: Any
    high: float  # largest sample, relative to the truth
    shapes: tuple[d.Shape, ...] = ()
    n: Any = (0.0, 0.0, 1.0)
    material: Any = field(default_factory=lambda: d.Diffuse(RHO))
    environment: Any = None
    lights: tuple[d.Light, ...] = ()
    view: Any = None
    variance: float | None = None  # of a sample, relative to the squared truth, where it is known
    atoms: bool = False  # a right sample may have some value other than 0 again and again


def unit(*v: float) -> np.ndarray:
    return np.array(v) / np.linalg.norm(v)


def frame(n: Any) -> np.ndarray:
    """Rows: two unit vectors and n, right-handed."""
    n = np.asarray(n, float)
    s = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
    s /= np.linalg.norm(s)
    return np.stack([s, np.cross(n, s), n])


def affine(linear: Any, offset: Any) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, offset
    return matrix


def mesh(points: Any, radiance: Any = None, **more: Any) -> d.Mesh:
    """A fan; the side from which its corners run counterclockwise shines."""
    faces = np.array([[0, i, i + 1] for i in range(1, len(points) - 1)])
    return d.Mesh(vertices=np.array(points, float), faces=faces, radiance=radiance, **{"front": None, **more})


def rectangle(corner: Any, a: Any, b: Any, radiance: Any = L) -> d.Rectangle:
    """Edges a, b from the corner, at right angles; it shines to the side of a x b."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    normal = np.cross(a, b)
    linear = np.stack([a / 2, b / 2, normal / np.linalg.norm(normal)], axis=1)
    return d.Rectangle(to_world=affine(linear, np.asarray(corner) + (a + b) / 2), radiance=radiance, front=None)


def corners(corner: Any, a: Any, b: Any) -> np.ndarray:
    corner, a, b = (np.asarray(v, float) for v in (corner, a, b))
    return np.array([corner, corner + a, corner + a + b, corner + b])


STEPS = 400


def highest(corner: Any, a: Any, b: Any, n: Any, share: float = 1.0) -> float:
    """Largest cos cos A / r^2 over a parallelogram (or share of it): on a grid, and 2 % for what lies between."""
    corner, a, b = (np.asarray(v, float) for v in (corner, a, b))
    normal = np.cross(a, b)
    u, v = np.meshgrid(*[np.linspace(0.0, 1.0, STEPS)] * 2)
    y = corner + u[..., None] * a + v[..., None] * b
    r2 = (y * y).sum(-1)
    cosines = np.maximum(0, y @ np.asarray(n)) * np.maximum(0, -(y @ normal))
    return 1.02 * share * float((cosines / r2**2).max())


def leaving(irradiances: Any) -> np.ndarray:
    return RHO * L * np.asarray(irradiances) / math.pi


N1 = unit(0.36, 0.2, 0.9)
A1, B1 = unit(0.25, 0.9, 0.3), np.cross(unit(0.25, 0.9, 0.3), unit(0.2, 0.25, -1.0))
B1 /= np.linalg.norm(B1)
RECT = (np.array([-0.9, -0.5, 1.3]), 1.1 * A1, -1.4 * B1)  # corner, edges: tilted, and above the horizon of N1
if np.cross(RECT[1], RECT[2])[2] > 0.0:
    RECT = (RECT[0], RECT[2], RECT[1])


def far_dark() -> tuple[d.Shape, ...]:
    """Something below the horizon that blocks nothing: a scene must hold more than its receiver."""
    return (mesh([(-0.2, 0, -3), (0.2, 0, -3), (0, 0.2, -3.0)]),)
