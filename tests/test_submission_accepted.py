"""Correct answers, written in many ways, are accepted without a word and are right.

Those that draw the same numbers in the same order as raylab give the same samples. The others are held against the
mean of raylab's own: both in plain Python, N samples each; |difference| <= z standard errors, z = 6 for a false alarm
of 2e-9 for each of fewer than 500 comparisons.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from raylab import trials
from raylab.plain import Plain
from raylab.strategies import BUILT_IN
from raylab.submission import Climb, Task, climb
from raylab.submission.example import Example, examples
from raylab.submission.shape import ENTRY, check_shape
from raylab.submission.source import read
from raylab.testing import Examiner

FOLDER = Path(__file__).parent / "submissions"
DIFFUSE = (
    "slide", "with_helpers", "early_ends", "by_hand", "by_index", "with_while", "other_numbers", "several_samples",
    "with_arrays", "decorated", "by_solid_angle", "inner", "with_lists", "one_of_them", "antithetic",
)  # fmt: skip
OTHERS = {
    "area_slide": "area", "area_keywords": "area", "area_sum": "area", "uniform_slide": "env_uniform",
    "uniform_own": "env_uniform", "uniform_rejected": "env_uniform", "cosine_slide": "env_cosine",
    "cosine_sphere": "env_cosine", "brdf_slide": "env_brdf", "brightness_slide": "env_brightness",
    "phong_slide": "glossy_phong", "phong_own": "glossy_phong", "mis_slide": "mis_balance",
    "mis_by_hand": "mis_balance",
}  # fmt: skip
NOT_THE_SAME_NUMBERS = {
    "other_numbers", "several_samples", "one_of_them", "antithetic", "uniform_own", "uniform_rejected", "cosine_sphere",
    "mis_by_hand", "by_solid_angle",
}  # fmt: skip
MAPS = ("hemisphere_slide", "hemisphere_turned", "hemisphere_folded", "cosine_lifted", "cosine_arcsin")
SHADES = [("area_diffuse.py", name, "area_diffuse") for name in DIFFUSE]
SHADES += [("others.py", name, like) for name, like in OTHERS.items()]


def task(name: str, like: str = "") -> Task:
    if like:
        return Task(name, name, like=like)
    return Task(
        name, name, kind="map", arguments=("N", "u"), takes=("vector", "pair"), gives=("vector", "number")
    )  # fmt: skip


def bytes_of(file: str) -> bytes:
    return (FOLDER / file).read_bytes()


@cache
def looked_at(file: str) -> Climb:
    tasks = [task(name, like) for in_file, name, like in SHADES if in_file == file]
    return climb(bytes_of(file), tasks + [task(name) for name in MAPS if file == "others.py"], until="interpret")


def samples(shade, example: Example, n: int) -> np.ndarray:
    plain = Plain(example.scene, example.place, seed=11)
    return np.array([tuple(plain.call(shade, i)) for i in range(n)])


@pytest.mark.parametrize(("file", "name", "like"), SHADES, ids=[name for _, name, _ in SHADES])
def test_a_correct_shade_is_accepted_and_right(file, name, like, capsys):
    said = [finding for finding in looked_at(file).of(name) if finding.kind not in ("note",)]
    assert said == []
    source = read(bytes_of(file))
    asked = task(name, like)
    own = source.namespace(check_shape(source, asked)[0])[ENTRY]
    for example in examples(asked):
        same = name not in NOT_THE_SAME_NUMBERS
        n = 40 if same else 600
        mine, raylabs = samples(own, example, n), samples(BUILT_IN[like][0], example, n)
        if same:  # rounding of some ten operations on numbers that may cancel to a thousandth
            np.testing.assert_allclose(mine, raylabs, rtol=1e-11, atol=1e-13)
        else:
            error = np.sqrt((mine.var(axis=0, ddof=1) + raylabs.var(axis=0, ddof=1)) / n)
            assert (abs(mine.mean(axis=0) - raylabs.mean(axis=0)) <= 6.0 * error).all()
        assert raylabs.mean() > 0.0


def test_maps_are_accepted_compiled_and_right():
    """Over the midpoints of a fine grid: unit vectors above the horizon, with the density and mean that are due."""
    climbed = climb(bytes_of("others.py"), [task(name) for name in MAPS])
    assert [f for f in climbed.findings if f.kind != "note"] == []
    m, N = 64, np.array([0.48, -0.6, 0.64])
    u = np.stack(np.meshgrid((np.arange(m) + 0.5) / m, (np.arange(m) + 0.5) / m), axis=-1).reshape(-1, 2)
    for name in MAPS:
        found = climbed.functions[name](np.hstack([np.tile(N, (m * m, 1)), u]))
        cosine, p = found[:, :3] @ N, found[:, 3]
        np.testing.assert_allclose(np.linalg.norm(found[:, :3], axis=1), 1.0, rtol=1e-14)
        assert cosine.min() >= 0.0
        by_cosine = name.startswith("cosine")
        np.testing.assert_allclose(p, cosine / np.pi if by_cosine else 0.5 / np.pi, rtol=1e-13)
        # the midpoint rule: 1 / m^2 for smooth integrands; a root at the edge, or a fold, costs m^(-3/2)
        assert abs(cosine.mean() - (2.0 / 3.0 if by_cosine else 0.5)) < 2.0 * m**-1.5


FEW = ("by_hand", "with_arrays", "inner", "with_lists")  # what a compiler may find hard


@pytest.mark.parametrize(
    ("file", "names"),
    [
        ("area_diffuse.py", FEW),
        pytest.param("area_diffuse.py", DIFFUSE, marks=pytest.mark.certify),
        pytest.param("others.py", tuple(OTHERS), marks=pytest.mark.certify),
    ],
    ids=["few", "diffuse", "others"],
)
def test_they_compile(file, names):
    tasks = [task(name, like) for _, name, like in SHADES if name in names]
    climbed = climb(bytes_of(file), tasks, until="compile")
    assert [str(f) for f in climbed.findings if f.kind != "note"] == []
    assert set(climbed.functions) == set(names)


def test_notes_are_no_faults():
    said = [str(f) for f in looked_at("area_diffuse.py").findings]
    assert len(said) == 2, said
    assert "has no effect" in said[0]  # @njit(fastmath=True, cache=True)
    assert "`albedo` for `k_d`" in said[1]


@pytest.mark.certify
@pytest.mark.parametrize("name", DIFFUSE)
def test_compiled_they_are_unbiased(name):
    asked = Task(name, name, like="area_diffuse", trial="polygons")
    climbed = climb(bytes_of("area_diffuse.py"), [asked])
    assert [f for f in climbed.findings if f.kind != "note"] == []
    technique = "one_light_uniform" if name == "one_of_them" else "direct"  # how large a sample may be
    report = Examiner().unbiased(technique, climbed.functions[name], trials.make("polygons", 5), delta=0.03)
    assert report.outcome == "PASS", str(report)
