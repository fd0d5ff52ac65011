"""@record: a NamedTuple whose methods and operators also compile; Table: many records of one kind in one array.

A record is passed by value. A kernel that receives it is compiled for the record's class and for the types of its
fields, which is how raylab leaves out what a scene does not need: a scene without textures holds a record whose
look-up is a constant, and nothing of textures is in the machine code.
"""

from __future__ import annotations

import functools
import inspect
import operator
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt
from numba import types
from numba.core import cgutils
from numba.core.imputils import RefType, impl_ret_borrowed, iternext_impl
from numba.core.typing.templates import AbstractTemplate, AttributeTemplate, infer_getattr, infer_global, signature
from numba.extending import (
    NativeValue,
    lower_builtin,
    make_attribute_wrapper,
    models,
    overload,
    register_model,
    typeof_impl,
    unbox,
)

from raylab.jit import OPTIONS, interpreted, njit
from raylab.view import View, ViewType

T = TypeVar("T")
_ROWS = ViewType(types.float64, 2)


def record(cls: type[T]) -> type[T]:
    """Let the methods of the NamedTuple class `cls`, and its operator -, be used inside compiled code."""
    for name, member in list(vars(cls).items()):
        if inspect.isfunction(member) and (name[0] != "_" or name == "__sub__"):
            _compiled_methods[cls, name] = njit(member)
    return cls


_compiled_methods: dict[tuple[type, str], Any] = {}


def methods_of(shared: type) -> Callable[[type[T]], type[T]]:
    """Below @record: a NamedTuple class, which cannot inherit, gets the methods of `shared` that are not its own."""

    def add(cls: type[T]) -> type[T]:
        for name, member in vars(shared).items():
            if inspect.isfunction(member) and name not in vars(cls):
                setattr(cls, name, member)
        return cls

    return add


def _dispatcher(numba_type: Any, name: str) -> types.Dispatcher | None:
    method = _compiled_methods.get((getattr(numba_type, "instance_class", None), name))  # type: ignore[arg-type]
    return None if method is None else types.Dispatcher(method.inner)


@infer_getattr
class _RecordMethods(AttributeTemplate):
    """record.name is a method of the record's class, if it has one of that name."""

    key = types.BaseNamedTuple

    def generic_resolve(self, record_type: Any, name: str) -> types.Type | None:
        if _dispatcher(record_type, name) is None:
            return None
        return types.BoundFunction(_method_template(name), record_type)


@functools.cache
def _method_template(name: str) -> type:
    """The typing template of all record methods called `name`, and their lowering: a call of the class's function."""

    class MethodTemplate(AbstractTemplate):
        key = ("record method", name)

        def generic(self, arguments, keywords):
            dispatcher = _dispatcher(self.this, name)
            full = dispatcher.get_call_type(self.context, (self.this, *arguments), keywords)
            return None if full is None else signature(full.return_type, *full.args[1:], recvr=self.this)

    @lower_builtin(MethodTemplate.key, types.BaseNamedTuple, types.VarArg(types.Any))
    def lower(context, builder, method_signature, arguments):
        return _call(context, builder, _dispatcher(method_signature.args[0], name), method_signature, arguments)

    return MethodTemplate


def _call(context, builder, dispatcher, call_signature, arguments):
    plain = signature(call_signature.return_type, *call_signature.args)
    dispatcher.get_call_type(context.typing_context, plain.args, {})
    function = context.get_function(dispatcher, plain)
    context.add_linking_libs(getattr(function, "libs", ()))
    return function(builder, arguments)


@infer_global(operator.sub)
class _RecordSub(AbstractTemplate):
    def generic(self, arguments, keywords):
        dispatcher = _dispatcher(arguments[0], "__sub__")
        return None if dispatcher is None else dispatcher.get_call_type(self.context, arguments, keywords)


@lower_builtin(operator.sub, types.BaseNamedTuple, types.Any)
def _lower_sub(context, builder, sub_signature, arguments):
    return _call(context, builder, _dispatcher(sub_signature.args[0], "__sub__"), sub_signature, arguments)


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


@functools.cache
def _row_reader(cls: Any) -> Any:
    return njit(cls.of)


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
        super().__init__(
            manager, numba_type, [("next", types.EphemeralPointer(types.intp)), ("table", numba_type.table)]
        )


make_attribute_wrapper(TableType, "rows", "rows")
make_attribute_wrapper(TableType, "store", "store")


@typeof_impl.register(Table)
def _typeof(value, context):
    one_row = View(np.zeros((1, value.rows.array.shape[1])))
    with interpreted():  # compiling `of` for this one call would take a second
        one = value.cls.of(one_row, 0, value.store)
    element = typeof_impl(one, context)
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
        of = _row_reader(table.cls)
        return lambda table, i: of(table.rows, i, table.store)


@lower_builtin("getiter", TableType)
def _getiter(context, builder, iter_signature, arguments):
    iterator = cgutils.create_struct_proxy(iter_signature.return_type)(context, builder)
    iterator.next = cgutils.alloca_once_value(builder, context.get_constant(types.intp, 0))
    iterator.table = arguments[0]
    return impl_ret_borrowed(context, builder, iter_signature.return_type, iterator._getvalue())


@lower_builtin("iternext", TableIterator)
@iternext_impl(RefType.NEW)
def _iternext(context, builder, next_signature, arguments, result):
    (iterator_type,) = next_signature.args
    iterator = cgutils.create_struct_proxy(iterator_type)(context, builder, value=arguments[0])
    of, i = _row_reader(iterator_type.table.cls), builder.load(iterator.next)

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
