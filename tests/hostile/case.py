"""A case: what is handed in, and the most points it may get. An honest submission gets 10, a wrong one 2."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from hostile.toy import HONEST, ONLY_SQUARE, WRONG

Make = Callable[[Path], None]


@dataclass(frozen=True)
class Case:
    """`score` is what it gets when nothing but the jail stands in its way; with the ladder before, at most that."""

    number: int
    name: str
    make: Make
    score: float
    says: str = ""  # in the results
    walls: tuple[str, ...] = ("naked", "ladder")
    slow: bool = False  # runs into a deadline
    racing: bool = False  # how many replies are there when the grader looks depends on the moment: at most `score`

    @property
    def behind_the_ladder(self) -> float:
        """At most this: what is not Python is refused, and what is refused in one function leaves the other."""
        return self.score if self.number < 19 else max(self.score, ONLY_SQUARE)

    @property
    def id(self) -> str:
        return f"{self.number} {self.name}"


def honest() -> bytes:
    return HONEST.encode()


def beside(files: Mapping[str, bytes]) -> Make:
    def make(folder: Path) -> None:
        for name, content in files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(content)

    return make


def only(content: bytes) -> Make:
    return beside({"shade.py": content})


def at_import(code: str, rest: str = WRONG) -> Make:
    """Code that runs when the file is read, before a wrong answer. HIDDEN is the folder of the hidden data."""

    def make(folder: Path) -> None:
        text = f"{code}\n{rest}".replace("HIDDEN", str(folder.parent)).replace("__future__", "__past__")
        (folder / "shade.py").write_text(text)

    return make


def in_call(code: str, rest: str = WRONG) -> Make:
    """Code that runs when warp() is called, before a wrong answer."""
    lines = "\n".join(f"    {line}" for line in code.splitlines())
    return at_import("", rest.replace("def warp(u):\n", f"def warp(u):\n{lines}\n", 1))


def quietly(code: str) -> str:
    """Try it, and go on when it is refused."""
    lines = "\n".join(f"    {line}" for line in code.splitlines())
    return f"try:\n{lines}\nexcept BaseException as error:\n    print(repr(error))\n"


__all__ = ["ONLY_SQUARE", "Case", "at_import", "beside", "honest", "in_call", "only", "quietly"]
