"""Stopping: when a picture is good enough, without a bias of its mean.

Who looks at the noise and stops when it is small stops more often when, by chance, the bright samples are missing:
the mean comes out too dark. Here the streams of a picture form two halves, and each half is stopped by the noise of
the other, of which it is independent: given the number of its samples, the mean of each half has no bias, and both
count the same.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from raylab.image import Image, estimate

Array = npt.NDArray[np.float64]


class Halves:
    """The two halves of an accumulator, as they were when each was stopped."""

    def __init__(self, relative_error: float, independent: bool) -> None:
        self.relative_error, self.independent = relative_error, independent
        self.kept: dict[int, Array] = {}

    def stop(self, accumulator: Array) -> bool:
        """Look at a picture whose samples are complete; True once both halves have stopped.

        Of two halves with the same noise, half the sum has 1 / sqrt(2) of it.
        """
        halves = np.split(accumulator, 2)
        for half in (0, 1):
            mean, error, counts = estimate(halves[1 - half], self.independent)
            if (
                half not in self.kept
                and Image(mean, error, counts).relative_error / math.sqrt(2) <= self.relative_error
            ):
                self.kept[half] = halves[half].copy()
        return len(self.kept) == 2

    def picture(self, accumulator: Array) -> Array:
        """The accumulator with the halves that have stopped as they were then."""
        return np.concatenate([self.kept.get(half, own) for half, own in enumerate(np.split(accumulator, 2))])
