"""Single: a compiled function of raylab once more in float32, so that the table tells formulas that hold from luck.

single(triangle_angle)(*map(vector, ...))   plain Python on numpy's float32, which a float of Python does not widen
"""

from __future__ import annotations

import math
import operator
import types
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import numpy as np

from raylab.jit import Compiled
from raylab.vec3 import Vec3


class Vector:
    """A Vec3 of float32."""

    def __init__(self, x: Any, y: Any, z: Any) -> None:
        self.x, self.y, self.z = np.float32(x), np.float32(y), np.float32(z)

    def __iter__(self) -> Iterator[np.float32]:
        yield from (self.x, self.y, self.z)

    def _with(self, other: Any, do: Callable[[Any, Any], Any]) -> Vector:
        others = other if isinstance(other, Vector) else (np.float32(other),) * 3
        return Vector(*(do(a, b) for a, b in zip(self, others, strict=True)))

    def __add__(self, other: Any) -> Vector:
        return self._with(other, operator.add)

    def __sub__(self, other: Any) -> Vector:
        return self._with(other, operator.sub)

    def __mul__(self, other: Any) -> Vector:
        return self._with(other, operator.mul)

    __rmul__ = __mul__
    __array_ufunc__ = None

    def __truediv__(self, other: Any) -> Vector:
        return self._with(other, operator.truediv)

    def __neg__(self) -> Vector:
        return Vector(-self.x, -self.y, -self.z)


class _Math:
    """The functions of `math`, rounded to float32."""

    def __getattr__(self, name: str) -> Any:
        found = getattr(math, name)
        if isinstance(found, float):
            return np.float32(found)
        return lambda *x: _rounded(getattr(np, _NUMPY.get(name, name))(*map(np.float32, x)))


_NUMPY = {"atan2": "arctan2", "atan": "arctan", "acos": "arccos", "asin": "arcsin", "pow": "power"}


def _rounded(value: Any) -> Any:
    return np.float32(value) if isinstance(value, np.floating | float) else value


@cache
def single(function: Any) -> Any:
    """The same in float32, with all that it calls; arguments and results are numpy's float32, alone or in a Vector."""
    plain = function.py_func if isinstance(function, Compiled) else function
    space = {name: _converted(value) for name, value in plain.__globals__.items() if name in _names(plain.__code__)}
    made = types.FunctionType(
        plain.__code__, space | {"__builtins__": __builtins__}, plain.__name__, plain.__defaults__
    )

    def call(*arguments: Any) -> Any:
        with np.errstate(all="ignore"):
            return made(*arguments)

    return call


def _names(code: types.CodeType) -> set[str]:
    inner = (c for c in code.co_consts if isinstance(c, types.CodeType))
    return set(code.co_names).union(*map(_names, inner))


def _converted(value: Any) -> Any:
    if value is math:
        return _Math()
    if value is Vec3:
        return Vector
    if isinstance(value, Vec3):
        return vector(value)
    if isinstance(value, float):
        return np.float32(value)
    if isinstance(value, tuple) and value and all(isinstance(v, float) for v in value) and type(value) is tuple:
        return tuple(np.float32(v) for v in value)
    return single(value) if isinstance(value, Compiled) else value


def vector(v: Any) -> Vector:
    """Three numbers as a vector of float32."""
    return Vector(*map(float, v))
