"""Judge: what is true of a submission, property by property, from numbers alone.

Every property is a claim that is tested with `raylab.testing`; all claims of a grading share one budget, so a
right submission is failed with probability at most 1e-6, whatever its random numbers. A claim that is not decided
within its samples is not held against anybody. Seeds follow from the budget's entropy and the name of the property.
"""

from __future__ import annotations

import math
import time
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from raylab import trials
from raylab.grading import expected, ranking
from raylab.grading.assignment import Assignment, Property
from raylab.grading.judged import Judged
from raylab.grading.source import Asked, Source
from raylab.stats.betting import Claim
from raylab.stats.budget import Budget
from raylab.stats.claims import variance_is
from raylab.stats.sampler_check import check_sampler
from raylab.testing.deciding import CHANNELS, Decision, decide
from raylab.trials import Trial

Array = npt.NDArray[np.float64]
FIRST = 4096  # samples of the first look: a scale, and a p-value for the instructor's histogram


class Judge:
    """Judges the properties of one submission."""

    def __init__(self, assignment: Assignment, source: Source, entropy: int | None = None) -> None:
        self.assignment, self.source = assignment, source
        tests = float(len(assignment.properties))
        self.budget = Budget(entropy=entropy, tests=tests)
        self.judged: list[Judged] = []
        self._p_value: float | None = None
        self._variance_ratio: float | None = None
        self._scattered: dict[str, tuple[Asked, trials.Answer, int]] = {}  # by task: what its variance was asked of

    @property
    def token(self) -> str:
        return self.budget.token

    def judge(self, own: Property) -> Judged:
        """One property. What the source raises is for the caller: the submission's fault, or the grader's."""
        start, self._p_value, self._variance_ratio = time.perf_counter(), None, None
        outcome, seen, samples = getattr(self, f"_{own.claim}")(own)
        score = 0.0 if outcome == "FAIL" else own.points
        seconds = time.perf_counter() - start
        judged = Judged(
            own.task, own.name, outcome, score, own.points, own.says, seen, self._variance_ratio, self._p_value,
            samples, seconds,
        )  # fmt: skip
        self.judged.append(judged)
        return judged

    def leaderboard(self) -> list[tuple[str, float, str]]:
        """(name, variance times rays, "asc") for each task that was found right; see `raylab.grading.ranking`."""
        return ranking.rows(self.assignment, self.judged, self._scattered)

    # --- claims: each returns outcome, what was seen, samples ---

    def _unbiased(self, own: Property) -> tuple[str, str, int]:
        """The mean is the truth, and no sample is larger than the technique allows."""
        share = self.budget.test(own.id)
        asked, trial, answer = self._asked(own, own.options["trial"], share.child(0))
        first = asked.sample(share.child(1), FIRST)
        self._p_value = p_value(first, answer.truth)
        delta = own.options["delta"]
        claims = [
            Claim(
                f"{own.id}, {channel}", answer.truth[c], 0.0, answer.bound[c], delta * answer.truth[c],
                trial.truth_error * answer.truth[c], share.alpha / 3.0,
            )
            for c, channel in enumerate(CHANNELS)
        ]  # fmt: skip
        report = decide(claims, asked.draws(share.child(2)))
        outcome = _worst(report)
        with np.errstate(all="ignore"):
            ratio = np.nanmean(first, axis=0) / answer.truth
        seen = "" if outcome == "PASS" else f"the mean is {_times(ratio)} the truth"
        return outcome, seen, report.samples + FIRST

    def _proportional(self, own: Property) -> tuple[str, str, int]:
        """The means in two trials are in the proportion of the truths, so that a wrong constant factor does not matter.

        The scale is that of a pilot; where the submission is right, bounds and claim are exact whatever the scale.
        """
        share = self.budget.test(own.id)
        x, made, answer = self._asked(own, own.options["trial"], share.child(0))
        y, _, base = self._asked(own, own.options["base"], share.child(1))
        first, other = x.sample(share.child(2), FIRST), y.sample(share.child(3), FIRST)
        scale = other.mean(axis=0) / base.truth
        if not (np.isfinite(scale).all() and (scale > 0.0).all()):
            return "FAIL", _emptiness(other), 2 * FIRST
        top_x, top_y = answer.bound / answer.truth / scale, base.bound / base.truth / scale
        allowed, delta = 2.0 * made.truth_error, own.options["delta"]
        claims = [
            Claim(f"{own.id}, {name}", 0.0, -top_y[c] * 1.01, top_x[c] * 1.01, delta, allowed, share.alpha / 3.0)
            for c, name in enumerate(CHANNELS)
        ]
        # a constant factor other than 1 scales the bounds of what is drawn: it is divided out above, but for noise
        claims = [_widened(claim, np.maximum(1.0, scale[c])) for c, claim in enumerate(claims)]
        draw_x, draw_y = x.draws(share.child(4)), y.draws(share.child(5))
        wrong: list[str] = []

        def draw(n: int) -> Array:
            a, b = draw_x(n), draw_y(n)
            wrong.extend(_impossible(a)[: 1 - len(wrong)])
            return a / (answer.truth * scale) - b / (base.truth * scale)

        report = decide(claims, draw)
        outcome = "FAIL" if wrong else _worst(report)
        with np.errstate(all="ignore"):
            ratio = np.nanmean(first, axis=0) / answer.truth / scale
        seen = (
            wrong[0] if wrong else "" if outcome == "PASS" else f"the light here is {_times(ratio)} what it should be"
        )
        return outcome, seen, 2 * (report.samples + FIRST)

    def _variance(self, own: Property) -> tuple[str, str, int]:
        """The variance of one sample, relative to the squared mean, is that of the technique."""
        share = self.budget.test(own.id)
        asked, _, answer = self._asked(own, own.options["trial"], share.child(0))
        if answer.variance is None:
            raise ValueError(f"{own.id}: trial {own.options['trial']!r} knows no variance")
        self._scattered[own.task] = asked, answer, share.child(3)
        c, tolerance = 1, own.options["tolerance"]
        first = asked.sample(share.child(1), FIRST)[:, c]
        scale = float(first.mean()) / answer.truth[c]
        if not (math.isfinite(scale) and scale > 0.0):
            return "FAIL", _emptiness(first), FIRST
        if abs(math.log(scale)) < 0.25:
            scale = 1.0  # the same units as the truth: of a right submission the claim is exact
        draw, top = asked.draws(share.child(2), c), answer.bound[c] * max(1.0, 1.05 / scale)
        found = variance_is(
            own.id, lambda n: draw(n) / scale, answer.variance[c], high=top, tolerance=tolerance, alpha=share.alpha
        )
        ratio = self._variance_ratio = float(first.var()) / scale**2 / answer.variance[c]
        seen = "" if found.outcome == "PASS" else f"the variance is {_times(np.array([ratio]))} what it should be"
        return found.outcome, seen, 2 * found.samples + FIRST

    def _density(self, own: Property) -> tuple[str, str, int]:
        """A sampler's points have the density that is due, around a random axis (`raylab.stats.sampler_check`)."""
        share = self.budget.test(own.id)
        rng = np.random.default_rng(share.child(0))
        domain, pdf, before = expected.density(own.options["density"], own.options["domain"], rng)
        drawn = 0

        def sample(u: Array) -> Array:
            nonlocal drawn
            drawn += len(u)
            return self.source.map(own.task, np.column_stack([np.tile(before, (len(u), 1)), u]))

        found = check_sampler(sample, pdf, domain, one_to_one=False, phi2=2e-3, alpha=share.alpha, rng=rng)
        wrong = [f for f in found if f.outcome == "FAIL" and f.name != "integral"]
        unsure = any(f.outcome == "INCONCLUSIVE" for f in found)
        outcome = "FAIL" if wrong else "INCONCLUSIVE" if unsure else "PASS"
        return outcome, wrong[0].sentence if wrong else "", drawn

    def _values(self, own: Property) -> tuple[str, str, int]:
        """A plain function returns what it must, at random inputs."""
        share = self.budget.test(own.id)
        rows, due = expected.VALUES[own.options["expected"]](np.random.default_rng(share.child(0)))
        found = self.source.map(own.task, rows)
        size = np.abs(due).max(axis=1, keepdims=True) + 1e-6 * np.abs(due).max()
        with np.errstate(all="ignore"):
            wrong = ~(np.abs(found - due) <= expected.TOLERANCE * size).all(axis=1)
        if not wrong.any():
            return "PASS", "", len(rows)
        i = int(np.argmax(wrong))
        seen = (
            f"{_row(rows[i])} gives {_row(found[i])}, expected {_row(due[i])}; so in {wrong.sum()} of {len(rows)} cases"
        )
        return "FAIL", seen, len(rows)

    def _asked(self, own: Property, trial: str, seed: int) -> tuple[Asked, Trial, trials.Answer]:
        made = trials.make(trial, seed)
        return Asked(self.source, own.task, trial, seed), made, made.answer(self.assignment.task(own.task).like)


def p_value(values: Array, truth: Array) -> float | None:
    """Two-sided, of the mean of the green channel against the truth, by the normal distribution."""
    x = values[:, 1]
    spread = float(x.std()) / math.sqrt(len(x))
    return math.erfc(abs(float(x.mean()) - truth[1]) / spread / math.sqrt(2.0)) if spread > 0.0 else None


def _worst(decision: Decision) -> str:
    """FAIL if anything was found; else the worst of the verdicts."""
    outcomes = {verdict.outcome for verdict in decision.verdicts}
    if decision.findings or "FAIL" in outcomes:
        return "FAIL"
    return "INCONCLUSIVE" if "INCONCLUSIVE" in outcomes else "PASS"


def _widened(claim: Claim, factor: float) -> Claim:
    return replace(claim, low=claim.low * factor, high=claim.high * factor)


def _row(values: Array) -> str:
    return "(" + ", ".join(f"{v:.6g}" for v in values) + ")"


def _times(ratio: Array) -> str:
    """How many times the truth: one number where the channels agree."""
    r = np.asarray(ratio, float)
    if not np.isfinite(r).all():
        return "not a number times"
    text = [f"{v:.3g}" for v in r]
    return f"{text[0]} times" if np.ptp(r) <= 0.02 * abs(r).max() else f"({', '.join(text)}) times"


def _impossible(values: Array) -> list[str]:
    if not np.isfinite(values).all():
        return ["a sample is not a number"]
    return ["a sample is negative light"] if (values < 0.0).any() else []


def _emptiness(values: Array) -> str:
    return "samples are not numbers" if not np.isfinite(values).all() else "all light is zero or negative"
