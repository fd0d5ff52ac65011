"""The commands of the staff: raylab grade, course-wheel, autograder."""

from __future__ import annotations

from pathlib import Path

import click

NAME = click.argument("name", metavar="ASSIGNMENT")


@click.command("grade")
@NAME
@click.argument("paths", metavar="SUBMISSIONS...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("-o", "out", metavar="DIR", required=True, type=click.Path(path_type=Path, file_okay=False),
              help="Results, gradebook and dashboard; what is there already is not graded again.")  # fmt: skip
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Submissions at a time.")
@click.option("--again", is_flag=True, help="Grade all of them again, and say whose score changes.")
def grade_command(name: str, paths: tuple[Path, ...], out: Path, jobs: int, again: bool) -> None:
    """Grade SUBMISSIONS: folders, zip archives or .py files, or folders of those. Ctrl-C keeps what is done."""
    from raylab.grading.assignment import load
    from raylab.grading.course import grade_all

    every = grade_all(load(name), paths, out, jobs, click.echo, again)
    click.echo(f"{len(every)} submissions: {out / 'gradebook.csv'}, {out / 'dashboard.html'}")


@click.command("course-wheel")
@click.argument("names", metavar="ASSIGNMENTS...", nargs=-1, required=True)
@click.option("-o", "out", metavar="DIR", default=".", type=click.Path(path_type=Path, file_okay=False),
              help="Where to put the wheel.")  # fmt: skip
def course_wheel_command(names: tuple[str, ...], out: Path) -> None:
    """Build the raylab that students install: the functions of ASSIGNMENTS are stubs in it."""
    from raylab.grading.assignment import load
    from raylab.grading.course_wheel import build

    click.echo(str(build([load(name) for name in names], out)))


COMMANDS: tuple[click.Command, ...] = (grade_command, course_wheel_command)
