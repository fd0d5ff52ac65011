"""Tests of `raylab.testing` on mutants: relations, 1/N, unbiasedness through the camera, watched calls; and picks."""

from __future__ import annotations

import math
import secrets
import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from raylab import trials
from raylab.jit import njit
from raylab.stats import Budget, Counts
from raylab.testing import Examiner, Report
from raylab.testing.source import draws
from raylab.view import View

ALPHA = 3.3e-9
FIXED = 7  # seed of the scene in which other projects' tests look at the mean
LINES = (0.02, 0.9, 0.03, 0.05)  # shares of the picks


def _examiner() -> Examiner:
    return Examiner(Budget(ALPHA, tests=1))


def _said(name: str, kind: str, report: Report) -> dict[str, Any]:
    reason = "; ".join([*report.findings, *(v.reason for v in report.verdicts if v.reason)])
    return {"trial": name, "test": kind, "outcome": report.outcome, "samples": report.samples,
            "seconds": report.seconds, "compiling": report.preparing, "reason": reason}  # fmt: skip


def _means(name: str, technique: str, trial: str) -> Iterator[dict[str, Any]]:
    """What the other projects' tests of means say in a scene of this kind."""
    from mutants.rivals import judge
    from mutants.run import VARIANCES, _rivals

    made = trials.make(trial, FIXED)
    drawn, truth = draws(technique, made, secrets.randbits(62)), made.answer(technique).truth

    def relative(n: int) -> Any:
        return (drawn(n) / truth).mean(axis=1)

    found, values = judge(relative, VARIANCES.get(name), float(truth.mean())), relative(200_000)
    bias = 100.0 * float(np.nan_to_num(values).mean() - 1.0)
    yield _rivals(name) | {"variance": float(np.var(values)), "bias": bias} | found


def relation(name: str, words: list[str]) -> Iterator[dict[str, Any]]:
    """ "relation NAME TECHNIQUE TRIAL" """
    which, technique, trial = words
    yield _said(name, "D", _examiner().relation(which, technique, trial=trial))
    yield from _means(name, technique, trial)


def shrinks(name: str, words: list[str]) -> Iterator[dict[str, Any]]:
    technique, trial = words
    yield _said(name, "C", _examiner().shrinks(technique, trial=trial))
    yield from _means(name, technique, trial)


def unbiased(name: str, words: list[str]) -> Iterator[dict[str, Any]]:
    technique, trial = words
    yield _said(name, "M", _examiner().unbiased(technique, trial=trial))
    yield from _means(name, technique, trial)


def watch(name: str, words: list[str]) -> Iterator[dict[str, Any]]:
    """In plain Python."""
    from raylab.estimator_check import CALLS
    from raylab.estimator_watch import watch as watched
    from raylab.strategies import BUILT_IN

    technique, trial = words
    made, function = trials.make(trial, secrets.randbits(32)), BUILT_IN[technique][0]
    made.scene  # noqa: B018 (built before the generators are closed)
    start = time.perf_counter()
    found = watched(function, made, technique, secrets.randbits(32))
    reason = "; ".join(f"{kind}: {seen}" for kind, seen in found)
    yield {"trial": name, "test": "W", "outcome": "FAIL" if found else "PASS", "samples": CALLS,
           "seconds": time.perf_counter() - start, "reason": reason}  # fmt: skip


@njit
def _choose(choice, squares, out):
    for i in range(len(out)):
        out[i] = choice.choose((squares[i, 0], squares[i, 1]))[0]


def picks(name: str, words: list[str]) -> Iterator[dict[str, Any]]:
    """How often each light is chosen that has a share of the power."""
    from raylab.light_choice import make_choice

    rng, choice, tally = (
        np.random.default_rng(secrets.randbits(64)),
        make_choice(np.array(LINES)),
        Counts(np.array(LINES)),
    )
    _choose(choice, View(rng.random((1, 2))), View(np.zeros(1, np.int64)))  # compiles
    start, taken, outcome = time.perf_counter(), 0, "PASS"
    while taken < 500_000 and outcome == "PASS":
        n = max(256, taken // 4)
        out = np.zeros(n, np.int64)
        _choose(choice, View(rng.random((n, 2))), View(out))
        tally.add(out)
        taken += n
        outcome = "FAIL" if tally.log_evidence() > -math.log(ALPHA) else "PASS"
    seconds = time.perf_counter() - start
    yield {"trial": name, "test": "P", "outcome": outcome, "samples": taken, "seconds": seconds, "reason": ""}


def brdf(name: str, words: list[str]) -> Iterator[dict[str, Any]]:
    """f_r(v, w) = f_r(w, v) >= 0, and the lobe follows the view, at random directions."""
    from mutants.maps import EXPONENT, N
    from raylab.brdf import Phong
    from raylab.vec3 import Vec3

    f = Phong(Vec3(0.1, 0.1, 0.1), Vec3(0.5, 0.5, 0.5), EXPONENT, N)
    f.eval(N, N)  # compiles
    rng, start, wrong, views = np.random.default_rng(secrets.randbits(64)), time.perf_counter(), 0.0, set()
    n = np.array([*N])
    for v, w in rng.normal(size=(100, 2, 3)):
        v, w = (x * np.sign(x @ n) / np.linalg.norm(x) for x in (v, w))
        one, two = (f.eval(Vec3(*a), Vec3(*b)).x for a, b in ((v, w), (w, v)))
        wrong = max(wrong, abs(one - two), -one)
        views.add(f.eval(Vec3(*v), N).x)
    bad = wrong > 1e-9 or len(views) < 50
    yield {"trial": name, "test": "D", "outcome": "FAIL" if bad else "PASS", "samples": 100,
           "seconds": time.perf_counter() - start, "reason": f"off by {wrong:.2g}; {len(views)} views"}  # fmt: skip
