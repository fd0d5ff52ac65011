"""Expected: what plain functions must return, for random inputs, in numpy.

Each entry makes rows of inputs (n, k) and the results (n, m); a result may be off by TOLERANCE, relative to its row.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np
import numpy.typing as npt

from raylab.grading.assignment import Property
from raylab.stats import domains
from raylab.stats.domains import Domain
from raylab.submission.task import Task

Array = npt.NDArray[np.float64]
Pair = tuple[Array, Array]
ROWS, TOLERANCE = 4000, 1e-9  # seven digits more than any slide has


def units(rng: np.random.Generator, n: int) -> Array:
    v = rng.normal(size=(n, 3))
    return np.asarray(v / np.linalg.norm(v, axis=1, keepdims=True))


def _lobe(rng: np.random.Generator, n: Array) -> Pair:
    R, w = units(rng, ROWS), units(rng, ROWS)
    w[: ROWS // 2] = R[: ROWS // 2] + w[: ROWS // 2] * (2.0 / np.sqrt(n[: ROWS // 2]))[:, None]
    w /= np.linalg.norm(w, axis=1, keepdims=True)
    s = np.cross(R, w)
    with np.errstate(divide="ignore"):
        logs = 0.5 * np.log1p(-np.minimum(1.0, (s * s).sum(axis=1)))
    value = np.where((R * w).sum(axis=1) > 0.0, (n + 1.0) / (2.0 * math.pi) * np.exp(n * logs), 0.0)
    return np.column_stack([R, n, w]), value[:, None]


def pdf_phong_lobe(rng: np.random.Generator) -> Pair:
    return _lobe(rng, rng.integers(1, 60, ROWS).astype(float))


def pdf_phong_lobe_sharp(rng: np.random.Generator) -> Pair:
    return _lobe(rng, 10.0 ** rng.uniform(3, 6, ROWS))


def _direction(rng: np.random.Generator, f: Array) -> Pair:
    toward = np.column_stack([rng.uniform(-1, 1, (ROWS, 2)), np.ones(ROWS)])
    p = rng.uniform(-0.5, 0.5, (ROWS, 2))
    focus = toward * f[:, None]
    found = (focus - np.column_stack([p, np.zeros(ROWS)])) / f[:, None]
    return np.column_stack([toward, f, p]), found


def lens_direction(rng: np.random.Generator) -> Pair:
    return _direction(rng, rng.uniform(0.5, 20.0, ROWS))


def lens_direction_far(rng: np.random.Generator) -> Pair:
    return _direction(rng, 10.0 ** rng.uniform(6, 12, ROWS))


def shutter_time(rng: np.random.Generator) -> Pair:
    a, length, u = rng.uniform(-2, 2, ROWS), rng.uniform(0.1, 3.0, ROWS), rng.random(ROWS)
    return np.column_stack([a, a + length, u]), (a * (1.0 - u) + (a + length) * u)[:, None]


def _position(rng: np.random.Generator, low: float, high: float) -> Pair:
    p0, p1 = rng.uniform(-3, 3, (ROWS, 3)), rng.uniform(-3, 3, (ROWS, 3))
    t0, length, s = rng.uniform(-2, 2, ROWS), rng.uniform(0.1, 3.0, ROWS), rng.uniform(low, high, ROWS)
    at = np.clip(s, 0.0, 1.0)[:, None]
    return np.column_stack([p0, p1, t0, t0 + length, t0 + s * length]), p0 + at * (p1 - p0)


def position(rng: np.random.Generator) -> Pair:
    return _position(rng, 0.0, 1.0)


def position_outside(rng: np.random.Generator) -> Pair:
    return _position(rng, -2.0, 3.0)


def _weight(rng: np.random.Generator, low: float, high: float, squared: bool) -> Pair:
    p, q = 10.0 ** rng.uniform(low, high, (2, ROWS))
    p[:100], q[100:200] = 0.0, 0.0
    with np.errstate(divide="ignore", over="ignore"):
        r = np.where(p > 0.0, q / np.where(p > 0.0, p, 1.0), np.inf)
        value = 1.0 / (1.0 + (r * r if squared else r))
    return np.column_stack([p, q]), value[:, None]


def balance(rng: np.random.Generator) -> Pair:
    return _weight(rng, -3, 3, False)


def balance_extreme(rng: np.random.Generator) -> Pair:
    return _weight(rng, -200, 300, False)


def power(rng: np.random.Generator) -> Pair:
    return _weight(rng, -3, 3, True)


def power_extreme(rng: np.random.Generator) -> Pair:
    return _weight(rng, -200, 300, True)


VALUES: dict[str, Callable[[np.random.Generator], Pair]] = {
    f.__name__: f
    for f in (
        pdf_phong_lobe, pdf_phong_lobe_sharp, lens_direction, lens_direction_far, shutter_time, position,
        position_outside, balance, balance_extreme, power, power_extreme,
    )
}  # fmt: skip


def density(name: str, domain: str, rng: np.random.Generator) -> tuple[Domain, Callable[[Array], Array], Array]:
    """A domain in a random position, the density that is due there, and the inputs before u."""
    if domain == "disk":
        a = float(rng.uniform(0.3, 3.0))
        return domains.disk(a), lambda p: np.full(len(p), 1.0 / (math.pi * a * a)), np.array([a])
    axis = units(rng, 1)[0]
    if domain == "lobe":
        n = float(rng.uniform(2.0, 40.0))

        def lobe(w: Array) -> Array:
            return np.asarray((n + 1.0) / (2.0 * math.pi) * np.maximum(0.0, w @ axis) ** n)

        return domains.lobe(tuple(axis), n), lobe, np.array([*axis, n])
    cosine = name == "cosine"

    def over(w: Array) -> Array:
        return np.asarray(np.maximum(0.0, w @ axis) / math.pi if cosine else np.full(len(w), 0.5 / math.pi))

    return domains.hemisphere(tuple(axis)), over, axis


# --- inputs on which mistakes are told from one another ---


def blocks(properties: Iterable[Property], n: int, seed: int) -> dict[str, Array]:
    """Rows of inputs (n, k) by name, from what a plain function is asked for: four positions of each domain."""
    found = {}
    for own in properties:
        rng = np.random.default_rng(seed)
        if own.claim == "values":
            rows, _ = VALUES[own.options["expected"]](rng)
            found[own.options["expected"]] = rows[:: ROWS // n][:n]
        elif own.claim == "density":
            for i in range(4):
                _, _, before = density(own.options["density"], own.options["domain"], rng)
                found[f"{own.options['domain']} {i}"] = np.column_stack([np.tile(before, (n, 1)), rng.random((n, 2))])
    return found


def random_columns(properties: Iterable[Property], task: Task) -> npt.NDArray[np.int_]:
    """Which columns of a row are the pair u of a sampler; none for other functions."""
    if not any(own.claim == "density" for own in properties):
        return np.zeros(0, int)
    return np.arange(task.columns[0])[-2:]
