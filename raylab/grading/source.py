"""Source: where the judge's numbers come from: a jail (`raylab.grading.session`), or this very process.

samples(task, trial, trial_seed, seed, first, n) -> (n, 3)     of a shade()
rays(task, trial, trial_seed, seed, n) -> how many it says that it has traced for the first n of them
map(task, rows (n, k)) -> (n, m)                               of a plain function
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from raylab import trials
from raylab.jit import interpreted
from raylab.plain import Plain
from raylab.probe import Draws, Place, Probe
from raylab.submission.interpret import flatten, unpack
from raylab.submission.task import Task
from raylab.trials import Trial

Array = npt.NDArray[np.float64]


class Source(Protocol):
    """Bytes in, numbers out."""

    def samples(self, task: str, trial: str, trial_seed: int, seed: int, first: int, n: int) -> Array:
        """Samples first .. first + n - 1 of a shade() in a trial, (n, 3)."""

    def rays(self, task: str, trial: str, trial_seed: int, seed: int, n: int) -> float:
        """How many rays are said to be traced for the first n samples."""

    def map(self, task: str, rows: npt.ArrayLike) -> Array:
        """A plain function of each row."""


def plain_of(trial: Trial, seed: int) -> Plain:
    """Where a shade() is called in plain Python."""
    assert isinstance(trial.place, Place)
    return Plain(trial.scene, trial.place, seed)


class InProcess:
    """Functions of this process, which are trusted."""

    def __init__(self, functions: Mapping[str, Any]) -> None:
        self.functions = functions
        self._trials: dict[tuple[str, int], Trial] = {}

    def trial(self, name: str, seed: int) -> Trial:
        if (name, seed) not in self._trials:
            self._trials[name, seed] = trials.make(name, seed)
        return self._trials[name, seed]

    def samples(self, task: str, trial: str, trial_seed: int, seed: int, first: int, n: int) -> Array:
        made = self.trial(trial, trial_seed)
        return Probe(made.scene, self.functions[task], made.place).sample(seed, n, first)

    def rays(self, task: str, trial: str, trial_seed: int, seed: int, n: int) -> float:
        made = self.trial(trial, trial_seed)
        return float(Probe(made.scene, self.functions[task], made.place).rays(seed, n))

    def map(self, task: str, rows: npt.ArrayLike) -> Array:
        return np.asarray(self.functions[task](np.asarray(rows, np.float64)), np.float64)


class Interpreted(InProcess):
    """The same in plain Python: nothing to compile, for few samples of many functions; what raises is not a number."""

    def __init__(self, functions: Mapping[str, Any], tasks: Mapping[str, Task] | None = None) -> None:
        super().__init__(functions)
        self.tasks = tasks or {}

    def samples(self, task: str, trial: str, trial_seed: int, seed: int, first: int, n: int) -> Array:
        called, function = plain_of(self.trial(trial, trial_seed), seed), self.functions[task]
        return numbers([partial(called.call, function, first + i) for i in range(n)], tuple, 3)

    def map(self, task: str, rows: npt.ArrayLike) -> Array:
        function, asked = self.functions[task], self.tasks[task]
        with interpreted():
            calls = [partial(function, *unpack(asked.takes, row)) for row in np.asarray(rows, np.float64)]
            return numbers(calls, lambda found: flatten(asked, found, 0), asked.columns[1])


def numbers(calls: Sequence[Callable[[], Any]], flat: Callable[[Any], Sequence[float]], width: int) -> Array:
    """What each call returns, made `flat`: (calls, width)."""
    values = np.full((len(calls), width), np.nan)
    for i, call in enumerate(calls):
        with suppress(Exception):  # whatever a student's function does
            values[i] = flat(call())
    return values


class Asked:
    """One task in one trial as something that draws: what a Probe is to the built-in functions."""

    def __init__(self, source: Source, task: str, trial: str, trial_seed: int) -> None:
        self.source, self.task, self.trial, self.trial_seed = source, task, trial, trial_seed

    def sample(self, seed: int, n: int, first: int = 0) -> Array:
        return self.source.samples(self.task, self.trial, self.trial_seed, seed, first, n)

    def rays(self, seed: int, n: int) -> float:
        return self.source.rays(self.task, self.trial, self.trial_seed, seed, n)

    def draws(self, seed: int, channel: int | None = None) -> Callable[[int], Array]:
        return Draws(lambda first, n: self.sample(seed, n, first), channel)
