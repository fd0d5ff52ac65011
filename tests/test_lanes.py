"""A packet's random numbers, drawn side by side: the numbers that each ray would draw by itself."""

from __future__ import annotations

import numpy as np
import pytest
from helpers import same_bits

from raylab import samplers
from raylab.jit import njit
from raylab.lanes import FILM, LANES, ROWS, TIME
from raylab.packet import new_packet

PIXEL, SEED = 1234, 5


@njit
def draw_packet(sampler, packet, streams, first, last, timed):
    lanes = sampler.lanes(packet, PIXEL, streams, first, last)
    if timed:
        lanes.number(TIME)
    lanes.squares(FILM, 2)
    return sampler.counter.next[0]


@njit
def draw_alone(sampler, numbers, streams, first, last, timed):
    """The same into numbers (ROWS, LANES), a ray after the other."""
    lane = 0
    for stream in range(streams):
        for sample in range(first, last):
            rng = sampler.stream(PIXEL, stream, sample)
            if timed:
                numbers[TIME, lane] = rng.number()
            numbers[0, lane], numbers[1, lane] = rng.square()
            numbers[2, lane], numbers[3, lane] = rng.square()
            lane += 1
    return sampler.counter.next[0]


@pytest.mark.parametrize("timed", [False, True], ids=["still", "timed"])
@pytest.mark.parametrize(
    ("streams", "first", "last"),
    [(1, 0, 16), (2, 8, 16), (4, 4, 8), (3, 10, 15), (1, 5, 6), (1, 4088, 4104), (2, 1 << 20, (1 << 20) + 8)],
)
@pytest.mark.parametrize("name", samplers.ALL_NAMES)
def test_a_packet_draws_what_each_ray_draws_alone(name, streams, first, last, timed):
    packet, alone = new_packet(), np.full((ROWS, LANES), 0.5)
    alone[TIME] = 0.0
    drawn = draw_packet(samplers.make(name, SEED, 4), packet, streams, first, last, timed)
    assert drawn == draw_alone(samplers.make(name, SEED, 4), alone, streams, first, last, timed)
    assert same_bits(packet.numbers.array.reshape(ROWS, LANES), alone)
