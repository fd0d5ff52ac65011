"""Task: a function that a student is asked to write, with the id that stub, test, rubric and report share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, Literal

from raylab.errors import UserError
from raylab.strategies import BUILT_IN, signature

WIDTHS = {"number": 1, "pair": 2, "vector": 3}  # columns of a row


@dataclass(frozen=True)
class Task:
    """What is asked for.

    kind "shade": `function` is a shade() with the signature of the built-in one called `like`.
    kind "map": a plain function of `arguments`; `takes` says of each what it is, `gives` what comes back: "number",
    "pair" (a tuple of two numbers), "vector" (a Vec3). More than one result is a tuple.
    `trial` is the kind of scene in which a shade() will be graded, a name of `raylab.trials`.
    `withheld` are words of `raylab.lecture` that would be the answer, and may not be used.
    """

    id: str
    function: str
    kind: Literal["shade", "map"] = "shade"
    like: str = ""
    arguments: tuple[str, ...] = ()
    takes: tuple[str, ...] = ()
    gives: tuple[str, ...] = ()
    trial: str = ""
    withheld: tuple[str, ...] = ()
    examples: tuple[tuple[float, ...], ...] = ()  # rows of inputs for kind "map"; random ones where there are none

    def __post_init__(self) -> None:
        for name in ("arguments", "takes", "gives", "withheld"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        object.__setattr__(self, "examples", tuple(tuple(float(v) for v in row) for row in self.examples))
        if self.kind == "shade":
            if self.like not in BUILT_IN:
                raise UserError(f"task {self.id!r}: like is {self.like!r}, expected one of {', '.join(BUILT_IN)}")
            object.__setattr__(self, "arguments", signature(self.like))
        elif self.kind != "map":
            raise UserError(f"task {self.id!r}: kind is {self.kind!r}, expected shade or map")
        elif unknown := [t for t in (*self.takes, *self.gives) if t not in WIDTHS]:
            raise UserError(f"task {self.id!r}: {unknown[0]!r} is not one of {', '.join(WIDTHS)}")
        elif len(self.takes) != len(self.arguments) or not self.gives:
            raise UserError(f"task {self.id!r}: expected one of takes for each argument, and at least one of gives")

    @property
    def columns(self) -> tuple[int, int]:
        """Numbers in a row of inputs and of results, for kind "map"."""
        return sum(WIDTHS[t] for t in self.takes), sum(WIDTHS[t] for t in self.gives)

    @classmethod
    def from_dict(cls, table: Mapping[str, Any]) -> Task:
        """From JSON or TOML; UserError for a key that is not a task's."""
        if unknown := set(table) - {f.name for f in fields(cls)}:
            raise UserError(f"a task has no {', '.join(sorted(unknown))}")
        return cls(**table)

    def to_dict(self) -> dict[str, Any]:
        """As JSON has it."""
        return asdict(self)
