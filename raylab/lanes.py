"""Lanes: the random numbers of a packet's rays, drawn row by row, a number for each ray.

`sampler.lanes(...)` has two methods: `number(row)` draws a number for each ray, and `squares(row, count)` points of the
unit square into rows row, row + 1, ..., two to a point. The numbers are those that each ray would draw by itself, with
`number()` and `square()`; how they are drawn is the sampler's affair.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from raylab.jit import njit
from raylab.record import record

# Rows: a point for the pixel filter, one for the aperture, and a time; what a scene does not draw stays as it is.
FILM, LENS, TIME, ROWS = 0, 2, 4, 5
LANES = 16


@record
class OneByOne(NamedTuple):
    """The streams of a packet's lanes, samples first .. last - 1 of each stream; each draws what it draws alone."""

    sampler: Any
    packet: Any
    pixel: int
    streams: int
    first: int
    last: int

    def number(self, row):
        d, lane = self.sampler.counter.next[0], 0
        for stream in range(self.streams):
            for sample in range(self.first, self.last):
                self.packet.keep(row, lane, resumed(self, stream, sample, d).number())
                lane += 1

    def squares(self, row, count):
        for k in range(count):
            d, lane = self.sampler.counter.next[0], 0
            for stream in range(self.streams):
                for sample in range(self.first, self.last):
                    u, v = resumed(self, stream, sample, d).square()
                    self.packet.keep(row + 2 * k, lane, u)
                    self.packet.keep(row + 2 * k + 1, lane, v)
                    lane += 1


@njit
def resumed(lanes, stream, sample, d):
    """A sample's stream from dimension d on."""
    rng = lanes.sampler.stream(lanes.pixel, stream, sample)
    lanes.sampler.counter.next[0] = d
    return rng


@njit
def one_by_one(sampler, packet, pixel, streams, first, last):
    """A sampler's `lanes`, from the first dimension on."""
    sampler.counter.next[0] = 0
    return OneByOne(sampler, packet, pixel, streams, first, last)
