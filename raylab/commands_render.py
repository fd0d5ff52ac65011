"""The command raylab render: a slide's shade(), or a student's beside the reference."""

from __future__ import annotations

import json
import threading
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import click

import raylab
from raylab import commands_student
from raylab.explain import explain, measured
from raylab.image import Image
from raylab.options import INTERRUPTED, PARAMETERS, PROGRESS, SCENE, SEED, THREADS, load, parameter, say
from raylab.plan import Plan
from raylab.samplers import ALL_NAMES as SAMPLERS


@click.command("render")
@SCENE
@click.option(
    "--shade",
    default="direct",
    show_default=True,
    metavar="NAME|FILE",
    help="A slide's function, see `raylab shades SCENE`; or FILE.py, your own, shown beside the reference.",
)
@click.option("--task", default="", metavar="ID", help="The task that FILE answers, such as a4.brdf, if unclear.")
@click.option("--sampler", help=f"{', '.join(SAMPLERS)}; the scene's own by default.")
@click.option("--spp", type=int, help="Samples per pixel; the scene's own by default.")
@click.option("--seconds", type=float, help="Stop after this time instead.")
@click.option(
    "--relative-error", type=float, help="Stop at this noise instead: standard error of a pixel over the mean."
)
@SEED
@THREADS
@PARAMETERS
@click.option("-o", "outputs", metavar="FILE", type=click.Path(path_type=Path), multiple=True,
              help="Write .png, .exr or .npz; can be repeated.")  # fmt: skip
@click.option("--checkpoint", metavar="FILE", type=click.Path(path_type=Path, dir_okay=False),
              help="Keep what is done in FILE, and go on from it; removed when the picture is written.")  # fmt: skip
@click.option("--strict", is_flag=True, help="Stop at the first sample that is not finite, and say which it is.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of sentences.")
@click.option(
    "--explain", "explained", is_flag=True, help="Say what the compiled kernel contains and what was left out."
)
@PROGRESS
def render_command(
    scene: Path,
    shade: str,
    task: str,
    sampler: str | None,
    spp: int | None,
    seconds: float | None,
    relative_error: float | None,
    seed: int | None,
    threads: int | None,
    parameters: tuple[str, ...],
    outputs: tuple[Path, ...],
    checkpoint: Path | None,
    strict: bool,
    as_json: bool,
    explained: bool,
    progress: bool | None,
) -> int:
    """Render SCENE with a slide's shade(), or your own; Ctrl-C keeps what is done."""
    from raylab.io import picture
    from raylab.progress import Bar

    Plan.make(sampler or "", spp, seconds, relative_error)
    for path in outputs:
        picture.check(path)
    loaded, load_seconds = load(scene, parameters)
    own = commands_student.own_shade(shade, task, loaded, spp, say)
    if own and not outputs:
        outputs = (own.picture,)
    if any(path.suffix.lower() == ".png" for path in outputs):
        threading.Thread(target=_prepare_png, daemon=True).start()
    with Bar(progress, seconds, relative_error) as bar, own.explained() if own else nullcontext():
        image = raylab.render(
            own.scene if own else loaded, own.function if own else shade, sampler=sampler, spp=spp, seconds=seconds,
            relative_error=relative_error, seed=seed, threads=threads, progress=bar, checkpoint=checkpoint,
            strict=strict,
        )  # fmt: skip
    for path in outputs:
        if lost := picture.write(image, path):
            say(f"warning: {lost}")
    if checkpoint and image.complete:
        checkpoint.unlink(missing_ok=True)
    _warn_about(image)
    result = measured(loaded, image, own.name if own else shade, load_seconds)
    if explained:
        click.echo(explain(loaded, result["shade"], result["sampler"]), err=as_json)
    complete, said = image.complete, ""
    if own and complete:
        names = {name for name, _ in map(parameter, parameters)}
        with Bar(progress) as bar:
            complete, said = commands_student.compare(own, image, names, threads, bar, outputs[0], result)
    text = "\n".join(filter(None, (_summary(result, outputs), said)))
    click.echo(json.dumps(result, allow_nan=False) if as_json else text)
    return 0 if complete else INTERRUPTED


def _prepare_png() -> None:
    """The first .png needs colour-science, which takes long to import; meanwhile the picture is rendered."""
    from raylab.io.image_file import encode_srgb

    encode_srgb((0.0, 0.0, 0.0))


def _warn_about(image: Image) -> None:
    """Say what was left out, and how far off the picture can be by it."""
    said = {
        "invalid_samples": "samples were not finite and are left out",
        "invalid_rays": "rays were not finite and let no light through",
        "degenerate_samples": "points of lights were seen edge-on, up to rounding, and count as in shadow",
    }
    for name, words in said.items():
        if count := getattr(image, name):
            bound = 100.0 * image.bias_bounds[name]
            say(f"warning: {count} {words}: the picture is off by at most {bound:.2g} % of the brightest sample.")
    if not image.complete:
        done = int(image.samples.min()), int(image.samples.max())
        say(f"stopped by Ctrl-C; what is done is kept: {done[0]} to {done[1]} samples in each pixel.")


def _summary(result: dict[str, Any], outputs: tuple[Path, ...]) -> str:
    channels = zip(result["mean"], result["standard_error"], strict=True)
    mean = ", ".join("unknown" if m is None else f"{m:.6g} ± {'?' if e is None else f'{e:.2g}'}" for m, e in channels)
    seconds, rays = result["seconds"], sum(result["rays"].values())
    rate = rays / seconds["render"] / 1e6 if seconds["render"] else 0.0
    lines = [
        f"{result['width']} x {result['height']} pixels, {result['spp']:g} samples each, shade {result['shade']}, "
        f"sampler {result['sampler']}, seed {result['seed']}: {seconds['render']:.2f} s on {result['threads']} threads "
        f"({rate:.1f} million rays per second), after {seconds['load']:.2f} s to load and {seconds['compile']:.2f} s "
        "to compile.",
        f"Mean radiance (R, G, B) and its standard error: {mean}.",
    ]
    if outputs:
        lines.append(f"Wrote {', '.join(map(str, outputs))}.")
    return "\n".join(lines)
