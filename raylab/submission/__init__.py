"""Submission: from the bytes of a student's file to compiled functions, with a sentence at each step that fails.

    climbed = climb(Path("shade.py").read_bytes(), [Task("a1.diffuse", "shade", like="area_diffuse")])
    for finding in climbed.findings: print(finding)
    Probe(scene, climbed.functions["a1.diffuse"], place).sample(seed, n)

The file is never imported: what stands at its top level is read, not run (`source`); its functions may name only what
`allowed` lists (`vet`); they run in plain Python on a few samples (`interpret`), are compiled with bounds checks
(`compile`), and both must agree. This is the first wall around code that nobody has read; a process of its own, which
the caller provides, is the second.
"""

from __future__ import annotations

from raylab.submission.finding import Finding
from raylab.submission.ladder import STAGES, Climb, climb
from raylab.submission.task import Task

__all__ = ["STAGES", "Climb", "Finding", "Task", "climb"]
