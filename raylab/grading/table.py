"""Table: the numbers of all variants of a task, over designed scenes or inputs and with fixed random numbers.

With it a mistake can be named where the solution is not: on a student's machine, and on the grader's. One file
`variants/TASK.npz` in the folder of an assignment; `make(...)` is the only thing here that runs the solutions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from raylab.grading import expected, moments
from raylab.grading.assignment import Assignment
from raylab.grading.faults import GraderFault
from raylab.grading.source import Source

if TYPE_CHECKING:
    from raylab.grading.variant import Variant

Array = npt.NDArray[np.float64]
PAIRED, FOR_MOMENTS, OF_SAMPLERS = 96, 2048, 4096  # samples: compared one by one; for moments, also of samplers
SEED, TRIAL_SEED = 20261122, 4620  # of the random numbers, and of the scenes
SMALL = ("samples", "features")  # of colours: floats of 32 bits are enough to know a number again


@dataclass(frozen=True, eq=False)
class Table:
    """`causes` (v,), the first of which is "none", the reference; `structural` (v,); numbers by trial.

    samples (v, trials, PAIRED, m); moments and their errors (v, trials, K), see `raylab.grading.moments`; features
    (f, trials, PAIRED, 3), `names` (f,) with | between. `rows` (trials, PAIRED, k) are the inputs of a plain function,
    whose columns `random` are the pair u; a shade() has none, and is asked in the trials by name.
    """

    trials: npt.NDArray[np.str_]
    causes: npt.NDArray[np.str_]
    structural: npt.NDArray[np.bool_]
    samples: Array
    moments: Array
    errors: Array
    names: npt.NDArray[np.str_]
    features: Array
    alone: npt.NDArray[np.str_]
    rows: Array
    random: npt.NDArray[np.int_]
    fingerprint: str

    def write(self, path: Path) -> None:
        path.parent.mkdir(exist_ok=True)
        own = {f.name: getattr(self, f.name) for f in fields(self)}
        small = {} if self.of_maps else {name: own[name].astype(np.float32) for name in SMALL}
        np.savez_compressed(path, **(own | small))

    @classmethod
    def read(cls, path: Path) -> Table:
        with np.load(path, allow_pickle=False) as z:
            own: dict[str, Any] = {f.name: z[f.name] for f in fields(cls)}
        return cls(
            **(own | {name: own[name].astype(float) for name in SMALL} | {"fingerprint": str(own["fingerprint"])})
        )

    @property
    def of_maps(self) -> bool:
        return self.rows.size > 0

    def paired(self, source: Source, task: str, n: int = PAIRED) -> Array:
        """The numbers of a submission that are compared one by one with `samples[v]`."""
        if self.of_maps:
            return np.stack([self._mapped(source, task, rows) for rows in self.rows[:, :n]])
        return drawn(source, task, self.trials, n)

    def many(self, source: Source, task: str, n: int) -> Array:
        """`n` samples by trial, or as many as the table has of a sampler; none where nothing is random."""
        if not self.of_maps:
            return drawn(source, task, self.trials, n)
        if not self.random.size:
            return np.zeros((0, 0, 0))
        return np.stack([self._mapped(source, task, fresh(rows, self.random)) for rows in self.rows])

    def _mapped(self, source: Source, task: str, rows: Array) -> Array:
        """What a plain function gives; no numbers at all where it raises."""
        try:
            return source.map(task, rows)
        except GraderFault:
            raise
        except Exception:  # whatever a student's function does
            return np.full((len(rows), self.samples.shape[3]), np.nan)

    def moments_of(self, values: Array) -> tuple[Array, Array]:
        """(trials, K) each: the mean of each moment, and its standard error."""
        if not values.size:
            return np.zeros((0, 0)), np.zeros((0, 0))
        found = moments.of_maps(values, self.rows[:, 0]) if self.of_maps else moments.of_colours(values)
        return found.mean(axis=1), found.std(axis=1) / np.sqrt(found.shape[1])


def drawn(source: Source, task: str, trials: npt.NDArray[np.str_], n: int) -> Array:
    return np.stack([source.samples(task, str(t), TRIAL_SEED, SEED, 0, n) for t in trials])


def fresh(rows: Array, random: npt.NDArray[np.int_]) -> Array:
    """The first row again and again with another u."""
    found = np.tile(rows[0], (OF_SAMPLERS, 1))
    found[:, random] = np.random.default_rng(SEED).random((OF_SAMPLERS, len(random)))
    return found


def path_of(folder: Path, task: str) -> Path:
    return folder / "variants" / f"{task}.npz"


def make(assignment: Assignment, task: str) -> Table:
    """Run every variant of a task in plain Python."""
    from raylab.grading import variant, variants
    from raylab.grading.source import Interpreted
    from raylab.grading.stub import solutions

    solution, asked = solutions()[task], assignment.task(task)
    planted = (variant.Variant("none", structural=True), *variants.VARIANTS[task])
    features = variants.FEATURES.get(task, ())
    own = [str(i) for i in range(len(planted))]
    texts = {name: variant.edited(solution.text, v) for name, v in zip(own, planted, strict=True)}
    texts |= {"|".join(names): variant.featured(solution.text, statement) for names, statement in features}
    functions = {name: variant.alive(solution, text) for name, text in texts.items()}
    source = Interpreted(functions, dict.fromkeys(functions, asked))
    table = _empty(assignment, task, planted, variants.fingerprint(solution))
    with np.errstate(all="ignore"):
        many = [table.moments_of(table.many(source, name, FOR_MOMENTS)) for name in own]
        return replace(
            table,
            samples=np.stack([table.paired(source, name) for name in own]),
            moments=np.stack([mean for mean, _ in many]),
            errors=np.stack([error for _, error in many]),
            names=np.array([name for name in functions if name not in own], str),
            features=np.array([drawn(source, name, table.trials, PAIRED) for name in functions if name not in own]),
            alone=np.array(variants.ALONE.get(task, ()), str),
        )


def _empty(assignment: Assignment, task: str, planted: Sequence[Variant], fingerprint: str) -> Table:
    """What is asked, before anybody has answered."""
    own, asked, nothing = assignment.of(task), assignment.task(task), np.zeros(0)
    blocks = expected.blocks(own, PAIRED, TRIAL_SEED) if asked.kind == "map" else {}
    width = asked.columns[1] if blocks else 3
    return Table(
        trials=np.array([*blocks] or assignment.diagnosis[task]),
        causes=np.array([v.cause for v in planted]), structural=np.array([v.structural for v in planted]),
        samples=np.zeros((1, 1, 1, width)), moments=nothing, errors=nothing, names=np.array([], str), features=nothing,
        alone=np.array([], str), rows=np.stack([*blocks.values()]) if blocks else nothing,
        random=expected.random_columns(own, asked) if blocks else np.zeros(0, int), fingerprint=fingerprint,
    )  # fmt: skip


def main(tasks: list[str]) -> None:
    """Make the tables of tasks anew."""
    from raylab.grading.assignment import load

    for task in tasks:
        assignment = load(task.partition(".")[0])
        make(assignment, task).write(path_of(assignment.folder, task))


if __name__ == "__main__":
    import sys

    main(sys.argv[1:])
