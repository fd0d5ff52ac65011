"""Charts: what a density says of cells of (cos theta, phi) about an axis, and how many samples fall there."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mutants.trial import frame

NODES, WEIGHTS = (0.5 * (v + o) for v, o in zip(np.polynomial.legendre.leggauss(6), (1.0, 0.0), strict=True))

FINEST = (64, 128)  # pieces of the chart that are integrated over by themselves, at least


@dataclass(frozen=True)
class Chart:
    """Rows and columns: cos theta about `axis` and phi on the sphere, r^2 and phi on the disk, y and x / (1 - y) on the
    triangle. `rows` and `columns` are where a density may jump: cells are cut there before they are integrated over.
    """

    shape: str = "sphere"
    axis: Any = (0.0, 0.0, 1.0)
    low: float = -1.0
    rows: Sequence[float] = ()
    columns: Sequence[float] = ()
    high: float = 1.0

    @property
    def sides(self) -> tuple[float, float]:
        return (0.0, 1.0) if self.shape == "triangle" else (-math.pi, math.pi)

    def points(self, row: Any, column: Any) -> Any:
        """(n, 3) points of (n,) coordinates."""
        if self.shape == "triangle":
            return np.stack([column * (1.0 - row), row, np.zeros_like(row)], axis=1)
        r = np.sqrt(row if self.shape == "disk" else np.maximum(1.0 - row * row, 0.0))
        z = np.zeros_like(row) if self.shape == "disk" else row
        local = np.stack([r * np.cos(column), r * np.sin(column), z], axis=1)
        return local if self.shape == "disk" else local @ frame(self.axis)

    def measure(self, row: Any) -> Any:
        """Area, or solid angle, of a piece of the chart."""
        return {"sphere": 1.0 + 0.0 * row, "disk": 0.5 + 0.0 * row, "triangle": 1.0 - row}[self.shape]

    def coordinates(self, points: Any) -> tuple[Any, Any]:
        x, y = points[:, 0], points[:, 1]
        if self.shape == "triangle":
            return y, x / np.maximum(1.0 - y, 1e-300)
        if self.shape == "disk":
            return x * x + y * y, np.arctan2(y, x)
        local = points @ frame(self.axis).T
        return local[:, 2], np.arctan2(local[:, 1], local[:, 0])

    def expected(self, density: Callable[[Any], Any], rows: int, columns: int) -> Any:
        """The integral of the density over each cell, (rows, columns)."""
        edges = [np.linspace(self.low, self.high, rows + 1), np.linspace(*self.sides, columns + 1)]
        fine = [
            np.unique(np.concatenate([e, np.linspace(e[0], e[-1], n + 1), [b for b in breaks if e[0] < b < e[-1]]]))
            for e, n, breaks in zip(edges, FINEST, (self.rows, self.columns), strict=True)
        ]
        width = [np.diff(f) for f in fine]
        at = [(f[:-1, None] + w[:, None] * NODES).ravel() for f, w in zip(fine, width, strict=True)]
        weight = [(w[:, None] * WEIGHTS).ravel() for w in width]
        row, column = (g.ravel() for g in np.meshgrid(*at, indexing="ij"))
        values = density(self.points(row, column)).reshape(len(at[0]), len(at[1]))
        values *= (weight[0] * self.measure(at[0]))[:, None] * weight[1]
        cells = [np.searchsorted(e, a) - 1 for e, a in zip(edges, at, strict=True)]
        out = np.zeros((rows, columns))
        np.add.at(out, (cells[0][:, None], cells[1][None, :]), values)
        return out

    def counts(self, points: Any, rows: int, columns: int) -> tuple[Any, int]:
        """Samples in each cell, and how many are in none or are not of length 1."""
        row, column = self.coordinates(np.nan_to_num(points, nan=9.0))
        left, right = self.sides
        i = np.floor((row - self.low) / (self.high - self.low) * rows).astype(np.int64)
        j = np.floor((column - left) / (right - left) * columns).astype(np.int64)
        good = (row >= self.low) & (row <= self.high) & (column >= left) & (column <= right)
        if self.shape == "sphere":
            good &= np.abs((points**2).sum(axis=1) - 1.0) < 1e-9
        i, j = np.minimum(i[good], rows - 1), np.minimum(j[good], columns - 1)
        return np.bincount(i * columns + j, minlength=rows * columns).reshape(rows, columns), int((~good).sum())
