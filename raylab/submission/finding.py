"""Finding: what is wrong with a submission, where, and what to do about it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Literal

Stage = Literal["parse", "shape", "vet", "interpret", "compile", "cross-check"]
Kind = Literal["error", "unfinished", "warning", "note"]  # the first two leave the task without a function


@dataclass(frozen=True)
class Finding:
    """One sentence of what was found at `line` (0: nowhere in particular) and one of what to do.

    `task` is empty where the whole file is meant; `text` is the line itself; `detail` is for those who want to know
    more, such as the compiler's own words.
    """

    stage: Stage
    task: str
    kind: Kind
    line: int
    text: str
    sentence: str
    advice: str = ""
    detail: str = ""

    @property
    def fatal(self) -> bool:
        """Whether the task has no function because of it."""
        return self.kind in ("error", "unfinished")

    def __str__(self) -> str:
        where = f"line {self.line}: " if self.line else ""
        lines = [f"{where}{self.sentence}"]
        if self.text.strip():
            lines.append(f"    {self.text.strip()}")
        return "\n".join([*lines, self.advice] if self.advice else lines)

    def to_dict(self) -> dict[str, Any]:
        """As JSON has it."""
        return asdict(self)


class Problem(Exception):  # noqa: N818 (it is the student's, not ours)
    """Why it does not go on: a finding that does not know its stage and task yet."""

    def __init__(self, sentence: str, advice: str = "", line: int = 0, detail: str = "", kind: Kind = "error") -> None:
        super().__init__(sentence)
        self.sentence, self.advice, self.line, self.detail, self.kind = sentence, advice, line, detail, kind
