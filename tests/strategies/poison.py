"""A number that is none, at any place of a description where raylab reads a number."""

from __future__ import annotations

import math
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np
from hypothesis import strategies as st

from raylab import description as d

Path = tuple[Any, ...]
MAY_BE_INFINITE = ("far_clip", "focus_distance")
NOT_READ = ("stddev",)  # of a box filter


def leaves(value: Any, path: Path = ()) -> list[Path]:
    """Where in a description there are floating-point numbers: the names and places that lead to each."""
    if is_dataclass(value):
        left_out = ("to_world",) if getattr(value, "motion", None) is not None else ()
        names = [f.name for f in fields(value) if f.name not in left_out]
        return [leaf for name in names for leaf in leaves(getattr(value, name), (*path, name))]
    if isinstance(value, tuple):
        return [leaf for i, item in enumerate(value) for leaf in leaves(item, (*path, i))]
    if isinstance(value, float) or (isinstance(value, np.ndarray) and value.dtype == np.float64 and value.size):
        return [path]
    return []


def readable(described: d.SceneDescription, bad: float) -> list[Path]:
    """The leaves where `bad` makes no sense."""
    fine = (*NOT_READ, *(MAY_BE_INFINITE if bad == math.inf else ()))
    return [path for path in leaves(described) if path[-1] not in fine]


def poisoned(value: Any, path: Path, place: int, bad: float) -> Any:
    """The description with `bad` for the number at the end of the path; in an array at that `place`."""
    if not path:
        if isinstance(value, float):
            return bad
        array = value.copy()
        array.ravel()[place % array.size] = bad
        return array
    if isinstance(value, tuple):
        i = path[0]
        return (*value[:i], poisoned(value[i], path[1:], place, bad), *value[i + 1 :])
    return replace(value, **{path[0]: poisoned(getattr(value, path[0]), path[1:], place, bad)})


@st.composite
def spoilt(draw: Any, scenes: st.SearchStrategy[d.SceneDescription]) -> d.SceneDescription:
    """A scene in which one number is NaN or infinite."""
    described, bad = draw(scenes), draw(st.sampled_from((math.nan, math.inf, -math.inf)))
    path = draw(st.sampled_from(readable(described, bad)))
    return poisoned(described, path, draw(st.integers(0, 15)), bad)
