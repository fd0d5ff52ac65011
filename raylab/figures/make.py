"""Making figures: many into a folder, one after the other, and the page that shows them."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

from raylab.atomic import replacing
from raylab.errors import UserError
from raylab.figures.gallery import markdown
from raylab.figures.registry import Figure

Step = Callable[[int, int, str], None]


def figures(wanted: Sequence[Figure], folder: Path, step: Step) -> list[Path]:
    """Draw into `folder`; Ctrl-C ends it and keeps what is done. Returns the files."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f'cannot make the folder "{folder}": {error.strerror}') from None
    done: list[Path] = []
    for figure in wanted:
        step(len(done), len(wanted), figure.name)
        try:
            done.append(figure.write(folder))
        except KeyboardInterrupt:
            step(len(done), len(wanted), "stopped by Ctrl-C")
            return done
    step(len(done), len(wanted), "done")
    return done


def gallery(page: Path, folder: Path) -> None:
    """Write the page of all figures, whose files are in `folder`."""
    with replacing(page) as beside:
        beside.write_text(markdown(Path(os.path.relpath(folder, page.parent)).as_posix()), encoding="utf-8")
