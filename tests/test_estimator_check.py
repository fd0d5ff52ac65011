"""Bad estimators: each is named as what it is, and a correct one is not."""

from __future__ import annotations

import pytest
import students

from raylab.estimator_check import KINDS, check

PATIENCE = 120.0  # seconds: a machine may be busy with other things


@pytest.mark.parametrize(
    ("shade", "kind", "seen"),
    [
        (students.returns_nan, "nan", "nan"),
        (students.returns_a_number, "type", "float, expected a Vec3"),
        (students.returns_two_numbers, "shape", "shape (2,)"),
        (students.returns_nothing, "type", "NoneType"),
        (students.returns_negative_light, "negative", "-"),
        (students.forgets_the_cosines_and_multiplies_by_pi, "bound", "at most"),
        (students.changes_a_light, "mutation", "not what it was"),
        (students.changes_the_normal, "mutation", "not what it was"),
        (students.keeps_state, "state", "with the same numbers"),
        (students.uses_random, "global random", "random.random()"),
        (students.uses_numpy, "global random", "numpy.random.default_rng()"),
        (students.raises, "error", "no_such_thing"),
    ],
)
def test_a_bad_estimator_is_named(shade, kind, seen):
    findings = check(shade, "area_diffuse", "polygons", seed=3, seconds=PATIENCE)
    assert [finding.kind for finding in findings] == [kind]
    assert seen in findings[0].seen
    assert str(findings[0]).startswith(KINDS[kind])


def test_one_that_never_returns_is_stopped():
    (finding,) = check(students.never_returns, "area_diffuse", "polygons", seconds=3.0)
    assert finding.kind == "time limit"


def test_a_correct_one_is_left_in_peace():
    assert check(students.correct, "area_diffuse", "polygons", seed=5, seconds=PATIENCE) == []
    assert check(students.correct, "area_diffuse", "round_lights", seed=5, seconds=PATIENCE) == []


def test_a_function_without_a_file_cannot_be_watched():
    space: dict = {}
    exec("def shade(x, k_d, N, scene, rng):\n    return k_d", space)
    with pytest.raises(OSError, match="not in a file"):
        check(space["shade"], "area_diffuse")
