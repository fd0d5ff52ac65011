"""Counter-based random numbers: a value depends on (seed, pixel, stream, sample, dimension) and on nothing else.

No state is carried from one number to the next, so a picture does not depend on the order in which threads and
tiles ask. Integers are 64 bits wide and wrap; `u64` keeps them so in compiled code and in plain Python alike.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba.extending import overload

from raylab.jit import OPTIONS, njit
from raylab.view import View

_MASK = (1 << 64) - 1
_GOLDEN = 0x9E3779B97F4A7C15  # 2^64 / golden ratio: Steele, Lea, Flood 2014, "Fast splittable PRNGs"


def u64(x):
    """x as an unsigned 64-bit integer (modulo 2^64)."""
    return int(x) & _MASK


@overload(u64, jit_options=OPTIONS)
def _u64(x):
    return lambda x: np.uint64(x)


@njit
def mix(x):
    """A bijection of 64-bit integers in which each output bit depends on each input bit.

    Source: the finaliser of SplitMix64, variant 13 of Stafford 2011, "Better bit mixing".
    """
    x = u64(x)
    x = u64((x ^ (x >> u64(30))) * u64(0xBF58476D1CE4E5B9))
    x = u64((x ^ (x >> u64(27))) * u64(0x94D049BB133111EB))
    return x ^ (x >> u64(31))


@njit
def combine(key, counter):
    """A new key from a key and a counter; distinct counters give unrelated keys."""
    return mix(u64(u64(key) ^ u64(u64(u64(counter) + u64(1)) * u64(_GOLDEN))))


@njit
def uniform(bits):
    """The top 53 of 64 random bits as a float64 in [0, 1): multiples of 2^-53, never 1."""
    return (u64(bits) >> u64(11)) * 1.1102230246251565e-16


@njit
def permute(i, n, key):
    """Element i of a permutation of 0 .. n-1 chosen by `key`.

    Source: Kensler 2013, "Correlated multi-jittered sampling", Pixar TM 13-01 (cycle walking), with a keyed
    Feistel network of four rounds as the bijection on the next even power of two. A keyed rotation at the end brings
    each element to each place equally often.
    """
    half = 1
    while (1 << (2 * half)) < n:
        half += 1
    low = (1 << half) - 1
    x = i
    while True:
        left, right = x >> half, x & low
        for turn in range(4):
            left, right = right, left ^ (int(combine(key, right * 4 + turn) >> u64(33)) & low)
        x = (left << half) | right
        if x < n:
            return (x + int(combine(key, -1) >> u64(11))) % n


class Counter(NamedTuple):
    """The dimension that the current sample draws next; one array for each thread."""

    next: View


def new_counter() -> Counter:
    return Counter(View(np.zeros(1, np.int64)))
