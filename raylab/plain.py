"""Plain: a shade() called in plain Python at one point of a surface, for those who want to look inside.

The twin of `raylab.probe`: the same place, the same random numbers, and so the same values but for rounding. It needs
no compiler, and a debugger can stop in it.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from raylab import samplers
from raylab.embree import TNEAR
from raylab.errors import UserError
from raylab.jit import interpreted
from raylab.probe import Place
from raylab.scene import Scene
from raylab.surface import BACK, FRONT, TALLIES, intersect, round32
from raylab.vec3 import Vec3, normalize
from raylab.view import View


class Plain:
    """Where a shade() is called, and with what: call number i has stream i, as in a probe with the same seed."""

    def __init__(self, scene: Scene, place: Place, seed: int) -> None:
        self.seed, placement = seed, scene.placement
        self.data = scene.data._replace(tally=View(np.zeros(TALLIES, np.int64)))
        o, d = Vec3(*placement.points(place.origin)), Vec3(*(place.direction / np.linalg.norm(place.direction)))
        with interpreted():
            hit = intersect(self.data, round32(o), round32(d), TNEAR, math.inf)
            if not hit.found:
                raise UserError(f"from {place.origin} toward {place.direction} there is no surface to shade")
            side = self.data.shapes[hit.shape, FRONT if hit.front else BACK]
            brdf = self.data.materials.at(side, hit.N, hit.uv)
            self.place = hit.x, normalize(-round32(d)), brdf, hit.N

    def arguments(self, shade: Callable[..., Any]) -> tuple[Any, ...]:
        """(x, V, brdf, N) or (x, k_d, N), whichever `shade` asks for."""
        x, _, brdf, N = self.place
        return (x, brdf.k_d, N) if "k_d" in inspect.signature(shade).parameters else self.place

    def stream(self, number: int) -> Any:
        """The random numbers of a call."""
        with interpreted():
            return samplers.make("independent", self.seed, 1).stream(0, 0, number)

    def call(self, shade: Callable[..., Any], number: int) -> Any:
        """What `shade` returns, in plain Python."""
        plain: Callable[..., Any] = getattr(shade, "py_func", shade)
        rng = self.stream(number)
        with interpreted():
            return plain(*self.arguments(plain), self.data, rng)

    def state(self) -> str:
        """All numbers of the arguments; the tally of rays is the kernel's own."""
        return numbers((*self.place, self.data._replace(tally=View(np.zeros(0)))))


def numbers(value: Any) -> str:
    """All numbers of which a value is made, as text."""
    if isinstance(value, Vec3):
        return repr((value.x, value.y, value.z))
    if isinstance(value, View):
        return numbers(value.array)
    if isinstance(value, np.ndarray):
        return repr((value.shape, value.tobytes()))
    if isinstance(value, tuple):
        return "(" + ",".join(numbers(v) for v in value) + ")"
    if hasattr(value, "rows") and hasattr(value, "store"):
        return numbers((value.rows, value.store))
    return repr(value)
