"""A small assignment that is judged without chance and in milliseconds, and submissions of known worth."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from raylab.grading.judged import Judged

WARP = {
    "id": "toy.warp", "function": "warp", "kind": "map", "arguments": ["u"], "takes": ["pair"], "gives": ["vector"],
}  # fmt: skip
SQUARE = {
    "id": "toy.square", "function": "square", "kind": "map", "arguments": ["a"], "takes": ["number"],
    "gives": ["number"],
}  # fmt: skip
ROWS = 64

SQUARE_TEXT = """

def square(a):
    return a * a
"""
HONEST = (
    """import math

from raylab.lecture import Vec3


def warp(u):
    z = u[0]
    r = math.sqrt(max(0.0, 1.0 - z * z))
    return Vec3(r * math.cos(2.0 * math.pi * u[1]), r * math.sin(2.0 * math.pi * u[1]), z)
"""
    + SQUARE_TEXT
)
WRONG = "from raylab.lecture import Vec3\n\n\ndef warp(u):\n    return Vec3(0.0, 0.0, 0.5)\n" + SQUARE_TEXT
FULL, ONLY_SQUARE = 10.0, 2.0


@dataclass(frozen=True)
class Property:
    task: str
    name: str
    points: float
    says: str

    @property
    def id(self) -> str:
        return f"{self.task}: {self.name}"


ASSIGNMENT = SimpleNamespace(
    id="toy", file="shade.py", folder=Path(__file__).parent, tasks=(WARP, SQUARE),
    properties=(
        Property("toy.warp", "right", 5.0, "The direction is uniform on the hemisphere."),
        Property("toy.warp", "pure", 3.0, "The same numbers give the same direction."),
        Property("toy.square", "right", 2.0, "A square is a square."),
    ),
)  # fmt: skip


class Judge:
    """Asks with secret numbers, in an order of their own, each of them twice."""

    def __init__(self, assignment, session, entropy):
        self.session = session
        rng = np.random.default_rng(entropy)
        self.u, self.order = rng.random((ROWS, 2)), rng.permutation(2 * ROWS) % ROWS

    def judge(self, own):
        if own.task == "toy.square":
            asked = self.session.map("toy.square", self.u[:, :1])
            good = np.array_equal(asked, self.u[:, :1] ** 2)
        else:
            asked = self.session.map("toy.warp", self.u[self.order])
            same = all(len({row.tobytes() for row in asked[self.order == i]}) == 1 for i in range(ROWS))
            right = np.allclose(asked, directions(self.u[self.order]), rtol=0.0, atol=1e-12)
            good = same if own.name == "pure" else right
            if own.name == "pure" and len({row.tobytes() for row in asked}) == 1:
                good = False  # a constant says nothing
        outcome = "PASS" if good else "FAIL"
        seen = "" if good else "It is not so."
        return Judged(own.task, own.name, outcome, own.points * good, own.points, own.says, seen, samples=len(asked))


def directions(u):
    r, phi = np.sqrt(1.0 - u[:, 0] ** 2), 2.0 * math.pi * u[:, 1]
    return np.stack([r * np.cos(phi), r * np.sin(phi), u[:, 0]], 1)
