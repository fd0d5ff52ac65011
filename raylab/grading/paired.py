"""Paired: the samples of a submission against those of every variant, with the same random numbers, one by one.

Where they differ by a factor that is made of pi, 2 and what a sample is made of (cosines, the squared distance, the
density, colours), the factor is named.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
import numpy.typing as npt

from raylab.grading.evidence import SAME, Diagnosis, composed, named_constant
from raylab.grading.table import Table

Array = npt.NDArray[np.float64]
STRAY = 1  # samples of a scene that rounding may bring to the other side of an edge
SPECIAL = 0.06  # of the inputs: 0 and the like
NEARLY = "nearly everywhere these are the numbers"
TEXT = "sample by sample these are the numbers"
NAMES: dict[tuple[str, float], str] = {
    ("r2", 1): "distance missing", ("cos_s", -1): "light cosine missing", ("cos_r", -1): "receiver cosine missing",
    ("p", 1): "pdf missing", ("p", 2): "pdf multiplied",
    ("radiance", -1): "radiance missing", ("k_d", -1): "k_d missing", ("f_r", -1): "f_r missing",
    ("np1", 1): "exponent off by one", ("np2", -1): "exponent off by one", ("lobe", 1): "pdf missing",
    ("lobe", -1): "f_r missing",
}  # fmt: skip
POWERS: dict[str, str] = {
    "r2": "distance power", "cos_s": "light cosine power", "cos_r": "receiver cosine power", "p": "pdf power",
    "radiance": "radiance power", "k_d": "k_d power", "f_r": "f_r power",
    "np1": "exponent off by one", "np2": "exponent off by one", "lobe": "pdf power",
}  # fmt: skip


def by_samples(table: Table, values: Array) -> list[Diagnosis]:
    """Variants whose samples these are, alone or times a factor; `values` (trials, PAIRED, m)."""
    if not (table.of_maps or values[np.isfinite(values)].any()):
        return [Diagnosis("black", 1.0, "every sample is black")]
    found = []
    for v, cause in enumerate(table.causes):
        if agree(values, table.samples[v]):
            found.append(Diagnosis(str(cause), 1.0, TEXT))
        elif table.structural[v]:
            found += _times_a_factor(table, values, v)
    if not found and table.of_maps and nearly(values, table.samples[0]) == math.inf:
        costs = [(str(cause), nearly(values, table.samples[v])) for v, cause in enumerate(table.causes)]
        found = [Diagnosis(cause, 2.0 + cost, NEARLY) for cause, cost in costs if cost < math.inf]
    return found


def nearly(x: Array, y: Array) -> float:
    """The share of inputs that one treats otherwise, if they are few but for those where a result is no number."""
    both = (np.isfinite(x) & np.isfinite(y)).all(axis=2)
    with np.errstate(all="ignore"):
        size = np.abs(y) + 1e-3 * np.minimum(typical(x), typical(y))
        off = ((np.abs(x - y) > SAME * size) & (x != y)).any(axis=2)
    if (both & off).mean(axis=1).max() > SPECIAL or both.mean() < 0.3:
        return math.inf
    return float((off | (np.isfinite(x).all(axis=2) != np.isfinite(y).all(axis=2))).mean())


def typical(x: Array) -> Array:
    """The median size of the numbers of each trial, (trials, 1, 1); 0 where there are none."""
    sizes = (np.abs(trial[np.isfinite(trial)]) for trial in x)
    return np.array([np.median(s) if s.size else 0.0 for s in sizes])[:, None, None]


def agree(x: Array, y: Array) -> bool:
    """All samples of every trial, but for strays, are the same."""
    with np.errstate(all="ignore"):
        size = np.abs(y) + 1e-3 * np.mean(np.where(np.abs(y) < 1e30, np.abs(y), 0.0), axis=1, keepdims=True)
        same = (np.abs(x - y) <= SAME * size) | (x == y) | (np.isnan(x) & np.isnan(y))
    raised = np.isnan(x).all(axis=(1, 2)) & np.isnan(y).any(
        axis=(1, 2)
    )  # compiled, a whole trial is lost by one sample
    return bool((((~same.all(axis=2)).sum(axis=1) <= STRAY) | raised).all())


def _times_a_factor(table: Table, values: Array, v: int) -> list[Diagnosis]:
    """The samples are those of variant v times constants and powers of the features."""
    reference = table.samples[v]
    lit, there = (np.abs(x) > 0.0 for x in (reference, values))
    strays = (lit != there).any(axis=2).sum(axis=1)
    if strays.max() > STRAY or lit.sum() < 20 or not np.isfinite(values).all():
        return []
    own = [i for i, t in enumerate(table.trials) if t in table.alone]
    with np.errstate(all="ignore"):
        ratio = np.where(lit, values / reference, np.nan)
    constant = _constant(ratio)
    if constant is not None and (constant > 0.0 or not table.random.size):  # -1 is half a turn around the lens
        causes = [] if abs(constant - 1.0) < SAME else named_constant(constant)
        return composed(str(table.causes[v]), causes, 0.5, TEXT)
    if not own:
        return []
    powers, scale = _powers(table, np.stack([ratio[i] for i in own]), own)
    if powers is None:
        return []
    causes = [(NAMES.get((name, e), POWERS.get(name, "factor")), "") for name, e in powers.items()]
    if abs(scale - 1.0) > 100 * SAME:
        causes += named_constant(scale)
    return composed(str(table.causes[v]), causes, 0.6 + 0.2 * sum(abs(e) for e in powers.values()), TEXT)


def _constant(ratio: Array) -> float | None:
    finite = ratio[np.isfinite(ratio)]
    middle = float(np.median(finite)) if len(finite) else 0.0
    if middle == 0.0:
        return None
    off = np.abs(finite / middle - 1.0) > 2 * SAME
    return middle if off.sum() <= STRAY else None


def _powers(table: Table, ratio: Array, own: list[int]) -> tuple[dict[str, float] | None, float]:
    """Exponents of the features that explain log(ratio), half a whole number each, as few as possible."""
    names, columns = _columns(table, own)
    y = ratio.reshape(-1)
    columns = [c.reshape(-1) for c in columns]
    good = np.isfinite(y) & (y > 0.0)
    for column in columns:
        good &= np.isfinite(column)
    if good.sum() < 20 or (np.isfinite(y) & (y <= 0.0)).any():
        return None, 1.0
    logs, target = np.stack([c[good] for c in columns], axis=1), np.log(y[good])
    for size in (1, 2, 3):
        for chosen in itertools.combinations(range(len(names)), size):
            design = np.column_stack([logs[:, list(chosen)], np.ones(len(target))])
            fit, *_ = np.linalg.lstsq(design, target, rcond=None)
            exponents = np.round(2.0 * fit[:-1]) / 2.0
            rest = target - logs[:, list(chosen)] @ exponents
            middle = float(np.median(rest))
            if exponents.all() and (np.abs(rest - middle) > 20 * SAME).sum() <= 2 * STRAY:
                return {names[c]: float(e) for c, e in zip(chosen, exponents, strict=True)}, math.exp(middle)
    return None, 1.0


def _columns(table: Table, own: list[int]) -> tuple[list[str], list[Array]]:
    """Logarithms of the features, (trials, PAIRED, 3) each."""
    names, columns = [], []
    with np.errstate(all="ignore"):
        for joined, feature in zip(table.names, table.features, strict=True):
            group = str(joined).split("|")
            for c, name in enumerate(group):
                if name != "one":
                    value = feature[own] if len(group) == 1 else np.repeat(feature[own][..., c : c + 1], 3, axis=2)
                    names.append(name)
                    columns.append(np.log(value))
    return names, columns
