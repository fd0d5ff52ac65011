"""Table: the numbers of all variants of a task, over designed scenes and with fixed random numbers.

With it a mistake can be named where the solution is not: on a student's machine, and on the grader's. One file
`variants/TASK.npz` in the folder of an assignment; `make(...)` is the only thing here that runs the solutions.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
PAIRED, FOR_MEANS = 48, 400  # samples: compared one by one; for the means
SEED, TRIAL_SEED = 20261122, 4620  # of the random numbers, and of the scenes


@dataclass(frozen=True, eq=False)
class Table:
    """`causes` (v,), the first of which is "none", the reference; `structural` (v,); numbers by trial.

    samples (v, trials, PAIRED, 3), means and errors (v, trials, 3), features (f, trials, PAIRED, 3), `names` (f, 3).
    """

    trials: tuple[str, ...]
    causes: tuple[str, ...]
    structural: npt.NDArray[np.bool_]
    samples: Array
    means: Array
    errors: Array
    names: tuple[tuple[str, ...], ...]
    features: Array
    alone: tuple[str, ...]
    fingerprint: str
    drawn: int = FOR_MEANS  # samples behind each mean

    def write(self, path: Path) -> None:
        """Floats of 32 bits are enough to know a number again."""
        path.parent.mkdir(exist_ok=True)
        np.savez_compressed(
            path, trials=list(self.trials), causes=list(self.causes), structural=self.structural,
            samples=self.samples.astype(np.float32), means=self.means, errors=self.errors,
            names=["|".join(n) for n in self.names], features=self.features.astype(np.float32),
            alone=list(self.alone), fingerprint=self.fingerprint, drawn=self.drawn,
        )  # fmt: skip

    @classmethod
    def read(cls, path: Path) -> Table:
        with np.load(path, allow_pickle=False) as z:
            return cls(
                tuple(map(str, z["trials"])), tuple(map(str, z["causes"])), z["structural"], z["samples"].astype(float),
                z["means"], z["errors"], tuple(tuple(str(n).split("|")) for n in z["names"]),
                z["features"].astype(float), tuple(map(str, z["alone"])), str(z["fingerprint"]), int(z["drawn"]),
            )  # fmt: skip


def path_of(folder: Path, task: str) -> Path:
    return folder / "variants" / f"{task}.npz"


def make(task: str, trials: tuple[str, ...], paired: int = PAIRED, for_means: int = FOR_MEANS) -> Table:
    """Run every variant of a task in plain Python."""
    from raylab.grading import variants
    from raylab.grading.source import Interpreted
    from raylab.grading.stub import solutions

    solution = solutions()[task]
    rows = (variants.Variant("none", ()), *variants.VARIANTS[task])
    functions = {str(i): variants.alive(solution, variants.edited(solution.text, v.edits)) for i, v in enumerate(rows)}
    features = variants.FEATURES[task]
    functions |= {
        f"f{i}": variants.alive(solution, variants.featured(solution.text, s)) for i, (_, s) in enumerate(features)
    }
    source = Interpreted(functions)

    def drawn(name: str, n: int) -> Array:
        return np.stack([source.samples(name, trial, TRIAL_SEED, SEED, 0, n) for trial in trials])

    with np.errstate(all="ignore"):
        values = np.stack([drawn(str(i), for_means) for i in range(len(rows))])
        found = np.stack([drawn(f"f{i}", paired) for i in range(len(features))])
        means, errors = values.mean(axis=2), values.std(axis=2) / np.sqrt(for_means)
    return Table(
        trials, tuple(v.cause for v in rows), np.array([v.structural or v.cause == "none" for v in rows]),
        values[:, :, :paired], means, errors, tuple(n for n, _ in features), found, variants.ALONE[task],
        variants.fingerprint(solution), for_means,
    )  # fmt: skip


def main(tasks: list[str]) -> None:
    """Make the tables of tasks anew."""
    from raylab.grading.assignment import load

    for task in tasks:
        assignment = load(task.partition(".")[0])
        make(task, assignment.diagnosis[task]).write(path_of(assignment.folder, task))


if __name__ == "__main__":
    import sys

    main(sys.argv[1:])
