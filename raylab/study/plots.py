"""The plots of a study: variance against samples, RMSE against seconds, efficiency."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from raylab.stats.convergence import Slope
from raylab.stats.intervals import Estimate
from raylab.study.look import (
    COLOURS,
    GREY,
    LINES,
    MARKERS,
    MINUS,
    TIMES,
    figure,
    label_lines,
    plain_ticks,
    png,
    reference_line,
    svg,
)
from raylab.study.results import Estimator, Level, Study
from raylab.study.words import readable

PLOTS = ("variance_samples", "error_time", "efficiency")


def draw(study: Study, name: str) -> tuple[bytes, bytes]:
    """(PNG, SVG) of one of PLOTS."""
    drawing = {"variance_samples": variance_samples, "error_time": error_time, "efficiency": efficiency}[name]
    with figure() as (drawn, axes):
        drawing(study, axes)
        return png(drawn), svg(drawn)


def variance_samples(study: Study, axes: Any) -> None:
    """Variance against samples per pixel, with 95 % bands; independent samples fall like 1/n."""
    _curves(study, axes, lambda level: (level.spp, level.variance), study.variance_slope)
    _references(study, axes, lambda level: (level.spp, level.variance), -1.0, -2.0)
    plain_ticks(axes.yaxis)
    axes.set(title="Variance against samples", xlabel="samples per pixel", ylabel="variance, radiance$^2$")
    axes.set_xticks(study.levels, [str(n) for n in study.levels])
    axes.minorticks_on()
    axes.tick_params(axis="x", which="minor", labelbottom=False)


def error_time(study: Study, axes: Any) -> None:
    """RMSE against seconds, with 95 % bands; independent samples fall like 1/sqrt(t)."""
    _curves(study, axes, lambda level: (level.seconds.value, level.rmse), study.rmse_slope)
    _references(study, axes, lambda level: (level.seconds.value, level.rmse), -0.5, -1.0)
    plain_ticks(axes.xaxis)
    plain_ticks(axes.yaxis)
    what = "pixels" if study.truth and study.truth.of_pixels else "image mean"
    threads = "1 thread" if study.threads == 1 else f"{study.threads} threads"
    axes.set(title="Error against run time", xlabel=f"seconds on {threads}", ylabel=f"RMSE of the {what}, radiance")


def efficiency(study: Study, axes: Any) -> None:
    """How many times as efficient as the first estimator each one is, with 95 % intervals."""
    estimators = study.estimators if study.common_level else []
    ends = [1.0]
    for place, e in enumerate(estimators):
        ratio, colour = study.relative_efficiency(e), colour_of(study, e)
        if not np.isfinite(ratio.value):  # the variance of one of the two is zero
            continue
        low, high = max(ratio.low, 1e-2 * ratio.value), min(ratio.high, 1e2 * ratio.value)
        if place and np.isfinite(ratio.high):
            axes.plot([low, high], [place, place], color=colour, marker="|", markersize=18, markeredgewidth=3)
        axes.plot(ratio.value, place, color=colour, marker=MARKERS[e.sampler], markersize=13)
        text = f"{readable(ratio.value)}{TIMES}" + ("" if np.isfinite(ratio.high) else "  (interval not trusted)")
        axes.annotate(text, (ratio.value, place), (0, 14), textcoords="offset points", ha="center", color=colour)
        ends += [low, high] if place else []
    axes.axvline(1.0, color=GREY, linewidth=1.4, linestyle=(0, (6, 4)))
    axes.set_xscale("log")
    axes.set_xlim(min(ends) / 1.4, max(ends) * 1.4)
    plain_ticks(axes.xaxis)
    axes.set_yticks(range(len(estimators)), [label_of(study, e) for e in estimators])
    axes.set_ylim(len(estimators) - 0.4, -0.7)
    axes.grid(False, axis="y", which="both")
    at = f" at {study.common_level} samples per pixel" if study.common_level else ""
    first = label_of(study, study.estimators[0])
    axes.set(title=f"Efficiency{at}", xlabel=f"1 / (variance {TIMES} time), as a multiple of {first}")


def colour_of(study: Study, e: Estimator) -> str:
    """A colour for each shade; for each sampler when there is one shade only."""
    shades, samplers = _distinct(study)
    number = shades.index(e.name) if len(shades) > 1 else samplers.index(e.sampler)
    return COLOURS[number % len(COLOURS)]


def label_of(study: Study, e: Estimator) -> str:
    """What tells an estimator from the others of this study."""
    shades, samplers = _distinct(study)
    if len(shades) == 1 and len(samplers) > 1:
        return e.sampler
    return e.label if len(samplers) > 1 else e.name


def _distinct(study: Study) -> tuple[list[str], list[str]]:
    shades = list(dict.fromkeys(e.name for e in study.estimators))
    return shades, list(dict.fromkeys(e.sampler for e in study.estimators))


Point = Callable[[Level], tuple[float, Estimate]]


def _points(study: Study, e: Estimator, point: Point) -> tuple[list[float], list[Estimate]]:
    """The points of one line that a logarithmic axis can show."""
    both = [point(level) for level in study.measured[e]]
    return [x for x, y in both if y.value > 0.0], [y for _, y in both if y.value > 0.0]


def _curves(study: Study, axes: Any, point: Point, slope: Callable[[Estimator], Slope | None]) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    ends = []
    for e in study.estimators:
        x, y = _points(study, e, point)
        if not x:
            continue
        colour, value = colour_of(study, e), [v.value for v in y]
        known = [np.isfinite(v.high) for v in y]
        axes.fill_between(
            x, [v.low for v in y], [v.high for v in y], where=known, color=colour, alpha=0.18, linewidth=0
        )
        axes.plot(x, value, color=colour, linestyle=LINES[e.sampler], marker=MARKERS[e.sampler])
        fitted = slope(e)
        doubt = " ?" if fitted and fitted.doubts else ""
        text = label_of(study, e) + (f"  (slope {_minus(fitted.value)}{doubt})" if fitted else "")
        ends.append((x[-1], value[-1], text, colour))
    _limit(study, axes, point)
    if ends:
        label_lines(axes, ends)


def _limit(study: Study, axes: Any, point: Point) -> None:
    """Room around all points; bands of hardly known ones must not squeeze the lines, nor equal ones the axes."""
    both = [_points(study, e, point) for e in study.estimators]
    x, y = [v for xs, _ in both for v in xs], [v.value for _, ys in both for v in ys]
    if x:
        axes.set_xlim(min(x) / 1.35, max(x) * 1.35)
        axes.set_ylim(min(y) / 4.0, max(y) * 5.0)


def _references(study: Study, axes: Any, point: Point, usual: float, better: float) -> None:
    """Above the lines the slope of independent samples; below them that of ideal points, if a sampler may reach it."""
    ends = [(x[0], y[0].value, x[-1]) for e in study.estimators for x, y in [_points(study, e, point)] if len(x) > 1]
    if not ends:
        return
    left, right = min(x for x, _, _ in ends), max(x for _, _, x in ends)
    low, high = axes.get_ylim()
    reference_line(axes, usual, (left, 2.0 * max(y for _, y, _ in ends)), right, above=True)
    if any(e.sampler != "independent" for e in study.estimators):
        start = 0.5 * min(y for _, y, _ in ends)
        reference_line(
            axes, better, (left, start), min(right, left * (1.5 * low / start) ** (1.0 / better)), above=False
        )
    axes.set_ylim(low, high)


def _minus(value: float) -> str:
    return f"{value:.2f}".replace("-", MINUS) if np.isfinite(value) else "?"
