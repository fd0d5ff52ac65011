"""Cells of a domain, about equally probable under a claimed pdf, with their probabilities by quadrature."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from raylab.stats.domains import Domain
from raylab.stats.histogram import Array

BANDS, SECTORS = 8, 16
SHARP = 1e-6  # error per area of the chart from which on a piece is cut in four
ROUNDS, LARGEST = 9, 30_000  # cuts of a piece; pieces that are looked at

_X, _W = np.polynomial.legendre.leggauss(6)
GAUSS = 0.5 * (_X + 1.0), 0.5 * _W  # nodes and weights on [0, 1]
_RIM, _INNER = 1.0 - 2.0**-30, math.sqrt(3.0 / 7.0)  # a hair inside: what happens on the rim itself has no meaning
LOBATTO = 0.5 * (np.array([-_RIM, -_INNER, 0.0, _INNER, _RIM]) + 1.0), np.array([9, 49, 64, 49, 9]) / 180.0


@dataclass(frozen=True)
class Cells:
    """Unions of the domain's pieces: `number` (rows, columns) of the piece's cell, `p` and its `error` per cell.

    `crowding` is the integral of the squared density of each chart coordinate: how likely two samples are to agree.
    """

    edges: tuple[Array, Array]
    number: np.ndarray
    p: Array
    error: Array
    crowding: float

    def of(self, chart: Array) -> np.ndarray:
        """The numbers of the cells in which points of the chart (n, 2) lie."""
        row, column = (
            np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
            for edges, x in zip(self.edges, chart.T, strict=True)
        )
        return np.asarray(self.number[row, column])


def cells_of(pdf: Callable[[Array], Array], domain: Domain) -> Cells:
    """Eight bands of equal probability in the chart's first coordinate, 16 sectors of each in the second."""
    p, error = integrate(pdf, domain)
    band = _groups(p.sum(axis=1), BANDS)
    number = np.empty(p.shape, int)
    for b in range(BANDS):
        rows = band == b
        number[rows] = SECTORS * b + _groups(p[rows].sum(axis=0), SECTORS)
    number = np.unique(number, return_inverse=True)[1].reshape(p.shape)
    crowding = max(float((p.sum(axis=1 - axis) ** 2 / np.diff(edges)).sum()) for axis, edges in enumerate(domain.edges))
    p_cell, error_cell = (np.bincount(number.ravel(), x.ravel()).astype(float) for x in (p, error))
    return Cells(domain.edges, number, p_cell, error_cell, crowding)


def _groups(p: Array, groups: int) -> np.ndarray:
    """Neighbouring entries of `p` in `groups` groups of about the same sum."""
    total = p.sum()
    middle = np.cumsum(p) - 0.5 * p
    return np.minimum((groups * middle / total).astype(int), groups - 1) if total > 0.0 else np.zeros(len(p), int)


def integrate(pdf: Callable[[Array], Array], domain: Domain) -> tuple[Array, Array]:
    """The probability of each piece (rows, columns) and its error.

    The error is what two rules differ by, one of which looks at the rim. A piece in which they differ is cut in four,
    again and again, so that a horizon in the pdf does no harm; where that has no end, the error is the range of values.
    """
    shape = tuple(len(edges) - 1 for edges in domain.edges)
    left, low = (a.ravel() for a in np.meshgrid(domain.edges[0][:-1], domain.edges[1][:-1], indexing="ij"))
    width, height = (a.ravel() for a in np.meshgrid(*(np.diff(e) for e in domain.edges), indexing="ij"))
    boxes, piece = np.stack([left, low, width, height]), np.arange(left.size)
    p, error, seen = np.zeros(left.size), np.zeros(left.size), 0
    for turn in range(ROUNDS):
        fine, _ = _rule(pdf, domain, boxes, *GAUSS)
        coarse, variation = _rule(pdf, domain, boxes, *LOBATTO)
        doubt, seen = np.abs(fine - coarse), seen + boxes.shape[1]
        sure = doubt <= SHARP * boxes[2] * boxes[3]
        done = sure | (turn == ROUNDS - 1) | (seen + 4 * (~sure).sum() > LARGEST)
        p += np.bincount(piece[done], fine[done], len(p))
        error += np.bincount(piece[done], np.where(sure, doubt, variation)[done], len(p))
        boxes, piece = _quarters(boxes[:, ~done]), np.tile(piece[~done], 4)
        if not len(piece):
            break
    return p.reshape(shape), error.reshape(shape)


def _rule(pdf: Callable[[Array], Array], domain: Domain, boxes: Array, x: Array, w: Array) -> tuple[Array, Array]:
    """The integral over each box (4, b) by a product rule, and its largest possible error for a step function."""
    left, low, width, height = boxes[:, :, None, None]
    v1, v2 = np.broadcast_arrays(left + width * x[:, None], low + height * x)
    v = np.stack([v1.ravel(), v2.ravel()], axis=1)
    values = np.asarray(pdf(domain.from_chart(v)) * domain.density(v)).reshape(v1.shape)
    area = boxes[2] * boxes[3]
    return np.asarray(np.einsum("bij,i,j->b", values, w, w) * area), np.ptp(values, axis=(1, 2)) * area


def _quarters(boxes: Array) -> Array:
    left, low, width, height = boxes[0], boxes[1], 0.5 * boxes[2], 0.5 * boxes[3]
    return np.concatenate(
        [np.stack([left + i * width, low + j * height, width, height]) for i in (0, 1) for j in (0, 1)], axis=1
    )
