"""@record: a NamedTuple whose methods and operators also compile; Table: many records of one kind in one array.

A record is passed by value. A kernel that receives it is compiled for the record's class and for the types of its
fields, which is how raylab leaves out what a scene does not need: a scene without textures holds a record whose
look-up is a constant, and nothing of textures is in the machine code.
"""

from __future__ import annotations

import inspect
import operator
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt
from numba import types
from numba.core import cgutils
from numba.core.imputils import RefType, impl_ret_borrowed, iternext_impl
from numba.extending import (
    NativeValue,
    lower_builtin,
    make_attribute_wrapper,
    models,
    overload,
    overload_method,
    register_model,
    typeof_impl,
    unbox,
)

from raylab.jit import OPTIONS, njit
from raylab.view import View, ViewType

T = TypeVar("T")
_ROWS = ViewType(types.float64, 2)
_compiled: dict[Callable[..., Any], Any] = {}
_methods: set[str] = set()
_fields: set[str] = set()


def record(cls: type[T]) -> type[T]:
    """Let the methods of the NamedTuple class `cls` be called inside compiled code.

    numba looks up methods by name for all NamedTuples, so a method must not share its name with a field of a record.
    """
    members = {name for name, member in vars(cls).items() if inspect.isfunction(member) and name[0] != "_"}
    _fields.update(cls._fields)  # type: ignore[attr-defined]
    for name in members - _methods:
        _overload_record_method(name)
    _methods.update(members)
    if _fields & _methods:
        raise TypeError(f"record {cls.__name__}: both a field and a method: {sorted(_fields & _methods)}")
    return cls


def _jitted(function: Callable[..., Any]) -> Any:
    if function not in _compiled:
        _compiled[function] = njit(function)
    return _compiled[function]


def _method_of(numba_type: Any, name: str) -> Any:
    method = getattr(getattr(numba_type, "instance_class", None), name, None)
    return _jitted(method) if method is not None else None


def _overload_record_method(name: str) -> None:
    @overload_method(types.BaseNamedTuple, name, jit_options=OPTIONS)
    def _(self, *arguments):
        method = _method_of(self, name)
        return None if method is None else lambda self, *arguments: method(self, *arguments)


@overload(operator.sub, jit_options=OPTIONS)
def _overload_sub(a, b):
    method = _method_of(a, "__sub__") if isinstance(a, types.BaseNamedTuple) else None
    return None if method is None else lambda a, b: method(a, b)


class Table:
    """A sequence of records of one class: `rows` (n, k) float64, a row for each, and what they share, `store`.

    `cls.of(rows, i, store)` makes record i. Iteration, `len` and `[i]` work compiled and in plain Python. A loop over
    a table whose class says EMPTY = True is compiled to nothing.
    """

    def __init__(self, cls: Any, rows: npt.ArrayLike, store: Any = 0) -> None:
        self.cls, self.rows, self.store = cls, View(np.asarray(rows, np.float64)), store

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, i: int) -> Any:
        return self.cls.of(self.rows, i, self.store)

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))


class TableType(types.IterableType):
    def __init__(self, cls: Any, element: types.Type, store: types.Type) -> None:
        self.cls, self.element, self.store = cls, element, store
        super().__init__(f"Table({cls.__module__}.{cls.__name__}, {store})")

    @property
    def iterator_type(self) -> types.Type:
        return TableIterator(self)


class TableIterator(types.SimpleIteratorType):
    def __init__(self, table: TableType) -> None:
        self.table = table
        super().__init__(f"iter({table.name})", table.element)


@register_model(TableType)
class _TableModel(models.StructModel):
    def __init__(self, manager, numba_type):
        members = [("rows", _ROWS), ("store", numba_type.store)]
        super().__init__(manager, numba_type, members)


@register_model(TableIterator)
class _TableIteratorModel(models.StructModel):
    def __init__(self, manager, numba_type):
        super().__init__(manager, numba_type, [("next", types.EphemeralPointer(types.intp)), ("table", numba_type.table)])


make_attribute_wrapper(TableType, "rows", "rows")
make_attribute_wrapper(TableType, "store", "store")


@typeof_impl.register(Table)
def _typeof(value, context):
    one_row = View(np.zeros((1, value.rows.array.shape[1])))
    element = typeof_impl(value.cls.of(one_row, 0, value.store), context)
    return TableType(value.cls, element, typeof_impl(value.store, context))


@unbox(TableType)
def _unbox(numba_type, value, c):
    struct = cgutils.create_struct_proxy(numba_type)(c.context, c.builder)
    for name, member in (("rows", _ROWS), ("store", numba_type.store)):
        attribute = c.pyapi.object_getattr_string(value, name)
        setattr(struct, name, c.unbox(member, attribute).value)
        c.pyapi.decref(attribute)
    return NativeValue(struct._getvalue(), is_error=cgutils.is_not_null(c.builder, c.pyapi.err_occurred()))


@overload(len, jit_options=OPTIONS)
def _overload_len(table):
    return (lambda table: len(table.rows)) if isinstance(table, TableType) else None


@overload(operator.getitem, jit_options=OPTIONS)
def _overload_getitem(table, i):
    if isinstance(table, TableType):
        of = _jitted(table.cls.of)
        return lambda table, i: of(table.rows, i, table.store)


@lower_builtin("getiter", TableType)
def _getiter(context, builder, signature, arguments):
    iterator = cgutils.create_struct_proxy(signature.return_type)(context, builder)
    iterator.next = cgutils.alloca_once_value(builder, context.get_constant(types.intp, 0))
    iterator.table = arguments[0]
    return impl_ret_borrowed(context, builder, signature.return_type, iterator._getvalue())


@lower_builtin("iternext", TableIterator)
@iternext_impl(RefType.NEW)
def _iternext(context, builder, signature, arguments, result):
    (iterator_type,) = signature.args
    iterator = cgutils.create_struct_proxy(iterator_type)(context, builder, value=arguments[0])
    of, i = _jitted(iterator_type.table.cls.of), builder.load(iterator.next)

    def size(table):
        return len(table.rows)

    def element(table, i):
        return of(table.rows, i, table.store)

    table = iterator.table
    n = context.compile_internal(builder, size, types.intp(iterator_type.table), [table])
    empty = getattr(iterator_type.table.cls, "EMPTY", False)
    more = cgutils.false_bit if empty else builder.icmp_signed("<", i, n)
    result.set_valid(more)
    with builder.if_then(more):
        of_i = iterator_type.yield_type(iterator_type.table, types.intp)
        result.yield_(context.compile_internal(builder, element, of_i, [table, i]))
        builder.store(cgutils.increment_index(builder, i), iterator.next)
