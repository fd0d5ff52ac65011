"""Progress: of a render, how far, how fast, how noisy; of an experiment, which step; and the bars that show it."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from types import TracebackType
from typing import Any, TypeVar

T = TypeVar("T")


@dataclass
class Progress:
    """What a progress bar shows; `done` and `total` are samples of the whole picture, total None when unknown."""

    done: int = 0
    total: int | None = None
    rays: int = 0
    seconds: float = 0.0
    relative_error: float = float("nan")


class _OnScreen:
    """A bar on standard error from the first step to the end of the `with`, if shown (by default: on a terminal)."""

    def __init__(self, shown: bool | None) -> None:
        self.shown = sys.stderr.isatty() if shown is None else shown
        self.bar: Any = None

    def __enter__(self: T) -> T:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.bar is not None:
            self.bar.refresh()
            self.bar.close()


class Bar(_OnScreen):
    """A progress bar on standard error; call it with a Progress. Hidden unless `shown` or, by default, on a terminal.

    The bar is full after all samples or, when a time was asked for, after `seconds`; when an error was asked for,
    it shows the one reached so far and `relative_error`.
    """

    def __init__(
        self, shown: bool | None = None, seconds: float | None = None, relative_error: float | None = None
    ) -> None:
        super().__init__(shown)
        self.seconds, self.relative_error = seconds, relative_error

    def __call__(self, progress: Progress) -> None:
        if not self.shown:
            return
        if self.bar is None:
            self.bar = self._open(progress)
        self.bar.n = progress.done if self.seconds is None else round(min(progress.seconds, self.seconds), 1)
        self.bar.set_postfix_str(self.text(progress), refresh=False)
        self.bar.update(0)

    def text(self, progress: Progress) -> str:
        """For example "12.3 Mrays/s, error 2.1 %"."""
        rate = progress.rays / progress.seconds / 1e6 if progress.seconds > 0.0 else 0.0
        text = f"{rate:.1f} Mrays/s"
        if progress.relative_error == progress.relative_error:
            text += f", error {100.0 * progress.relative_error:.2g} %"
            if self.relative_error is not None:
                text += f" (until {100.0 * self.relative_error:.2g} %)"
        return text

    def _open(self, progress: Progress) -> Any:
        from tqdm import tqdm

        total: float | None = progress.total if self.seconds is None else self.seconds
        unit = " samples" if self.seconds is None else " s"
        form = "{l_bar}{bar}| {n:g} of {total:g}{unit} [{elapsed}<{remaining}{postfix}]"
        if total is None:
            form = "{n:g}{unit} [{elapsed}{postfix}]"
        return tqdm(
            desc="raylab", total=total, unit=unit, bar_format=form, mininterval=0.1, dynamic_ncols=True, leave=True
        )


class StepBar(_OnScreen):
    """A bar over the steps of a long experiment; call it with (done, total, what). Silent unless shown."""

    def __init__(self, name: str, shown: bool | None = None) -> None:
        super().__init__(shown)
        self.name = name

    def __call__(self, done: int, total: int, what: str) -> None:
        if not self.shown:
            return
        if self.bar is None:
            from tqdm import tqdm

            form = "{l_bar}{bar}| [{elapsed}<{remaining}{postfix}]"
            self.bar = tqdm(desc=self.name, total=total, bar_format=form, dynamic_ncols=True)
        self.bar.n, self.bar.total = done, total
        self.bar.set_postfix_str(what, refresh=False)
        self.bar.update(0)
