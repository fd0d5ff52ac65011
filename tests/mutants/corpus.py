"""All mutants by name. Reading the tables does not import raylab."""

from __future__ import annotations

from mutants import area_mutants, loop_mutants, more_mutants, sky_mutants
from mutants.patch import Mutant

ALL: tuple[Mutant, ...] = (*area_mutants.MUTANTS, *sky_mutants.MUTANTS, *loop_mutants.MUTANTS, *more_mutants.MUTANTS)
BY_NAME = {m.name: m for m in ALL}
assert len(BY_NAME) == len(ALL), "two mutants of one name"
EQUIVALENT = tuple(m for m in ALL if m.test == "=")
