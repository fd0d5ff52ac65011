"""View: an array inside a record, seen by compiled code as a bare pointer and a shape.

numba counts references to arrays, atomically, each time a record with an array in it changes hands, which costs
more than the shading. A View counts nothing: the Python side keeps the array alive for the length of the call.
"""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
from numba import from_dtype, types
from numba.core import cgutils
from numba.extending import (
    NativeValue,
    intrinsic,
    make_attribute_wrapper,
    models,
    overload,
    register_model,
    typeof_impl,
    unbox,
)

from raylab.jit import OPTIONS


class View:
    """A C-contiguous array of one or two dimensions: `view[i]`, `view[i, j]`, `len(view)`, assignment."""

    __slots__ = ("array",)

    def __init__(self, array: Any) -> None:
        self.array = np.ascontiguousarray(array)
        if self.array.ndim not in (1, 2):
            raise ValueError(f"a View has one or two dimensions, got {self.array.ndim}")

    def __getitem__(self, index: Any) -> Any:
        return self.array[index].item()

    def __setitem__(self, index: Any, value: Any) -> None:
        self.array[index] = value

    def __len__(self) -> int:
        return len(self.array)


class ViewType(types.Type):
    def __init__(self, dtype: types.Type, ndim: int) -> None:
        self.dtype, self.ndim = dtype, ndim
        super().__init__(f"View({dtype}, {ndim}d)")


@register_model(ViewType)
class _ViewModel(models.StructModel):
    def __init__(self, manager, numba_type):
        members = [("data", types.CPointer(numba_type.dtype)), ("rows", types.intp), ("columns", types.intp)]
        super().__init__(manager, numba_type, members)


make_attribute_wrapper(ViewType, "rows", "rows")
make_attribute_wrapper(ViewType, "columns", "columns")


@typeof_impl.register(View)
def _typeof(value, context):
    return ViewType(from_dtype(value.array.dtype), value.array.ndim)


@unbox(ViewType)
def _unbox(numba_type, value, c):
    array_type = types.Array(numba_type.dtype, numba_type.ndim, "C")
    attribute = c.pyapi.object_getattr_string(value, "array")
    native = c.unbox(array_type, attribute)
    array = c.context.make_array(array_type)(c.context, c.builder, value=native.value)
    shape = cgutils.unpack_tuple(c.builder, array.shape)
    struct = cgutils.create_struct_proxy(numba_type)(c.context, c.builder)
    struct.data, struct.rows = array.data, shape[0]
    struct.columns = shape[1] if numba_type.ndim == 2 else c.context.get_constant(types.intp, 1)
    c.context.nrt.decref(c.builder, array_type, native.value)
    c.pyapi.decref(attribute)
    return NativeValue(struct._getvalue(), is_error=native.is_error)


def _pointer(context, builder, view_type, view, i, j):
    struct = cgutils.create_struct_proxy(view_type)(context, builder, value=view)
    return builder.gep(struct.data, [builder.add(builder.mul(i, struct.columns), j)])


@intrinsic
def _load(typing_context, view, i, j):
    def codegen(context, builder, signature, arguments):
        return builder.load(_pointer(context, builder, signature.args[0], *arguments))

    return view.dtype(view, types.intp, types.intp), codegen


@intrinsic
def _store(typing_context, view, i, j, value):
    def codegen(context, builder, signature, arguments):
        *place, stored = arguments
        builder.store(stored, _pointer(context, builder, signature.args[0], *place))

    return types.void(view, types.intp, types.intp, view.dtype), codegen


@overload(operator.getitem, jit_options=OPTIONS)
def _overload_getitem(view, index):
    if isinstance(view, ViewType):
        if isinstance(index, types.BaseTuple):
            return lambda view, index: _load(view, index[0], index[1])
        return lambda view, index: _load(view, index, 0)


@overload(operator.setitem, jit_options=OPTIONS)
def _overload_setitem(view, index, value):
    if isinstance(view, ViewType):
        if isinstance(index, types.BaseTuple):
            return lambda view, index, value: _store(view, index[0], index[1], value)
        return lambda view, index, value: _store(view, index, 0, value)


@overload(len, jit_options=OPTIONS)
def _overload_len(view):
    return (lambda view: view.rows) if isinstance(view, ViewType) else None


# --- memory that somebody else owns: what Embree hands to a callback ---


def view_at(address, rows, columns, dtype):
    """A View of `rows` x `columns` numbers of the numpy type `dtype` at an address."""
    numbers = np.ctypeslib.as_ctypes_type(dtype) * (rows * columns)
    return View(np.ctypeslib.as_array(numbers.from_address(int(address))).reshape(rows, columns))


@intrinsic
def _view_at(typing_context, address, rows, columns, dtype):
    view_type = ViewType(dtype.dtype, 2)

    def codegen(context, builder, signature, arguments):
        struct = cgutils.create_struct_proxy(view_type)(context, builder)
        struct.data = builder.inttoptr(arguments[0], context.get_value_type(types.CPointer(dtype.dtype)))
        struct.rows, struct.columns = arguments[1], arguments[2]
        return struct._getvalue()

    return view_type(types.int64, types.intp, types.intp, dtype), codegen


@overload(view_at, jit_options=OPTIONS)
def _overload_view_at(address, rows, columns, dtype):
    return lambda address, rows, columns, dtype: _view_at(address, rows, columns, dtype)
