"""Faults: whose fault it is that there are no numbers. Standard library only."""

from __future__ import annotations

from typing import Literal

Cause = Literal["error", "crash", "time", "memory", "protocol", "given up"]


class Fault(Exception):  # noqa: N818
    """The submission's: a sentence for the student; `detail` is what the program printed, or more of the error."""

    def __init__(self, cause: Cause, sentence: str, detail: str = "", task: str = "") -> None:
        super().__init__(sentence)
        self.cause: Cause = cause
        self.sentence, self.detail, self.task = sentence, detail, task

    @property
    def killed(self) -> bool:
        """Did it cost the worker its life?"""
        return self.cause in ("crash", "time", "memory", "protocol")


class GraderFault(Exception):  # noqa: N818
    """Ours or the machine's: the submission could not be graded, which is not zero points."""
