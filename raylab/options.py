"""Options: what several commands share: their arguments, how a scene is loaded, how something is said."""

from __future__ import annotations

import time
from pathlib import Path

import click

import raylab
from raylab.errors import UserError

INTERRUPTED = 130  # 128 + SIGINT, as a shell counts
SCENE = click.argument("scene", type=click.Path(path_type=Path))
PARAMETERS = click.option(
    "-D", "parameters", metavar="NAME=VALUE", multiple=True, help="Value of $NAME in the scene file."
)
THREADS = click.option("--threads", type=click.IntRange(min=1), help="Threads; all cores by default.")
SEED = click.option("--seed", type=click.IntRange(0, 2**63 - 1), help="The same seed gives the same picture.")
PROGRESS = click.option("--progress/--no-progress", default=None, help="Show progress; by default on a terminal.")


def say(sentence: str) -> None:
    click.echo(f"raylab: {sentence}", err=True)


def load(path: Path, parameters: tuple[str, ...]) -> tuple[raylab.Scene, float]:
    """The scene, with its warnings said, and the seconds that it took."""
    start = time.perf_counter()
    scene = raylab.load(path, dict(parameter(text) for text in parameters))
    for warning in scene.warnings:
        say(f"warning: {warning}")
    return scene, time.perf_counter() - start


def parameter(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not (name and equals):
        raise UserError(f'-D: expected NAME=VALUE, got "{text}"')
    return name, value
