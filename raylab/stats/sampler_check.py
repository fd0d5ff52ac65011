"""Samplers: do the samples have the density that pdf() says? The first finding that is wrong names the bug.

Deterministic checks come first, since they see the smallest errors in the fewest samples: a map of density p stretches
areas by 1 / p, everywhere. Then samples are counted in cells (`multinomial`), which sees what is not a map.
Only counts and ties involve chance: a right sampler fails in each with probability at most alpha / 2.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from raylab.stats.cells import Cells, cells_of
from raylab.stats.domains import ROUNDING, Domain
from raylab.stats.histogram import Array
from raylab.stats.multinomial import Counts
from raylab.stats.sampler_map import (
    LAST,
    NOISE,
    Finding,
    Pdf,
    Sampler,
    basics,
    first_wrong,
    jacobian,
    returned_pdf,
)

__all__ = ["ENOUGH", "Finding", "check_sampler", "first_wrong"]

ULP = 2.0**-52
ENOUGH = 350.0  # N phi^2 at which the evidence over 128 cells speaks with probability 0.99 or more: measured
SAME = 2.0**-50  # coordinates that differ by less are the same


def check_sampler(
    sample: Callable[[Array], object], pdf: Pdf, domain: Domain, *, numbers: int = 2, one_to_one: bool = True,
    may_miss: bool = False, integrand: Pdf | None = None, phi2: float = 5e-4, alpha: float = 3.3e-9,
    rng: np.random.Generator | None = None,
) -> list[Finding]:  # fmt: skip
    """All findings about `sample(u (n, numbers)) -> points` or `(points, p)` and `pdf(points)`.

    `one_to_one` is False for mixtures and rejection, where 1 / pdf is not the Jacobian. With `may_miss` a sample may be
    no sample, which it says by p = 0. A distribution at a chi-square distance of `phi2` = sum (q - p)^2 / p from the
    pdf's must be noticed. `integrand` is what the samples are for: the pdf must not be 0 where it is not.
    """
    rng = rng or np.random.default_rng()
    draw = Sampler(sample, domain.columns)
    findings = basics(draw, pdf, domain, numbers, may_miss, rng)
    if first_wrong(findings):
        return findings
    findings += [returned_pdf(draw, pdf, domain, numbers, rng)]
    if domain.items:
        p = np.asarray(pdf(np.arange(domain.items, dtype=float)[:, None]), np.float64)
        total, error, cells = float(p.sum()), ULP * domain.items, None
    else:
        if one_to_one and numbers == 2:
            findings.append(jacobian(draw, pdf, domain, rng))
        cells = cells_of(pdf, domain)
        p, total, error = cells.p, float(cells.p.sum()), float(cells.error.sum()) + NOISE
    findings.append(counts(draw, p, cells, domain, numbers, total, may_miss, phi2, alpha / 2.0, rng))
    findings.append(unit_integral(total, error, may_miss))
    if integrand is not None:
        findings.append(support(integrand, pdf, domain))
    if cells is not None:
        findings.append(ties(draw, domain, numbers, cells.crowding, alpha / 2.0, rng))
    return findings


# --- counts ---


def counts(
    draw: Sampler, p: Array, cells: Cells | None, domain: Domain, numbers: int, total: float, may_miss: bool,
    phi2: float, alpha: float, rng: np.random.Generator,
) -> Finding:  # fmt: skip
    """Samples fall into cells as often as the pdf says; a place that the pdf leaves out is a cell of its own."""
    enough = math.ceil(ENOUGH / phi2)
    if cells is not None:
        unsure = float((cells.error**2 / np.maximum(p, 1e-300)).sum())
        if enough * unsure > 0.1:
            return Finding(
                "counts", "INCONCLUSIVE", f"the pdf varies too fast to integrate (phi^2 {unsure:.1e})", unsure
            )
    test = Counts(p / (max(total, 1.0) if may_miss else total))  # whether it adds up is `unit_integral`'s question
    while test.n.sum() < enough:
        points, returned = draw(rng.random((min(max(64, int(test.n.sum() / 2)), 1 << 16), numbers)))
        taken = domain.contains(points)
        if returned is not None and may_miss:
            taken &= returned != 0.0
        number = points[taken, 0].astype(int) if cells is None else cells.of(domain.to_chart(points[taken]))
        where = np.full(len(points), -1)
        where[taken] = number
        test.add(where)
        evidence = test.log_evidence()
        if evidence >= -math.log(alpha):
            return Finding("counts", "FAIL", _where_counts_differ(test), float(test.n.sum()))
    text = f"{len(p)} cells agree after {test.n.sum():.0f} samples (phi^2 = {phi2:g} would have been seen)"
    return Finding("counts", "PASS", text, float(test.n.sum()))


def _where_counts_differ(test: Counts) -> str:
    n = test.n.sum()
    expected = n * test.p
    worst = int(np.argmax(np.abs(test.n - expected) / np.sqrt(np.maximum(expected, 1e-3))))
    place = "outside all cells" if worst == len(test.p) - 1 else f"in cell {worst}"
    return f"{test.n[worst]:.0f} of {n:.0f} samples {place}, where the pdf expects {expected[worst]:.4g}"


def unit_integral(total: float, error: float, may_miss: bool) -> Finding:
    """The pdf integrates to 1, or to no more if samples may be none."""
    good = total <= 1.0 + error and (may_miss or total >= 1.0 - error)
    text = f"the pdf integrates to {total:.9g} +- {error:.1e}"
    return Finding("integral", "PASS" if good else "FAIL", text if good else f"{text} instead of 1", total)


def support(integrand: Pdf, pdf: Pdf, domain: Domain) -> Finding:
    """Where the integrand is positive the pdf is: at Sobol' points, and around the integrand's largest values."""
    from scipy.stats import qmc

    if domain.items:
        points = np.arange(domain.items, dtype=float)[:, None]
    else:
        v = np.asarray(qmc.Sobol(2, rng=np.random.default_rng()).random_base2(13))
        for width in (2.0**-6, 2.0**-12, 2.0**-18):  # around the argmax, closer and closer
            best = v[np.argmax(integrand(domain.from_chart(v)))]
            v = np.concatenate([v, np.clip(best + width * (v[:512] - 0.5), 0.0, LAST)])
        points = domain.from_chart(v)
    hole = (np.asarray(integrand(points)) > 0.0) & ~(np.asarray(pdf(points)) > 0.0)
    if not hole.any():
        return Finding("support", "PASS", f"pdf > 0 wherever the integrand is, at {len(points)} points", 0.0)
    where = ", ".join(f"{x:.4g}" for x in points[np.argmax(hole)])
    text = f"the pdf is 0 where the integrand is not, as at ({where}): {hole.sum()} of {len(points)} points"
    return Finding("support", "FAIL", text, float(hole.mean()))


# --- ties ---


def ties(
    draw: Sampler, domain: Domain, numbers: int, crowding: float, alpha: float, rng: np.random.Generator
) -> Finding:
    """Points of a density never agree: not in one chart coordinate to 2^-50 or its rounding, not in both at all.

    Two of n samples agree in a coordinate with probability at most n^2 same crowding, so n is chosen small enough.
    """
    points, returned = draw(rng.random((1 << 14, numbers)))
    kept = points[returned != 0.0] if returned is not None else points
    ordered = kept[np.lexsort(kept.T)]
    again = (np.diff(ordered, axis=0) == 0.0).all(axis=1)
    if again.any():
        where = ", ".join(f"{x:.6g}" for x in ordered[np.argmax(again)])
        text = f"{again.sum()} of {len(kept)} samples are points that came before, as ({where}) did"
        return Finding("ties", "FAIL", text, float(again.sum()))
    same = max(SAME, _chart_rounding(kept[:1000], domain))
    n = int(np.clip(math.sqrt(alpha / (2.0 * same * crowding)), 2, 2000))
    for axis, x in enumerate(domain.to_chart(kept[:n]).T):
        found = int((np.diff(np.sort(x)) <= same).sum())
        if found:
            text = f"{found} of {n} samples repeat chart coordinate {axis + 1} of another: the numbers are too coarse"
            return Finding("ties", "FAIL", text, float(found))
    return Finding("ties", "PASS", f"{len(kept)} samples are all different", float(len(kept)))


def _chart_rounding(points: Array, domain: Domain) -> float:
    """How far the rounding of a typical point moves its chart coordinates."""
    h, size, chart = 2.0**-30, np.abs(points).max(initial=1.0), domain.to_chart(points)
    moves = [np.abs(domain.to_chart(points + h * size * axis) - chart) for axis in np.eye(domain.columns)]
    return float(np.median(np.max(moves, axis=0), axis=0).max() * ROUNDING / h)
