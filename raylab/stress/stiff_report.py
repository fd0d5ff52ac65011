"""Stiff report: error against run time of each strategy on the stiff scenes, by `raylab.study`, as docs/stiff.md."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill

import numpy as np

from raylab.atomic import replacing
from raylab.errors import UserError
from raylab.render import render
from raylab.scene import Scene
from raylab.stats.convergence import Slope, fit
from raylab.stats.intervals import median_interval
from raylab.stress.stiff_scenes import TABLE, Stiff
from raylab.study import Study, study, words
from raylab.study.results import Estimator
from raylab.study.truth import compute

COMMAND = "raylab stiff -o stiff --markdown docs/stiff.md"
SEED, SHARPER, COVER, INTERVALS, NORMAL = 6, 16, 64, 4096, 1.96
HEADS = (
    "strategy", "error (RMSE) at the most samples", "in", "slope of the error over N", "95 % intervals that hold",
    "efficiency", "variance",
)  # fmt: skip
INTRODUCTION = f"""# Where the estimator itself is stiff

Made by `{COMMAND}`. Each scene is a small picture in which one
strategy, the first line of its table, is stiff; the others are the cures. They are measured by `raylab study`
(12 repeats, 64 where the picture is one pixel; one thread, strategies in turns; its page for each scene is in the
folder), against a reference rendered by the last of them with {SHARPER} times as many Sobol' points as the most.

- **slope**: d log RMSE / d log N with its 95 % interval; -1/2 where there is a variance. Without one it is that of the
  median error of the repeats. (Over the run time: the plot.)
- **intervals that hold**: of {INTERVALS} intervals mean ± {NORMAL} standard errors of pixels with {COVER} independent
  samples, how many hold the truth. What is stiff, holds less, without a word.
- **efficiency**: 1 / (variance x time) over that of the first line, with its 95 % interval.
- **variance**: what `raylab study` says of it.

The variances in closed form are those that section S of [stability](stability.md) checks.

![error against run time](stiff/error_time.png)

"""


@dataclass(frozen=True)
class Measured:
    """A stiff scene, its study, and the share of intervals that hold for each estimator of independent samples."""

    stiff: Stiff
    study: Study
    coverage: dict[Estimator, float]


def chosen(names: Sequence[str]) -> list[Stiff]:
    """The scenes of these ids, all by default; UserError for an id that there is not."""
    for name in names:
        if all(name != stiff.id for stiff in TABLE):
            raise UserError(f"no stiff scene is called {name!r}; expected one of {'; '.join(s.id for s in TABLE)}")
    return [stiff for stiff in TABLE if not names or stiff.id in names]


def measure(wanted: Sequence[Stiff], progress: Callable[[int, int, str], None]) -> Iterator[Measured]:
    """Study after study; the last one is not complete after Ctrl-C."""
    for stiff in wanted:
        step = lambda done, total, what, id=stiff.id: progress(done, total, f"{id}: {what}")  # noqa: E731
        scene = Scene(stiff.make())
        step(0, 1, "reference")
        truth = compute(scene, stiff.shades[-1], SHARPER * max(stiff.spp), SEED, None)
        found = study(
            scene, stiff.shades, samplers=stiff.samplers, spp=stiff.spp, repeats=stiff.repeats, seed=SEED,
            threads=1, truth=truth, progress=step,
        )  # fmt: skip
        covered = {e: coverage(found, e) for e in found.estimators if e.sampler == "independent"}
        yield Measured(stiff, found, covered if found.complete else {})
        if not found.complete:
            return


def coverage(found: Study, e: Estimator) -> float:
    """The share of the pixels' intervals that hold the truth, whose own error counts; a black pixel is known."""
    assert found.truth is not None
    held, pixels = [], found.truth.value[..., 0].size
    for number in range(max(1, INTERVALS // pixels)):
        image = render(found.scene, e.shade, sampler=e.sampler, spp=COVER, seed=1000 + number, threads=1)
        error = np.hypot(image.standard_error, found.truth.standard_error)
        held.append(np.abs(image.mean - found.truth.value) <= NORMAL * error)
    return float(np.mean(held))


def slope(found: Study, e: Estimator) -> Slope | None:
    """d log error / d log samples: of the RMSE; without a variance of the median over the repeats, whose interval by
    order statistics needs none."""
    errors = [level.rmse for level in found.measured[e]]
    if found.infinite.get(e):
        rows = [
            [r.squared_error**0.5 for r in found.rows if (r.estimator, r.spp) == (e.label, n)] for n in found.levels
        ]
        errors = [median_interval(np.array(some)) for some in rows]
    return fit([float(n) for n in found.levels], errors, found.repeats)


def markdown(rows: Sequence[Measured]) -> str:
    """The page for docs/."""
    parts = [INTRODUCTION]
    for row in rows:
        parts += [f"## {row.stiff.id}: {row.stiff.title}\n", row.stiff.theory + "\n"]
        parts += ["| " + " | ".join(HEADS) + " |", "|---" * len(HEADS) + "|"]
        parts += ["| " + " | ".join(cells(row, e)) + " |" for e in row.study.estimators]
        parts.append("")
    parts += [f"{words.machine()}.", ""]
    return "\n".join(parts)


def cells(row: Measured, e: Estimator) -> list[str]:
    """A line of a table."""
    found, last = row.study, row.study.measured[e][-1]
    held, first = row.coverage.get(e), e == found.estimators[0]
    name = f"`{e.name}`" if len({o.sampler for o in found.estimators}) == 1 else f"`{e.name}`, {e.sampler}"
    milliseconds = f"{words.readable(1e3 * last.seconds.value, 2)} ms"
    return [
        name, words.number(last.rmse), milliseconds, words.slope(slope(found, e)),
        "" if held is None else f"{100.0 * held:.1f} %", "1" if first else words.number(found.relative_efficiency(e)),
        found.infinite.get(e, "") or "finite",
    ]  # fmt: skip


def plot(rows: Sequence[Measured], path: Path) -> None:
    """Error against run time of all scenes."""
    from raylab.figures import panels
    from raylab.study.plots import error_time

    across = min(3, len(rows))
    down = math.ceil(len(rows) / across)
    with panels.plots(path, down, across, 11.0 * across, 6.2 * down) as axes:
        for row, part in zip(rows, axes, strict=False):
            error_time(row.study, part)
            part.set(title=fill(f"{row.stiff.id}: {row.stiff.title}", 56), ylabel="RMSE")
        for part in axes[len(rows) :]:
            part.set_axis_off()


def write(rows: Sequence[Measured], folder: Path, page: Path | None) -> None:
    """The plot and, where it is asked for, the page with its own."""
    folder.mkdir(parents=True, exist_ok=True)
    plot(rows, folder / "error_time.png")
    if page:
        own = page.with_suffix("") / "error_time.png"
        own.parent.mkdir(parents=True, exist_ok=True)
        own.write_bytes((folder / "error_time.png").read_bytes())
        with replacing(page) as beside:
            beside.write_text(markdown(rows), encoding="utf-8")
