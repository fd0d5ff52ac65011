"""What Embree calls when a ray enters the box of a quadric: the float64 intersection of `raylab.quadrics`.

The argument is the address of an RTCIntersectFunctionNArguments or RTCOccludedFunctionNArguments, which agree in
layout: valid, user data (our rows), primID, context, rays, N and geomID. Word w of ray i stands at w N + i.
"""

from __future__ import annotations

import ctypes
import math
from functools import cache
from typing import Any

import numba
import numpy as np
from numba import types

from raylab.jit import CACHE, OPTIONS, in_cache_folder, njit
from raylab.quadrics import ALL_ROWS, MOVING_COLUMNS, first_hit, quadric_at, quadric_at_time
from raylab.vec3 import Vec3
from raylab.view import view_at

_COLUMNS = 14  # of a Quadric row
_TIME, _T_FAR, _NORMAL, _PRIMITIVE, _GEOMETRY, _INSTANCE, _WORDS = 7, 8, 12, 17, 18, 19, 20  # words of an RTCRayHit


@njit
def still(rows, primitive, time):
    """The quadric of a table in which nothing moves."""
    return quadric_at(rows, primitive)


@njit
def distance(rays, lane, rows, primitive, place):
    """Where a ray (column `lane` of words) meets the quadric; inf for a miss."""
    o, d = Vec3(rays[0, lane], rays[1, lane], rays[2, lane]), Vec3(rays[4, lane], rays[5, lane], rays[6, lane])
    return first_hit(place(rows, primitive, rays[_TIME, lane]), o, d, rays[3, lane], rays[_T_FAR, lane])


@njit
def shorten(arguments, columns, place):
    """Shorten each ray to its first hit and say which primitive that is."""
    pointers, integers = view_at(arguments, 6, 1, np.int64), view_at(arguments, 12, 1, np.int32)
    primitive, lanes, geometry = integers[4, 0], integers[10, 0], integers[11, 0]
    valid, rows = view_at(pointers[0, 0], lanes, 1, np.int32), table_at(pointers[1, 0], primitive, columns)
    rays, ids = view_at(pointers[4, 0], _WORDS, lanes, np.float32), view_at(pointers[4, 0], _WORDS, lanes, np.int32)
    for lane in range(lanes):
        if valid[lane, 0] != 0:
            t = distance(rays, lane, rows, primitive, place)
            if t < math.inf:
                rays[_T_FAR, lane] = np.float32(t)
                for word in range(_NORMAL, _PRIMITIVE):  # Ng, u and v are recomputed by the caller
                    rays[word, lane] = np.float32(0.0)
                ids[_PRIMITIVE, lane], ids[_GEOMETRY, lane], ids[_INSTANCE, lane] = primitive, geometry, -1


@njit
def block(arguments, columns, place):
    """Mark each ray that meets the quadric as blocked."""
    pointers, integers = view_at(arguments, 6, 1, np.int64), view_at(arguments, 12, 1, np.int32)
    primitive, lanes = integers[4, 0], integers[10, 0]
    valid, rows = view_at(pointers[0, 0], lanes, 1, np.int32), table_at(pointers[1, 0], primitive, columns)
    rays = view_at(pointers[4, 0], _NORMAL, lanes, np.float32)
    for lane in range(lanes):
        if valid[lane, 0] != 0 and distance(rays, lane, rows, primitive, place) < math.inf:
            rays[_T_FAR, lane] = np.float32(-math.inf)


@njit
def table_at(address, primitive, columns):
    """Our rows: as many as are needed to read the primitive's, or all where pieces of motion stand behind them."""
    rows = view_at(address, primitive + 1, columns, np.float64)
    if columns == _COLUMNS:
        return rows
    return view_at(address, int(rows[primitive, ALL_ROWS]), columns, np.float64)


def intersect(arguments):
    shorten(arguments, _COLUMNS, still)


def occlude(arguments):
    block(arguments, _COLUMNS, still)


def intersect_moving(arguments):
    shorten(arguments, MOVING_COLUMNS, quadric_at_time)


def occlude_moving(arguments):
    block(arguments, MOVING_COLUMNS, quadric_at_time)


@cache
def quadric_callbacks(moving: bool = False) -> tuple[int, int, Any]:
    """Addresses of the intersect and the occluded callback, and the objects that keep them alive."""
    functions = (intersect_moving, occlude_moving) if moving else (intersect, occlude)
    if numba.config.DISABLE_JIT:
        owners: list[Any] = [ctypes.CFUNCTYPE(None, ctypes.c_void_p)(function) for function in functions]
        addresses = [ctypes.cast(owner, ctypes.c_void_p).value or 0 for owner in owners]
    else:
        owners = [_compile(function) for function in functions]
        addresses = [owner.address for owner in owners]
    return addresses[0], addresses[1], owners


def _compile(function: Any) -> Any:
    options = {name: value for name, value in OPTIONS.items() if name != "nogil"}
    return in_cache_folder(lambda: numba.cfunc(types.void(types.int64), cache=CACHE, **options)(function))
