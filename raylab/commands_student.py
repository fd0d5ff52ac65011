"""The commands of students: raylab new, check, replay."""

from __future__ import annotations

from pathlib import Path

import click

NAME = click.argument("name", metavar="ASSIGNMENT")
FILE = click.argument("path", metavar="[FILE]", required=False, type=click.Path(path_type=Path))


@click.command("new")
@NAME
@click.option("-o", "folder", metavar="DIR", type=click.Path(path_type=Path), help="Where to put it; ./ASSIGNMENT.")
def new_command(name: str, folder: Path | None) -> None:
    """Begin ASSIGNMENT (a1 to a7): a folder with the handout, the file to complete, scenes and tests."""
    from raylab.grading.assignment import load
    from raylab.grading.begin import begin

    folder = folder or Path(name)
    for path in begin(load(name), folder):
        click.echo(str(path))
    click.echo(f"Read {folder / 'handout.md'}, complete {folder / load(name).file}, then: raylab check {name}")


@click.command("check")
@NAME
@FILE
@click.option("--hint", type=click.IntRange(1, 3), default=1, show_default=True, help="How much is said of a mistake.")
@click.option("--seed", metavar="TOKEN", help="Repeat the random numbers of a check.")
def check_command(name: str, path: Path | None, hint: int, seed: str | None) -> int:
    """Judge FILE (./ASSIGNMENT/shade.py) as the grader does, with other random numbers."""
    from raylab.grading.assignment import load
    from raylab.grading.check import check

    assignment = load(name)
    judged = check(assignment, found(path, name, assignment.file), click.echo, hint, int(seed, 16) if seed else None)
    return 0 if all(j.outcome in ("PASS", "INCONCLUSIVE") for j in judged) else 1


@click.command("replay")
@click.argument("token")
@FILE
@click.option("--debug", is_flag=True, help="Stop in the debugger at the first line.")
def replay_command(token: str, path: Path | None, debug: bool) -> None:
    """Run one sample, named by TOKEN, in plain Python, line by line."""
    from raylab.grading.replay import parse, replay

    assignment = parse(token)[0]
    replay(token, found(path, assignment.id, assignment.file), click.echo, debug)


def found(path: Path | None, name: str, file: str) -> Path:
    """The file that is meant: as given, or in the folder of the assignment, or here."""
    if path is not None:
        return path
    for guess in (Path(name) / file, Path(file)):
        if guess.exists():
            return guess
    return Path(name) / file


COMMANDS = (new_command, check_command, replay_command)
