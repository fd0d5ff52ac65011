"""Bad estimators: each is named as what it is, and a correct one is not."""

from __future__ import annotations

import random

import numpy as np
import pytest

from raylab.estimator_check import KINDS, check
from raylab.point import dist_sqr
from raylab.shadow import shadow
from raylab.vec3 import Vec3, black, dot, normalize

CALLS = []


def correct(x, k_d, N, scene, rng):
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            result += light.radiance * k_d * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y) / p_y
    return result


def returns_nan(x, k_d, N, scene, rng):
    return correct(x, k_d, N, scene, rng) * (float("nan") if rng.number() < 0.5 else 1.0)


def returns_a_number(x, k_d, N, scene, rng):
    return 0.5


def returns_two_numbers(x, k_d, N, scene, rng):
    return np.array([0.5, 0.5])


def returns_nothing(x, k_d, N, scene, rng):
    correct(x, k_d, N, scene, rng)


def returns_negative_light(x, k_d, N, scene, rng):
    return correct(x, k_d, N, scene, rng) - Vec3(0.0, 1e-3, 0.0)


def forgets_the_cosines_and_multiplies_by_pi(x, k_d, N, scene, rng):
    return correct(x, k_d, N, scene, rng) * 30.0


def changes_a_light(x, k_d, N, scene, rng):
    scene.lights.rows[0, 1] = 0.0
    return correct(x, k_d, N, scene, rng)


def changes_the_normal(x, k_d, N, scene, rng):
    N.z = -N.z
    return correct(x, k_d, N, scene, rng)


def keeps_state(x, k_d, N, scene, rng):
    CALLS.append(1)
    return correct(x, k_d, N, scene, rng) * (1.0 / len(CALLS))


def uses_random(x, k_d, N, scene, rng):
    return correct(x, k_d, N, scene, rng) * random.random()


def uses_numpy(x, k_d, N, scene, rng):
    return correct(x, k_d, N, scene, rng) * np.random.default_rng(1).random()


def never_returns(x, k_d, N, scene, rng):
    while True:
        pass


def raises(x, k_d, N, scene, rng):
    return scene.no_such_thing


@pytest.mark.parametrize(
    ("shade", "kind", "seen"),
    [
        (returns_nan, "nan", "nan"),
        (returns_a_number, "type", "float, expected a Vec3"),
        (returns_two_numbers, "shape", "shape (2,)"),
        (returns_nothing, "type", "NoneType"),
        (returns_negative_light, "negative", "-"),
        (forgets_the_cosines_and_multiplies_by_pi, "bound", "at most"),
        (changes_a_light, "mutation", "not what it was"),
        (changes_the_normal, "mutation", "not what it was"),
        (keeps_state, "state", "with the same numbers"),
        (uses_random, "global random", "random.random()"),
        (uses_numpy, "global random", "numpy.random.default_rng()"),
        (raises, "error", "no_such_thing"),
    ],
)
def test_a_bad_estimator_is_named(shade, kind, seen):
    findings = check(shade, "area_diffuse", "polygons", seed=3)
    assert [finding.kind for finding in findings] == [kind]
    assert seen in findings[0].seen
    assert str(findings[0]).startswith(KINDS[kind])


def test_one_that_never_returns_is_stopped():
    (finding,) = check(never_returns, "area_diffuse", "polygons", seconds=6.0)
    assert finding.kind == "time limit"


def test_a_correct_one_is_left_in_peace():
    assert check(correct, "area_diffuse", "polygons", seed=5) == []
    assert check(correct, "area_diffuse", "round_lights", seed=5) == []


def test_a_function_without_a_file_cannot_be_watched():
    space: dict = {}
    exec("def shade(x, k_d, N, scene, rng):\n    return k_d", space)
    with pytest.raises(OSError, match="not in a file"):
        check(space["shade"], "area_diffuse")
