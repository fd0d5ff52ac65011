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


SMALL = """
    a, b = 1.5, (1, 2.5, 'x'); return b[1] * u * a
    θ = u; Δx = 2.0 * θ; return Δx
    def g(b): return b * u; return g(2.0)
    b = [i * u for i in range(3)]; return b[0] + sum(b) + len(b)
    a, b = (u, 1) if u > 0.5 else (1, u); return a if a > b else b
    v = Vec3(u, 0, 0); v += v; v *= 2; v /= 2; v -= v * 0.5; return v.x + True
    return int(u * 5) // 2 % 2 + min(u, 1, 0.5) + max((u, 2.0)) + round(u) + abs(-u) + divmod(5, 3)[0] + pow(u, 2)
    b = np.zeros((2, 2)); b[0, 1] = u; return b[0, 1] + b.sum() + b.shape[0] + np.sum(b * b) + np.mean(b)
    c = u; c, b = c, c; c: float = b; return c + b
    t = 0.0; t += sum((u, 2 * u)) + math.tau; return t
    return dot(AXES[1], Vec3(u, u, u)) * HALF * N + helper(u)
    return u if u else 0
    return helper(helper(u, 2.0), power=3.0)
""".strip().splitlines()


def test_small_ways_of_writing_are_accepted():
    """Python and the compiler agree on each of them: that is what the ladder checks."""
    head = (
        "import math\nimport numpy as np\nfrom raylab.lecture import *\nN = 2 ** 3 - 1\nHALF = -1 / 2\n"
        "AXES = (Vec3(1.0, 0.0, 0.0), Vec3(0.0, 2.0, 0.0))\n\n\ndef helper(u, power=2.0):\n    return u ** power\n\n\n"
    )
    text, tasks = head, []
    for number, line in enumerate(SMALL):
        body = line.strip().replace("def g(b): return b * u; ", "g = lambda b: b * u; ").replace("; ", "\n    ")
        text += f"def f{number}(u):\n    {body}\n\n\n"
        tasks.append(Task(str(number), f"f{number}", "map", "", ("u",), ("number",), ("number",)))
    climbed = climb(text.encode(), tasks)
    assert [str(f) for f in climbed.findings] == []
    assert len(climbed.functions) == len(SMALL)
