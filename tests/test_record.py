"""Records, views, tables: the same answers compiled and in plain Python, no leaks, nothing compiled in vain."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest
from helpers import COMPILED, held, size

from raylab.jit import njit
from raylab.record import Table, record
from raylab.vec3 import Vec3, black, vec3_at
from raylab.view import View, view_at

MANY = size(5_000, 200)
compiled_only = pytest.mark.compiled(reason="about the compiler")


@record
class Pair(NamedTuple):
    a: Any
    b: Any

    def total(self):
        return self.a + self.b

    def weighted(self, k, shift):
        return self.total() * k + shift

    def __sub__(self, other):
        return self.a - other


@record
class Other(NamedTuple):
    a: Any

    def total(self):
        return self.a


@record
class Nest(NamedTuple):
    inner: Any
    factor: float

    def total(self):
        return self.inner.total() * self.factor


class Bare(NamedTuple):
    """No @record: fields only."""

    a: float

    def total(self):
        return self.a


@njit
def total(thing):
    return thing.total()


@njit
def weighted(thing, k, shift):
    return thing.weighted(k, shift)


@njit
def deep(nest):
    return nest.inner.inner.total() + nest.total() + nest.inner.inner.a


@njit
def minus(thing, other):
    return thing - other


@pytest.mark.parametrize(
    ("pair", "want", "kind"),
    [
        (Pair(2**60, 1), 2**60 + 1, int),  # an integer: a float64 would lose the 1
        (Pair(2**60, 1.0), 2.0**60, float),
        (Pair(Vec3(1, 2, 3), Vec3(4, 5, 6)), Vec3(5.0, 7.0, 9.0), Vec3),
        (Other(2.5), 2.5, float),
        (Nest(Pair(1, 2), 0.5), 1.5, float),
        (Nest(Nest(Pair(Vec3(1, 2, 3), black), 2.0), 3.0), Vec3(6.0, 12.0, 18.0), Vec3),
    ],
)
def test_methods_are_compiled_for_the_class_and_the_types_of_its_fields(pair, want, kind):
    result = total(pair)
    assert type(result) is kind
    assert result == want == pair.total()


def test_a_method_calls_another_and_takes_arguments():
    assert weighted(Pair(1.0, 2.0), 10.0, 0.5) == 30.5
    assert weighted(Pair(Vec3(1, 0, 0), Vec3(0, 1, 0)), 2, Vec3(0, 0, 7)) == Vec3(2.0, 2.0, 7.0)


def test_methods_and_fields_through_nested_records():
    assert deep(Nest(Nest(Pair(1.0, 2.0), 10.0), 100.0)) == 3.0 + 3000.0 + 1.0


def test_the_operator_minus_of_a_record():
    assert minus(Pair(5.0, 0), 2.0) == 3.0
    assert minus(Pair(Vec3(1, 1, 1), 0), Vec3(0, 1, 2)) == Vec3(1.0, 0.0, -1.0)


@compiled_only
def test_what_is_no_record_has_no_methods():
    import numba

    with pytest.raises(numba.TypingError, match="total"):
        total(Bare(1.0))


# --- View ---


@njit
def touch(view, i, j):
    view[i, j] = view[i, j] + 1
    return len(view)


@njit
def swap(view, i, j):
    a = view[i]
    view[i] = view[j]
    view[j] = a
    return len(view)


@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.int64, np.uint32, np.uint8])
def test_a_view_reads_and_writes_the_array_itself(dtype):
    array = np.arange(12, dtype=dtype).reshape(4, 3)
    view = View(array)
    assert touch(view, 2, 1) == 4
    want = np.arange(12).reshape(4, 3)
    want[2, 1] += 1
    assert np.array_equal(array, want)
    assert view[2, 1] == 8
    line = np.arange(5, dtype=dtype)
    assert swap(View(line), 1, 3) == 5
    assert line.tolist() == [0, 3, 2, 1, 4]


def test_a_view_of_a_strided_array_reads_in_its_order():
    assert [View(np.arange(12.0).reshape(3, 4).T)[i, j] for i in range(4) for j in range(3)] == (
        np.arange(12.0).reshape(3, 4).T.ravel().tolist()
    )
    assert swap(View(np.arange(10.0)[::2]), 0, 4) == 5


@pytest.mark.parametrize("shape", [(), (2, 2, 2)])
def test_a_view_has_one_or_two_dimensions(shape):
    if shape == ():
        assert len(View(np.zeros(shape))) == 1  # numpy makes one element of a number
    else:
        with pytest.raises(ValueError, match="got 3"):
            View(np.zeros(shape))


@compiled_only
def test_views_count_no_references():
    array = np.zeros((2, 2))
    view = View(array)
    touch(view, 0, 0)
    before = held(array, view)
    for _ in range(MANY):
        touch(view, 0, 0)
    assert array[0, 0] == MANY + 1
    assert np.all(held(array, view) - before < MANY / 2)  # a leak would be MANY


@njit
def look(address):
    view = view_at(address, 2, 3, np.float32)
    view[1, 2] = 9.0
    return view[0, 1], len(view)


def test_a_view_of_memory_at_an_address():
    array = np.arange(6, dtype=np.float32).reshape(2, 3)
    assert look(array.ctypes.data) == (1.0, 2)
    assert array.tolist() == [[0, 1, 2], [3, 4, 9]]


# --- Table ---


@record
class Item(NamedTuple):
    value: Vec3
    store: Any

    @staticmethod
    def of(rows, i, store):
        return Item(vec3_at(rows, i), store)

    def scaled(self):
        return self.value * self.store.total()


@record
class Nothing(NamedTuple):
    """What an empty table of Items would hold: by EMPTY, loops over it are left out, whatever `rows` says."""

    value: Vec3
    EMPTY = True

    @staticmethod
    def of(rows, i, store):
        return Nothing(vec3_at(rows, i))

    def scaled(self):
        return Vec3(self.value.x**0.3, 0.0, 0.0)  # `pow` is easy to find in machine code


@record
class Something(NamedTuple):
    """Nothing, but for its EMPTY."""

    value: Vec3

    @staticmethod
    def of(rows, i, store):
        return Something(vec3_at(rows, i))

    def scaled(self):
        return Vec3(self.value.x**0.3, 0.0, 0.0)


class Scene(NamedTuple):
    items: Any


ROWS = np.arange(15.0).reshape(5, 3)


@njit
def walk(scene):
    """Position-weighted sum, so that an element left out, repeated or out of order shows."""
    result, weight = black, 1.0
    for item in scene.items:
        result += item.scaled() * weight
        weight *= 16.0
    return result


@njit
def pairs(table):
    """Two iterators over one table, and a loop that stops early."""
    result, n = 0.0, 0
    for p in table:
        for q in table:
            if q.value.x > p.value.x:
                break
            result += p.value.x * 100.0 + q.value.y
            n += 1
    return result, n


@njit
def at(table, i):
    return table[i].value, len(table), len(table.rows), table.store.total()


def table(rows=ROWS):
    return Table(Item, rows, Pair(1.0, 1.0))


def test_a_table_is_walked_in_order():
    want = black
    for i, row in enumerate(ROWS):
        want = want + Vec3(*row) * 2.0 * 16.0**i
    assert walk(Scene(table())) == want


def test_a_table_of_no_rows_is_walked_not_at_all():
    assert walk(Scene(table(np.zeros((0, 3))))) == black
    assert at(table(), 3) == (Vec3(9.0, 10.0, 11.0), 5, 5, 2.0)
    assert len(table(np.zeros((0, 3)))) == 0


def test_two_loops_over_one_table_do_not_disturb_each_other():
    want = [p[0] * 100.0 + q[1] for i, p in enumerate(ROWS) for q in ROWS[: i + 1]]
    assert pairs(table()) == (sum(want), len(want))


def test_a_table_in_plain_python():
    items = list(table())
    assert [item.value for item in items] == [Vec3(*row) for row in ROWS]
    assert table()[4].scaled() == Vec3(24.0, 26.0, 28.0)
    assert walk.py_func(Scene(table())) == walk(Scene(table())) if COMPILED else True


def test_rows_of_integers_are_read_as_floats():
    assert table(np.arange(6).reshape(2, 3))[1].value == Vec3(3.0, 4.0, 5.0)


@compiled_only
def test_a_loop_over_an_empty_class_is_compiled_to_nothing():
    rows = np.ones((3, 3))

    def machine_code():
        walk._outer.overloads.clear()  # so that one signature is left to look at
        return lambda: next(iter(walk._outer.overloads.values())).library.get_llvm_str()

    code = machine_code()
    assert walk(Scene(Table(Something, rows))) == Vec3(1 + 16 + 256, 0.0, 0.0)
    assert "@llvm.pow" in code() or "@pow" in code()  # the search finds what is there
    code = machine_code()
    assert walk(Scene(Table(Nothing, rows))) == black
    assert "@llvm.pow" not in code()
    assert "@pow" not in code()


@compiled_only
def test_tables_and_their_stores_leak_nothing():
    one, store = np.ones((2, 3)), Pair(1.5, 2.5)
    scene = Scene(Table(Item, one, store))
    walk(scene)
    things = (one, store, scene, scene.items, scene.items.rows)
    before = held(*things)
    for _ in range(MANY):
        walk(scene)
    assert np.all(held(*things) - before < MANY / 2)
