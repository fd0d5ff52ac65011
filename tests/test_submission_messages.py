"""What students do wrong, in their own lines, and the sentence that each of them gets.

Each row goes through the whole ladder without the compiler; the rows that Python lets pass, and those that show what
the compiler alone would have said, go to the compiler directly.
"""

from __future__ import annotations

import re

import pytest

from raylab.plain import Plain
from raylab.submission import Task, climb
from raylab.submission.compile import compile_shade, prepare
from raylab.submission.example import SEED, examples
from raylab.submission.finding import Problem
from raylab.submission.messages import explain_compiler
from raylab.submission.shape import check_shape
from raylab.submission.source import read

TASK = Task("a1.diffuse", "shade", like="area_diffuse")
IMPORTS = "import math\nimport numpy as np\nimport random\nfrom raylab.lecture import *\n\n"
HEAD = IMPORTS + "def shade(x, k_d, N, scene, rng):\n"  # line 6; what follows begins at line 7

# what was written, the line, the sentence of the ladder ("" if Python can run it), the sentence of the compiler
# ("" if it accepts), the advice
ROWS = [
    ("    return kd\n", 7, "`kd` is not defined", "`kd` is not defined", "`k_d`"),
    ("    return helper(k_d)\n", 7, "`helper` is not defined", "`helper` is not defined", ""),
    ("    class V: pass\n    return k_d\n", 7, "Classes cannot be used", "a class cannot be made", "Vec3"),
    ("    return shade(x, k_d, N, scene, rng)\n", 7, "`shade` calls itself", "in a circle", "loop"),
    ("    if N.x < 2.0:\n        return 0\n    return k_d\n", 8, "the number 0", "a number and a Vec3", "black"),
    ("    if N.x < 2.0:\n        return (0.0, 0.0, 0.0)\n    return k_d\n", 8, "a tuple of 3", "a tuple and", ""),
    ("    if N.x > 2.0:\n        return k_d\n", 7, "ends without `return`", "ends without `return`", "return result"),
    ("    result = k_d\n", 7, "ends without `return`", "None", "return result"),
    ("    r = 0\n    if N.x < 2.0:\n        r = k_d\n    return r * k_d\n", 10, "",
     "`r` is a number in one place and a Vec3 in another (lines 7 and 9)", "black"),
    ("    r = 0.0\n    for light in scene.lights:\n        r = r + light.radiance\n    return r\n", 9,
     "adds a number and a Vec3", "adds a number and a Vec3", "result = black"),
    ("    r = 0.0\n    for light in scene.lights:\n        r += light.radiance\n    return r\n", 9,
     "adds a number and a Vec3", "adds a number and a Vec3", "result = black"),
    ("    r = None\n    for light in scene.lights:\n        r = r + light.radiance\n    return r\n", 9,
     "One side of this calculation is None", "one side of this calculation is None", "black"),
    ("    return k_d * np.dot([0, 0, 1], [1, 2, 3])\n", 7, "", "np.dot is for arrays of floats", "dot(a, b)"),
    ("    return k_d * np.dot(N, N)\n", 7, "", "np.dot is for arrays of floats", "dot(a, b)"),
    ("    return k_d * dot([0.0, 0.0, 1.0], N)\n", 7, "A Vec3 is expected", "a Vec3 is expected", "Vec3(x, y, z)"),
    ("    return k_d * dot(N)\n", 7, "`dot` needs more arguments: 'b'", "`dot` needs more arguments: 'b'", ""),
    ("    a = (1.0, 2.0) * 2.0\n    return k_d * a[0]\n", 7, "A tuple, list or text cannot be multiplied",
     "combines a tuple and a number by *", ""),
    ("    return x + k_d\n", 7, "a point or a tuple as if it were a vector", "a point or a tuple", "x.p"),
    ("    return k_d @ 2.0\n", 7, "`@` is not known", "`@` is not known", "dot(a, b)"),
    ("    return 1.0 / k_d\n", 7, "divides a number by a Vec3", "divides a number by a Vec3", ""),
    ("    return k_d ** 2\n", 7, "cannot be raised to a power", "cannot be raised to a power", "a * a"),
    ("    return k_d * N.length()\n", 7, "`.length` is not known", "`.length` is not known", "length(v)"),
    ("    return k_d * light.normal\n", 7, "`light` is not defined", "`light` is not defined", ""),
    ("    return k_d * x.radiance\n", 7, "There is no `.radiance` in a Point", "no `.radiance`", "p (its place)"),
    ("    return k_d * N[2]\n", 7, "A Vec3 has no index", "a Vec3 has no index", "v.x"),
    ("    u = rng.square\n    return k_d * u[0]\n", 8, "must be called first", "must be called first", "brackets"),
    ("    return k_d (2.0)\n", 7, "A Vec3 is not a function", "a Vec3 is not a function", "a * is missing"),
    ("    r = []\n    return k_d * len(r)\n", 7, "", "the list is empty", "np.zeros"),
    ("    return k_d * sum(2.0 for i in range(3))\n", 7, "A generator", "generators cannot be compiled", "for loop"),
    ("    yield k_d\n", 7, "`yield` cannot be used", "generators cannot be compiled", "for loop"),
    ("    try:\n        r = 1.0 / N.x\n    except ZeroDivisionError:\n        r = 0.0\n    return k_d * r\n", 7,
     "`try` cannot be used", "", "Test before dividing"),
    ("    a = f'{N.x:.3f}'\n    return k_d\n", 7, "", "a number cannot be formatted", ""),
    ("    global c\n    c = 1\n    return k_d\n", 7, "cannot change globals", "globals cannot be changed", ""),
    ("    import os\n    return k_d\n", 7, "An import stands inside", "an import stands inside", "top of the file"),
    ("    with open('f') as f:\n        pass\n    return k_d\n", 7, "`with` cannot be used", "`with` cannot be", ""),
    ("    return k_d * np.random.default_rng().random()\n", 7, "`np.random` has a state", "`np.random` has a state",
     "rng.number()"),
    ("    return k_d * random.random()\n", 7, "no `random`", "no `random`", "rng.number()"),
    ("    u = rng.square()\n    u[0] = 0.5\n    return k_d * u[0]\n", 8, "A tuple cannot be changed",
     "a tuple cannot be changed", "u1, u2 = rng.square()"),
    ("    N.x = 0.0\n    return k_d\n", 7, "changes `N.x`", "`.x`", "Vec3(x, y, z)"),
    ("    return k_d / (N.x - N.x)\n", 7, "divides by zero", "", "Test before dividing"),
    ("    return k_d * math.sqrt(-1.0)\n", 7, "of a negative number", "", "max(0.0"),
    ("    a = np.ones(3) + np.ones(2)\n    return k_d * a[0]\n", 7, "different sizes", "", ""),
    ("    a = np.ones(3)\n    return k_d * a[3]\n", 8, "Index 3 is past the end: the array has 3", "", ""),
    ("    return k_d * rng.square()[2]\n", 7, "past the end of the tuple", "past the end of the tuple", "[0] and [1]"),
    ("    if N.x > 2.0:\n        r = 2.0\n    return k_d * r\n", 9, "`r` has no value here; it is only set on line 8",
     "", "r = 0.0"),
    ("    a, b, c = rng.square()\n    return k_d * a\n", 7, "stand 3 names, on the right 2", "3 names", "two numbers"),
    ("    for light in scene.lights:\n        y = light.sample(x, rng.square())\n        L = y.p\n    return k_d\n", 9,
     "A point is expected here, and a tuple", "a point is expected here", "y, p_y = light.sample"),
    ("    for i in 3:\n        pass\n    return k_d\n", 7, "cannot run over a number", "cannot run over", "range"),
    ("    for i in range(2.0):\n        pass\n    return k_d\n", 7, "A whole number is needed", "", "int(...)"),
    ("    return k_d * max(0.0, N)\n", 7, "cannot be compared", "`max` is given a Vec3", ""),
    ("    if k_d == black:\n        return black\n    return k_d\n", 7, "", "cannot be compared by ==", "luminance"),
    ("    return k_d * math.sqrt(N)\n", 7, "is given a Vec3", "`sqrt` is given a Vec3", ""),
    ("    return np.sqrt(k_d)\n", 7, "`numpy` cannot calculate with a Vec3", "`sqrt` is given a Vec3", ""),
    ("    return k_d * light.area\n", 7, "`light` is not defined", "`light` is not defined", "for light in"),
    ("    return k_d * rng.random()\n", 7, "`.random` is not known", "`.random` is not known", "number()"),
    ("    return k_d * shadow(scene, x.p, x.p)\n", 7, "A point is expected here, and", "a point is", "x, y"),
    ("    return k_d * dot(N, x)\n", 7, "A Vec3 is expected here, and a point", "a Vec3 is expected here", "y - x"),
    ("    return k_d * scene.lights.radiance\n", 7, "`.radiance` in a list of lights", "no `.radiance`", "for light"),
    ("    y = scene.lights[0].sample(x, 0.5)\n    return k_d\n", 7, "A number has no index", "a number has no index",
     "rng.square()"),
    ("    u1, u2 = rng.square\n    return k_d\n", 7, "must be called first", "", "brackets"),
    ("    return k_d * abs(N)\n", 7, "`abs` is for numbers", "`abs` is given a Vec3", ""),
    ("    return Vec3([1.0, 2.0, 3.0])\n", 7, "Vec3 takes three numbers", "Vec3 takes three numbers", ""),
    ("    a, b, c = k_d\n    return Vec3(a, b, c)\n", 7, "", "cannot be taken apart", ""),
    ("    i = 10 ** 20\n    return k_d * (i / 1e20)\n", 7, "", "too large for 64 bits", "1e20"),
    ("    d = {'a': 1.0}\n    return k_d\n", 7, "Dictionaries", "", "tuples"),
    ("    if (a := N.z) > 0.5:\n        return k_d * a\n    return black\n", 7, "`:=` cannot be compiled", "", ""),
    ("    return k_d * np.clip(N.z, 0.0, 1.0)\n", 7, "`numpy.clip` cannot be used", "`numpy.clip` cannot", "min(max("),
    ("    return k_d * np.fromfile('f')\n", 7, "`numpy.fromfile` cannot be used", "`numpy.fromfile` cannot", ""),
    ("    return k_d * N.__class__\n", 7, "`.__class__` is not known", "`.__class__` is not known", ""),
    ("    return k_d * math.factorial(3)\n", 7, "", "`factorial` is not known to it", "write it out"),
    ("    for i in (1, 2.0):\n        pass\n    return k_d\n", 7, "", "not all of one kind", "as floats"),
    ("    a = str(N.x)\n    return k_d\n", 7, "`str` cannot be used", "", ""),
    ("    return k_d * eval('1')\n", 7, "`eval` cannot be used", "`eval` cannot be used", ""),
]  # fmt: skip


def compiler_says(source: str) -> Problem | None:
    """What comes of compiling without looking first."""
    read_in, first = read(source.encode()), next(examples(TASK))
    entry, _ = check_shape(read_in, TASK)
    try:
        compile_shade(read_in, TASK, prepare(read_in, TASK, entry), Plain(first.scene, first.place, SEED))
    except Problem as problem:
        return problem
    return None


def ids(rows: list[tuple]) -> list[str]:
    return [row[0].strip().replace("\n", "; ") for row in rows]


@pytest.mark.parametrize(("body", "line", "ladder", "compiler", "advice"), ROWS, ids=ids(ROWS))
def test_a_students_line_gets_a_sentence(body, line, ladder, compiler, advice):
    source = HEAD + body
    findings = climb(source.encode(), [TASK], until="interpret").findings
    if not ladder:
        assert findings == []
        return
    (finding,) = findings
    assert finding.kind == "error"
    assert finding.line == line
    assert finding.text == source.split("\n")[line - 1]
    assert ladder in finding.sentence
    assert finding.sentence[0] in "`ABCDEFGHIJKLMNOPQRSTUVWXYZ"
    assert finding.sentence.endswith((".", "?"))
    assert advice in finding.advice


TOLD = [row for row in ROWS if row[3]]


@pytest.mark.parametrize(("body", "line", "ladder", "compiler", "advice"), TOLD, ids=ids(TOLD))
def test_what_the_compiler_says_is_put_into_words(body, line, ladder, compiler, advice):
    said = compiler_says(HEAD + body)
    assert said is not None
    assert compiler in said.sentence, said.detail
    assert "0x" not in said.detail
    assert not re.search(r"[\s\"']/\w", said.detail)
    if not ladder:
        assert said.line == line
        assert advice in said.advice


def test_a_message_that_nobody_has_put_into_words_keeps_line_and_text():
    source = read((HEAD + "    return k_d\n").encode())
    said = explain_compiler(ValueError('Something new\nFile "shade.py", line 7:\n'), source)
    assert said.line == 7
    assert "no name here" in said.sentence
    assert "Something new" in said.detail


def test_the_values_at_the_fault_are_told():
    source = HEAD + "    a = 2.0\n    return k_d / (a - 2.0)\n"
    (finding,) = climb(source.encode(), [TASK], until="interpret").findings
    assert "a = 2.0" in finding.detail
    assert "N = Vec3(0.0, 0.0, 1.0)" in finding.detail
