"""What Embree calls when a ray enters the box of a quadric: the float64 intersection of `raylab.quadrics`.

The argument is the address of an RTCIntersectFunctionNArguments or RTCOccludedFunctionNArguments of one ray, which
agree in layout: valid, user data (our rows), primID, context, ray, N and geomID.
"""

from __future__ import annotations

import ctypes
import math
from functools import cache
from typing import Any

import numba
import numpy as np
from numba import types

from raylab.jit import OPTIONS, in_cache_folder, njit
from raylab.quadrics import first_hit, quadric_at
from raylab.vec3 import Vec3
from raylab.view import view_at

_COLUMNS = 14  # of a Quadric row
_T_FAR, _NORMAL, _PRIMITIVE, _GEOMETRY, _INSTANCE = 8, 12, 17, 18, 19  # words of an RTCRayHit


@njit
def distance(ray, rows, primitive):
    """Where the ray (words of an RTCRay) meets the quadric; inf for a miss."""
    o, d = Vec3(ray[0, 0], ray[1, 0], ray[2, 0]), Vec3(ray[4, 0], ray[5, 0], ray[6, 0])
    return first_hit(quadric_at(rows, primitive), o, d, ray[3, 0], ray[_T_FAR, 0])


def intersect(arguments):
    """Shorten the ray to its first hit and say which primitive that is."""
    pointers, integers = view_at(arguments, 6, 1, np.int64), view_at(arguments, 12, 1, np.int32)
    primitive, geometry = integers[4, 0], integers[11, 0]
    ray, ids = view_at(pointers[4, 0], 24, 1, np.float32), view_at(pointers[4, 0], 24, 1, np.int32)
    t = distance(ray, view_at(pointers[1, 0], primitive + 1, _COLUMNS, np.float64), primitive)
    if t < math.inf:
        ray[_T_FAR, 0] = np.float32(t)
        for word in range(_NORMAL, _PRIMITIVE):  # Ng, u and v are recomputed by the caller
            ray[word, 0] = np.float32(0.0)
        ids[_PRIMITIVE, 0] = primitive
        ids[_GEOMETRY, 0] = geometry
        ids[_INSTANCE, 0] = np.int32(-1)


def occlude(arguments):
    """Mark the ray as blocked when it meets the quadric."""
    pointers, integers = view_at(arguments, 6, 1, np.int64), view_at(arguments, 12, 1, np.int32)
    primitive, ray = integers[4, 0], view_at(pointers[4, 0], 12, 1, np.float32)
    if distance(ray, view_at(pointers[1, 0], primitive + 1, _COLUMNS, np.float64), primitive) < math.inf:
        ray[_T_FAR, 0] = np.float32(-math.inf)


@cache
def quadric_callbacks() -> tuple[int, int, Any]:
    """Addresses of the intersect and the occluded callback, and the objects that keep them alive."""
    if numba.config.DISABLE_JIT:
        owners: list[Any] = [ctypes.CFUNCTYPE(None, ctypes.c_void_p)(function) for function in (intersect, occlude)]
        addresses = [ctypes.cast(owner, ctypes.c_void_p).value or 0 for owner in owners]
    else:
        owners = [_compile(function) for function in (intersect, occlude)]
        addresses = [owner.address for owner in owners]
    return addresses[0], addresses[1], owners


def _compile(function: Any) -> Any:
    options = {name: value for name, value in OPTIONS.items() if name != "nogil"}
    return in_cache_folder(lambda: numba.cfunc(types.void(types.int64), cache=True, **options)(function))
