"""One XML element as written: its attributes, and the file and line that every complaint about it names."""

from __future__ import annotations

import difflib
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from raylab.errors import SceneError


@dataclass(frozen=True)
class Tag:
    """An element with its parameters filled in; `label` is how messages quote it."""

    name: str
    attributes: dict[str, str]
    file: Path
    line: int

    @property
    def label(self) -> str:
        for key in ("type", "name", "id"):
            if key in self.attributes:
                return f'<{self.name} {key}="{self.attributes[key]}">'
        return f"<{self.name}>"

    @property
    def place(self) -> str:
        return f"{self.file}:{self.line}: {self.label}"

    def error(self, message: str) -> SceneError:
        """An error that starts with file, line and element."""
        return SceneError(f"{self.place}: {message}")

    def check_attributes(self, required: Collection[str] = (), optional: Collection[str] = ()) -> None:
        """Refuse unknown and missing attributes."""
        known = [*required, *optional]
        for key in self.attributes:
            if key not in known:
                raise self.error(f'unknown attribute "{key}"; ' + choices(key, known))
        for key in required:
            if key not in self.attributes:
                raise self.error(f'attribute "{key}" is missing')


def choices(word: str, known: Collection[str], what: str = "expected") -> str:
    """The closing words of a complaint about `word`: what is known, and the nearest of it."""
    if not known:
        return "it takes none"
    near = difflib.get_close_matches(word, list(known), n=1)
    text = f"{what} " + ", ".join(sorted(known))
    return text + (f'; did you mean "{near[0]}"?' if near else "")
