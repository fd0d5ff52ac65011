"""What a submission must not reach is refused, twice: in its text, and in what the compiler would read."""

from __future__ import annotations

import ctypes
import os

import numba
import numpy as np
import pytest

from raylab import lecture
from raylab.submission import Task, allowed, climb
from raylab.submission.finding import Problem
from raylab.submission.wall import wall

TASK = Task("a1.diffuse", "shade", like="area_diffuse")
MAP = Task("a3.sample", "sample", kind="map", arguments=("u",), takes=("pair",), gives=("number",))
IMPORTS = """import ctypes, gc, os, sys
import numpy as np
import numba
from numba import objmode, carray, cfunc, literal_unroll
from numpy.lib.stride_tricks import as_strided
from ctypes import CDLL
from raylab import jit, shade as solution, embree
from raylab.shade import area_diffuse
from raylab.embree import trace
from raylab.lecture import *
"""
HEAD = IMPORTS + "\n\ndef shade(x, k_d, N, scene, rng):\n"
LINE = HEAD.count("\n") + 1


@pytest.mark.parametrize(
    "line",
    [
        "with objmode(a='float64'): a = 1.0",
        "os._exit(0)",
        "os.kill(os.getpid(), 9)",
        "sys.setrecursionlimit(10**9)",
        "gc.get_objects()",
        "ctypes.memset(0, 0, 1)",
        "CDLL(None).exit(0)",
        "carray(0, 3)",
        "cfunc('void()')",
        "literal_unroll((1, 2))",
        "as_strided(np.zeros(3), (9,), (8,))",
        "numba.carray(0, 3)",
        "np.zeros(3).ctypes",
        "np.zeros(3).data",
        "np.zeros(3).view(np.int64)",
        "np.zeros(3).tofile('f')",
        "np.save('f', np.zeros(3))",
        "np.load('f')",
        "np.lib",
        "np.core.multiarray",
        "np.random.rand()",
        "np.linalg.linalg",
        "area_diffuse(x, k_d, N, scene, rng)",
        "solution.area_diffuse(x, k_d, N, scene, rng)",
        "trace(scene.embree, N, N, 0.0, 1.0)",
        "scene.embree",
        "scene.tally",
        "scene.lights.rows",
        "scene.vertices.array",
        "light_from.py_func",
        "dot.__globals__",
        "N.__class__.__mro__",
        "(lambda: 0).__code__",
        "(i for i in (1,)).gi_frame",
        "[c for c in ().__class__.__base__.__subclasses__()]",
        "'{0.__class__}'.format(N)",
        "exec('1')",
        "eval('1')",
        "open('f')",
        "getattr(N, 'x')",
        "setattr(N, 'x', 0.0)",
        "globals()",
        "vars(N)",
        "__import__('os')",
        "__builtins__",
        "breakpoint()",
        "input()",
        "type(N)",
        "super()",
        "print.__self__",
        "import os",
        "from os import path",
        "global os",
        "nonlocal x",
        "del x",
        "class V: pass",
        "async def f(): pass",
        "raise SystemExit",
        "raise KeyboardInterrupt",
    ],
)
def test_a_line_that_reaches_out_is_refused(line):
    findings = climb((HEAD + f"    {line}\n    return k_d\n").encode(), [TASK], until="interpret").findings
    assert [f.kind for f in findings] == ["error"]
    assert findings[0].stage in ("vet", "parse")
    assert findings[0].line == LINE
    assert "Traceback" not in str(findings[0])


@pytest.mark.parametrize(
    "top",
    [
        "print('x')",
        "os._exit(0)",
        "x = open('f')",
        "x = [i for i in range(3)]",
        "x = np.zeros(3)",
        "x = (lambda: 0)()",
        "x = area_diffuse",
        "for i in range(3): pass",
        "while True: pass",
        "with open('f'): pass",
        "try:\n    pass\nexcept Exception: pass",
        "del os",
        "assert os._exit(0)",
        "def f(a=os._exit(0)): pass",
        "def f(a=[]): pass",
        "@os._exit\ndef f(): pass",
        "def f(a: os._exit(0)): pass",
        "class A(os._exit(0)): pass",
        "x: os._exit(0) = 1",
        "x = 10 ** 10 ** 10",
        "x = 'a' * 10 ** 10",
        "if os._exit(0): pass",
    ],
)
def test_nothing_of_the_top_level_runs(top):
    """It is refused, or read without being run; and then the rest of the file is what it was."""
    source = f"{IMPORTS}{top}\n\n\ndef sample(u):\n    return u[0]\n"
    findings = climb(source.encode(), [MAP], until="interpret").findings
    assert len(findings) <= 1
    assert all(f.stage == "parse" and (f.line == LINE - 3 or f.kind == "note") for f in findings)


@pytest.mark.parametrize(
    "body",
    ["(" * 100_000 + ")" * 100_000, "-" * 100_000 + "1", "1" + "+1" * 40_000, "[" * 5000, "0\n" + "if u:\n" * 3000],
    ids=["brackets", "signs", "sum", "open", "ifs"],
)
def test_monsters_are_refused(body):
    findings = climb(f"def sample(u):\n    return {body}\n".encode(), [MAP], until="interpret").findings
    assert [f.kind for f in findings] == ["error"]
    assert findings[0].stage == "parse"


def own(value) -> bool:
    return False


def test_the_wall_sees_objects_and_not_names():
    """A name that looks innocent may stand for anything."""
    dot, sqrt, cos = ctypes.CDLL(None).getpid, os.getpid, np.random.rand

    def pointer(u):
        return dot()

    def system(u):
        return sqrt()

    def chance(u):
        return cos()

    def attribute(u):
        return u.ctypes

    def deep(u):
        return np.random.rand()

    def block(u):
        with numba.objmode(a="float64"):
            a = 1.0
        return a

    for function in (pointer, system, chance, attribute, deep, block):
        with pytest.raises(Problem):
            wall(function, own)


def test_the_wall_lets_the_lecture_pass():
    dot, normalize, black = lecture.dot, lecture.normalize, lecture.black

    def fine(x, N):
        result = black
        for i in range(3):
            result += normalize(N) * max(0.0, dot(x, N)) * np.sqrt(np.abs(x.x)) * np.pi * i
        return result

    wall(fine, own)
    assert all(allowed.permitted(getattr(lecture, name)) for name in lecture.__all__)
    assert not any(
        allowed.permitted(v) for v in (os, os.getpid, eval, exec, open, getattr, object(), type, [], {}, ctypes)
    )


def test_what_is_withheld_is_not_lent():
    source = b"from raylab.lecture import *\ndef sample(u):\n    return sample_sphere(u).x\n"
    asked = Task("a3.sample", "sample", "map", arguments=("u",), takes=("pair",), gives=("number",))
    assert climb(source, [asked], until="interpret").findings == []
    asked = Task("a3.sample", "sample", "map", "", ("u",), ("pair",), ("number",), withheld=("sample_sphere",))
    (finding,) = climb(source, [asked], until="interpret").findings
    assert "what you are asked to write yourself" in finding.sentence
    assert finding.line == 3


def test_one_bad_function_does_not_stop_the_others():
    source = b"def sample(u):\n    return u[0]\n\ndef worse(u):\n    return undefined + 1\n"
    other = Task("a3.other", "worse", "map", arguments=("u",), takes=("pair",), gives=("number",))
    climbed = climb(source, [other, MAP])
    assert [f.task for f in climbed.findings] == ["a3.other"]
    assert list(climbed.functions) == ["a3.sample"]
    np.testing.assert_array_equal(climbed.functions["a3.sample"](np.array([[0.25, 0.5]])), [[0.25]])
