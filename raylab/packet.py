"""Packet: sixteen eye rays that start alike, traced together by `rtcIntersect16`: a third of the cost of one by one.

An RTCRayHit16: word w of lane i stands at [w, i].
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from raylab.embree import BYTES, INT32, call, library
from raylab.jit import OPTIONS, njit
from raylab.lanes import LANES, ROWS, TIME
from raylab.record import record
from raylab.vec3 import Vec3
from raylab.view import View

_PACKET_WORDS = 24  # of an RTCRayHit, and room to spare
_COHERENT = np.array([1 << 16, -1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0], np.int32)  # RTCIntersectArguments: flags, features


@njit
def at(row, lane):
    """Where word `row` of a lane stands."""
    return row * LANES + lane


@record
class Packet(NamedTuple):
    """LANES rays and their hits, in memory of one thread's own: word w of lane i at w LANES + i, so that the compiler
    may treat several lanes side by side."""

    words: View  # (24 LANES,) float32
    ids: View  # the same memory as int32
    valid: View  # (LANES,) int32: -1 for a lane in use, 0 for one that is not
    numbers: View  # (ROWS LANES,) float64: of which each ray is made, see `raylab.lanes`

    def keep(self, row, lane, number):
        """Set a random number of which a lane's ray will be made; rows as in `raylab.lanes`."""
        self.numbers[at(row, lane)] = number

    def keep_point(self, row, lane, point):
        self.numbers[at(row, lane)], self.numbers[at(row + 1, lane)] = point

    def point(self, row, lane):
        """The point in rows `row` and `row` + 1."""
        return self.numbers[at(row, lane)], self.numbers[at(row + 1, lane)]

    def drawn_time(self, lane):
        """The time in [0, 1], as Embree sees it."""
        return np.float64(np.float32(self.numbers[at(TIME, lane)]))

    def put(self, lane, o, d, tfar, time, valid):
        """Set a lane to the ray o + t d, 0 <= t <= tfar, at a time."""
        words = self.words
        words[at(7, lane)] = time
        words[at(0, lane)], words[at(1, lane)], words[at(2, lane)] = o.x, o.y, o.z
        words[at(4, lane)], words[at(5, lane)], words[at(6, lane)] = d.x, d.y, d.z
        words[at(8, lane)] = tfar
        self.valid[lane] = -1 if valid else 0

    def invalid(self, used):
        """How many of the first `used` lanes have no valid ray."""
        count = 0
        for lane in range(used):
            count += 1 + self.valid[lane]
        return count

    def clear(self, used):
        """No hits yet, and lanes `used`, used + 1, ... are not traced. Embree leaves the words in between alone."""
        for lane in range(LANES):
            self.ids[at(9, lane)] = -1
            self.ids[at(18, lane)] = -1
        for lane in range(used, LANES):
            self.valid[lane] = 0

    def o(self, lane):
        return Vec3(self.words[at(0, lane)], self.words[at(1, lane)], self.words[at(2, lane)])

    def d(self, lane):
        return Vec3(self.words[at(4, lane)], self.words[at(5, lane)], self.words[at(6, lane)])

    def time(self, lane):
        return np.float64(self.words[at(7, lane)])

    def hit(self, lane):
        """(geometry, primitive) that the lane's ray met first; geometry -1 for nothing."""
        return np.int64(self.ids[at(18, lane)]), np.int64(self.ids[at(17, lane)])


def new_packet() -> Packet:
    """A packet in memory aligned as Embree wants it; what no ray changes (tnear, id, flags) is 0."""
    memory = np.zeros((_PACKET_WORDS + 2) * LANES, np.float32)
    start = (-memory.ctypes.data % 64) // 4
    words, valid = np.split(memory[start:][: (_PACKET_WORDS + 1) * LANES], [_PACKET_WORDS * LANES])
    numbers = np.full(ROWS * LANES, 0.5)
    numbers[at(TIME, 0) :] = 0.0
    return Packet(View(words), View(words.view(np.int32)), View(valid.view(np.int32)), View(numbers))


def trace_packet(handle, packet):
    """Let each lane in use find its first hit: `packet.hit`."""
    words, valid = packet.words.array, packet.valid.array
    library().rtcIntersect16(valid.ctypes.data, int(handle), words.ctypes.data, _COHERENT.ctypes.data)


@intrinsic
def _trace_packet(typing_context, handle, words, valid):
    def codegen(context, builder, signature, arguments):
        handle, words, valid = arguments
        memory = [
            cgutils.create_struct_proxy(t)(context, builder, value=v).data
            for t, v in zip(signature.args[1:], (words, valid), strict=True)
        ]
        content = ir.Constant(ir.ArrayType(INT32, len(_COHERENT)), [int(v) for v in _COHERENT])
        options = cgutils.global_constant(builder, "raylab_coherent", content)
        options.align = 16
        call(builder, "rtcIntersect16", memory[1], builder.inttoptr(handle, BYTES), memory[0], options)

    return types.void(types.uint64, words, valid), codegen


@overload(trace_packet, jit_options=OPTIONS)
def _overload_trace_packet(handle, packet):
    return lambda handle, packet: _trace_packet(handle, packet.words, packet.valid)
