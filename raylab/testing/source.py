"""Source: where the samples of an estimator come from: a shade() in this process, or anything else that draws."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from raylab.trials import Trial

Array = npt.NDArray[np.float64]
Draw = Callable[[int], Array]


@runtime_checkable
class Source(Protocol):
    """An estimator of which only the samples are known, such as a function that runs in another process.

    Its name in reports is its `__name__` if it has one, else that of its class.
    """

    def draws(self, trial: Trial, seed: int) -> Draw:
        """A function n -> (n, 3): further independent samples in `trial`; they depend on `seed` and on their number
        in the sequence alone."""


Shade = str | Callable[..., Any] | Source


def name_of(shade: Shade) -> str:
    return shade if isinstance(shade, str) else str(getattr(shade, "__name__", type(shade).__name__))


def draws(shade: Shade, trial: Trial, seed: int, threads: int = 0) -> Draw:
    """Samples of a shade(), by name or as a function, or of a source. A kernel is compiled now, not when drawing."""
    if isinstance(shade, Source):
        return shade.draws(trial, seed)
    drawn = trial.probe(shade, threads).draws(seed)
    drawn(0)
    return drawn


def channel(draw: Draw, c: int) -> Draw:
    """One colour channel of the samples, (n,)."""
    return lambda n: draw(n)[:, c]
