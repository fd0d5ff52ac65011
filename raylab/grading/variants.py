"""Variants: all planted mistakes, by task, to be compared with a submission number by number.

A row is a cause (`raylab.grading.causes`) and what it does to the solution's text (`raylab.grading.variant`).
`FEATURES` are statements that stand in for the one that adds a sample up, and return what a sample is made of. These
modules know the solutions: students do not get them, but what follows from them as numbers (`raylab.grading.table`).
"""

from __future__ import annotations

import hashlib

from raylab.grading import lamp_variants, map_variants, sky_variants
from raylab.grading.stub import Solution
from raylab.grading.variant import Features, Variant

VARIANTS: dict[str, tuple[Variant, ...]] = lamp_variants.VARIANTS | sky_variants.VARIANTS | map_variants.VARIANTS
FEATURES: dict[str, Features] = lamp_variants.FEATURES | sky_variants.FEATURES
ALONE: dict[str, tuple[str, ...]] = lamp_variants.ALONE | sky_variants.ALONE


def fingerprint(solution: Solution) -> str:
    """Changes with the solution, its variants and its features."""
    task = solution.task
    rows = repr((solution.text, VARIANTS[task], FEATURES.get(task, ()), ALONE.get(task, ())))
    return hashlib.sha256(rows.encode()).hexdigest()[:16]
