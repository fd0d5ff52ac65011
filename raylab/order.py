"""Order: lights stand in the tables of a scene by place, whatever their order in the file.

The n-th random numbers of a sample are those of the n-th light, and sums are rounded. So that the order in which lights
are described changes no bit of a picture, they are sorted: by where they are in normalised coordinates, which no power
of two and no dyadic translation changes; in the same place by all else that is said of them, but for the name.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from itertools import groupby
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
STEP = 2.0**-20  # of the scene's size: far above rounding, which must not exchange lights of the same height


def order(places: npt.ArrayLike, described: Sequence[Any]) -> list[int]:
    """The numbers of things by their places (n, k); those within STEP of each other by what is said of them."""
    with np.errstate(over="ignore"):  # a light may be anywhere; infinities are alike
        rounded = np.rint(np.asarray(places, np.float64) / STEP)
    keys = list(map(tuple, rounded.tolist()))
    found: list[int] = []
    for _, group in groupby(sorted(range(len(keys)), key=keys.__getitem__), key=keys.__getitem__):
        alike = list(group)
        found += alike if len(alike) == 1 else sorted(alike, key=lambda i: content(described[i]))
    return found


def content(value: Any) -> tuple[Any, ...]:
    """What a description says but for names, as tuples of numbers and words that can be compared with each other."""
    if is_dataclass(value):
        parts = (content(getattr(value, field.name)) for field in fields(value) if field.name != "name")
        return type(value).__name__, *parts
    if value is None or isinstance(value, str):
        return "word", value or ""
    if isinstance(value, tuple | list):
        return "several", *map(content, value)
    numbers = np.asarray(value)
    return "numbers", numbers.shape, tuple(numbers.ravel().tolist())
