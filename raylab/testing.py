"""Testing: one line for each claim about an estimator; trials, probes and bets are put together here.

    report = Examiner().unbiased("area_diffuse", my_shade, trial="polygons")
    print(report)

`technique` is the built-in shade() whose slide prescribes what is sampled: it decides the truth and the largest value
that one sample may have. Each colour channel is tested, with a third of the test's alpha; the outcome is the worst.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from raylab import trials
from raylab.errors import UserError
from raylab.estimator_check import CALLS, KINDS, check
from raylab.metamorphic import Relation, relate
from raylab.probe import Probe
from raylab.scene import Scene
from raylab.stats.betting import PILOT, Claim, Test
from raylab.stats.budget import Budget, Share
from raylab.stats.claims import LARGEST_BLOCK, shrinks_as, uncorrelated, variance_is, variance_ratio_is
from raylab.stats.tails import rule_of_three
from raylab.stats.verdict import Outcome, Verdict
from raylab.strategies import BUILT_IN
from raylab.trials import Answer, Trial

Array = npt.NDArray[np.float64]
Shade = str | Callable[..., Any]
Draw = Callable[[int], Array]
CHANNELS = ("red", "green", "blue")
ROUNDING = (
    2.0**-10
)  # relative: float32 moves points by 2^-24 of the scene, and 1/r^2 and cosines by some 100 times that
FLIPS = 1e-3  # samples that rounding may bring to the other side of an edge or texel: far fewer than that
CAP = 8  # times what a true claim needs on average


@dataclass(frozen=True)
class Report:
    """What a test found: a verdict for each channel, the sum of their samples, the time, and how to repeat it."""

    name: str
    verdicts: tuple[Verdict, ...]
    samples: int
    seconds: float
    token: str
    findings: tuple[str, ...] = ()  # what is wrong beyond the verdicts, in words

    @property
    def outcome(self) -> Outcome:
        """FAIL if anything was found; else the worst of the verdicts: FAIL before INCONCLUSIVE before PASS."""
        outcomes = {verdict.outcome for verdict in self.verdicts}
        if self.findings or "FAIL" in outcomes:
            return "FAIL"
        return "INCONCLUSIVE" if "INCONCLUSIVE" in outcomes else "PASS"

    @property
    def detectable(self) -> float:
        """The smallest bias, as a share of the truth, that would have been seen in every channel."""
        relative = [v.detectable / abs(v.truth) if v.truth else float("nan") for v in self.verdicts]
        return max(relative, default=float("nan"))

    def __str__(self) -> str:
        lines = [f"{self.outcome}  {self.name}: {self.samples} samples, {self.seconds:.2g} s, replay {self.token}"]
        return "\n".join(lines + [f"  {line}" for line in (*self.findings, *self.verdicts)])


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
        function = BUILT_IN[technique][0] if shade is None or isinstance(shade, str) else shade
        share, start = self.budget.test(f"{self.prefix}well behaved {technique} {_name(function)} {trial}"), time.time()
        found = check(function, technique, trial, seed=share.child(0), seconds=seconds)
        return Report(share.name, (), CALLS, time.time() - start, self.budget.token, tuple(str(f) for f in found))

    def unbiased(
        self, technique: str, shade: Shade | None = None, trial: str | Trial = "polygons", delta: float = 0.01
    ) -> Report:
        """The mean is the truth, and no sample is larger than the technique allows; a bias of `delta` is noticed."""
        shade = technique if shade is None else shade
        share, made = self._prepare(f"unbiased {technique} {_name(shade)}", trial)
        answer, draw = made.answer(technique), made.probe(shade, self.threads).draws(share.child(1))
        claims = [
            Claim(
                f"{share.name}, {channel}", answer.truth[c], 0.0, answer.bound[c], delta * answer.truth[c],
                made.truth_error * answer.truth[c], share.alpha / 3.0,
            )
            for c, channel in enumerate(CHANNELS)
        ]  # fmt: skip
        return self.decide(share.name, claims, draw)

    def same_mean(
        self,
        technique: str,
        other: str,
        shade: Shade | None = None,
        trial: str | Trial = "polygons",
        delta: float = 0.01,
    ) -> Report:
        """Two techniques have the same mean, whatever it is; `shade` claims to be the first."""
        shade = technique if shade is None else shade
        share, made = self._prepare(f"same mean {technique} {other} {_name(shade)}", trial)
        x, y = made.answer(technique), made.answer(other)
        draw_x = made.probe(shade, self.threads).draws(share.child(1))
        draw_y = made.probe(other, self.threads).draws(share.child(2))
        claims = _equal_means(share, x.bound, y.bound, delta * y.truth)
        return self.decide(share.name, claims, lambda n: draw_x(n) - draw_y(n))

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
        shade = technique if shade is None else shade
        share, made = self._prepare(f"variance {technique} {_name(shade)}", trial)
        answer, start = made.answer(technique), time.perf_counter()
        x, y = made.probe(shade, self.threads), made.probe(technique, self.threads)
        verdicts, samples = [], 0
        for c, channel in enumerate(CHANNELS):
            name, alpha = f"{share.name}, {channel}", share.alpha / 3.0
            draw = x.draws(share.child(2 * c + 1), c)
            if answer.variance is not None:
                found = variance_is(
                    name, draw, answer.variance[c], high=answer.bound[c], tolerance=tolerance, alpha=alpha
                )
            else:
                found = _same_variance(
                    name, draw, y.draws(share.child(2 * c + 2), c), answer.bound[c], tolerance, alpha
                )
            verdicts.append(found)
            samples += 2 * found.samples
        return Report(share.name, tuple(verdicts), samples, time.perf_counter() - start, self.budget.token)

    def shrinks(
        self, technique: str, shade: Shade | None = None, trial: str | Trial = "polygons", n: int = 16
    ) -> Report:
        """The variance of a mean of n samples is 1/n of that of one: each call draws numbers of its own."""
        shade = technique if shade is None else shade
        share, made = self._prepare(f"shrinks {technique} {_name(shade)}", trial)
        start, means = time.perf_counter(), made.probe(shade, self.threads).means(share.child(1), 1)
        found = shrinks_as(f"{share.name}, green", means, n, high=made.answer(technique).bound[1], alpha=share.alpha)
        samples = 2 * (n + 1) * found.samples
        return Report(share.name, (found,), samples, time.perf_counter() - start, self.budget.token)

    def independent(self, technique: str, shade: Shade | None = None, trial: str | Trial = "polygons") -> Report:
        """Neighbouring calls are not correlated."""
        shade = technique if shade is None else shade
        share, made = self._prepare(f"independent {technique} {_name(shade)}", trial)
        start, draw = time.perf_counter(), made.probe(shade, self.threads).draws(share.child(1), 1)
        answer = made.answer(technique)

        def pairs(n: int) -> tuple[Array, Array]:
            values = draw(2 * n)
            return values[::2], values[1::2]

        found = uncorrelated(
            f"{share.name}, green", pairs, answer.truth[1], high=answer.bound[1], alpha=share.alpha
        )  # fmt: skip
        return Report(share.name, (found,), 2 * found.samples, time.perf_counter() - start, self.budget.token)

    def more_rays(
        self, technique: str, shade: Shade | None = None, trial: str | Trial = "polygons", delta: float = 0.01
    ) -> Report:
        """The mean of two calls is on average what one call is."""
        shade = technique if shade is None else shade
        share, made = self._prepare(f"more rays {technique} {_name(shade)}", trial)
        one, two = (made.probe(shade, self.threads).draws(share.child(i)) for i in (1, 2))
        answer = made.answer(technique)
        claims = _equal_means(share, answer.bound, answer.bound, delta * answer.truth)
        return self.decide(share.name, claims, lambda n: one(n) - two(2 * n).reshape(n, 2, 3).mean(axis=1))

    def relation(
        self, relation: str, technique: str, shade: Shade | None = None, trial: str | Trial = "polygons",
        delta: float = 0.01,
    ) -> Report:  # fmt: skip
        """A metamorphic relation (`raylab.metamorphic.RELATIONS`) holds; UserError where it does not apply."""
        shade = technique if shade is None else shade
        share, made = self._prepare(f"{relation} {technique} {_name(shade)}", trial)
        found = relate(relation, made.description, share.child(0))
        if found is None:
            raise UserError(f"relation {relation!r} does not apply to trial {made.name!r}")
        before = made.probe(shade, self.threads)
        return self.related(share, before, found, made.answer(technique).bound, delta)

    def related(
        self, share: Share, before: Probe, relation: Relation, bound: Array | None = None, delta: float = 0.01
    ) -> Report:
        """A relation for the samples of any probe; one about means alone needs a bound of the samples (3,)."""
        after = Probe(Scene(relation.description), before.shade, relation.place(before.place), before.threads)
        if relation.expected in ("bitwise", "rounding"):
            return self._same_samples(share, before, after, relation)
        x, y = before.draws(share.child(1)), after.draws(share.child(2))
        pilot = before.sample(share.child(3), PILOT)
        if (
            relation.expected == "distribution"
        ):  # of samples that are spread alike, all that is cut off alike is as well
            bound = 4.0 * pilot.max(axis=0) + 1e-300
        if bound is None:
            raise UserError(f"relation {relation.name!r} is about means: expected a bound of the samples")
        top = np.asarray(bound)
        cut = (lambda v: np.minimum(v, top)) if relation.expected == "distribution" else (lambda v: v)
        delta_abs = delta * np.maximum(pilot.mean(axis=0), 1e-6 * top)
        claims = _equal_means(share, top, top, delta_abs)
        return self.decide(share.name, claims, lambda n: cut(x(n)) - cut(y(n) / relation.factor))

    def _same_samples(self, share: Share, before: Probe, after: Probe, relation: Relation) -> Report:
        """Sample by sample: all the same, or at most one in a thousand different by more than rounding."""
        start, seed = time.perf_counter(), share.child(1)
        taken = 0

        def differs(n: int) -> Array:
            nonlocal taken
            x = before.sample(seed, n, taken) * relation.factor
            y = after.sample(seed, n, taken)
            taken += n
            allowed = 0.0
            if relation.expected == "rounding":
                allowed = ROUNDING * np.maximum(np.abs(x), np.nanmean(np.abs(x), axis=0) + 1e-300)
            same = (np.abs(y - x) <= allowed) | (np.isnan(x) & np.isnan(y))
            return np.where(same.all(axis=1), 0.0, 1.0)

        if relation.expected == "rounding":
            claim = Claim(share.name, 0.5 * FLIPS, 0.0, 1.0, 9.5 * FLIPS, 0.5 * FLIPS, share.alpha)
            return self.decide(share.name, [claim], lambda n: differs(n)[:, None])
        wrong = float(differs(1 << 12).mean())
        unseen = rule_of_three(1 << 12, 1.0 - 1e-3)
        seconds = time.perf_counter() - start
        verdict = Verdict(
            share.name, "FAIL" if wrong else "PASS", wrong, (0.0, max(wrong, unseen)), 0.0, 1 << 12, unseen, 0.0, 1e-3,
            seconds, f"{100 * wrong:.3g} % of the samples changed, expected none" if wrong else "",
        )  # fmt: skip
        return Report(share.name, (verdict,), 2 << 12, seconds, self.budget.token)

    def decide(self, name: str, claims: Sequence[Claim], draw: Draw) -> Report:
        """Decide a claim for each column of what `draw(n) -> (n, k)` gives, all of them from the same samples.

        A value that is not a finite number decides against; so does one outside its range.
        """
        start, tests = time.perf_counter(), [Test(claim) for claim in claims]
        findings: list[str] = []
        values = draw(PILOT)
        caps = [self._cap(claim, values[:, c]) for c, claim in enumerate(claims)]
        while True:
            for c, test in enumerate(tests):
                test.update(values[:, c])
                findings += _named(test.claim, values[:, c])
            taken = tests[0].samples if len(tests) == 1 else max(test.samples for test in tests)
            open_ = [t.outcome == "INCONCLUSIVE" and t.samples < cap for t, cap in zip(tests, caps, strict=True)]
            if not any(open_) or any(t.outcome == "FAIL" for t in tests):
                break
            values = draw(min(max(64, taken // 4), LARGEST_BLOCK))
        seconds = time.perf_counter() - start
        verdicts = tuple(test.verdict(seconds) for test in tests)
        return Report(name, verdicts, taken, seconds, self.budget.token, tuple(findings))

    @staticmethod
    def _cap(claim: Claim, pilot: Array) -> int:
        finite = pilot[np.isfinite(pilot)]
        spread = float(finite.std()) if len(finite) else 0.0
        needed = max(23.0 * (spread / claim.delta) ** 2, 8.0 * (claim.high - claim.low) / claim.delta, 4.0 * PILOT)
        return int(CAP * needed)

    def _prepare(self, what: str, trial: str | Trial) -> tuple[Share, Trial]:
        share = self.budget.test(f"{self.prefix}{what} {trial if isinstance(trial, str) else trial.name}")
        return share, trials.make(trial, share.child(0)) if isinstance(trial, str) else trial


def _named(claim: Claim, values: Array) -> list[str]:
    """The first value that no correct estimator gives, as what it is."""
    wrong = values[~((values >= claim.low) & (values <= claim.high))]
    if not len(wrong):
        return []
    kind = "nan" if not np.isfinite(wrong[0]) else "negative" if claim.low == 0.0 and wrong[0] < 0.0 else "bound"
    return [f"{claim.name}: {KINDS[kind]}: {wrong[0]:.6g}, expected [{claim.low:.6g}, {claim.high:.6g}]"]


def _equal_means(share: Share, high_x: Array, high_y: Array, delta: Array) -> list[Claim]:
    """E X = E Y in each channel, X in [0, high_x] and Y in [0, high_y], claimed of X - Y."""
    return [
        Claim(f"{share.name}, {channel}", 0.0, -high_y[c], high_x[c], delta[c], 0.0, share.alpha / 3.0)
        for c, channel in enumerate(CHANNELS)
    ]


def _same_variance(name: str, x: Draw, y: Draw, bound: float, tolerance: float, alpha: float) -> Verdict:
    return variance_ratio_is(name, x, y, 1.0, high_x=bound, high_y=bound, tolerance=tolerance, alpha=alpha)


def _name(shade: Shade) -> str:
    return shade if isinstance(shade, str) else getattr(shade, "__name__", "shade")


__all__ = ["Answer", "Examiner", "Report", "UserError"]
