"""Allowed: what a student's function may name. All that is not listed here is refused, whatever it is.

Modules (`math`, `numpy`, `raylab.lecture`), some of numpy, some of Python's own functions, and the attributes of the
objects that a shade() is given. Objects are compared by identity, not by name.
"""

from __future__ import annotations

import math
import types
from dataclasses import dataclass
from typing import Any

import numpy as np

from raylab import lecture
from raylab.vec3 import Vec3


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


BUILT_INS: dict[str, Any] = {
    f.__name__: f
    for f in (abs, bool, divmod, enumerate, float, int, len, max, min, pow, print, range, round, tuple, zip)
} | {"sum": sum, "isinstance": isinstance}  # fmt: skip
ERRORS: dict[str, Any] = {
    e.__name__: e for e in (ArithmeticError, Exception, NotImplementedError, RuntimeError, ValueError)
} | {"ZeroDivisionError": ZeroDivisionError, "AssertionError": AssertionError}  # fmt: skip
NUMPY = _words("""
    abs absolute add arccos arcsin arctan arctan2 array array_equal asarray ceil copy copysign cos cosh
    cross cumsum deg2rad degrees dot e empty exp expm1 eye float32 float64 floor fmax fmin full hypot inf int32
    int64 isfinite isinf isnan linalg linspace log log10 log1p log2 max maximum mean min minimum multiply nan
    ones outer pi power prod rad2deg radians round sign sin sinh sqrt square subtract sum tan tanh uint64 vdot
    where zeros zeros_like
""")  # fmt: skip
LINALG = frozenset(("norm", "det", "inv", "solve"))
# of points, vectors, lights, scenes, environments, BRDFs and random numbers
ATTRIBUTES = _words("""
    x y z p n N w k_d k_s I radiance area sample pdf eval lobe sample_solid_angle pdf_solid_angle lights points
    suns environment present by_brightness number square is_glossy is_specular reflection refraction choice
    choose shape size copy dot sum real T append
""")  # fmt: skip
_UNWRITTEN = ("typing", "collections.abc", "__future__", "raylab.jit", "numba")  # of no effect, and so welcome
OWN_SOLUTIONS = ("shade", "beyond", "glossy", "direct", "basic", "strategies", "")


@dataclass(frozen=True)
class Unavailable:
    """A name that stands for something a graded function cannot use, and the words to say so."""

    sentence: str
    advice: str = ""


_IN_LECTURE = "Import what you need from raylab.lecture, math or numpy."
RANDOM = "Use the numbers that you are given: rng.number() is uniform in [0, 1), rng.square() is a pair of them."


def from_import(module: str, name: str) -> Any:
    """What `from module import name` gives; an Unavailable where it gives nothing of use. Nothing is imported."""
    full = f"{module}.{name}"
    if full == "raylab.lecture":
        return lecture
    if module.split(".")[0] == "raylab":
        if module != "raylab" and name in lecture.__all__:
            return getattr(lecture, name)
        if module.removeprefix("raylab").removeprefix(".") in OWN_SOLUTIONS:
            return Unavailable(f"`{name}` of {module} is raylab's own and would be the answer.", _IN_LECTURE)
        close = nearest(name, lecture.__all__)
        return Unavailable(f"`{name}` of {module} is not among the words of raylab.lecture.", close or _IN_LECTURE)
    if module in ("math", "numpy", "numpy.linalg"):
        owner = {"math": math, "numpy": np, "numpy.linalg": np.linalg}[module]
        return member(owner, name)
    if module == "numba" and name == "prange":
        return range
    if module in _UNWRITTEN:
        return Unavailable(f"`{name}` of {module} has no place inside a graded function.", "Leave it out.")
    return whole_module(module)


def whole_module(module: str) -> Any:
    """What `import module` gives."""
    known = {"math": math, "numpy": np, "raylab.lecture": lecture}
    if module in known:
        return known[module]
    top = module.split(".")[0]
    if top in ("random", "secrets"):
        return Unavailable(f"Graded functions have no `{top}`.", RANDOM)
    return Unavailable(f"`{module}` is not available in graded functions.", _IN_LECTURE)


def member(owner: Any, name: str) -> Any:
    """The attribute of one of the modules above, or an Unavailable."""
    if owner is np and name == "random":
        return Unavailable("`np.random` has a state of its own, so no sample could be repeated.", RANDOM)
    listed = {np: NUMPY, np.linalg: LINALG, lecture: frozenset(lecture.__all__)}
    public = listed.get(owner) or frozenset(n for n in vars(math) if not n.startswith("_"))
    if name not in public:
        advice = "Write min(max(a, 0.0), 1.0)." if name == "clip" else nearest(name, public)
        if name in lecture.__all__:
            advice = f"raylab.lecture has it: write {name}."
        return Unavailable(f"`{owner.__name__}.{name}` cannot be used in graded functions.", advice)
    return getattr(owner, name)


def nearest(name: str, known: Any) -> str:
    """Did you mean ...?"""
    import difflib

    folded = {str(k).lower().replace("_", ""): str(k) for k in sorted(known)}
    plain = name.lower().replace("_", "")
    begins = [f for f in folded if len(f) > 2 and (plain.startswith(f) or (len(plain) > 2 and f.startswith(plain)))]
    found = sorted(begins, key=len) or difflib.get_close_matches(plain, folded, 1, 0.6)
    return f"Did you mean `{folded[found[0]]}`?" if found else ""


def permitted(value: Any) -> bool:
    """Whether a graded function may hold this object (its own functions apart)."""
    if value is None or isinstance(value, bool | int | float | Vec3):
        return True
    if isinstance(value, str):
        return True
    if isinstance(value, tuple):
        return all(permitted(v) for v in value)
    if isinstance(value, types.ModuleType):
        return value in (math, np, np.linalg, lecture)
    return any(value is known for known in _OBJECTS)


_OBJECTS: list[Any] = [
    slice, str,
    *BUILT_INS.values(), *ERRORS.values(), *(getattr(lecture, n) for n in lecture.__all__),
    *(getattr(np, n) for n in NUMPY), *(getattr(np.linalg, n) for n in LINALG),
    *(v for n, v in vars(math).items() if not n.startswith("_")),
]  # fmt: skip
