"""Bad estimators: each is named as what it is, and a correct one is not."""

from __future__ import annotations

import pytest
import students

from raylab.estimator_check import KINDS, check
from raylab.testing import Examiner

EXAMINER = Examiner()
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
def test_a_bad_estimator_is_named_in_the_verdict(shade, kind, seen):
    report = EXAMINER.well_behaved("area_diffuse", shade, trial="polygons", seconds=PATIENCE)
    assert report.outcome == "FAIL"
    (finding,) = report.findings
    assert finding.startswith(KINDS[kind])
    assert seen in finding
    assert finding in str(report)


def test_one_that_never_returns_is_stopped():
    report = EXAMINER.well_behaved("area_diffuse", students.never_returns, trial="polygons", seconds=3.0)
    assert report.outcome == "FAIL"
    assert KINDS["time limit"] in str(report)


def test_a_correct_one_is_left_in_peace():
    assert check(students.correct, "area_diffuse", "polygons", seed=5, seconds=PATIENCE) == []
    assert check(students.correct, "area_diffuse", "round_lights", seed=5, seconds=PATIENCE) == []


def test_a_function_without_a_file_cannot_be_watched():
    space: dict = {}
    exec("def shade(x, k_d, N, scene, rng):\n    return k_d", space)
    with pytest.raises(OSError, match="not in a file"):
        check(space["shade"], "area_diffuse")
