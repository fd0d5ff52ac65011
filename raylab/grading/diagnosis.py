"""Diagnosis: names the mistake in a submission that has failed.

First the submission's samples are compared with those of every variant of the reference, drawn with the same random
numbers, one by one (`raylab.grading.paired`). A submission that uses its random numbers in another way is compared by
the distribution of its samples: their moments over the designed scenes. Only the table's numbers are used, no solution.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from raylab.grading import moments
from raylab.grading.evidence import SAME, Diagnosis, about, composed, ranked
from raylab.grading.paired import STRAY, by_samples
from raylab.grading.source import Source
from raylab.grading.table import Table

Array = npt.NDArray[np.float64]
FOR_MOMENTS = 1 << 13
NOISE = 0.01  # of a moment, added to its standard error
REFUTED = 4.5  # z: the reference does not have this moment
PLAUSIBLE = 3.5  # root of the mean z^2, in the scene that speaks most against a variant
TEXT = "the samples have this distribution"


def diagnose(table: Table, source: Source, task: str, most: int = 3, n: int = FOR_MOMENTS) -> list[Diagnosis]:
    """The likeliest causes, the likeliest first; [] when the submission is the reference, or nothing is known of it."""
    paired = table.paired(source, task)
    found = by_samples(table, paired)
    return ranked(found or [*by_moments(table, table.many(source, task, n)), *by_length(table, paired)])[:most]


def by_moments(table: Table, values: Array) -> list[Diagnosis]:
    """Variants whose moments over the scenes these are, alone or times one constant; `values` (trials, n, m)."""
    if not values.size or not np.isfinite(values).all():
        return []
    mean, error = table.moments_of(values)
    degree, noise = (moments.OF_MAPS, 0.0) if table.of_maps else (moments.OF_COLOURS, NOISE)
    floor = np.where(degree > 0, 1e-3 * np.abs(table.moments[0]), 2.0 / values.shape[1])

    def distance(v: int, scale: float) -> Array:
        """In units of noise, (trials, K)."""
        factor = np.sign(scale) ** (degree == 1) * np.abs(scale) ** degree
        due, its = factor * table.moments[v], factor * table.errors[v]
        return np.asarray((mean - due) / np.sqrt(error**2 + its**2 + (noise * due) ** 2 + floor**2))

    def cost(z: Array) -> float:
        worst = float(np.sqrt(np.mean(z**2, axis=1)).max())
        return worst / 4.0 if worst < PLAUSIBLE else math.inf

    if np.abs(distance(0, 1.0)).max() < REFUTED:
        return [Diagnosis("none", 0.0, TEXT)]
    found: list[Diagnosis] = []
    for v, cause in enumerate(table.causes):
        plain = cost(distance(v, 1.0)) if v else math.inf
        if plain < math.inf:
            found.append(Diagnosis(str(cause), 2.0 + plain, TEXT))
        elif table.structural[v]:
            c = ratio(mean[:, degree == 1], table.moments[v][:, degree == 1])
            scaled = cost(distance(v, c)) if c else math.inf
            if scaled < math.inf:
                others = [("factor", about(c))] if c > 0 else [("negated", "")]
                found += composed(str(cause), others, (1.05 if v == 0 else 2.0) + scaled, TEXT)
    return found


def by_length(table: Table, values: Array) -> list[Diagnosis]:
    """Whether a sampler's directions are longer or shorter than 1."""
    if not (table.of_maps and table.random.size and values.shape[2] == 3):
        return []
    off = np.abs(np.linalg.norm(values, axis=2) - 1.0) > SAME
    return [Diagnosis("not of unit length", 3.0, f"so {off.sum()} of {off.size} are")] if off.sum() > STRAY else []


def ratio(x: Array, y: Array) -> float:
    """The constant by which most of x differs from y; 0 if there is none."""
    large = np.abs(y) > 0.1 * np.abs(y).max(axis=1, keepdims=True)
    found = x[large] / y[large]
    return float(np.median(found)) if len(found) and np.isfinite(found).all() else 0.0
