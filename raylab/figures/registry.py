"""The register of figures.

    @figure("soft_edges", "Cause of soft shadows (area lights)", "Caption, in Markdown: what is seen and why.")
    def soft_edges(path: Path) -> None:
        panels.row(path, [panels.Panel("title", image.mean), ...])

`slide` is a title of `raylab.slides.TABLE`; the file is NAME.png, at most 150 kB, drawn within ten seconds.
"""

from __future__ import annotations

import difflib
import importlib
import pkgutil
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

import raylab.figures
from raylab.atomic import replacing
from raylab.errors import UserError
from raylab.slides import TABLE

Draw = Callable[[Path], None]
MOST_BYTES = 150_000


class Figure(NamedTuple):
    """A figure: `draw` writes it to a path that ends in .png."""

    name: str
    slide: str
    caption: str
    draw: Draw

    def write(self, folder: Path) -> Path:
        """Draw into `folder`/NAME.png, which is there in full or not at all."""
        path = folder / f"{self.name}.png"
        with replacing(path) as beside:
            self.draw(beside)
        return path


_REGISTERED: dict[str, Figure] = {}


def figure(name: str, slide: str, caption: str) -> Callable[[Draw], Draw]:
    """Register a function draw(path) as the figure `name` of a slide."""
    if name in _REGISTERED:
        raise ValueError(f"two figures are called {name!r}")
    if slide not in {row.title for row in TABLE}:
        raise ValueError(f"figure {name!r}: no slide is called {slide!r}")

    def register(draw: Draw) -> Draw:
        _REGISTERED[name] = Figure(name, slide, " ".join(caption.split()), draw)
        return draw

    return register


def all_figures() -> dict[str, Figure]:
    """Every figure by name, in slide order; figures of one slide by name."""
    for module in pkgutil.iter_modules(raylab.figures.__path__, "raylab.figures."):
        importlib.import_module(module.name)
    place = {row.title: i for i, row in enumerate(TABLE)}
    return {f.name: f for f in sorted(_REGISTERED.values(), key=lambda f: (place[f.slide], f.name))}


def chosen(names: Iterable[str]) -> list[Figure]:
    """The figures called so, or all; UserError names the nearest for an unknown one."""
    known = all_figures()
    for name in names:
        if name not in known:
            near = difflib.get_close_matches(name, known, 1, 0.0)
            raise UserError(f'unknown figure "{name}"; the nearest is "{near[0]}" (raylab figures --list names all)')
    return [known[name] for name in names] or list(known.values())
