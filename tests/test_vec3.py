"""Vec3: the operators compiled and in plain Python, conversions, memory."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import COMPILED, held, same_bits, size

from raylab import vec3
from raylab.jit import njit
from raylab.vec3 import Vec3, black

RAMP = Vec3(1.0, 2.0, 3.0)
MANY = size(10_000, 500)


@njit
def operate(a, b, s):
    added, subtracted, multiplied, divided = a, a, a, a
    added += b
    subtracted -= b
    multiplied *= b
    divided /= b
    scaled, shrunk = a, a
    scaled *= s
    shrunk /= s
    return (a + b, a - b, a * b, a / b, a * s, s * a, a / s, -a, added, subtracted, multiplied, divided, scaled, shrunk)


def expected(a, b, s):
    """The same fourteen results from nothing but float arithmetic."""
    pairs = list(zip(a, b, strict=True))
    add, sub = [p + q for p, q in pairs], [p - q for p, q in pairs]
    mul, div = [p * q for p, q in pairs], [p / q for p, q in pairs]
    scale, shrink = [p * s for p in a], [p * (1.0 / s) for p in a]
    return [add, sub, mul, div, scale, scale, shrink, [-p for p in a], add, sub, mul, div, scale, shrink]


def numbers():
    """Triples over all magnitudes, with signed zeros, infinities, NaN and subnormal numbers among them."""
    rng = np.random.default_rng(1)
    special = [0.0, -0.0, math.inf, -math.inf, math.nan, 5e-324, -(2.0**-1060), 1.7e308]
    for _ in range(200):
        a, b = rng.choice([-1.0, 1.0], (2, 3)) * (1 + rng.random((2, 3))) * 2.0 ** rng.integers(-500, 500, (2, 3))
        s = float((1 + rng.random()) * 2.0 ** rng.integers(-500, 500))
        if rng.random() < 0.5:
            a[rng.integers(3)] = rng.choice(special)
        yield [float(p) for p in a], [float(p) for p in b], s


def test_operators_compute_what_floats_compute_bit_for_bit():
    for a, b, s in numbers():
        for result, want in zip(operate(Vec3(*a), Vec3(*b), s), expected(a, b, s), strict=True):
            assert same_bits([*result], want), (a, b, s)


def test_operators_in_plain_python_are_the_compiled_ones():
    plain = getattr(operate, "py_func", operate)
    for a, b, s in numbers():
        for compiled, interpreted in zip(operate(Vec3(*a), Vec3(*b), s), plain(Vec3(*a), Vec3(*b), s), strict=True):
            assert type(interpreted) is Vec3
            assert same_bits([*compiled], [*interpreted])


def test_dot_cross_length_normalize_luminance_are_their_formulas():
    for a, b, _ in numbers():
        u, v = Vec3(*a), Vec3(*b)
        (ax, ay, az), (bx, by, bz) = a, b
        square = ax * ax + ay * ay + az * az
        assert same_bits(vec3.dot(u, v), ax * bx + ay * by + az * bz)
        assert same_bits([*vec3.cross(u, v)], [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
        assert same_bits(vec3.length(u), math.sqrt(square) if square == square else math.nan)
        assert same_bits([*vec3.absolute(u)], [abs(p) for p in a])
        assert same_bits(vec3.luminance(u), 0.2126 * ax + 0.7152 * ay + 0.0722 * az)
        assert vec3.is_finite(u) == all(map(math.isfinite, a))
        if 0.0 < square < math.inf:
            inverse = 1.0 / math.sqrt(square)
            assert same_bits([*vec3.normalize(u)], [p * inverse for p in a])


def test_luminance_of_white_is_one():
    assert vec3.luminance(Vec3(1, 1, 1)) == pytest.approx(1.0, abs=2.0**-52)


def test_the_zero_vector_has_no_direction():
    if COMPILED:
        assert all(map(math.isnan, vec3.normalize(black)))
    else:
        with pytest.raises(ZeroDivisionError):
            vec3.normalize(black)


@njit
def accumulate(n):
    result = black
    for i in range(n):
        result += RAMP * i
    return result


def test_a_constant_of_the_module_can_be_added_to():
    assert accumulate(5) == Vec3(10.0, 20.0, 30.0)
    assert accumulate(0) == Vec3(0.0, 0.0, 0.0)
    assert [*black] == [0.0, 0.0, 0.0]


@njit
def from_integers(first):
    result = Vec3(0, 0, 0) if first else Vec3(0.5, 1, True)
    return result + Vec3(1, -2, np.float32(0.25))


@pytest.mark.parametrize(("first", "want"), [(True, (1.0, -2.0, 0.25)), (False, (1.5, -1.0, 1.25))])
def test_integers_become_floats(first, want):
    result = from_integers(first)
    assert (*result,) == want
    assert all(type(component) is float for component in (result.x, result.y, result.z))
    assert all(type(component) is float for component in Vec3(0, 1, np.int32(2)))


@njit
def by_number(k, v):
    return k * v, v * k, v / k


@pytest.mark.parametrize("k", [4, 4.0, np.float64(4.0), np.float32(4.0), np.int64(4)])
def test_any_number_scales_from_either_side(k):
    want = (Vec3(4.0, 8.0, 12.0), Vec3(4.0, 8.0, 12.0), Vec3(0.25, 0.5, 0.75))
    for results in (by_number(k, RAMP), (k * RAMP, RAMP * k, RAMP / k)):
        assert [type(result) for result in results] == [Vec3] * 3  # and not an array of three objects
        assert results == want


@njit
def through(v):
    return v


@njit
def two(v):
    return v, v + v


@pytest.mark.compiled(reason="boxing is compiled code")
def test_boxing_and_unboxing_leak_nothing():
    v = Vec3(1.5, 2.5, 3.5)
    through(v), two(v)
    before = held(Vec3, v, v.x)
    for _ in range(MANY):
        through(v)
        two(v)
    assert np.all(held(Vec3, v, v.x) - before < MANY / 2)  # a leak would be MANY


@pytest.mark.compiled(reason="unboxing is compiled code")
def test_a_component_that_is_no_number_is_an_error():
    v = Vec3(1, 2, 3)
    v.y = "two"  # type: ignore[assignment]
    with pytest.raises(TypeError):
        through(v)


def test_a_vector_and_a_number_cannot_be_added():
    with pytest.raises((TypeError, AttributeError)):
        RAMP + 1.0  # type: ignore[operator]


def test_equality_hash_repr_and_iteration():
    assert Vec3(1, 2, 3) == RAMP != Vec3(1, 2, 4)
    assert RAMP != (1.0, 2.0, 3.0)
    assert hash(Vec3(1, 2, 3)) == hash(RAMP)
    tenth = Vec3(0.1, -0.0, 1e-300)
    assert same_bits([*eval(repr(tenth))], [0.1, -0.0, 1e-300])


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_rows_of_an_array_as_vectors(dtype):
    rows = np.arange(12, dtype=dtype).reshape(4, 3) / 3
    assert [*vec3.vec3_at(rows, 2)] == rows[2].tolist()
