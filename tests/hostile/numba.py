"""45 to 60: what compiled code can do; the ladder stands before it."""

from __future__ import annotations

from hostile.case import Case, at_import, in_call
from hostile.toy import FULL, HONEST

LADDER = ("ladder",)


def numba_case(number, name, make, score, **more):
    return Case(number, name, make, score, walls=LADDER, **more)


DECORATED = HONEST.replace("def warp", "@njit(boundscheck=False, fastmath=True, parallel=True, cache=True)\ndef warp")
OPTIONAL = "if u[0] > 2.0:\n    return Vec3(1.0, 0.0, 0.0)\nif u[0] < 2.0:\n    return None"

CASES = [
    numba_case(45, "objmode", in_call("with objmode():\n    print(1)", "from numba import objmode\n" + HONEST), 2.0),
    numba_case(46, "pointer to a function", at_import(
        "import ctypes\nsleep = ctypes.CDLL(None).sleep\nsleep.argtypes = [ctypes.c_uint]"), 2.0),
    numba_case(47, "carray", in_call("x = carray(0, 3)", "from numba import carray\n" + HONEST), 2.0),
    numba_case(47, "as_strided", in_call(
        "x = np.lib.stride_tricks.as_strided(np.zeros(3), (1000,), (8,))", "import numpy as np\n" + HONEST), 2.0),
    numba_case(47, "ctypes of an array", in_call("x = np.zeros(3).ctypes", "import numpy as np\n" + HONEST), 2.0),
    numba_case(48, "own options", at_import("from numba import njit", DECORATED), FULL),
    numba_case(49, "out of range", in_call("x = np.zeros(3)\nx[3 + int(u[0])] = 1.0", "import numpy as np\n" + HONEST),
        2.0),
    numba_case(50, "endless", in_call("while u[0] < 2.0:\n    pass", HONEST), 2.0, slow=True),
    numba_case(51, "recursion", in_call("if u[0] < 2.0:\n    return warp(u)", HONEST), 2.0),
    numba_case(52, "2^59 numbers", in_call("x = np.zeros(1 << 59)\nif x[0] > 0.0:\n    return Vec3(1.0, 0.0, 0.0)",
        "import numpy as np\n" + HONEST), 2.0),
    numba_case(53, "changed arguments", in_call("u[0] = 0.5", HONEST), 2.0),
    numba_case(54, "unset variable", in_call("if u[0] > 2.0:\n    w = 1.0\nq = w", HONEST), 2.0),
    numba_case(55, "no return", in_call(OPTIONAL, HONEST), 2.0),
    numba_case(56, "its own chance", in_call("x = np.random.random()", "import numpy as np\n" + HONEST), 2.0),
    numba_case(57, "not a number", in_call(
        "if u[0] < 0.5:\n    return Vec3(math.nan, math.inf, -1.0)", HONEST), 5.0),
    numba_case(58, "ten thousand lines", in_call("x = u[0]\n" + "x = math.sin(x) + 1.0\n" * 10_000, HONEST), FULL,
        slow=True),
    numba_case(59, "changed constant", at_import("C = 1.0\n", HONEST), FULL),
    numba_case(60, "a number for the scene", in_call("visible = shadow(7, u, u)",
        "from raylab.lecture import shadow\n" + HONEST), 2.0),
]  # fmt: skip
