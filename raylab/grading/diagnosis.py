"""Diagnosis: names the mistake in a submission that has failed.

First the submission's samples are compared with those of every variant of the reference, drawn with the same random
numbers, one by one; where they differ by a factor that is made of pi, 2 and what a sample is made of (cosines, the
squared distance, the density, colours), the factor is named. A submission that uses its random numbers in another way
is compared by its means over the designed scenes. Only the table's numbers are used, no solution.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab.grading.causes import CAUSES
from raylab.grading.source import Source
from raylab.grading.table import PAIRED, SEED, TRIAL_SEED, Table

Array = npt.NDArray[np.float64]
SAME = 2e-5  # relative: other orders of the same operations, and float32 in the table
STRAY = 1  # samples of a scene that rounding may bring to the other side of an edge
FOR_MEANS = 1 << 13
NOISE = 0.02  # of a mean, added to its standard errors
PLAUSIBLE = 3.5  # z in the scene that speaks most against it
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


@dataclass(frozen=True)
class Diagnosis:
    """A cause, the price of believing it (less is likelier), and what spoke for it."""

    cause: str
    cost: float
    evidence: str
    factor: str = ""

    def hint(self, level: int) -> str:
        """In the words of the slide, from 1 (where to look) to 3 (what it is)."""
        return CAUSES[self.cause].hints[level - 1].format(factor=self.factor or "a constant")


def diagnose(table: Table, source: Source, task: str, most: int = 3) -> list[Diagnosis]:
    """The likeliest causes, the likeliest first; [] when the submission is the reference, or nothing is known of it."""
    paired = np.stack([source.samples(task, t, TRIAL_SEED, SEED, 0, PAIRED) for t in table.trials])
    found = by_samples(table, paired)
    if not found:
        values = np.stack([source.samples(task, t, TRIAL_SEED, SEED, 0, FOR_MEANS) for t in table.trials])
        found = by_means(table, values)
    return ranked(found)[:most]


def ranked(found: Iterable[Diagnosis]) -> list[Diagnosis]:
    """Each cause once, by its price; if the reference explains all, there is nothing to name."""
    best: dict[str, Diagnosis] = {}
    for d in sorted(found, key=lambda d: d.cost):
        best.setdefault(d.cause, d)
    return [] if "none" in best else list(best.values())


# --- sample by sample ---


def by_samples(table: Table, values: Array) -> list[Diagnosis]:
    """Variants whose samples these are, alone or times a factor; `values` (trials, PAIRED, 3)."""
    if not values[np.isfinite(values)].any():
        return [Diagnosis("black", 1.0, "every sample is black")]
    found = []
    for v, cause in enumerate(table.causes):
        if agree(values, table.samples[v]):
            text = "sample by sample these are the numbers"
            found.append(Diagnosis(cause, 1.0, text))
        elif table.structural[v]:
            found += _times_a_factor(table, values, v)
    return found


def agree(x: Array, y: Array) -> bool:
    """All samples of every trial, but for strays, are the same."""
    with np.errstate(all="ignore"):
        size = np.abs(y) + 1e-3 * np.mean(np.where(np.isfinite(y), np.abs(y), 0.0), axis=1, keepdims=True)
        same = (np.abs(x - y) <= SAME * size) | (np.isnan(x) & np.isnan(y))
    return bool(((~same.all(axis=2)).sum(axis=1) <= STRAY).all())


def _times_a_factor(table: Table, values: Array, v: int) -> list[Diagnosis]:
    """The samples are those of variant v times constants and powers of the features."""
    reference = table.samples[v]
    lit, there = (np.abs(x) > 0.0 for x in (reference, values))
    if (lit != there).sum() > STRAY * 3 * len(values) or lit.sum() < 20 or not np.isfinite(values).all():
        return []
    own = [i for i, t in enumerate(table.trials) if t in table.alone]
    with np.errstate(all="ignore"):
        ratio = np.where(lit, values / reference, np.nan)
    constant = _constant(ratio)
    if constant is not None:
        causes = [("none", "")] if abs(constant - 1.0) < SAME else _named_constant(constant)
        return _composed(table, v, causes, 0.5)
    if not own:
        return []
    powers, scale = _powers(table, np.stack([ratio[i] for i in own]), own)
    if powers is None:
        return []
    causes = [(NAMES.get((name, e), POWERS.get(name, "factor")), "") for name, e in powers.items()]
    if abs(scale - 1.0) > 100 * SAME:
        causes += _named_constant(scale)
    return _composed(table, v, causes, 0.6 + 0.2 * sum(abs(e) for e in powers.values()))


def _composed(table: Table, v: int, causes: Sequence[tuple[str, str]], cost: float) -> list[Diagnosis]:
    """All that must be wrong at once: the variant itself first."""
    every = [(table.causes[v], ""), *causes] if table.causes[v] != "none" else list(causes)
    text = (
        "sample by sample these are the numbers" if len(every) == 1 else "several things at once explain every sample"
    )
    return [Diagnosis(cause, cost + len(every) + 0.01 * i, text, factor) for i, (cause, factor) in enumerate(every)]


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
        for group, feature in zip(table.names, table.features, strict=True):
            for c, name in enumerate(group):
                if name != "one":
                    value = feature[own] if len(group) == 1 else np.repeat(feature[own][..., c : c + 1], 3, axis=2)
                    names.append(name)
                    columns.append(np.log(value))
    return names, columns


def _named_constant(c: float) -> list[tuple[str, str]]:
    """The constant in the words of the slides, if it is made of pi and small numbers."""
    if c < 0.0:
        rest = [] if abs(c + 1.0) < SAME else _named_constant(-c)
        return [("negated", ""), *rest]
    if abs(c - 2.0) < 2 * SAME:
        return [("factor", "2"), ("counted twice", "")]
    return [("factor", words_of(c))]


def words_of(c: float) -> str:
    """2 pi, pi / 2, 1 / 4, ... or just the number."""
    for k, i, j in itertools.product((0, 1, -1, 2, -2), (1, 2, 3, 4, 8), (1, 2, 3, 4, 8)):
        if math.gcd(i, j) == 1 and abs(c / (math.pi**k * i / j) - 1.0) < 3 * SAME:
            power = "" if k == 0 else "pi" if abs(k) == 1 else "pi^2"
            above = " ".join([str(i)] * (i != 1 or k <= 0) + [power] * (k > 0))
            below = " ".join([str(j)] * (j != 1) + [power] * (k < 0))
            return above if not below else f"{above} / ({below})" if " " in below else f"{above} / {below}"
    return f"{c:.4g}"


# --- by the means ---


def by_means(table: Table, values: Array) -> list[Diagnosis]:
    """Variants whose means over the scenes these are, alone or times one constant; `values` (trials, n, 3)."""
    with np.errstate(all="ignore"):
        mean, error = values.mean(axis=1), values.std(axis=1) / math.sqrt(values.shape[1])
    if not np.isfinite(mean).all():
        return []
    found: list[Diagnosis] = []
    spread = values.std(axis=1)
    for v, cause in enumerate(table.causes):
        z = _distance(mean, error, table.means[v], table.errors[v], 1.0)
        spreads = _spreads(table, spread, v)
        text = "the means over all scenes agree"
        if z < PLAUSIBLE:
            found.append(Diagnosis(cause, 2.0 + z / 10.0 + spreads, text))
        elif table.structural[v]:
            lit = np.isfinite(table.means[v]) & (table.means[v] != 0.0)
            if not lit.any():
                continue
            c = float(np.median(mean[lit] / table.means[v][lit]))
            z = _distance(mean, error, table.means[v], table.errors[v], c)
            if c != 0.0 and z < PLAUSIBLE:
                near = [("factor", _near(c))] if c > 0 else [("negated", "")]
                found += _composed(table, v, near, (1.05 if v == 0 else 2.0) + z / 10.0 + spreads)
    return found


def _distance(mean: Array, error: Array, other: Array, its: Array, scale: float) -> float:
    """The difference in units of noise: its root mean square over the channels, in the scene where that is largest."""
    size = np.abs(other) + 1e-4 * np.abs(other).max(axis=0)
    sigma = np.sqrt(error**2 + (scale * its) ** 2 + (NOISE * scale * size) ** 2)
    with np.errstate(all="ignore"):
        z = (mean - scale * other) / sigma
    return (
        float(np.sqrt(np.mean(np.where(np.isfinite(z), z, 0.0) ** 2, axis=1)).max())
        if np.isfinite(z).any()
        else math.inf
    )


def _spreads(table: Table, spread: Array, v: int) -> float:
    """How differently single samples scatter, at most 1."""
    other = table.errors[v] * math.sqrt(table.drawn)
    with np.errstate(all="ignore"):
        off = np.abs(np.log(spread / other))
    off = off[np.isfinite(off)]
    return min(1.0, float(np.median(off))) if len(off) else 0.0


def _near(c: float) -> str:
    """A constant that is known within a few percent."""
    for k, i, j in itertools.product((0, 1, -1), (1, 2, 4), (1, 2, 4)):
        if abs(c / (math.pi**k * i / j) - 1.0) < 0.02 and math.gcd(i, j) == 1:
            return "about " + words_of(math.pi**k * i / j)
    return f"about {c:.3g}"


__all__: list[Any] = ["Diagnosis", "by_means", "by_samples", "diagnose", "ranked", "words_of"]
