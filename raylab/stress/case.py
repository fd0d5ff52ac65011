"""Case: an extreme set-up with a known truth, measured by raylab and by the code that is usually written for it.

    @case("B01", "sphere light, R / D = 1e-3 to 1e-8", usual="2 pi (1 - cos)", rule="2 pi s^2 / (1 + sqrt(1 - s^2))",
          truth="mpmath", unit="relative error of the solid angle", allowed=4 * U53)
    def cone_of_a_distant_sphere() -> Found: ...

A case holds when the error that is found is at most what is allowed; a NaN is more than anything.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from raylab.errors import UserError

U53, U24 = 2.0**-53, 2.0**-24  # the unit roundoff of float64 and of float32

SECTIONS = {
    "A": "Tracing", "B": "Light sampling, solid angles, the 1/r^2 term", "C": "BRDF, Fresnel, frames",
    "D": "Environment maps", "E": "Camera, lens, time", "F": "Random numbers", "G": "Accumulation and statistics",
    "H": "Colour and output", "I": "Python and numba", "S": "Stiff estimators",
}  # fmt: skip
LIMIT = 20.0  # s, compiling included: a ray that is not a number takes Embree a thousand times as long


@dataclass(frozen=True)
class Found:
    """What was measured: the error of raylab, of the usual code, and of raylab's formula in float32."""

    error: float
    usual: float | None = None
    single: float | None = None
    note: str = ""


@dataclass(frozen=True)
class Case:
    """A row of the table."""

    id: str
    setup: str
    usual: str  # the code that is usually written
    rule: str  # what raylab does
    truth: str  # where the truth comes from
    unit: str  # of the errors
    allowed: float
    limit: float  # seconds
    slow: bool  # not in `make test`
    measure: Callable[[], Found]

    @property
    def section(self) -> str:
        return SECTIONS[self.id[0]]


@dataclass(frozen=True)
class Row:
    """A case that was run; `failed` says why there is nothing to see, such as a traceback or the time limit."""

    case: Case
    seconds: float
    found: Found | None = None
    failed: str = ""

    @property
    def held(self) -> bool:
        return self.found is not None and holds(self.found.error, self.case.allowed)

    @property
    def usual_held(self) -> bool | None:
        """Would the usual code have done? None where it was not tried."""
        if self.found is None or self.found.usual is None:
            return None
        return holds(self.found.usual, self.case.allowed)


def holds(error: float, allowed: float) -> bool:
    return not math.isnan(error) and error <= allowed


_CASES: dict[str, Case] = {}


def case(
    id: str, setup: str, *, usual: str = "", rule: str, truth: str, unit: str, allowed: float = 0.0,
    limit: float = LIMIT, slow: bool = False,
) -> Callable[[Callable[[], Found]], Callable[[], Found]]:  # fmt: skip
    """Enter a function that measures into the table; each id once."""

    def enter(measure: Callable[[], Found]) -> Callable[[], Found]:
        if id in _CASES:
            raise ValueError(f"two cases are called {id}: {_CASES[id].setup!r} and {setup!r}")
        _CASES[id] = Case(id, setup, usual, rule, truth, unit, allowed, limit, slow, measure)
        return measure

    return enter


def cases() -> dict[str, Case]:
    """All cases by id, in order."""
    from raylab.stress import sections

    sections.load()
    return dict(sorted(_CASES.items()))


def chosen(names: Sequence[str]) -> list[Case]:
    """The cases of these ids or sections; all of them by default. UserError for a name that is neither."""
    known = cases()
    for name in names:
        if name not in known and name not in SECTIONS:
            raise UserError(
                f"no case is called {name!r}; expected an id such as B05, or a section: {', '.join(SECTIONS)}"
            )
    return [one for id, one in known.items() if not names or id in names or id[0] in names]
