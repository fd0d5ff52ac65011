"""The command line: raylab render, study, shades, figures, demo; those of assignments are in `commands_*`.

Standard output carries results, standard error everything else. Exit codes: 0 done, 2 bad input, 130 Ctrl-C.
"""

from __future__ import annotations

import json
import sys
import threading
import time
from contextlib import nullcontext
from pathlib import Path
from typing import Any, NoReturn

import click

import raylab
from raylab import commands_staff, commands_student, strategies
from raylab.errors import UserError
from raylab.explain import explain, measured
from raylab.image import Image
from raylab.render import Plan
from raylab.samplers import ALL_NAMES as SAMPLERS

INTERRUPTED = 130  # 128 + SIGINT, as a shell counts
SCENE = click.argument("scene", type=click.Path(path_type=Path))
PARAMETERS = click.option(
    "-D", "parameters", metavar="NAME=VALUE", multiple=True, help="Value of $NAME in the scene file."
)
THREADS = click.option("--threads", type=click.IntRange(min=1), help="Threads; all cores by default.")
SEED = click.option("--seed", type=click.IntRange(0, 2**63 - 1), help="The same seed gives the same picture.")
PROGRESS = click.option("--progress/--no-progress", default=None, help="Show progress; by default on a terminal.")


def main() -> NoReturn:
    """Run the command line and leave with its exit code."""
    try:
        code = commands.main(prog_name="raylab", standalone_mode=False)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        code = error.exit_code
    except click.ClickException as error:
        _say(f"error: {error.format_message()}")
        code = error.exit_code
    except UserError as error:
        _say(f"error: {error}")
        code = 2
    except (KeyboardInterrupt, click.Abort):
        _say("stopped before there was anything to keep.")
        code = INTERRUPTED
    sys.exit(code)


commands = click.Group(
    help='The lecture "Advanced Ray Tracing" as a laboratory.',
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
)
click.version_option(raylab.__version__, message="raylab %(version)s")(commands)


@commands.command("render")
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
    loaded, load_seconds = _load(scene, parameters)
    own = commands_student.own_shade(shade, task, loaded, spp, _say)
    if own and not outputs:
        outputs = (own.picture,)
    if any(path.suffix.lower() == ".png" for path in outputs):
        threading.Thread(target=_prepare_png, daemon=True).start()
    with Bar(progress, seconds, relative_error) as bar, own.explained() if own else nullcontext():
        image = raylab.render(
            own.scene if own else loaded, own.function if own else shade, sampler=sampler, spp=spp, seconds=seconds,
            relative_error=relative_error, seed=seed, threads=threads, progress=bar,
        )  # fmt: skip
    for path in outputs:
        if lost := picture.write(image, path):
            _say(f"warning: {lost}")
    _warn_about(image)
    result = measured(loaded, image, own.name if own else shade, load_seconds)
    if explained:
        click.echo(explain(loaded, result["shade"], result["sampler"]), err=as_json)
    complete, said = image.complete, ""
    if own and complete:
        names = {name for name, _ in map(_parameter, parameters)}
        with Bar(progress) as bar:
            complete, said = commands_student.compare(own, image, names, threads, bar, outputs[0], result)
    text = "\n".join(filter(None, (_summary(result, outputs), said)))
    click.echo(json.dumps(result, allow_nan=False) if as_json else text)
    return 0 if complete else INTERRUPTED


@commands.command("shades")
@SCENE
@PARAMETERS
def shades_command(scene: Path, parameters: tuple[str, ...]) -> None:
    """List the slides' functions that make sense for SCENE."""
    for name in strategies.available(_load(scene, parameters)[0]):
        function = strategies.BUILT_IN[name][0]
        first_line = (function.__doc__ or "").strip().splitlines()[0]
        click.echo(f"{name:18} {first_line}")


@commands.command("study")
@SCENE
@click.option("--shades", required=True, metavar="A,B,C", help="The slides' functions to compare.")
@click.option("--samplers", default="independent", show_default=True, metavar="A,B,C", help="Samplers to compare.")
@click.option("--spp", default="1,4,16,64,256", show_default=True, metavar="N,N,...", help="Samples per pixel.")
@click.option("--repeats", default=20, show_default=True, type=click.IntRange(min=2), help="Independent repeats.")
@SEED
@THREADS
@PARAMETERS
@click.option("-o", "folder", metavar="DIR", required=True, type=click.Path(path_type=Path, file_okay=False),
              help="Folder for the table, the plots and the page.")  # fmt: skip
@PROGRESS
def study_command(
    scene: Path,
    shades: str,
    samplers: str,
    spp: str,
    repeats: int,
    seed: int | None,
    threads: int | None,
    parameters: tuple[str, ...],
    folder: Path,
    progress: bool | None,
) -> int:
    """Measure error against run time on SCENE; Ctrl-C keeps what is done."""
    from raylab.progress import StepBar
    from raylab.study import find_truth, study

    loaded, _ = _load(scene, parameters)
    with StepBar("study", progress) as step:
        result = study(
            loaded, _names(shades), samplers=_names(samplers), spp=_numbers(spp), repeats=repeats,
            seed=seed or 0, threads=threads, truth=find_truth(loaded, dict(map(_parameter, parameters))), progress=step,
        )  # fmt: skip
    page = result.write(folder)
    click.echo(result.summary())
    click.echo(f"Wrote {page} and the table and plots beside it.")
    return 0 if result.complete else INTERRUPTED


@commands.command("stress")
@click.argument("names", nargs=-1, metavar="[CASE]...")
@click.option("-o", "folder", metavar="DIR", required=True, type=click.Path(path_type=Path, file_okay=False),
              help="Folder for the page.")  # fmt: skip
@click.option("--markdown", metavar="FILE", type=click.Path(path_type=Path, dir_okay=False),
              help="Write the table as Markdown as well.")  # fmt: skip
@PROGRESS
def stress_command(names: tuple[str, ...], folder: Path, markdown: Path | None, progress: bool | None) -> int:
    """Run the extreme cases (all, or those named, such as A01 or B): what holds, and what the usual code does."""
    from raylab.progress import StepBar
    from raylab.stress import report
    from raylab.stress.case import chosen
    from raylab.stress.runner import run

    wanted, rows = chosen(names), []
    try:
        with StepBar("stress", progress) as step:
            for row in run(wanted):
                rows.append(row)
                step(len(rows), len(wanted), row.case.id)
                if not row.held:
                    _say(f"{row.case.id} does not hold: {row.case.setup}: {report.cells(row)[7]}")
    except KeyboardInterrupt:
        _say("stopped by Ctrl-C; the page shows what is done.")
        markdown = None
    click.echo(f"{report.summary(rows)} Wrote {report.write(rows, folder, markdown)}.")
    return 0 if len(rows) == len(wanted) else INTERRUPTED


@commands.command("figures")
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("-o", "folder", metavar="DIR", type=click.Path(path_type=Path, file_okay=False), help="Where to write.")
@click.option("--list", "listed", is_flag=True, help="Name all figures and their slides instead.")
@click.option("--gallery", metavar="FILE", type=click.Path(path_type=Path, dir_okay=False),
              help="Write the page of all figures as well.")  # fmt: skip
@PROGRESS
def figures_command(
    names: tuple[str, ...], folder: Path | None, listed: bool, gallery: Path | None, progress: bool | None
) -> int:
    """Make the lecture's figures (all, or those named); Ctrl-C keeps what is done."""
    from raylab.figures import make
    from raylab.figures.registry import chosen
    from raylab.progress import StepBar

    wanted = chosen(names)
    if listed:
        for figure in wanted:
            click.echo(f"{figure.name:26} {figure.slide}")
        return 0
    if folder is None:
        raise UserError("figures: expected -o DIR, the folder to write to (or --list)")
    with StepBar("figures", progress) as step:
        done = make.figures(wanted, folder, step)
    if gallery and len(done) == len(wanted):
        make.gallery(gallery, folder)
    click.echo(f"Wrote {len(done)} of {len(wanted)} figures into {folder}.")
    if len(done) < len(wanted):
        _say("stopped by Ctrl-C; what is done is kept.")
        return INTERRUPTED
    return 0


@commands.command("demo")
@click.option("-o", "folder", default="demo", show_default=True, type=click.Path(path_type=Path, file_okay=False))
@click.option(
    "--scenes", default="reference_scenes", show_default=True, type=click.Path(path_type=Path, file_okay=False)
)
@THREADS
def demo_command(folder: Path, scenes: Path, threads: int | None) -> int:
    """The lecture's pictures and its central plot, in a few minutes."""
    from raylab.demo import demo

    return 0 if demo(folder, scenes, threads) else INTERRUPTED


for _command in [*commands_staff.COMMANDS, *commands_student.COMMANDS]:
    commands.add_command(_command)


def _say(sentence: str) -> None:
    click.echo(f"raylab: {sentence}", err=True)


def _load(path: Path, parameters: tuple[str, ...]) -> tuple[raylab.Scene, float]:
    """The scene, with its warnings said, and the seconds that it took."""
    start = time.perf_counter()
    scene = raylab.load(path, dict(_parameter(text) for text in parameters))
    for warning in scene.warnings:
        _say(f"warning: {warning}")
    return scene, time.perf_counter() - start


def _parameter(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not (name and equals):
        raise UserError(f'-D: expected NAME=VALUE, got "{text}"')
    return name, value


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _numbers(text: str) -> list[int]:
    try:
        return [int(number) for number in _names(text)]
    except ValueError:
        raise UserError(f'--spp: expected whole numbers with commas between them, got "{text}"') from None


def _prepare_png() -> None:
    """The first .png needs colour-science, which takes long to import; meanwhile the picture is rendered."""
    from raylab.io.image_file import encode_srgb

    encode_srgb((0.0, 0.0, 0.0))


def _warn_about(image: Image) -> None:
    if image.invalid_samples:
        _say(f"warning: {image.invalid_samples} samples were not finite; they are left out, which may hide a bias.")
    if image.invalid_rays:
        _say(f"warning: {image.invalid_rays} rays were not finite and let no light through.")
    if not image.complete:
        done = int(image.samples.min()), int(image.samples.max())
        _say(f"stopped by Ctrl-C; what is done is kept: {done[0]} to {done[1]} samples in each pixel.")


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


if __name__ == "__main__":
    main()
