"""Diagnosis: the mistake is named, and right answers are not accused. All planted mistakes: docs/diagnosis.md."""

from __future__ import annotations

import numpy as np
import planted
import pytest

from raylab.grading.assignment import NAMES, load
from raylab.grading.causes import CAUSES
from raylab.grading.check import check
from raylab.grading.diagnosis import diagnose
from raylab.grading.evidence import words_of

CORPUS = planted.corpus()
OTHER_NUMBERS = (
    "other_numbers", "a2.area_mirrored", "uniform_own", "cosine_sphere", "a4.brdf_turned", "a5.shade_turned",
    "a3.hemisphere_own_frame", "a5.lobe_turned", "a6.aperture_degrees",
)  # fmt: skip
FIRST = {right.task: right for right in reversed(planted.RIGHT.values())}  # one for each task


def test_there_are_enough_planted_mistakes_and_right_answers():
    assert len(CORPUS) >= 160
    assert {row.right.task for row in CORPUS} == set(planted.TASKS)
    for row in CORPUS:
        row.right.edited(row.edits)
    for name in NAMES:
        assert len(planted.manners.of_assignment(name)) >= 10


def named(rows, n):
    """Of each row, whether the right cause is the first of three that are named, and whether it is among them."""
    found = [[d.cause in row.causes for d in planted.diagnosed(row.right, row.function(), n)] for row in rows]
    return [f[:1] == [True] for f in found], [any(f) for f in found]


def test_the_right_cause_is_named_first_in_most_cases():
    """A selection: at least 85 % of all are asked for, so three in four of these."""
    some = CORPUS[::29]
    first, _ = named(some, 256)
    assert np.mean(first) >= 0.75, [row.name for row, good in zip(some, first, strict=True) if not good]


@pytest.mark.certify
def test_the_right_cause_is_named():
    first, among = named(CORPUS, planted.FOR_MOMENTS)
    assert np.mean(first) >= 0.85
    assert np.mean(among) >= 0.95


@pytest.mark.parametrize("right", FIRST.values(), ids=lambda right: right.task)
def test_a_right_answer_is_not_accused(right):
    assert planted.diagnosed(right, right.function(), 100) == []


@pytest.mark.parametrize("style", OTHER_NUMBERS)
def test_nor_one_that_uses_its_random_numbers_in_another_way(style):
    right = planted.RIGHT[style]
    assert planted.diagnosed(right, right.function(), 256) == []


@pytest.mark.certify
@pytest.mark.parametrize("right", planted.RIGHT.values(), ids=planted.RIGHT)
def test_no_right_answer_is_accused(right):
    assert planted.diagnosed(right, right.function()) == []


SEVERAL = """
import math
from raylab.lecture import Vec3, normalize


def sample_aperture(a, u):
    r, phi = a * u[1], 2.0 * math.pi * u[0]
    return r * math.sin(phi), r * math.cos(phi)


def lens_direction(toward, f, px, py):
    return (normalize(toward) * f - Vec3(px, py, 0.0)) / f


def shutter_time(open, close, u):
    return open + u * close


def position(p0, p1, t0, t1, t):
    return p0 + (p1 - p0) * ((t - t0) / (t1 - t0))
"""
WRONG = {"aperture": "no square root", "lens": "focus sphere", "time": "interval for end", "motion": "not clamped"}


@pytest.mark.parametrize("level", [1, 3])
def test_a_check_names_what_is_wrong_with_plain_functions(level, tmp_path):
    """One that uses its random numbers in another order among them."""
    (tmp_path / "shade.py").write_text(SEVERAL)
    said = []
    check(load("a6"), tmp_path / "shade.py", said.append, hint=level)
    for task, cause in WRONG.items():
        assert f"a6.{task}: {CAUSES[cause].hints[level - 1]}" in said


def test_what_raises_is_named_too():
    """Compiled, 0 / 0 ends the whole block of inputs."""

    class Raises:
        def map(self, task, rows):
            p, q = np.square(rows).T
            if not (p + q).all():
                raise ZeroDivisionError
            return (p / (p + q))[:, None]

    with np.errstate(over="ignore", invalid="ignore"):
        found = diagnose(planted.table("a7.power"), Raises(), "a7.power")
    assert [d.cause for d in found][:1] == ["overflow"]


def test_constants_are_written_as_on_the_slides():
    said = [words_of(c) for c in (2.0, np.pi, 0.5 / np.pi, np.pi / 4, 2 * np.pi, 1 / np.pi**2, 0.123)]
    assert said == ["2", "pi", "1 / (2 pi)", "pi / 4", "2 pi", "1 / pi^2", "0.123"]
