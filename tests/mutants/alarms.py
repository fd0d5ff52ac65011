"""False alarms and power, measured: of the harness on random numbers of known mean, and of whole gradings."""

from __future__ import annotations

import math
import multiprocessing
import signal
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from typing import Any

import numpy as np
from scipy import stats
from scipy.special import logsumexp

from raylab.stats.betting import PILOT, SIZES, Claim, Test, upward
from raylab.stats.histogram import Histogram

ALPHA = 3.3e-9
Draw = Callable[[Any, int], Any]


def weights_at_the_crossing(alpha: float, runs: int) -> list[float]:
    """1 / E where the capital reaches 1 / alpha, in runs under Q: P0(it ever does) is their mean, as E = dQ/dP0.

    X is 0 or 1 with the fair mean 1/4, looked at after each 128. Under Q_j the odds of bet j are true, and the mixture
    of the Q_j over all bets is the one whose likelihood ratio to P0 the capital ought to be. The crossing is where the
    code sees it; a code that counts its capital too high would cross early, with 1 / E above alpha. Bets 1 to 5 of 14
    are sampled, whose share of alpha is 5/14.
    """
    rng, mean = np.random.default_rng(), 0.25
    bets, weights = SIZES / mean, []
    gain, loss = np.log1p(bets * (1 - mean)), np.log1p(-bets * mean)
    for _ in range(runs):
        j = rng.integers(5)
        histogram, ones = Histogram(np.array([0.0, 0.5, 1.0])), 0
        while upward(histogram, 0.0, mean) < -math.log(alpha):
            values = (rng.random(128) < mean * (1 + bets[j] * (1 - mean))).astype(float)
            histogram.add(values)
            ones += int(values.sum())
        total = int(histogram.counts.sum())
        weights.append(math.exp(-(logsumexp(ones * gain + (total - ones) * loss) - math.log(len(bets)))))
    return weights


def by_change_of_measure(alpha: float, runs: int) -> tuple[float, float]:
    """P0(capital ever reaches 1 / alpha) / alpha and its standard error."""
    weights = weights_at_the_crossing(alpha, runs)
    return float(np.mean(weights)) / alpha, float(stats.sem(weights)) / alpha


# --- whole gradings: 34 claims about estimators that are right ---


def _half_square(draw: Draw) -> Draw:
    return lambda rng, n: 0.5 * (draw(rng, n) - draw(rng, n)) ** 2


def _uniform(rng: Any, n: int) -> Any:
    return 2.0 * rng.random(n)


SHAPES: dict[str, tuple[Draw, float]] = {  # draws of mean 1, and the bound that is declared for them
    "uniform": (_uniform, 2.2),
    "uniform, loose bound": (_uniform, 40.0),
    "half in shadow": (lambda rng, n: 2.0 * (rng.random(n) < 0.5), 2.0),
    "a tenth in light": (lambda rng, n: 10.0 * (rng.random(n) < 0.1), 10.0),
    "skewed": (lambda rng, n: 3.5 * rng.beta(2.0, 5.0, n), 3.5),
    "two factors": (lambda rng, n: 4.0 * rng.random(n) * rng.random(n), 4.0),
    "squared": (lambda rng, n: 3.0 * rng.random(n) ** 2, 3.0),
    "nearly constant": (lambda rng, n: 1.0 + 0.2 * (rng.random(n) - 0.5), 1.3),
    "two lights": (lambda rng, n: np.where(rng.random(n) < 0.3, 2.0, 4.0 / 7.0), 2.5),
    "mean of four": (lambda rng, n: 0.5 * rng.random((n, 4)).sum(axis=1), 2.0),
}


def suite() -> Iterator[tuple[Claim, Draw]]:
    """Ten means, each to be known within 10, 20 and 30 %; two variances; two correlations."""
    for name, (draw, high) in SHAPES.items():
        for delta in (0.1, 0.2, 0.3):
            yield Claim(name, 1.0, 0.0, high, delta, alpha=ALPHA), draw
    for name, variance in (("uniform", 1.0 / 3.0), ("half in shadow", 1.0)):
        yield Claim(f"variance, {name}", variance, 0.0, 2.5, 0.2 * variance, alpha=ALPHA), _half_square(SHAPES[name][0])
    for name, tolerance in (("neighbours", 0.2), ("streams", 0.3)):
        draw = lambda rng, n: 12.0 * (rng.random(n) - 0.5) * (rng.random(n) - 0.5)  # noqa: E731
        yield Claim(f"correlation of {name}", 0.0, -3.0, 3.0, tolerance, alpha=ALPHA), draw


def verdict(claim: Claim, draw: Draw, rng: Any, cap: int) -> Test:
    test, block = Test(claim), PILOT
    while test.outcome == "INCONCLUSIVE" and test.samples < cap:
        test.update(draw(rng, block))
        block = max(64, test.samples // 2)
    return test


def _gradings(n: int) -> Counter[str]:
    rng, seen = np.random.default_rng(), Counter[str]()
    for _ in range(n):
        outcomes = [verdict(claim, draw, rng, 100_000).outcome for claim, draw in suite()]
        seen.update(outcomes)
        seen["gradings"] += 1
        seen["gradings with a FAIL"] += "FAIL" in outcomes
    return seen


def gradings(n: int, jobs: int = 2) -> Iterator[Counter[str]]:
    """Outcomes of n more gradings, a few at a time; entropy is the system's."""
    yield from _shared(_gradings, n, jobs)


def _shared(grade: Callable[[int], Counter[str]], n: int, jobs: int) -> Iterator[Counter[str]]:
    part = 10
    # Ctrl-C is the parent's; it ends the others
    start = {"initializer": signal.signal, "initargs": (signal.SIGINT, signal.SIG_IGN)}
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), **start) as pool:
        try:
            yield from pool.map(grade, [part] * -(-n // part))
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


# --- whole gradings of an assignment: the judge of `raylab grade`, and the function of the package ---


def _graded(n: int) -> Counter[str]:
    from raylab import shade
    from raylab.grading import assignment
    from raylab.grading.judge import Judge
    from raylab.grading.source import InProcess

    asked, seen = assignment.load("a1"), Counter[str]()
    task = asked.tasks[0].id
    for _ in range(n):
        judge = Judge(asked, InProcess({task: shade.area_diffuse}))
        outcomes = [judged.outcome for judged in judge.all([task])]
        seen.update(outcomes)
        seen["gradings"] += 1
        seen["gradings with a FAIL"] += "FAIL" in outcomes
    return seen


def assignments(n: int, jobs: int = 2) -> Iterator[Counter[str]]:
    """Outcomes of n more gradings of assignment a1: six properties, on scenes that follow from fresh entropy."""
    yield from _shared(_graded, n, jobs)


# --- power: predicted, and measured ---

CV2, AT = 1.0 / 3.0, (1_000, 4_000)


def predicted(bias: float, n: int) -> float:
    """P(FAIL within n samples), uniform on [0, 2 + 2 bias].

    The best bet of the mixture has the log capital n (m - 1)^2 / (2 s^2) when the mean of the samples is m, and is
    one of 14 on one of two sides: FAIL when |m - 1| > s sqrt(2 ln(28 / alpha) / n), and m is normal.
    """
    s = math.sqrt(CV2) * (1.0 + bias)
    threshold = s * math.sqrt(2.0 * math.log(28.0 / ALPHA) / n)
    return float(stats.norm.sf((threshold - abs(bias)) / (s / math.sqrt(n))))


def measured(bias: float, n: int, repeats: int) -> float:
    rng, found = np.random.default_rng(), 0
    for _ in range(repeats):
        test = Test(Claim("uniform", 1.0, 0.0, 2.0 * 1.5, 0.01, alpha=ALPHA))
        step = n // 8
        while test.outcome == "INCONCLUSIVE" and test.samples < n:
            test.update(_uniform(rng, min(step, n - test.samples)) * (1.0 + bias))
        found += test.outcome == "FAIL"
    return found / repeats


def power(repeats: int, tell: Callable[[int], None] = lambda done: None) -> list[tuple[int, float, float, float]]:
    """(n, bias, predicted, measured) where the power rises from nothing to everything."""
    rows = []
    for n in AT:
        middle = math.sqrt(2.0 * math.log(28.0 / ALPHA) * CV2 / n)
        for factor in (0.5, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5):
            bias = factor * middle
            rows.append((n, bias, predicted(bias, n), measured(bias, n, repeats)))
            tell(len(rows))
    return rows
