"""The demo: the lecture's pictures and its central plot, in a few minutes, on one page."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import raylab
from raylab.atomic import replacing
from raylab.demo import pictures
from raylab.demo.exhibits import EXHIBITS, Change, Exhibit, Experiment, Picture
from raylab.errors import UserError
from raylab.image import Image
from raylab.progress import StepBar
from raylab.render import default_threads
from raylab.scene import Scene
from raylab.study import Study, study
from raylab.study.look import data_uri
from raylab.study.page import fill
from raylab.study.plots import draw, label_of
from raylab.study.words import machine, readable, with_error

REFERENCE_SPP = 128  # with Sobol' points and the default shade


@dataclass
class Shown:
    """An exhibit with what was rendered for it so far."""

    exhibit: Exhibit
    pictures: list[dict[str, str]] = field(default_factory=list)
    plots: list[dict[str, str]] = field(default_factory=list)
    sentences: list[str] = field(default_factory=list)


@dataclass
class Demo:
    """A run of the demo: where it reads and writes, and its clock."""

    folder: Path
    scenes: Path
    threads: int
    start: float = field(default_factory=time.perf_counter)
    shown: list[Shown] = field(default_factory=list)

    def say(self, sentence: str) -> None:
        print(f"{time.perf_counter() - self.start:5.0f} s  {sentence}", flush=True)


def demo(
    folder: str | Path = "demo",
    scenes: str | Path = "reference_scenes",
    threads: int | None = None,
    exhibits: Sequence[Exhibit] = EXHIBITS,
) -> bool:
    """Render all exhibits into `folder`/index.html; False if it was stopped by Ctrl-C, which keeps what is done.

    Raises UserError if there is no folder of scenes.
    """
    run = Demo(Path(folder), Path(scenes), threads or default_threads())
    if not run.scenes.is_dir():
        raise UserError(f'the demo needs the reference scenes, but there is no folder "{run.scenes}"')
    (run.folder / "pictures").mkdir(parents=True, exist_ok=True)
    complete = True
    try:
        for exhibit in exhibits:
            run.shown.append(Shown(exhibit))
            _show(run, run.shown[-1])
            _write(run, complete)
    except KeyboardInterrupt:
        complete = False
        run.say("Stopped by Ctrl-C; what is done is kept.")
    page = _write(run, complete)
    run.say(f"Done: open {page}")
    return complete


def _show(run: Demo, shown: Shown) -> None:
    exhibit = shown.exhibit
    here = [p for p in exhibit.pictures if (run.scenes / p.scene / "scene.xml").is_file()]
    missing = sorted({p.scene for p in exhibit.pictures} - {p.scene for p in here})
    run.say(f"{exhibit.slide}: {exhibit.title}" + (f" (skipped, not there: {', '.join(missing)})" if missing else ""))
    reference = _reference(run, exhibit, here[0]) if exhibit.compared and here else None
    for p in here:
        image, load = _render(run, exhibit, p.scene, p.parameters, p.shade, p.sampler, p.spp, p.title)
        shown.pictures.append(_entry(run, len(run.shown), len(shown.pictures), p, image, reference, load))
        if not image.complete:
            raise KeyboardInterrupt
    if exhibit.experiment and not missing:
        _experiment(run, shown, exhibit.experiment)


def _load(run: Demo, change: Change | None, name: str, parameters: Sequence[tuple[str, Any]]) -> Scene:
    scene = raylab.load(run.scenes / name / "scene.xml", dict(parameters))
    return Scene(change(scene.description)) if change else scene


def _render(
    run: Demo,
    exhibit: Exhibit,
    name: str,
    parameters: Sequence[tuple[str, Any]],
    shade: str,
    sampler: str,
    spp: int,
    title: str,
) -> tuple[Image, Scene]:
    scene = _load(run, exhibit.change, name, parameters)
    image = raylab.render(scene, shade, sampler=sampler, spp=spp, threads=run.threads)
    seconds = image.report["seconds"]
    run.say(
        f"  {title}: {name}, {shade}, {sampler}, {spp} samples, "
        f"{seconds['render']:.2f} s (and {seconds['compile']:.1f} s to compile)"
    )
    return image, scene


def _reference(run: Demo, exhibit: Exhibit, p: Picture) -> Image:
    image, _ = _render(run, exhibit, p.scene, p.parameters, "direct", "sobol", REFERENCE_SPP, "reference")
    if not image.complete:
        raise KeyboardInterrupt
    return image


def _entry(
    run: Demo, part: int, place: int, p: Picture, image: Image, reference: Image | None, scene: Scene
) -> dict[str, str]:
    """A picture as the page shows it: files, title and what it cost."""
    stem = f"{part}_{place + 1}_{p.scene}_{p.shade}_{p.sampler}"
    taken = image.report["rays"]["camera"] / image.samples.size
    facts = [
        f"{taken:g} sample{'s' if taken != 1 else ''} a pixel in {image.report['seconds']['render']:.2f} s",
        f"mean {_with_error(image)}",
    ]
    entry = {
        "title": p.title,
        "code": f"{'' if p.shade == 'direct' else 'shade.'}{p.shade}, {p.sampler}, {p.scene}",
        "image": pictures.picture(image, run.folder / "pictures" / f"{stem}.png"),
        "map": "",
    }
    if reference is not None:
        facts.append(f"RMSE {pictures.rmse(image, reference):.2g}")
        entry["map"] = pictures.error_map(image, reference.mean, run.folder / "pictures" / f"{stem}_error.png")
    if image.invalid_samples:
        facts.append(f"{image.invalid_samples} invalid samples left out")
    return {**entry, "facts": "; ".join(facts)}


def _with_error(image: Image) -> str:
    """Mean radiance over pixels and channels; the channels share their noise, so their errors are averaged."""
    mean, error = float(image.image_mean.mean()), float(image.image_standard_error.mean())
    return with_error(mean, error)


def _experiment(run: Demo, shown: Shown, e: Experiment) -> None:
    scene = _load(run, e.change or shown.exhibit.change, e.scene, e.parameters)
    run.say(f"  error against run time: {e.repeats} repeats of {', '.join(map(str, e.spp))} samples")
    with StepBar("study") as step:
        result = study(
            scene, e.shades, samplers=e.samplers, spp=e.spp, repeats=e.repeats, threads=run.threads, progress=step
        )
    name = f"study_{e.scene}"
    result.write(run.folder / name)
    if result.common_level:
        shown.plots.append(
            {"image": data_uri(draw(result, "error_time")[1], "svg+xml"), "caption": _caption(result, name)}
        )
        shown.sentences += _findings(result)
    if not result.complete:
        raise KeyboardInterrupt


def _caption(result: Study, name: str) -> str:
    camera = result.scene.description.camera
    return (
        f"The lecture's central plot: root mean square error against run time, {camera.width} by {camera.height} "
        f"pixels, {result.repeats} repeats, bands of 95 %. Down and to the left is better. "
        f"Tables and more plots: {name}/index.html."
    )


def _findings(result: Study) -> list[str]:
    """How much more efficient than the first estimator the others are, and what to doubt."""
    first = label_of(result, result.estimators[0])
    sentences = []
    for e in result.estimators[1:]:
        ratio = result.relative_efficiency(e)
        doubt = "; the interval is not trustworthy: " + ", ".join(ratio.doubts) if ratio.doubts else ""
        sentences.append(
            f"{label_of(result, e)} is {readable(ratio.value)} times as efficient as {first} "
            f"at {result.common_level} samples (95 %: {readable(ratio.low, 2)} to {readable(ratio.high, 2)}{doubt})."
        )
    return sentences


def _write(run: Demo, complete: bool) -> Path:
    page = run.folder / "index.html"
    values: dict[str, Any] = {
        "parts": [s for s in run.shown if s.pictures or s.plots],
        "complete": complete,
        "seconds": f"{time.perf_counter() - run.start:.0f}",
        "machine": machine(),
        "threads": run.threads,
        "scale": pictures.scale(run.folder / "pictures" / "scale.png"),
        "version": raylab.__version__,
        "reference_spp": REFERENCE_SPP,
    }
    with replacing(page) as beside:
        beside.write_text(fill(Path(__file__).parent / "page.html", **values), encoding="utf-8")
    return page
