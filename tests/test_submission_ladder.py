"""The way of a student's file: which stage stops it, in which line, and what comes out at the top."""

from __future__ import annotations

import json

import numpy as np
import pytest

from raylab.probe import Probe
from raylab.submission import Finding, Task, climb
from raylab.submission.example import examples

DIFFUSE = Task("a1.diffuse", "shade", like="area_diffuse")
SAMPLE = Task(
    "a3.sample", "sample", kind="map", arguments=("N", "u"), takes=("vector", "pair"), gives=("vector", "number")
)
IMPORTS = "import math\nimport numpy as np\nfrom raylab.lecture import *\n\n\n"
HEAD = IMPORTS + "def shade(x, k_d, N, scene, rng):\n"  # line 6
BOX = """    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        if not shadow(scene, x, y):
            L = normalize(y - x)
            result += (light.radiance * k_d
                       * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n))
                       / dist_sqr(x, y) / p_y)
    return result
"""
LIFTED = """
def sample(N, u):
    return lift(N, u[0], math.sqrt(1.0 - u[0] * u[0]), u[1]), 0.5 / PI
"""


def looked_at(source: str | bytes, task: Task = DIFFUSE) -> list[Finding]:
    """What is found without the compiler."""
    return climb(source if isinstance(source, bytes) else source.encode(), [task], until="interpret").findings


def test_a_correct_file_gives_functions_that_agree_with_raylab():
    """The whole ladder: two kernels are compiled, which takes some ten seconds."""
    heard: list[Finding] = []
    climbed = climb((HEAD + BOX + LIFTED).encode(), [DIFFUSE, SAMPLE], heard.append)
    assert climbed.findings == heard == []
    where = next(examples(DIFFUSE))
    ours = Probe(where.scene, "area_diffuse", where.place, 1).sample(7, 50)
    theirs = Probe(where.scene, climbed.functions["a1.diffuse"], where.place, 1).sample(7, 50)
    np.testing.assert_allclose(theirs, ours, rtol=2.0**-48)
    rows = climbed.functions["a3.sample"](np.array([[0.0, 0.0, 1.0, 0.6, 0.25]]))
    np.testing.assert_allclose(rows[0, 2:], [0.6, 0.5 / np.pi], rtol=2.0**-50)
    assert np.hypot(*rows[0, :2]) == pytest.approx(0.8, rel=2.0**-50)


@pytest.mark.parametrize(
    ("source", "stage", "kind", "line", "words"),
    [
        (b"", "parse", "error", 0, "empty"),
        (b"PK\x03\x04", "parse", "error", 0, "a zip file"),
        ("def shade()".encode("utf-16"), "parse", "error", 0, "UTF-16"),
        (b"a = 1\nb = '\xe9'\n", "parse", "error", 2, "not UTF-8"),
        (b"a = 1\nb = \x00\n", "parse", "error", 2, "NUL"),
        (b"#" * (1 << 19), "parse", "error", 0, "524288 bytes"),
        (b'{"cells": []}', "parse", "error", 0, "notebook"),
        ("a = “1”\n", "parse", "error", 1, "U+201C"),
        ("a = 1 +\u00a01\n", "parse", "error", 1, "U+00A0"),
        ("# \u202e\n", "parse", "error", 1, "U+202E"),
        ("d\u043et = 1\n", "parse", "error", 1, "cyrillic small letter o"),
        ("def shade(x:\n", "parse", "error", 1, "was never closed"),
        ("def shade(x)\n    pass\n", "parse", "error", 1, "expected ':'"),
        ("import os, sys\nsys.exit(0)\n", "parse", "error", 2, "would run as soon as"),
        ("class V:\n    pass\n", "parse", "error", 1, "Classes"),
        ("A = [1]\n", "parse", "error", 1, "constant"),
        (HEAD + "    raise NotImplementedError('the slide')\n", "shape", "unfinished", 6, "not written yet"),
        (HEAD + '    """Doc."""\n    pass\n', "shape", "unfinished", 6, "not written yet"),
        (HEAD + "    result = black\n    raise NotImplementedError\n", "interpret", "unfinished", 8, "not written yet"),
        (IMPORTS + "def Shade(x):\n    return x\n", "shape", "error", 6, "no function `shade`"),
        (IMPORTS + "def shade(x, N):\n    return x\n", "shape", "error", 6, "it will be given (x, k_d, N, scene, rng)"),
        (HEAD + BOX.replace("k_d", "kd"), "vet", "error", 12, "`kd` is not defined"),
        (HEAD + "    return area\n", "vet", "error", 7, "`area` is not defined"),
        (HEAD + "    while True: pass\n", "interpret", "error", 7, "does not end"),
        (HEAD + "    return 0\n", "interpret", "error", 7, "the number 0"),
        (HEAD + "    return k_d * (1.0 / (x.p.x - x.p.x))\n", "interpret", "error", 7, "divides by zero"),
        (HEAD + "    return k_d * dot(-N, N)\n", "interpret", "warning", 7, "negative"),
        (HEAD + "    a = math.inf\n    b = a - a\n    return k_d * b\n", "interpret", "warning", 7, "`a` becomes"),
    ],
)  # fmt: skip
def test_a_file_is_stopped_in_a_line_and_in_words(source, stage, kind, line, words):
    (finding,) = looked_at(source)
    assert (finding.stage, finding.kind, finding.line) == (stage, kind, line), str(finding)
    assert words in finding.sentence
    assert json.loads(json.dumps(finding.to_dict()))["sentence"] == finding.sentence


def test_tasks_are_read_from_tables():
    assert Task.from_dict(json.loads(json.dumps(SAMPLE.to_dict()))) == SAMPLE
    assert Task.from_dict(DIFFUSE.to_dict()) == DIFFUSE
    assert SAMPLE.columns == (5, 4)
    with pytest.raises(ValueError, match="no colour"):
        Task.from_dict({"id": "a", "colour": 1})
    with pytest.raises(ValueError, match="expected one of"):
        Task("a", "shade", like="area_difuse")


ROW = Task("map", "f", kind="map", arguments=("a",), takes=("number",), gives=("number",), examples=((0.25,), (0.75,)))


def climbed(body: str) -> list[Finding]:
    return climb((IMPORTS + "def f(a):\n" + body).encode(), [ROW]).findings


def test_python_and_the_compiler_must_agree():
    (finding,) = climbed("    i = 10\n    for k in range(19):\n        i = i * 10\n    return a * i\n")
    assert finding.stage == "cross-check"
    assert finding.kind == "error"
    assert "sample 0 is (2.5e+19) and (" in finding.sentence
    assert climbed("    i = 10.0\n    for k in range(19):\n        i = i * 10\n    return a * i\n") == []


def test_a_variable_without_a_value_on_some_way_is_remarked():
    """No sample goes that way: Python cannot know."""
    (finding,) = climbed("    if a < 2.0:\n        b = a\n    return b\n")
    assert (finding.stage, finding.kind, finding.line) == ("compile", "note", 9)
    assert "`b` may have no value here" in finding.sentence


def test_windows_and_tabs_are_welcome():
    source = "\ufeffdef f(a):\n\tb = a\n\treturn b\n".replace("\n", "\r\n")
    assert climb(source.encode(), [ROW], until="interpret").findings == []


@pytest.mark.parametrize(
    ("source", "line", "words"),
    [
        ("from raylab.lecture import *\ndef f(a):\n    b = length(N)\n    return b\n", 3, "`N` is not defined"),
        ("def f(a):\n    return g(a)\ndef g(a):\n    return f(a)\n", 2, "`f` calls itself, by way of `g`"),
        ("from raylab.vec3 import *\ndef f(a):\n    dot = dot(a)\n    return dot\n", 3, "is a function, and line 3"),
        ("def f(a):\n    max = max(a, 0.0)\n    return max\n", 2, "is a function, and line 2"),
        ("from raylab.lecture import distSqr\ndef f(a):\n    return distSqr(a, a)\n", 3, "not among the words"),
        ("def f(a):\n    return\n", 1, "not written yet"),
        ("def f(a):\n    return a, a\n", 2, "a tuple of 2 where a number is expected"),
        ("def f(a):\n    return 'x'\n", 2, "a text where a number is expected"),
        ("def f(a):\n    return a / (a - a)\n", 2, "divides by zero"),
    ],
)  # fmt: skip
def test_a_map_gets_its_sentences_too(source, line, words):
    findings = climb(source.encode(), [ROW], until="interpret").findings
    assert [(f.line, f.kind in ("error", "unfinished")) for f in findings] == [(line, True)]
    assert words in findings[0].sentence
