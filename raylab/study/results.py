"""Study: what was measured, and what follows from it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab.scene import Scene
from raylab.stats import convergence, efficiency
from raylab.stats import intervals as st
from raylab.stats.convergence import Slope
from raylab.stats.intervals import Estimate
from raylab.study.truth import Truth

Array = npt.NDArray[np.float64]
DEARER = 1.5  # cost of a sample in the shortest renders over that in the longest, from which on it is said
DISAGREES = 5.0  # standard errors between an estimator's mean and the truth from which on it is said


@dataclass(frozen=True)
class Estimator:
    """A shade, by name or a function, with a sampler."""

    shade: str | Callable[..., Any]
    sampler: str

    @property
    def name(self) -> str:
        return self.shade if isinstance(self.shade, str) else getattr(self.shade, "__name__", "shade")

    @property
    def label(self) -> str:
        return f"{self.name}, {self.sampler}"


@dataclass
class Row:
    """One render; the fields are the columns of measurements.csv, explained in COLUMNS."""

    estimator: str
    shade: str
    sampler: str
    spp: int
    repeat: int
    place: int
    seed: int
    seconds: float
    squared_error: float
    deviation: float
    mean_r: float
    mean_g: float
    mean_b: float
    camera_rays: int
    shadow_rays: int
    invalid_samples: int


COLUMNS = {
    "estimator": "shade and sampler",
    "shade": "the slide's function",
    "sampler": "where its random points come from",
    "spp": "samples per pixel",
    "repeat": "number of the block, from 0; a block renders every estimator once",
    "place": "place within the block, from 0; the order is reversed in every other block",
    "seed": "seed of this render, derived from the study's seed",
    "seconds": "wall time of the render, s, without loading and compiling",
    "squared_error": "mean squared difference to the truth, radiance^2; the reference's own error is still in it",
    "deviation": "mean squared difference to the mean of all repeats, times R / (R - 1); its mean is the variance",
    "mean_r": "mean of the image, red, W/(m^2 sr)",
    "mean_g": "the same, green",
    "mean_b": "the same, blue",
    "camera_rays": "eye rays traced",
    "shadow_rays": "shadow rays traced",
    "invalid_samples": "samples that were not finite and left out",
}


@dataclass(frozen=True)
class Level:
    """One estimator at one number of samples: variance, RMSE and seconds with their intervals."""

    estimator: Estimator
    spp: int
    repeats: int
    variance: Estimate
    rmse: Estimate
    seconds: Estimate
    timings: Array


@dataclass(eq=False)
class Study:
    """The measurements of a study; `complete` is False after Ctrl-C."""

    scene: Scene
    estimators: list[Estimator]
    levels: list[int]
    repeats: int
    seed: int
    threads: int
    truth: Truth | None = None
    rows: list[Row] = field(default_factory=list)
    compile_seconds: dict[Estimator, float] = field(default_factory=dict)
    crowding: dict[tuple[Estimator, int], str] = field(default_factory=dict)
    infinite: dict[Estimator, str] = field(default_factory=dict)  # why it has no variance; empty if it has one
    reference_doubt: str = ""
    complete: bool = True

    @classmethod
    def empty(
        cls, scene: Scene, estimators: list[Estimator], levels: list[int], repeats: int, seed: int, threads: int
    ) -> Study:
        return cls(scene, estimators, levels, repeats, seed, threads)

    @cached_property
    def measured(self) -> dict[Estimator, list[Level]]:
        """The levels of each estimator that have at least two repeats; ask when the study is over."""
        return {e: [level for n in self.levels if (level := self._level(e, n))] for e in self.estimators}

    def _level(self, e: Estimator, n: int) -> Level | None:
        rows = [row for row in self.rows if row.estimator == e.label and row.spp == n]
        if len(rows) < 2 or self.truth is None:
            return None
        timings = np.array([row.seconds for row in rows])
        variance = st.mean_interval(np.array([row.deviation for row in rows]))
        error = st.mean_interval(
            np.array([row.squared_error for row in rows]), self.truth.variance, self.truth.variance_error
        )
        if crowd := self.crowding.get((e, n), ""):
            variance = Estimate(variance.value, variance.low, variance.high, (*variance.doubts, crowd))
            error = Estimate(error.value, error.low, error.high, (*error.doubts, crowd))
        if infinite := self.infinite.get(e, ""):
            variance, error = (Estimate(v.value, 0.0, math.inf, (infinite,)) for v in (variance, error))
        return Level(e, n, len(rows), variance, error.map(0.5), st.median_interval(timings), timings)

    def variance_slope(self, e: Estimator) -> Slope | None:
        """d log variance / d log samples."""
        levels = self.measured[e]
        return convergence.fit([v.spp for v in levels], [v.variance for v in levels], self.repeats)

    def rmse_slope(self, e: Estimator) -> Slope | None:
        """d log RMSE / d log seconds."""
        levels = self.measured[e]
        return convergence.fit([v.seconds.value for v in levels], [v.rmse for v in levels], self.repeats)

    @property
    def common_level(self) -> int | None:
        """The largest number of samples that every estimator was measured at."""
        common = [n for n in self.levels if all(any(v.spp == n for v in vs) for vs in self.measured.values())]
        return common[-1] if common else None

    def _at_common(self, e: Estimator) -> Level:
        return next(level for level in self.measured[e] if level.spp == self.common_level)

    def efficiency(self, e: Estimator) -> Estimate:
        """1 / (variance x median time) at the common level, 1/(radiance^2 s)."""
        level = self._at_common(e)
        return efficiency.efficiency(level.variance, level.timings)

    def relative_efficiency(self, e: Estimator) -> Estimate:
        """Efficiency over that of the first estimator, times compared within each block."""
        level, first = self._at_common(e), self._at_common(self.estimators[0])
        return efficiency.efficiency_ratio(level.variance, level.timings, first.variance, first.timings)

    def notes(self) -> list[str]:
        """Everything that a reader must know before trusting a number."""
        notes = [] if self.complete else ["Stopped by Ctrl-C: only what was measured until then is shown."]
        if self.reference_doubt:
            notes.append(f"The reference has no known error, and is no truth: {self.reference_doubt}.")
        for e, levels in self.measured.items():
            if infinite := self.infinite.get(e, ""):
                notes.append(f"{e.label}: {infinite}.")
                continue
            doubts: dict[str, list[int]] = {}
            for level in levels:
                for doubt in dict.fromkeys((*level.variance.doubts, *level.rmse.doubts, *level.seconds.doubts)):
                    doubts.setdefault(doubt, []).append(level.spp)
            notes += [f"{e.label}: {d}, at {', '.join(map(str, at))} samples per pixel; do not lean on the interval."
                      for d, at in doubts.items()]  # fmt: skip
            notes += _fixed_costs(levels)
            for what, slope in (("variance", self.variance_slope(e)), ("RMSE", self.rmse_slope(e))):
                notes += [f"{e.label}, slope of the {what}: {d}." for d in (slope.doubts if slope else ())]
        invalid = sum(row.invalid_samples for row in self.rows)
        if invalid:
            notes.append(f"{invalid} samples were not finite and were left out, which may hide a bias.")
        return notes + self.disagreements()

    def disagreements(self) -> list[str]:
        """Estimators whose mean is further from the truth than chance allows: one of the two is wrong."""
        notes = []
        for e, levels in self.measured.items():
            rows = [row for row in self.rows if levels and row.estimator == e.label and row.spp == levels[-1].spp]
            if self.truth is None or len(rows) < st.FEW or self.infinite.get(e) or self.reference_doubt:
                continue
            means = np.array([(row.mean_r, row.mean_g, row.mean_b) for row in rows])
            truth, error = self.truth.value, self.truth.standard_error
            if self.truth.of_pixels:
                truth, error = truth.mean(axis=(0, 1)), np.sqrt((error**2).sum(axis=(0, 1))) / truth[..., 0].size
            spread = np.hypot(means.std(axis=0, ddof=1) / np.sqrt(len(means)), error)
            off = np.abs(means.mean(axis=0) - truth)
            worst = float(np.max(off / np.maximum(spread, 1e-12 * np.abs(truth) + 1e-300)))
            if worst > DISAGREES:
                notes.append(
                    f"{e.label}: its mean is {worst:.0f} standard errors away from the truth; one of them is wrong."
                )
        return notes

    def summary(self) -> str:
        """A few lines for the terminal."""
        lines = [f"Truth: {self.truth.source}." if self.truth else "Nothing was measured."]
        for e in self.estimators if self.common_level else ():
            ratio, level = self.relative_efficiency(e), self._at_common(e)
            known = f"{ratio.low:.3g} to {ratio.high:.3g}" if math.isfinite(ratio.high) else "interval not trusted"
            lines.append(
                f"{e.label}: RMSE {level.rmse.value:.3g} at {level.spp} samples in {level.seconds.value:.3g} s; "
                f"efficiency {ratio.value:.3g} times ({known}) that of the first"
            )
        return "\n".join([*lines, *self.notes()])

    def write(self, folder: str | Path) -> Path:
        """Write measurements.csv, summary.csv, columns.txt, the plots (PNG, SVG) and index.html; returns the page."""
        from raylab.study.page import write

        return write(self, Path(folder))


def _fixed_costs(levels: list[Level]) -> list[str]:
    """A note when the shortest renders cost much more per sample than the longest."""
    if len(levels) < 2 or levels[0].seconds.value / levels[0].spp < DEARER * levels[-1].seconds.value / levels[-1].spp:
        return []
    return [
        f"{levels[0].estimator.label}: renders of {levels[0].spp} samples are so short that fixed costs show in "
        "their time, which makes the slope over time steeper; a larger picture mends that."
    ]
