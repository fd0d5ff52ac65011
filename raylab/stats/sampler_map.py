"""Maps from random numbers to points: what can be said of them without chance, to many digits.

A map whose samples have the density p stretches areas by 1 / p, everywhere. That sees the smallest errors of all.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from raylab.stats.domains import ROUNDING, Booleans, Domain
from raylab.stats.histogram import Array
from raylab.stats.verdict import Outcome

Pdf = Callable[[Array], Array]
LAST = 1.0 - 2.0**-53
STEPS = (2.0**-16, 2.0**-20, 2.0**-24)  # of the differences; a kink of the map is met by the first at most
FEW = 400  # chosen random numbers
ODD = 3  # wrong places that are no accident
NOISE = 64 * 2.0**-53  # relative rounding of a pdf of a few dozen operations


@dataclass(frozen=True)
class Finding:
    """What one check saw: a sentence, and the number on which it rests."""

    name: str
    outcome: Outcome
    sentence: str
    number: float = math.nan

    @property
    def ok(self) -> bool:
        return self.outcome == "PASS"


def first_wrong(findings: Sequence[Finding]) -> Finding | None:
    """The finding that names the bug."""
    return next((f for f in findings if f.outcome == "FAIL"), None)


class Sampler:
    """`sample(u (n, numbers))` as a function that returns (points (n, columns), p (n,) or None)."""

    def __init__(self, sample: Callable[[Array], object], columns: int) -> None:
        self._sample, self._columns = sample, columns

    def __call__(self, u: Array) -> tuple[Array, Array | None]:
        """Raises ValueError with a sentence when the answer has another shape."""
        found = self._sample(u)
        points, p = found if isinstance(found, tuple) else (found, None)
        points = np.asarray(points, np.float64)
        points = points[:, None] if points.ndim == 1 else points
        if points.shape != (len(u), self._columns):
            raise ValueError(f"sample() returned an array {points.shape}, expected {(len(u), self._columns)}")
        if p is not None:
            p = np.asarray(p, np.float64)
            if p.shape != (len(u),):
                raise ValueError(f"sample() returned densities {p.shape}, expected {(len(u),)}")
        return points, p


# --- what needs no theory ---


def basics(
    draw: Sampler, pdf: Pdf, domain: Domain, numbers: int, may_miss: bool, rng: np.random.Generator
) -> list[Finding]:
    """Shape, repeatability, finiteness, unit length, domain; also at random numbers 0 and 1 - 2^-53."""
    u = np.concatenate([rng.random((2000, numbers)), rng.choice([0.0, 0.5, LAST], (64, numbers))])
    given = u.copy()
    try:
        points, p = draw(u)
        again, _ = draw(given.copy())
        density = np.asarray(pdf(points), np.float64)
    except ValueError as error:
        return [Finding("range", "FAIL", str(error))]
    if not np.array_equal(u, given):
        return [Finding("range", "FAIL", "sample() changed the random numbers that it was given")]
    if not np.array_equal(points, again, equal_nan=True):
        return [Finding("range", "FAIL", "sample() returned other points for the same random numbers")]
    if density.shape != (len(u),):
        return [Finding("range", "FAIL", f"pdf() returned an array {density.shape}, expected {(len(u),)}")]
    taken = p != 0.0 if may_miss and p is not None else np.ones(len(u), bool)
    points, density, at = points[taken], density[taken], given[taken]
    rows = (
        ("range", density >= 0.0, "pdf() is negative or not a number", density),
        ("finiteness", np.isfinite(points).all(axis=1) & np.isfinite(density),
         "a point or its pdf is not finite", density),
        ("unit length", _unit(points) if domain.directions else np.ones(len(points), bool),
         "a direction does not have unit length", np.linalg.norm(points, axis=1)),
        ("domain", domain.contains(points), f"a point lies outside the {domain.name}", density),
    )  # fmt: skip
    findings: list[Finding] = []
    for name, good, sentence, value in rows:
        bad = np.flatnonzero(~good)
        if len(bad):
            where = ", ".join(f"{x:.17g}" for x in at[bad[0]])
            text = f"{sentence}: {value[bad[0]]:.9g} at u = ({where}); {len(bad)} of {len(good)}"
            return [*findings, Finding(name, "FAIL", text, float(value[bad[0]]))]
        findings.append(Finding(name, "PASS", f"{len(good)} samples", float(len(good))))
    return findings


def _unit(points: Array) -> Booleans:
    return np.asarray(np.abs(np.linalg.norm(points, axis=1) - 1.0) <= ROUNDING)


def returned_pdf(draw: Sampler, pdf: Pdf, domain: Domain, numbers: int, rng: np.random.Generator) -> Finding:
    """The p that sample() returns is pdf() of the point, up to rounding of both."""
    points, p = draw(rng.random((2000, numbers)))
    if p is None:
        return Finding("returned pdf", "PASS", "sample() returns no pdf")
    taken = p != 0.0
    points, p = points[taken], p[taken]
    if not len(p):
        return Finding("returned pdf", "FAIL", "sample() returned p = 0 each time")
    density = np.asarray(pdf(points), np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.abs(p / density - 1.0)
    wrong = np.flatnonzero(~(off <= _doubt(pdf, points, density, domain)))
    if not len(wrong):
        return Finding("returned pdf", "PASS", f"sample() and pdf() agree within {off.max():.1e}", float(off.max()))
    i = wrong[0]
    text = f"sample() returned p = {p[i]:.9g} where pdf() says {density[i]:.9g}; {len(wrong)} of {len(p)}"
    return Finding("returned pdf", "FAIL", text, float(off[i]))


def _doubt(pdf: Pdf, points: Array, density: Array, domain: Domain) -> Array:
    """Relative rounding of pdf(points): its own, and how much it varies over a step of 2^-30, scaled to a point's."""
    if domain.items:
        return np.full(len(points), NOISE)
    h, size = 2.0**-30, np.abs(points).max(initial=1.0)
    varies = np.zeros(len(points))
    for axis in np.eye(domain.columns):
        for side in (-h, h):
            moved = points + side * size * axis
            moved = moved / np.linalg.norm(moved, axis=1, keepdims=True) if domain.directions else moved
            varies = np.maximum(varies, np.abs(np.asarray(pdf(moved)) - density))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(NOISE + ROUNDING / h * varies / density)


# --- the map stretches areas by 1 / pdf ---


def jacobian(draw: Sampler, pdf: Pdf, domain: Domain, rng: np.random.Generator) -> Finding:
    """pdf times the area that a square of random numbers becomes is 1.

    Central differences with steps h and 2h: they differ by three times the truncation error of the first. To that comes
    rounding, ROUNDING / h of each column. A place is wrong if it is with every step: kinks of the map are as rare as
    they are narrow.
    """
    side = math.isqrt(FEW)
    grid = np.stack(np.meshgrid(np.arange(side), np.arange(side), indexing="ij"), axis=-1).reshape(-1, 2)
    u = 2.0**-10 + (grid + rng.random(grid.shape)) / side * (1.0 - 2.0**-9)
    points, _ = draw(u)
    density = np.asarray(pdf(points), np.float64)
    doubt = _doubt(pdf, points, density, domain)
    wrong, product = np.ones(len(u), bool), np.zeros(len(u))
    for h in STEPS:
        area, lengths = _area(draw, u, h)
        wide, _ = _area(draw, u, 2.0 * h)
        size = np.abs(points).max(initial=1.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            rounding = density * (ROUNDING * size / h) * lengths
            bound = density * np.abs(wide - area) + rounding + doubt + NOISE
        product = density * area
        wrong &= ~(np.abs(product - 1.0) <= bound)
    if wrong.sum() < ODD:
        off = float(np.median(np.abs(product - 1.0)))
        return Finding("jacobian", "PASS", f"pdf = 1 / Jacobian at {len(u)} places, within {off:.1e}", off)
    return Finding(
        "jacobian", "FAIL", _what_is_wrong(product[wrong], u[wrong], len(u)), float(np.median(product[wrong]))
    )


def _area(draw: Sampler, u: Array, h: float) -> tuple[Array, Array]:
    """|dx/du1 x dx/du2| by central differences with step h, and |dx/du1| + |dx/du2|."""
    columns = []
    for step in h * np.eye(2):
        above, _ = draw(u + step)
        below, _ = draw(u - step)
        columns.append((above - below) / (2.0 * h))
    aa, ab, bb = ((x * y).sum(axis=1) for x, y in ((columns[0],) * 2, columns, (columns[1],) * 2))
    return np.sqrt(np.maximum(aa * bb - ab * ab, 0.0)), np.sqrt(aa) + np.sqrt(bb)


def _what_is_wrong(product: Array, u: Array, places: int) -> str:
    low, high = float(product.min()), float(product.max())
    if high <= 1e-6:
        return f"pdf times Jacobian is 0 at {len(u)} of {places} places: the points fill no area (one number for two?)"
    if len(u) == places and high - low <= 1e-6 * high:
        return f"pdf times Jacobian is {high:.6g} instead of 1 everywhere: the pdf is off by this factor"
    where = f"{product[0]:.9g} at u = ({u[0, 0]:.6f}, {u[0, 1]:.6f})"
    return f"pdf times Jacobian is {where}, {low:.3g} to {high:.3g} instead of 1, at {len(u)} of {places} places"
