"""Examiner: all that can be claimed of an estimator, in one line each.

`technique` is the built-in shade() whose slide prescribes what is sampled: it decides the truth and the largest value
that one sample may have. Each colour channel is tested, with a third of the test's alpha; the outcome is the worst.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from raylab import trials
from raylab.errors import UserError
from raylab.estimator_check import CALLS, check
from raylab.metamorphic import Relation, relate
from raylab.probe import Probe
from raylab.scene import Scene
from raylab.stats.betting import PILOT, Claim
from raylab.stats.budget import Budget, Share
from raylab.stats.claims import half_square, shrinks_as, uncorrelated
from raylab.strategies import BUILT_IN
from raylab.testing.deciding import CHANNELS, Decision, decide, equal_means
from raylab.testing.relations import related
from raylab.testing.report import Report
from raylab.testing.source import Array, Draw, Shade, Source, channel, draws, name_of
from raylab.trials import Trial


@dataclass
class Examiner:
    """Makes tests that share one budget of false alarms."""

    budget: Budget = field(default_factory=Budget)
    threads: int = 0
    prefix: str = ""  # of the names of the tests

    CLAIMS: ClassVar[tuple[str, ...]] = (
        "unbiased", "same_mean", "variance", "shrinks", "independent", "more_rays", "relation", "well_behaved",
    )  # fmt: skip

    def well_behaved(
        self, technique: str, shade: Shade | None = None, trial: str | Trial = "polygons", seconds: float = 20.0
    ) -> Report:
        """No NaN, no wrong type or shape, nothing negative or too large, no state, no other random generator, and an
        end within `seconds`; see `raylab.estimator_check`."""
        if not isinstance(trial, str):
            raise UserError("expected the name of a trial: the estimator runs in another process")
        if isinstance(shade, Source):
            raise UserError(f"{name_of(shade)}: expected a function; of a source only the samples can be looked at")
        function = BUILT_IN[technique][0] if shade is None or isinstance(shade, str) else shade
        share, start = (
            self.budget.test(f"{self.prefix}well behaved {technique} {name_of(function)} {trial}"),
            time.time(),
        )
        found = check(function, technique, trial, seed=share.child(0), seconds=seconds)
        return Report(share.name, (), CALLS, time.time() - start, self.budget.token, tuple(str(f) for f in found))

    def unbiased(
        self, technique: str, shade: Shade | None = None, trial: str | Trial = "polygons", delta: float = 0.01
    ) -> Report:
        """The mean is the truth, and no sample is larger than the technique allows; a bias of `delta` is noticed."""
        test = self._test("unbiased", technique, shade, trial)
        answer, draw = test.trial.answer(technique), test.draws(1)
        claims = [
            Claim(
                f"{test.share.name}, {name}", answer.truth[c], 0.0, answer.bound[c], delta * answer.truth[c],
                test.trial.truth_error * answer.truth[c], test.share.alpha / 3.0,
            )
            for c, name in enumerate(CHANNELS)
        ]  # fmt: skip
        return test.report(lambda: decide(claims, draw))

    def same_mean(
        self,
        technique: str,
        other: str,
        shade: Shade | None = None,
        trial: str | Trial = "polygons",
        delta: float = 0.01,
    ) -> Report:
        """Two techniques have the same mean, whatever it is; `shade` claims to be the first."""
        test = self._test(f"same mean as {other}", technique, shade, trial)
        x, y = test.trial.answer(technique), test.trial.answer(other)
        draw_x, draw_y = test.draws(1), draws(other, test.trial, test.share.child(2), self.threads)
        claims = equal_means(test.share, x.bound, y.bound, delta * y.truth)
        return test.report(lambda: decide(claims, lambda n: draw_x(n) - draw_y(n)), 2)

    def variance(
        self,
        technique: str,
        shade: Shade | None = None,
        trial: str | Trial = "lens_before_focus",
        tolerance: float = 0.1,
    ) -> Report:
        """The variance of one sample is that of the technique: not more, and not less either.

        Where the trial knows no closed form, the built-in shade() is asked: two variances are compared.
        """
        test = self._test("variance", technique, shade, trial)
        answer, half = test.trial.answer(technique), half_square(test.draws(1))
        if answer.variance is not None:
            claims, draw, calls = _variances(test.share, answer.variance, answer.bound, tolerance), half, 2
        else:
            other = half_square(draws(technique, test.trial, test.share.child(2), self.threads))
            known, highest = other(PILOT).mean(axis=0), 0.5 * answer.bound**2
            claims = equal_means(test.share, highest, highest, tolerance * np.maximum(known, 1e-9 * highest))
            draw, calls = (lambda n: half(n) - other(n)), 4
        return test.report(lambda: decide(claims, draw), calls)

    def shrinks(
        self, technique: str, shade: Shade | None = None, trial: str | Trial = "polygons", n: int = 16
    ) -> Report:
        """The variance of a mean of n samples is 1/n of that of one: each call draws numbers of its own."""
        test = self._test("shrinks", technique, shade, trial)
        green, bound = channel(test.draws(1), 1), test.trial.answer(technique).bound[1]

        def means(samples: int, count: int) -> Array:
            return np.asarray(green(samples * count).reshape(count, samples).mean(axis=1))

        def found() -> Decision:
            verdict = shrinks_as(f"{test.share.name}, green", means, n, high=bound, alpha=test.share.alpha)
            return Decision((verdict,), verdict.samples, ())

        return test.report(found, 2 * (n + 1))

    def independent(self, technique: str, shade: Shade | None = None, trial: str | Trial = "polygons") -> Report:
        """Neighbouring calls are not correlated."""
        test = self._test("independent", technique, shade, trial)
        green, answer = channel(test.draws(1), 1), test.trial.answer(technique)

        def pairs(n: int) -> tuple[Array, Array]:
            values = green(2 * n)
            return values[::2], values[1::2]

        def found() -> Decision:
            name, truth, bound = f"{test.share.name}, green", answer.truth[1], answer.bound[1]
            verdict = uncorrelated(name, pairs, truth, high=bound, alpha=test.share.alpha)
            return Decision((verdict,), verdict.samples, ())

        return test.report(found, 2)

    def more_rays(
        self, technique: str, shade: Shade | None = None, trial: str | Trial = "polygons", delta: float = 0.01
    ) -> Report:
        """The mean of two calls is on average what one call is."""
        test = self._test("more rays", technique, shade, trial)
        one, two, answer = test.draws(1), test.draws(2), test.trial.answer(technique)
        claims = equal_means(test.share, answer.bound, answer.bound, delta * answer.truth)
        return test.report(lambda: decide(claims, lambda n: one(n) - two(2 * n).reshape(n, 2, 3).mean(axis=1)), 3)

    def relation(
        self, relation: str, technique: str, shade: Shade | None = None, trial: str | Trial = "polygons",
        delta: float = 0.01,
    ) -> Report:  # fmt: skip
        """A metamorphic relation (`raylab.metamorphic.RELATIONS`) holds; UserError where it does not apply."""
        test = self._test(relation, technique, shade, trial)
        found = relate(relation, test.trial.description, test.share.child(0))
        if found is None:
            raise UserError(f"relation {relation!r} does not apply to trial {test.trial.name!r}")
        changed, bound = found.trial(test.trial), test.trial.answer(technique).bound

        def after(seed: int) -> Draw:
            return draws(test.shade, changed, seed, self.threads)

        for seeded in (test.seeded, after):
            seeded(0)  # compiles, before the clock runs
        return test.report(lambda: related(test.share, test.seeded, after, found, bound, delta), 2)

    def related(
        self, share: Share, before: Probe, relation: Relation, bound: Array | None = None, delta: float = 0.01
    ) -> Report:
        """A relation for the samples of any probe; one about means alone needs a bound of the samples (3,)."""
        after = Probe(Scene(relation.description), before.shade, relation.place(before.place), before.threads)
        start = time.perf_counter()
        found = related(share, before.draws, after.draws, relation, bound, delta)
        seconds = time.perf_counter() - start
        return Report(share.name, found.verdicts, 2 * found.samples, seconds, self.budget.token, found.findings)

    def _test(self, what: str, technique: str, shade: Shade | None, trial: str | Trial) -> _Test:
        shade, start = technique if shade is None else shade, time.perf_counter()
        place = trial if isinstance(trial, str) else trial.name
        share = self.budget.test(f"{self.prefix}{what} {technique} {name_of(shade)} {place}")
        made = trials.make(trial, share.child(0)) if isinstance(trial, str) else trial
        return _Test(share, made, shade, self.threads, self.budget.token, start)


@dataclass(frozen=True)
class _Test:
    """One test: its share of the budget, the estimator and the trial."""

    share: Share
    trial: Trial
    shade: Shade
    threads: int
    token: str
    started: float

    def seeded(self, seed: int) -> Draw:
        return draws(self.shade, self.trial, seed, self.threads)

    def draws(self, child: int) -> Draw:
        return self.seeded(self.share.child(child))

    def report(self, find: Callable[[], Decision], calls: int = 1) -> Report:
        """What `find` decides, which takes `calls` samples for each of its observations."""
        start = time.perf_counter()
        found = find()
        seconds, prepared = time.perf_counter() - start, start - self.started
        return Report(
            self.share.name, found.verdicts, calls * found.samples, seconds, self.token, found.findings, prepared
        )


def _variances(share: Share, variance: Array, bound: Array, tolerance: float) -> list[Claim]:
    """E (X - X')^2 / 2 = variance in each channel."""
    return [
        Claim(
            f"{share.name}, {name}", variance[c], 0.0, 0.5 * bound[c] ** 2, tolerance * variance[c],
            alpha=share.alpha / 3.0,
        )
        for c, name in enumerate(CHANNELS)
    ]  # fmt: skip
