"""Schedule: in which passes a render takes its samples, in which pieces, and when its time is up.

The samples of each stream are taken in passes that end at powers of two, so that an Owen-scrambled sequence is
complete after each and the error is known early. Where a time is asked for, a pass is to take at most half of what is
left of it, and rows that are not begun when it is up keep the samples they have. All this looks at the clock and at
numbers of samples, never at their values.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from raylab.packet import LANES
from raylab.plan import MAX_SAMPLES, Plan

SHORT = 0.5  # seconds: what can be done in this time is one pass
FIRST_PASS = 1 << 22  # camera rays that the first pass may take over the whole picture
PIECE = 200_000  # camera rays of a work item, of at least a row
PART = 0.005  # of the time asked: what a work item may take of it
clock = time.perf_counter


@dataclass
class Schedule:
    """The passes of one render; `seconds` are those since its first sample, without loading, compiling and writing
    the picture."""

    plan: Plan
    width: int
    height: int
    threads: int
    band_rows: int | None = None  # of a work item, if given
    at_risk: float = math.inf  # seconds of work that may be lost
    taken: int = 0  # samples of each stream, complete over the picture
    seconds: float = 0.0
    start: float = 0.0  # on the clock

    def begin(self) -> None:
        """Sampling begins, or goes on after `seconds`."""
        self.start = clock() - self.seconds

    def look(self) -> float:
        """`seconds` by now."""
        self.seconds = clock() - self.start
        return self.seconds

    def late(self) -> bool:
        """Is the time up? Not before each pixel has a sample of each stream."""
        return self.taken > 0 and clock() - self.start >= self.plan.seconds

    def next_end(self) -> int:
        """Where the next pass ends: what can be done in a SHORT time, or as much again as is done; less if time is up.

        At 1 or at a multiple of LANES, so that which eye rays share a packet does not depend on the clock, unless the
        time is nearly up. Where it is the noise that ends the render, it is looked at after every power of two, for
        the same reason.
        """
        if self.taken == 0:
            return min(self._first_end(), self.plan.samples)
        rate = self.taken / max(self.seconds, 1e-9)
        fast = int(rate * SHORT).bit_length() - 1 if self.plan.relative_error == 0.0 else 0
        last = max(LANES, 1 << max(self.taken.bit_length(), fast))
        if self.at_risk < math.inf:  # a pass that is killed is lost
            last = min(last, LANES * max(1, int(self.taken + rate * self.at_risk) // LANES))
            last = max(last, LANES * (self.taken // LANES + 1))
        return min(last, self.taken + self._in_time(), self.plan.samples)

    def _first_end(self) -> int:
        """How many samples of each stream to begin with: a packet in a small picture whose number is given, else 1."""
        rays = self.width * self.height * self.plan.streams
        return LANES if self.plan.samples < MAX_SAMPLES and LANES * rays <= FIRST_PASS else 1

    def _in_time(self) -> int:
        """Samples of each stream that take half the time that is left, while a row of them takes a small PART."""
        if self.plan.seconds == math.inf:
            return MAX_SAMPLES
        half = 0.5 * (self.plan.seconds - self.seconds)
        n = int(min(half / self._row_seconds(1) * self.threads / self.height, self._part() / self._row_seconds(1)))
        return max(1, n - (self.taken + n) % LANES if n > LANES else n)

    def bands(self, samples: int) -> list[tuple[int, int]]:
        """Work items that take so many samples of each stream, each of some rows: no thread waits long for another."""
        rows = self.band_rows or self._rows(samples)
        return [(top, min(top + rows, self.height)) for top in range(0, self.height, rows)]

    def _rows(self, samples: int) -> int:
        rows = min(-(-self.height // (4 * self.threads)), PIECE // (self.width * self.plan.streams * samples))
        if self.plan.seconds < math.inf and self.taken > 0:
            rows = min(rows, int(self._part() / self._row_seconds(samples)))
        return max(1, rows)

    def _part(self) -> float:
        return PART * self.plan.seconds

    def _row_seconds(self, samples: int) -> float:
        """What a thread has needed for so many samples of a row."""
        return max(self.seconds, 1e-9) * self.threads / self.height * samples / self.taken
