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
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import trials
from raylab.errors import UserError
from raylab.stats.betting import PILOT, Claim, Test
from raylab.stats.budget import Budget, Share
from raylab.stats.claims import LARGEST_BLOCK, shrinks_as, uncorrelated, variance_is
from raylab.stats.verdict import Outcome, Verdict
from raylab.trials import Answer, Trial

Array = npt.NDArray[np.float64]
Shade = str | Callable[..., Any]
Draw = Callable[[int], Array]
CHANNELS = ("red", "green", "blue")
CAP = 8  # times what a true claim needs on average


@dataclass(frozen=True)
class Report:
    """What a test found: a verdict for each channel, the sum of their samples, the time, and how to repeat it."""

    name: str
    verdicts: tuple[Verdict, ...]
    samples: int
    seconds: float
    token: str
    reason: str = ""

    @property
    def outcome(self) -> Outcome:
        """The worst of the verdicts: FAIL before INCONCLUSIVE before PASS."""
        outcomes = {verdict.outcome for verdict in self.verdicts}
        return next(o for o in ("FAIL", "INCONCLUSIVE", "PASS") if o in outcomes)  # type: ignore[return-value]

    @property
    def detectable(self) -> float:
        """The smallest bias, as a share of the truth, that would have been seen in every channel."""
        relative = [v.detectable / abs(v.truth) if v.truth else float("nan") for v in self.verdicts]
        return max(relative, default=float("nan"))

    def __str__(self) -> str:
        lines = [f"{self.outcome}  {self.name}: {self.samples} samples, {self.seconds:.2g} s, replay {self.token}"]
        lines += [f"  {self.reason}"] if self.reason else []
        return "\n".join(lines + [f"  {verdict}" for verdict in self.verdicts])


@dataclass
class Examiner:
    """Makes tests that share one budget of false alarms."""

    budget: Budget = field(default_factory=Budget)
    threads: int = 0

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
        claims = [
            Claim(f"{share.name}, {channel}", 0.0, -y.bound[c], x.bound[c], delta * y.truth[c], 0.0, share.alpha / 3.0)
            for c, channel in enumerate(CHANNELS)
        ]
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

    def decide(self, name: str, claims: Sequence[Claim], draw: Draw) -> Report:
        """Decide a claim for each column of what `draw(n) -> (n, k)` gives, all of them from the same samples.

        A value that is not a finite number decides against; so does one outside its range.
        """
        start, tests = time.perf_counter(), [Test(claim) for claim in claims]
        values = draw(PILOT)
        caps = [self._cap(claim, values[:, c]) for c, claim in enumerate(claims)]
        while True:
            for c, test in enumerate(tests):
                test.update(values[:, c])
            taken = tests[0].samples if len(tests) == 1 else max(test.samples for test in tests)
            open_ = [t.outcome == "INCONCLUSIVE" and t.samples < cap for t, cap in zip(tests, caps, strict=True)]
            if not any(open_) or any(t.outcome == "FAIL" for t in tests):
                break
            values = draw(min(max(64, taken // 4), LARGEST_BLOCK))
        seconds = time.perf_counter() - start
        return Report(name, tuple(test.verdict(seconds) for test in tests), taken, seconds, self.budget.token)

    @staticmethod
    def _cap(claim: Claim, pilot: Array) -> int:
        finite = pilot[np.isfinite(pilot)]
        spread = float(finite.std()) if len(finite) else 0.0
        needed = max(23.0 * (spread / claim.delta) ** 2, 8.0 * (claim.high - claim.low) / claim.delta, 4.0 * PILOT)
        return int(CAP * needed)

    def _prepare(self, what: str, trial: str | Trial) -> tuple[Share, Trial]:
        share = self.budget.test(f"{what} {trial if isinstance(trial, str) else trial.name}")
        return share, trials.make(trial, share.child(0)) if isinstance(trial, str) else trial


def _same_variance(name: str, x: Draw, y: Draw, bound: float, tolerance: float, alpha: float) -> Verdict:
    from raylab.stats.claims import variance_ratio_is

    return variance_ratio_is(name, x, y, 1.0, high_x=bound, high_y=bound, tolerance=tolerance, alpha=alpha)


def _name(shade: Shade) -> str:
    return shade if isinstance(shade, str) else getattr(shade, "__name__", "shade")


__all__ = ["Answer", "Examiner", "Report", "UserError"]
