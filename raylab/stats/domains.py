"""Domains of samplers, each with a chart: a map of the unit square onto it, and how much of it a piece of chart is.

A density over the domain (1/m^2, 1/sr) times `density(v)` is a density over the chart, so one test serves all domains.
Points are arrays (n, columns); directions have unit length.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from raylab.stats.histogram import Array

Booleans = npt.NDArray[np.bool_]
Map = Callable[[Array], Array]
ROUNDING = 16 * 2.0**-53  # of a component of a point that is a sum of three products of rounded numbers
PIECES = (np.linspace(0.0, 1.0, 65), np.linspace(0.0, 1.0, 33))


@dataclass(frozen=True)
class Domain:
    """Where a sampler's points lie.

    `to_chart` and `from_chart` go between points and the unit square, `density` is the measure of the domain per area
    of the chart, `edges` cut the chart into pieces in which a density is taken to be smooth. `items` is not 0 for
    choices among so many, whose points are the numbers 0 .. items - 1.
    """

    name: str
    columns: int
    to_chart: Map
    from_chart: Map
    density: Map
    contains: Callable[[Array], Booleans]
    edges: tuple[Array, Array] = PIECES
    directions: bool = False
    items: int = 0


def square() -> Domain:
    """[0, 1)^2."""
    return Domain(
        "square", 2, lambda x: x, lambda v: v, lambda v: np.ones(len(v)),
        lambda x: np.asarray(((x >= 0.0) & (x < 1.0)).all(axis=1)),
    )  # fmt: skip


def disk(radius: float = 1.0) -> Domain:
    """Points (x, y); the chart is (r^2, phi), of constant density."""

    def to_chart(p: Array) -> Array:
        return np.stack([(p**2).sum(axis=1) / radius**2, _turn(p[:, 1], p[:, 0])], axis=1)

    def from_chart(v: Array) -> Array:
        r, phi = radius * np.sqrt(v[:, 0]), 2.0 * np.pi * v[:, 1]
        return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=1)

    return Domain(
        "disk", 2, to_chart, from_chart, lambda v: np.full(len(v), np.pi * radius**2),
        lambda p: np.hypot(p[:, 0], p[:, 1]) <= radius * (1.0 + ROUNDING),
    )  # fmt: skip


def triangle(
    a: Sequence[float] = (0.0, 0.0), b: Sequence[float] = (1.0, 0.0), c: Sequence[float] = (0.0, 1.0)
) -> Domain:
    """The triangle a, b, c, by default of barycentric coordinates; the chart is ((b1 + b2)^2, b2 / (b1 + b2))."""
    origin = np.asarray(a, np.float64)
    edges = np.stack([np.asarray(b, np.float64) - origin, np.asarray(c, np.float64) - origin])
    area = 0.5 * math.sqrt(float(np.linalg.det(edges @ edges.T)))
    inverse, size = np.linalg.pinv(edges), float(np.abs(edges).max() + np.abs(origin).max())
    slack = ROUNDING * size * float(np.abs(inverse).sum())

    def barycentric(p: Array) -> Array:
        return np.asarray((p - origin) @ inverse)

    def to_chart(p: Array) -> Array:
        b1, b2 = np.maximum(barycentric(p), 0.0).T
        root = b1 + b2
        return np.stack([root**2, b2 / np.maximum(root, 1e-300)], axis=1)

    def from_chart(v: Array) -> Array:
        root = np.sqrt(v[:, 0])
        return np.asarray(origin + np.stack([root * (1.0 - v[:, 1]), root * v[:, 1]], axis=1) @ edges)

    def contains(p: Array) -> Booleans:
        inside = barycentric(p)
        off = np.abs(p - origin - inside @ edges).max(axis=1)  # out of the plane
        return (inside.min(axis=1) >= -slack) & (inside.sum(axis=1) <= 1.0 + slack) & (off <= ROUNDING * size)

    return Domain("triangle", len(origin), to_chart, from_chart, lambda v: np.full(len(v), area), contains)


# --- directions around an axis: x = 1 - cos(theta), without cancellation ---


def hemisphere(normal: Sequence[float]) -> Domain:
    """The directions above the horizon of `normal`; the chart is (1 - cos(theta), phi)."""
    return cap(normal, 1.0, "hemisphere")


def sphere(axis: Sequence[float] = (0.0, 0.0, 1.0)) -> Domain:
    """All directions; the chart is ((1 - cos(theta)) / 2, phi) around `axis`."""
    return cap(axis, 2.0, "sphere")


def cap(axis: Sequence[float], height: float, name: str = "cap") -> Domain:
    """The directions with 1 - cos(theta) <= `height` around `axis`: a cone."""
    return _around(
        name, axis, height, lambda x: x / height, lambda v: v * height,
        lambda v: np.full(len(v), 2.0 * np.pi * height),
    )  # fmt: skip


def lobe(axis: Sequence[float], n: float) -> Domain:
    """The hemisphere around `axis`, with a chart that resolves a lobe cos(theta)^n and what lies beside it.

    Half of the chart is the lobe's, half the hemisphere's: v = (x + 1 - (1 - x)^(n + 1)) / 2 with x = 1 - cos(theta).
    """

    def share(x: Array) -> Array:
        x = np.minimum(x, 1.0)
        with np.errstate(divide="ignore"):
            return np.asarray(0.5 * (x - np.expm1((n + 1.0) * np.log1p(-x))))

    def rise(x: Array) -> Array:
        with np.errstate(divide="ignore"):
            return np.asarray(0.5 + 0.5 * (n + 1.0) * np.exp(n * np.log1p(-x)))

    def back(v: Array) -> Array:
        x = np.zeros(len(v))  # Newton's method from below, where a concave function keeps it
        for _ in range(60):
            before, x = x, np.minimum(x + np.maximum(v - share(x), 0.0) / rise(x), 1.0 - 2.0**-53)
            if (x - before <= 2.0**-52 * x).all():
                break
        return x

    near = 2.0 ** np.arange(math.floor(math.log2(n + 1.0)) - 4.0) / (n + 1.0)  # where the lobe ends, v = 1/2, finely
    edges = (np.unique(np.concatenate([PIECES[0], 0.5 - 0.5 * near, 0.5 + 0.5 * near])), PIECES[1])
    return _around("lobe", axis, 1.0, share, back, lambda v: 2.0 * np.pi / rise(back(v)), edges)


def _around(
    name: str, axis: Sequence[float], height: float, share: Map, back: Map, slope: Map,
    edges: tuple[Array, Array] = PIECES,
) -> Domain:  # fmt: skip
    n = np.asarray(axis, np.float64)
    n = n / np.linalg.norm(n)
    s = np.eye(3)[np.argmin(np.abs(n))]
    s = s - n * (s @ n)
    s /= np.linalg.norm(s)
    t = np.cross(n, s)
    slack = ROUNDING * (math.sqrt(height * (2.0 - height)) + ROUNDING)

    def lowness(w: Array) -> Array:
        cosine, sine = w @ n, np.cross(n, w)
        return np.where(cosine > 0.0, (sine**2).sum(axis=1) / (1.0 + np.abs(cosine)), 1.0 - cosine)

    def to_chart(w: Array) -> Array:
        return np.stack([share(lowness(w)), _turn(w @ t, w @ s)], axis=1)

    def from_chart(v: Array) -> Array:
        x, phi = back(v[:, 0]), 2.0 * np.pi * v[:, 1]
        r = np.sqrt(x * (2.0 - x))
        return np.asarray(np.outer(r * np.cos(phi), s) + np.outer(r * np.sin(phi), t) + np.outer(1.0 - x, n))

    def contains(w: Array) -> Booleans:
        return np.asarray(lowness(w) <= height + slack) if height < 2.0 else np.ones(len(w), bool)

    return Domain(name, 3, to_chart, from_chart, lambda v: slope(v[:, 0]), contains, edges, directions=True)


# --- pieces and choices ---


def texels(
    rows: int, columns: int, up: Sequence[float] = (0.0, 1.0, 0.0), start: Sequence[float] = (0.0, 0.0, -1.0),
    towards: Sequence[float] = (1.0, 0.0, 0.0),
) -> Domain:  # fmt: skip
    """All directions, cut into the cells of a latitude-longitude image; the chart is (theta / pi, phi / (2 pi)).

    theta is counted from `up`, phi from `start` `towards` another direction; the three are orthonormal.
    """
    y, a, b = (np.asarray(axis, np.float64) for axis in (up, start, towards))

    def to_chart(w: Array) -> Array:
        theta = np.arctan2(np.hypot(w @ a, w @ b), w @ y)
        return np.stack([theta / np.pi, _turn(w @ b, w @ a)], axis=1)

    def from_chart(v: Array) -> Array:
        theta, phi = np.pi * v[:, 0], 2.0 * np.pi * v[:, 1]
        r = np.sin(theta)
        return np.asarray(np.outer(r * np.cos(phi), a) + np.outer(r * np.sin(phi), b) + np.outer(np.cos(theta), y))

    return Domain(
        "environment", 3, to_chart, from_chart, lambda v: 2.0 * np.pi**2 * np.sin(np.pi * v[:, 0]),
        lambda w: np.ones(len(w), bool), (np.linspace(0.0, 1.0, rows + 1), np.linspace(0.0, 1.0, columns + 1)),
        directions=True,
    )  # fmt: skip


def choices(items: int) -> Domain:
    """The numbers 0 .. items - 1, such as those of lights or texels; a density is a probability."""
    return Domain(
        "choices", 1, lambda k: k, lambda v: v, lambda v: np.ones(len(v)),
        lambda k: np.asarray(((k >= 0) & (k < items) & (k == np.floor(k))).all(axis=1)), items=items,
    )  # fmt: skip


def _turn(y: Array, x: Array) -> Array:
    fraction = np.arctan2(y, x) / (2.0 * np.pi)
    fraction = np.where(fraction < 0.0, fraction + 1.0, fraction)
    return np.where(fraction < 1.0, fraction, 0.0)
