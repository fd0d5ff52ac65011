"""The page of a study: one HTML file that needs no other, with the tables and plots beside it."""

from __future__ import annotations

import platform
from pathlib import Path
from typing import Any

from raylab.atomic import replacing
from raylab.errors import UserError
from raylab.study import table
from raylab.study.look import MINUS, TIMES, data_uri
from raylab.study.plots import PLOTS, draw
from raylab.study.results import COLUMNS, Level, Study
from raylab.study.words import machine, number, slope

HERE = Path(__file__).parent
CAPTIONS = {
    "variance_samples": "Variance over independent repeats, against samples per pixel. Bands are 95 % intervals; "
    f"dashed lines show the slope of independent samples ({MINUS}1) and of ideal, smooth stratification ({MINUS}2).",
    "error_time": "Root mean square error against the median time of a render. Down and to the left is better: the "
    "horizontal gap between two lines is how much longer one takes for the same error.",
    "efficiency": f"Efficiency, 1 / (variance {TIMES} time), relative to the first estimator, with 95 % intervals.",
}


def write(study: Study, folder: Path) -> Path:
    """Write everything about `study` into `folder`; returns the path of index.html."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f'cannot make the folder "{folder}": {error.strerror}') from None
    table.write(study, folder)
    plots = []
    for name in PLOTS if study.common_level else ():
        as_png, as_svg = draw(study, name)
        for suffix, content in ((".png", as_png), (".svg", as_svg)):
            with replacing(folder / f"{name}{suffix}") as beside:
                beside.write_bytes(content)
        plots.append({"image": data_uri(as_svg, "svg+xml"), "caption": CAPTIONS[name]})
    page = folder / "index.html"
    with replacing(page) as beside:
        beside.write_text(html(study, plots), encoding="utf-8")
    return page


def html(study: Study, plots: list[dict[str, str]]) -> str:
    """The text of the page."""
    camera, path = study.scene.description.camera, study.scene.description.path
    scene = path.parent.name if path and path.stem == "scene" else study.scene.description.name
    return fill(
        HERE / "page.html",
        title=f"Error against run time: {scene}",
        lead=f"{len(study.estimators)} estimators, {study.repeats} independent repeats, "
        f"{camera.width} {TIMES} {camera.height} pixels.",
        notes=study.notes(),
        plots=plots,
        estimators=[_estimator_row(study, e) for e in study.estimators] if study.common_level else [],
        levels=[_level_row(level) for levels in study.measured.values() for level in levels],
        method=method(study),
        columns=COLUMNS,
    )


def fill(template: Path, **values: Any) -> str:
    """A template of the package with `values`, escaped; `style` is the project's style sheet."""
    import jinja2

    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, keep_trailing_newline=True)
    # The style sheet is the package's own file; nothing in it comes from a user.
    style = jinja2.filters.Markup((HERE / "page.css").read_text(encoding="utf-8"))
    return environment.from_string(template.read_text(encoding="utf-8")).render(style=style, **values)


def method(study: Study) -> list[str]:
    """How everything was measured, sentence by sentence."""
    from importlib.metadata import version

    truth = f"Truth: {study.truth.source}." if study.truth else "No truth."
    if study.truth and study.truth.variance > 0.0:
        truth += (
            f" Its own root mean square error, {study.truth.variance**0.5:.3g}, is taken out of the RMSE (its square "
            "out of the mean squared error), and how well it is known is part of the intervals."
        )
    threads = f"{study.threads} thread{'s' if study.threads > 1 else ''}"
    return [
        truth,
        "RMSE: root of the mean over pixels and channels (of the image mean where the truth is a closed form), and "
        "over the repeats, of the squared difference to the truth. Variance: across the repeats, unbiased, averaged "
        "the same way; it needs no truth and is honest also for Sobol' points, whose samples depend on one another.",
        "Intervals: 95 %, log-t over the repeats (log value ± t times the standard error of the log). On normal data "
        "with 20 repeats they held the truth in 92 % (single numbers) to 95 % (pictures) of 4000 trials. Median times: "
        "exact intervals from order statistics. Efficiency: the errors of variance and median time (bootstrap), added.",
        "Slopes: weighted least squares in log-log; where the points scatter about the line by more than their "
        "errors, the interval is widened by as much.",
        f"Efficiency is taken at {study.common_level} samples per pixel; the ratio compares times block by block.",
        f"Time: wall time of a render on {threads}, without loading and compiling (the column “compiled in”; a kernel "
        "from the cache takes a fraction of a second). The estimators are interleaved, in reversed order in every "
        "other block (ABBA); a time is the median over the repeats.",
        f"Seed {study.seed}: every render has its own seed, listed in measurements.csv.",
        f"Machine: {machine()}; Python {platform.python_version()}, numpy {version('numpy')}, "
        f"numba {version('numba')}.",
    ]


def _estimator_row(study: Study, e: Any) -> dict[str, str]:
    return {
        "label": e.label,
        "variance_slope": slope(study.variance_slope(e)),
        "rmse_slope": slope(study.rmse_slope(e)),
        "efficiency": number(study.efficiency(e)),
        "relative": "1" if e == study.estimators[0] else number(study.relative_efficiency(e)),
        "compiled": f"{study.compile_seconds[e]:.2f} s",
    }


def _level_row(level: Level) -> dict[str, Any]:
    return {
        "label": level.estimator.label,
        "spp": level.spp,
        "repeats": level.repeats,
        "variance": number(level.variance),
        "rmse": number(level.rmse),
        "seconds": number(level.seconds),
    }
