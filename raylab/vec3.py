"""Vec3: three numbers by value, for points, directions and colours, with the operators of the slides.

The class runs as it stands in plain Python. Compiled, a Vec3 is a struct of three float64 in registers, and each
operator compiles the very function that the class uses, so both worlds have one source. `*` and `/` between two
Vec3 work component by component (a colour times a colour).
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterator
from typing import Any

from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_constant
from numba.extending import (
    NativeValue,
    box,
    lower_builtin,
    make_attribute_wrapper,
    models,
    overload,
    register_model,
    type_callable,
    typeof_impl,
    unbox,
)

from raylab.jit import OPTIONS, njit


class Vec3:
    """A point, direction or linear RGB colour (x, y, z)."""

    __slots__ = ("x", "y", "z")
    __array_ufunc__ = None  # np.float64 * Vec3 must come to __rmul__

    def __init__(self, x: float, y: float, z: float) -> None:
        self.x, self.y, self.z = float(x), float(y), float(z)

    def __add__(self, other: Vec3) -> Vec3:
        return _add(self, other)

    def __sub__(self, other: Vec3) -> Vec3:
        return _sub(self, other)

    def __mul__(self, other: Vec3 | float) -> Vec3:
        return _mul(self, other) if isinstance(other, Vec3) else _scale(self, other)

    def __rmul__(self, other: float) -> Vec3:
        return _rscale(other, self)

    def __truediv__(self, other: Vec3 | float) -> Vec3:
        return _div(self, other) if isinstance(other, Vec3) else _shrink(self, other)

    def __neg__(self) -> Vec3:
        return _neg(self)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Vec3) and tuple(self) == tuple(other)

    def __hash__(self) -> int:
        return hash(tuple(self))

    def __iter__(self) -> Iterator[float]:
        yield from (self.x, self.y, self.z)

    def __repr__(self) -> str:
        return f"Vec3({self.x!r}, {self.y!r}, {self.z!r})"


def _add(a, b):
    return Vec3(a.x + b.x, a.y + b.y, a.z + b.z)


def _sub(a, b):
    return Vec3(a.x - b.x, a.y - b.y, a.z - b.z)


def _mul(a, b):
    return Vec3(a.x * b.x, a.y * b.y, a.z * b.z)


def _div(a, b):
    return Vec3(a.x / b.x, a.y / b.y, a.z / b.z)


def _scale(a, b):
    return Vec3(a.x * b, a.y * b, a.z * b)


def _rscale(a, b):
    return Vec3(a * b.x, a * b.y, a * b.z)


def _shrink(a, b):
    inverse = 1.0 / b
    return Vec3(a.x * inverse, a.y * inverse, a.z * inverse)


def _neg(a):
    return Vec3(-a.x, -a.y, -a.z)


# --- what numba must know: a struct of three float64, made from numbers, taken from and given to Python ---


class Vec3Type(types.Type):
    def __init__(self) -> None:
        super().__init__(name="Vec3")


vec3_type = Vec3Type()


@register_model(Vec3Type)
class _Vec3Model(models.StructModel):
    def __init__(self, manager, numba_type):
        super().__init__(manager, numba_type, [(name, types.float64) for name in "xyz"])


for _name in "xyz":
    make_attribute_wrapper(Vec3Type, _name, _name)


@typeof_impl.register(Vec3)
def _typeof(value, context):
    return vec3_type


@type_callable(Vec3)
def _type_constructor(context):
    def typer(x, y, z):
        if all(isinstance(t, types.Number | types.Boolean) for t in (x, y, z)):
            return vec3_type

    return typer


def _pack(context, builder, components):
    struct = cgutils.create_struct_proxy(vec3_type)(context, builder)
    struct.x, struct.y, struct.z = components
    return struct._getvalue()


@lower_builtin(Vec3, types.Any, types.Any, types.Any)
def _lower_constructor(context, builder, signature, arguments):
    pairs = zip(arguments, signature.args, strict=True)
    return _pack(context, builder, [context.cast(builder, v, t, types.float64) for v, t in pairs])


@lower_constant(Vec3Type)
def _lower_constant(context, builder, numba_type, value):
    return _pack(context, builder, [context.get_constant(types.float64, c) for c in value])


@unbox(Vec3Type)
def _unbox(numba_type, value, c):
    components = []
    for name in "xyz":
        attribute = c.pyapi.object_getattr_string(value, name)
        components.append(c.pyapi.float_as_double(attribute))
        c.pyapi.decref(attribute)
    failed = cgutils.is_not_null(c.builder, c.pyapi.err_occurred())
    return NativeValue(_pack(c.context, c.builder, components), is_error=failed)


@box(Vec3Type)
def _box(numba_type, value, c):
    struct = cgutils.create_struct_proxy(vec3_type)(c.context, c.builder, value=value)
    components = [c.pyapi.float_from_double(getattr(struct, name)) for name in "xyz"]
    cls = c.pyapi.unserialize(c.pyapi.serialize_object(Vec3))
    result = c.pyapi.call_function_objargs(cls, components)
    for owned in (*components, cls):
        c.pyapi.decref(owned)
    return result


def _is_vec3(numba_type: Any) -> bool:
    return isinstance(numba_type, Vec3Type)


def _overload_binary(op: Callable, vectors: Callable, vector_number: Callable | None, number_vector: Callable | None):
    @overload(op, jit_options=OPTIONS)
    def _(a, b):
        if _is_vec3(a) and _is_vec3(b):
            return vectors
        if _is_vec3(a) and isinstance(b, types.Number | types.Boolean):
            return vector_number
        if isinstance(a, types.Number | types.Boolean) and _is_vec3(b):
            return number_vector


for _op in (operator.add, operator.iadd):
    _overload_binary(_op, _add, None, None)
for _op in (operator.sub, operator.isub):
    _overload_binary(_op, _sub, None, None)
for _op in (operator.mul, operator.imul):
    _overload_binary(_op, _mul, _scale, _rscale)
for _op in (operator.truediv, operator.itruediv):
    _overload_binary(_op, _div, _shrink, None)


@overload(operator.neg, jit_options=OPTIONS)
def _overload_neg(a):
    return _neg if _is_vec3(a) else None


# --- the words of the slides ---

black = Vec3(0.0, 0.0, 0.0)


@njit
def dot(a, b):
    """a . b"""
    return a.x * b.x + a.y * b.y + a.z * b.z


@njit
def cross(a, b):
    """a x b"""
    return Vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


@njit
def length(a):
    """|a|"""
    return math.sqrt(dot(a, a))


@njit
def normalize(a):
    """a / |a|; for the zero vector NaN compiled, ZeroDivisionError in plain Python."""
    return a / length(a)


@njit
def absolute(a):
    """(|x|, |y|, |z|)"""
    return Vec3(abs(a.x), abs(a.y), abs(a.z))


@njit
def luminance(c):
    """Relative luminance Y of a linear sRGB colour (IEC 61966-2-1)."""
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z


@njit
def is_finite(a):
    """True when no component is NaN or infinite."""
    return math.isfinite(a.x) and math.isfinite(a.y) and math.isfinite(a.z)


@njit
def vec3_at(rows, i):
    """Row i of an (n, 3) array as a Vec3."""
    return Vec3(rows[i, 0], rows[i, 1], rows[i, 2])
