"""The commands of students: raylab new, check, replay; and what raylab render does with a file of theirs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from raylab.errors import UserError

if TYPE_CHECKING:
    from raylab.grading.own import Own

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
    """Run one sample, named by TOKEN, in plain Python: of a task, line by line; of a picture (FILE is its scene)."""
    if "/" in token:
        from raylab import load
        from raylab.pixel_sample import PixelSample

        sample, scene = PixelSample.parse(token), load(found(path, ".", "scene.xml"))
        if debug:
            import pdb

            pdb.Pdb().runcall(sample.value, scene, None, click.echo)
        else:
            sample.value(scene, None, click.echo)
        return
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


def own_shade(shade: str, task: str, scene: Any, spp: int | None, say: Callable[[str], None]) -> Own | None:
    """The function in a student's file, or None where `shade` is the name of a slide's."""
    if not (shade.endswith(".py") or "/" in shade or Path(shade).is_file()):
        if task:
            raise UserError(f"--task is about a file; expected --shade FILE.py, got --shade {shade}")
        return None
    if spp == 1:
        raise UserError("--spp 1: of one sample the noise is not known; to compare a picture, expected 2 or more")
    from raylab.grading.own import Own

    return Own.read(Path(shade), scene, task, say)


def compare(
    own: Own, image: Any, parameters: set[str], threads: int | None, progress: Any, picture: Path,
    result: dict[str, Any],
) -> tuple[bool, str]:  # fmt: skip
    """Whether there was time for it, and what there is to say; `result` gets the numbers."""
    try:
        reference = own.reference(image, parameters, threads, progress)
    except KeyboardInterrupt:
        return False, "Stopped by Ctrl-C before there was a reference; the picture is kept."
    if reference is None:
        return True, (
            "There is no reference: this raylab has not the solution, and the picture that it keeps is that of "
            f"{own.assignment.scenes.get(own.tasks[0].id, 'no scene')} as it was given, in its own size."
        )
    out = picture.with_name(f"{picture.stem}_compared.png")
    comparison = own.compare(image, reference, out)
    result["comparison"] = comparison.to_dict()
    wrote = f"Wrote {out}: yours, the reference ({reference.source}), the difference."
    return True, "\n".join((comparison.numbers, comparison.verdict, wrote))


COMMANDS = (new_command, check_command, replay_command)
