"""Embree inside the kernel: which primitive does a ray meet, and is anything in the way?

The embreex wheel carries Embree's C library. ctypes builds the scene; compiled code calls `rtcIntersect1` and
`rtcOccluded1` directly. Embree answers *which* primitive and *whether*; where, and with what normal, is recomputed
in float64 by the caller. Coordinates are the normalised ones of `raylab.scene` (all within [-1, 1]).

Rays go one by one (`trace`, `blocked`) or, when many start alike, in a `raylab.packet`.
"""

from __future__ import annotations

import ctypes
import importlib.metadata
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
from llvmlite import binding as llvm
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from raylab.callbacks import quadric_callbacks
from raylab.jit import OPTIONS
from raylab.vec3 import Vec3, Vec3Type

TNEAR = 2.0**-100  # robust mode counts a hit at t = tnear, so tnear = 0 would meet the surface the ray starts on
_TRIANGLES, _USER, _INDEX, _VERTEX, _UINT3, _FLOAT3, _ROBUST = 0, 120, 0, 1, 0x5003, 0x9003, 4
_POINTER, _UINT = ctypes.c_void_p, ctypes.c_uint
_SIGNATURES: dict[str, tuple[Any, list[Any]]] = {
    "rtcNewDevice": (_POINTER, [ctypes.c_char_p]),
    "rtcReleaseDevice": (None, [_POINTER]),
    "rtcGetDeviceError": (ctypes.c_int, [_POINTER]),
    "rtcNewScene": (_POINTER, [_POINTER]),
    "rtcReleaseScene": (None, [_POINTER]),
    "rtcSetSceneFlags": (None, [_POINTER, ctypes.c_int]),
    "rtcCommitScene": (None, [_POINTER]),
    "rtcNewGeometry": (_POINTER, [_POINTER, ctypes.c_int]),
    "rtcReleaseGeometry": (None, [_POINTER]),
    "rtcCommitGeometry": (None, [_POINTER]),
    "rtcAttachGeometry": (_UINT, [_POINTER, _POINTER]),
    "rtcSetSharedGeometryBuffer": (
        None,
        [_POINTER, ctypes.c_int, _UINT, ctypes.c_int, _POINTER, ctypes.c_size_t, ctypes.c_size_t, ctypes.c_size_t],
    ),
    "rtcSetGeometryUserPrimitiveCount": (None, [_POINTER, _UINT]),
    "rtcSetGeometryTimeStepCount": (None, [_POINTER, _UINT]),
    "rtcSetGeometryUserData": (None, [_POINTER, _POINTER]),
    "rtcSetGeometryBoundsFunction": (None, [_POINTER, _POINTER, _POINTER]),
    "rtcSetGeometryIntersectFunction": (None, [_POINTER, _POINTER]),
    "rtcSetGeometryOccludedFunction": (None, [_POINTER, _POINTER]),
    "rtcIntersect1": (None, [_POINTER, _POINTER, _POINTER]),
    "rtcIntersect16": (None, [_POINTER, _POINTER, _POINTER, _POINTER]),
    "rtcOccluded1": (None, [_POINTER, _POINTER, _POINTER]),
}


@cache
def library() -> ctypes.CDLL:
    """Embree 4's C library, as shipped by the embreex wheel, made known to the compiler."""
    files = importlib.metadata.files("embreex") or []
    path = next((f for f in files if f.name.startswith(("libembree4", "embree4"))), None)
    if path is None:
        raise ImportError("the installed embreex package does not contain the Embree 4 library")
    loaded = ctypes.CDLL(str(path.locate()))
    for name, (result, arguments) in _SIGNATURES.items():
        function = getattr(loaded, name)
        function.restype, function.argtypes = result, arguments
    for name in ("rtcIntersect1", "rtcIntersect16", "rtcOccluded1"):
        llvm.add_symbol(name, ctypes.cast(getattr(loaded, name), _POINTER).value)
    return loaded


def _options() -> bytes:
    """Moving triangles with their corners in the leaves of the tree, where Embree's choice has indices to them: up to
    1.8 times as fast, but a ray along the edge of two of them may slip through (docs/precision.md)."""
    wide = llvm.get_host_cpu_features().get("avx2", False)
    return b"tri_accel_mb=bvh8.triangle4vmb" if wide else b"tri_accel_mb=bvh4.triangle4vmb"


class EmbreeScene:
    """An acceleration structure over triangle meshes and quadrics; geometry i is mesh i, the last one the quadrics.

    `handle` is what compiled code passes to `trace` and `blocked`; it lives as long as this object.
    """

    def __init__(self) -> None:
        self._rtc = library()
        self._device = self._rtc.rtcNewDevice(_options())
        self._scene = self._rtc.rtcNewScene(self._device)
        self._rtc.rtcSetSceneFlags(self._scene, _ROBUST)
        self._keep: list[Any] = []  # buffers and callbacks that Embree refers to

    @property
    def handle(self) -> int:
        return int(self._scene)

    def add_mesh(self, vertices: npt.NDArray[np.float32], faces: npt.NDArray[np.uint32], segments: int = 0) -> None:
        """Share `vertices` (n, 3), followed in memory by at least four more bytes, and `faces` (m, 3).

        A mesh that moves in `segments` straight parts of equal duration has n / (segments + 1) vertices at each end.
        """
        geometry = self._rtc.rtcNewGeometry(self._device, _TRIANGLES)
        count = len(vertices) // (segments + 1)
        if segments:
            self._rtc.rtcSetGeometryTimeStepCount(geometry, segments + 1)
        buffers = [(_VERTEX, k, _FLOAT3, vertices[k * count :], count) for k in range(segments + 1)]
        for kind, slot, layout, buffer, size in [*buffers, (_INDEX, 0, _UINT3, faces, len(faces))]:
            self._rtc.rtcSetSharedGeometryBuffer(geometry, kind, slot, layout, buffer.ctypes.data, 0, 12, size)
        self._keep += [vertices, faces]
        self._attach(geometry)

    def add_quadrics(self, rows: npt.NDArray[np.float64], bounds: npt.NDArray[np.float64]) -> None:
        """Add `Quadric` rows with their boxes `bounds` (steps, n, 6): lower then upper corner, at each time step.

        With more than one step the rows are those of `MovingQuadric`.
        """
        steps, count = bounds.shape[:2]
        outer = np.concatenate([bounds[..., :3] - 2.0**-18, bounds[..., 3:] + 2.0**-18], axis=-1).astype(np.float32)

        def give_bounds(arguments: int) -> None:
            primitive, step = _UINT.from_address(arguments + 8).value, _UINT.from_address(arguments + 12).value
            target = _POINTER.from_address(arguments + 16).value or 0
            ctypes.memmove(target, outer[step, primitive, :3].ctypes.data, 12)
            ctypes.memmove(target + 16, outer[step, primitive, 3:].ctypes.data, 12)

        callback = ctypes.CFUNCTYPE(None, _POINTER)(give_bounds)
        intersect, occluded, owner = quadric_callbacks(steps > 1)
        geometry = self._rtc.rtcNewGeometry(self._device, _USER)
        self._rtc.rtcSetGeometryUserPrimitiveCount(geometry, count)
        if steps > 1:
            self._rtc.rtcSetGeometryTimeStepCount(geometry, steps)
        self._rtc.rtcSetGeometryUserData(geometry, rows.ctypes.data)
        self._rtc.rtcSetGeometryBoundsFunction(geometry, ctypes.cast(callback, _POINTER), None)
        self._rtc.rtcSetGeometryIntersectFunction(geometry, intersect)
        self._rtc.rtcSetGeometryOccludedFunction(geometry, occluded)
        self._keep += [rows, callback, owner]
        self._attach(geometry)

    def _attach(self, geometry: int) -> None:
        self._rtc.rtcCommitGeometry(geometry)
        self._rtc.rtcAttachGeometry(self._scene, geometry)
        self._rtc.rtcReleaseGeometry(geometry)

    def commit(self) -> None:
        """Build; rays may be traced afterwards."""
        self._rtc.rtcCommitScene(self._scene)
        error = self._rtc.rtcGetDeviceError(self._device)
        if error != 0:
            raise RuntimeError(f"Embree reports error {error} while building the scene")

    def __del__(self) -> None:
        if hasattr(self, "_scene"):
            self._rtc.rtcReleaseScene(self._scene)
            self._rtc.rtcReleaseDevice(self._device)


# --- rays from compiled code: an RTCRay (48 bytes) or RTCRayHit (96 bytes), 16-byte aligned, on the stack ---

_F32, INT32, _I64, BYTES = ir.FloatType(), ir.IntType(32), ir.IntType(64), ir.IntType(8).as_pointer()


def _new_ray(builder, words, o, d, tnear, tfar, time):
    with builder.goto_entry_block():
        ray = builder.alloca(ir.ArrayType(_F32, words))
        ray.align = 16
    for k, v in enumerate((*o, tnear, *d, time, tfar)):
        builder.store(builder.fptrunc(v, _F32), _word(builder, ray, k))
    for k, v in ((9, -1), (10, 0), (11, 0)):  # mask, id, flags
        builder.store(ir.Constant(INT32, v), _word(builder, ray, k, INT32))
    return ray


def _word(builder, ray, k, element=_F32):
    address = builder.gep(ray, [ir.Constant(INT32, 0), ir.Constant(INT32, k)])
    return address if element is _F32 else builder.bitcast(address, element.as_pointer())


def call(builder, name, *pointers):
    signature = ir.FunctionType(ir.VoidType(), [BYTES] * len(pointers))
    function = cgutils.get_or_insert_function(builder.module, signature, name)
    builder.call(function, [builder.bitcast(p, BYTES) for p in pointers])


def _components(context, builder, value):
    struct = cgutils.create_struct_proxy(Vec3Type())(context, builder, value=value)
    return struct.x, struct.y, struct.z


@intrinsic
def _trace(typing_context, handle, o, d, tnear, tfar, time):
    result = types.UniTuple(types.int64, 2)

    def codegen(context, builder, signature, arguments):
        handle, o, d, *interval = arguments
        ray = _new_ray(builder, 24, _components(context, builder, o), _components(context, builder, d), *interval)
        for k in (17, 18, 19, 20):  # primID, geomID, instID, instPrimID: none
            builder.store(ir.Constant(INT32, -1), _word(builder, ray, k, INT32))
        call(builder, "rtcIntersect1", builder.inttoptr(handle, BYTES), ray, ir.Constant(BYTES, None))
        ids = [builder.sext(builder.load(_word(builder, ray, k, INT32)), _I64) for k in (18, 17)]
        return context.make_tuple(builder, result, ids)

    return result(types.uint64, o, d, types.float64, types.float64, types.float64), codegen


@intrinsic
def _blocked(typing_context, handle, o, d, tfar, time):
    def codegen(context, builder, signature, arguments):
        handle, o, d, tfar, time = arguments
        interval = (ir.Constant(ir.DoubleType(), TNEAR), tfar, time)
        ray = _new_ray(builder, 12, _components(context, builder, o), _components(context, builder, d), *interval)
        call(builder, "rtcOccluded1", builder.inttoptr(handle, BYTES), ray, ir.Constant(BYTES, None))
        return builder.fcmp_ordered("<", builder.load(_word(builder, ray, 8)), ir.Constant(_F32, 0.0))

    return types.boolean(types.uint64, o, d, types.float64, types.float64), codegen


def trace(handle, o, d, tnear, tfar, time=0.0):
    """(geometry, primitive) of the first thing that o + t d meets for t in [tnear, tfar]; -1 for nothing."""
    words = _python_ray(o, d, tnear, tfar, time)
    words[17:21].view(np.int32)[:] = -1
    library().rtcIntersect1(int(handle), words.ctypes.data, None)
    return int(words.view(np.int32)[18]), int(words.view(np.int32)[17])


def blocked(handle, o, d, tfar, time=0.0):
    """Whether anything lies on o + t d for t in (0, tfar)."""
    words = _python_ray(o, d, TNEAR, tfar, time)
    library().rtcOccluded1(int(handle), words.ctypes.data, None)
    return bool(words[8] < 0.0)


@overload(trace, jit_options=OPTIONS)
def _overload_trace(handle, o, d, tnear, tfar, time=0.0):
    return lambda handle, o, d, tnear, tfar, time=0.0: _trace(handle, o, d, tnear, tfar, time)


@overload(blocked, jit_options=OPTIONS)
def _overload_blocked(handle, o, d, tfar, time=0.0):
    return lambda handle, o, d, tfar, time=0.0: _blocked(handle, o, d, tfar, time)


def _python_ray(o: Vec3, d: Vec3, tnear: float, tfar: float, time: float = 0.0) -> npt.NDArray[np.float32]:
    memory = np.zeros(32, np.float32)
    start = (-memory.ctypes.data % 16) // 4
    words = memory[start : start + 24]
    words[:9] = [*o, tnear, *d, time, tfar]
    words[9:10].view(np.int32)[0] = -1
    return words
