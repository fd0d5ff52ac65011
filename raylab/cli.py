"""The command line: raylab study, shades, figures, demo, stress, stiff; the others are in `commands_*`.

Standard output carries results, standard error everything else. Exit codes: 0 done, 2 bad input, 130 Ctrl-C.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NoReturn

import click

import raylab
from raylab import commands_render, commands_staff, commands_student, strategies
from raylab.errors import UserError
from raylab.options import INTERRUPTED, PARAMETERS, PROGRESS, SCENE, SEED, THREADS, load, parameter, say


def main() -> NoReturn:
    """Run the command line and leave with its exit code."""
    try:
        code = commands.main(prog_name="raylab", standalone_mode=False)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        code = error.exit_code
    except click.ClickException as error:
        say(f"error: {error.format_message()}")
        code = error.exit_code
    except UserError as error:
        say(f"error: {error}")
        code = 2
    except (KeyboardInterrupt, click.Abort):
        say("stopped before there was anything to keep.")
        code = INTERRUPTED
    sys.exit(code)


commands = click.Group(
    help='The lecture "Advanced Ray Tracing" as a laboratory.',
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
)
click.version_option(raylab.__version__, message="raylab %(version)s")(commands)


@commands.command("shades")
@SCENE
@PARAMETERS
def shades_command(scene: Path, parameters: tuple[str, ...]) -> None:
    """List the slides' functions that make sense for SCENE."""
    for name in strategies.available(load(scene, parameters)[0]):
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

    loaded, _ = load(scene, parameters)
    with StepBar("study", progress) as step:
        result = study(
            loaded, _names(shades), samplers=_names(samplers), spp=_numbers(spp), repeats=repeats,
            seed=seed or 0, threads=threads, truth=find_truth(loaded, dict(map(parameter, parameters))), progress=step,
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
                    say(f"{row.case.id} does not hold: {row.case.setup}: {report.cells(row)[7]}")
    except KeyboardInterrupt:
        say("stopped by Ctrl-C; the page shows what is done.")
        markdown = None
    click.echo(f"{report.summary(rows)} Wrote {report.write(rows, folder, markdown)}.")
    return 0 if len(rows) == len(wanted) else INTERRUPTED


@commands.command("stiff")
@click.argument("names", nargs=-1, metavar="[CASE]...")
@click.option("-o", "folder", metavar="DIR", required=True, type=click.Path(path_type=Path, file_okay=False),
              help="Folder for the plot and the studies.")  # fmt: skip
@click.option("--markdown", metavar="FILE", type=click.Path(path_type=Path, dir_okay=False),
              help="Write the tables as Markdown as well.")  # fmt: skip
@PROGRESS
def stiff_command(names: tuple[str, ...], folder: Path, markdown: Path | None, progress: bool | None) -> int:
    """Error against run time of each strategy on the stiff scenes (all, or those named, such as S02)."""
    from raylab.progress import StepBar
    from raylab.stress import stiff_report

    wanted, rows = stiff_report.chosen(names), []
    with StepBar("stiff", progress) as step:
        for row in stiff_report.measure(wanted, step):
            row.study.write(folder / row.stiff.id)
            rows.append(row)
            click.echo(f"{row.stiff.id}: {row.stiff.title}.\n{row.study.summary()}")
    done = [row for row in rows if row.study.complete]
    if done:
        stiff_report.write(done, folder, markdown)
    click.echo(f"Wrote {len(done)} of {len(wanted)} scenes into {folder}.")
    return 0 if len(done) == len(wanted) else INTERRUPTED


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
        say("stopped by Ctrl-C; what is done is kept.")
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


for _command in [*commands_staff.COMMANDS, *commands_student.COMMANDS, commands_render.render_command]:
    commands.add_command(_command)


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _numbers(text: str) -> list[int]:
    try:
        return [int(number) for number in _names(text)]
    except ValueError:
        raise UserError(f'--spp: expected whole numbers with commas between them, got "{text}"') from None


if __name__ == "__main__":
    main()
