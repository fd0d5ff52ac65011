"""The commands of the staff: raylab grade, course-wheel, autograder build, test and probe."""

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
@click.option("--trust", is_flag=True, help="Grade although this machine cannot shut the jail: see autograder probe.")
def grade_command(name: str, paths: tuple[Path, ...], out: Path, jobs: int, again: bool, trust: bool) -> None:
    """Grade SUBMISSIONS: folders, zip archives or .py files, or folders of those. Ctrl-C keeps what is done."""
    from raylab.grading.assignment import load
    from raylab.grading.course import grade_all

    every = grade_all(load(name), paths, out, jobs, click.echo, again, trust)
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


@click.group("autograder")
def autograder_command() -> None:
    """The package that grades an assignment on Gradescope."""


@autograder_command.command("build")
@NAME
@click.option("-o", "out", metavar="ZIP", required=True, type=click.Path(path_type=Path, dir_okay=False),
              help="The file to upload.")  # fmt: skip
@click.option("--secret", "folder", metavar="DIR", default=".", type=click.Path(path_type=Path, file_okay=False),
              help="Where the secret of the course is kept, or will be: the file `secret`.")  # fmt: skip
def build_command(name: str, out: Path, folder: Path) -> None:
    """Build it. The same raylab, ASSIGNMENT and secret give the same file; a solution inside is refused."""
    from raylab.grading.assignment import load
    from raylab.grading.course import secret_of
    from raylab.grading.gradescope import build
    from raylab.grading.grading import commitment

    secret = secret_of(folder)
    click.echo(f"{build(load(name), out, secret)}  {out}")
    click.echo(f"publish before the deadline: {commitment(secret)} (SHA-256 of the secret)")


@autograder_command.command("test")
@click.argument("package", metavar="ZIP", type=click.Path(path_type=Path, dir_okay=False))
@click.argument("submission", metavar="SUBMISSION", type=click.Path(path_type=Path, exists=True))
@click.option("-o", "out", metavar="FILE", type=click.Path(path_type=Path, dir_okay=False), help="Keep results.json.")
def test_command(package: Path, submission: Path, out: Path | None) -> None:
    """Run ZIP on SUBMISSION here, in the layout of Gradescope, and say what it would show."""
    import json

    from raylab.errors import UserError
    from raylab.grading.gradescope import try_out
    from raylab.grading.results import points

    trial = try_out(package, submission)
    click.echo(trial.printed, err=True)
    if trial.problems:
        raise UserError(f"the results are not what Gradescope expects: {'; '.join(trial.problems)}")
    if out:
        out.write_text(json.dumps(trial.results, indent=1))
    for row in trial.results["tests"]:
        click.echo(f"{row['score']:g} of {row['max_score']:g}  {row['name']}")
    click.echo(trial.results["output"])
    click.echo(f"{points(trial.results):g} points, {trial.results['extra_data']['status']}, {trial.seconds:.0f} s")


@autograder_command.command("probe")
def probe_command() -> None:
    """What this machine allows to keep a submission in: as JSON, `shut` for whether that is enough."""
    import json

    from raylab.grading.session import probe

    click.echo(json.dumps(probe(), indent=1))


COMMANDS: tuple[click.Command, ...] = (grade_command, course_wheel_command, autograder_command)
