"""Run: a render under way: what is rendered and how, the kernel, the picture so far, and its checkpoint."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from raylab import samplers
from raylab.checkpoint import Checkpoint
from raylab.image import Image, estimate, invalid
from raylab.jit import entry_point
from raylab.motion import own_copy
from raylab.packet import new_packet
from raylab.pixels import COUNT, cached_accumulate, fresh_accumulate, new_accumulator, view
from raylab.plan import MAX_SAMPLES
from raylab.scene import Scene
from raylab.schedule import Schedule
from raylab.stopping import Halves
from raylab.surface import DEGENERATE_SAMPLES, INVALID_RAYS, SHADOW_RAYS, TALLIES
from raylab.view import View

LOOK = 1 << 14  # pixels that the progress bar takes the noise of


@dataclass
class Run:
    """`halves` are there where it stops at an error, `checkpoint` where it is to survive a kill."""

    scene: Scene
    strategy: Any
    name: str  # of the strategy
    sampler: str
    seed: int
    strict: bool
    schedule: Schedule
    accumulator: Any = None
    tally: Any = field(default_factory=lambda: np.zeros(TALLIES, np.int64))
    halves: Halves | None = None
    checkpoint: Checkpoint | None = None
    kernel: Any = None
    compile_seconds: float = 0.0

    def __post_init__(self) -> None:
        plan = self.schedule.plan
        if self.accumulator is None:
            self.accumulator = new_accumulator(plan.streams, self.schedule.width, self.schedule.height)
        if plan.relative_error > 0.0:
            self.halves = Halves(plan.relative_error, self.independent)

    @property
    def independent(self) -> bool:
        """Are the samples of a stream independent of one another?"""
        return self.sampler == "independent"

    @property
    def cells(self) -> int:
        """Of a stratified sampler: the samples of a stream, where they are known beforehand."""
        return self.schedule.plan.samples if self.schedule.plan.samples < MAX_SAMPLES else 16

    def compile(self) -> None:
        """Compile the kernel of this scene and strategy, or load it from the cache."""
        start = time.perf_counter()
        kernel = cached_accumulate if self.strategy.cached else fresh_accumulate
        self.kernel = entry_point(kernel, self._arguments(self.tally, (0, 0), (0, 0)))
        self.compile_seconds = time.perf_counter() - start

    def band(self, rows: tuple[int, int], samples: tuple[int, int]) -> tuple[int, Any]:
        """Take some samples of some rows; how many rows, and what was counted."""
        tally = np.zeros(TALLIES, np.int64)
        self.kernel(*self._arguments(tally, rows, samples))
        return rows[1] - rows[0], tally

    def band_in_time(self, rows: tuple[int, int], samples: tuple[int, int]) -> tuple[int, Any]:
        """The same, but nothing once the time is up."""
        return (0, 0) if self.schedule.late() else self.band(rows, samples)

    def _arguments(self, tally: Any, rows: tuple[int, int], samples: tuple[int, int]) -> tuple[Any, ...]:
        sampler = samplers.make(self.sampler, self.seed, self.cells)
        data = own_copy(self.scene.data._replace(tally=View(tally)))
        return (
            data, self.scene.camera, self.strategy, sampler, new_packet(), view(self.accumulator),
            self.schedule.width, self.schedule.height, rows, samples,
        )  # fmt: skip

    def resume(self, checkpoint: Checkpoint) -> None:
        """Go on from what was written, if there is something; write at once: who cannot is told before the work."""
        self.checkpoint, self.schedule.at_risk = checkpoint, checkpoint.interval
        if kept := checkpoint.load():
            self.accumulator, self.tally = kept["accumulator"], kept["tally"]
            self.schedule.taken, self.schedule.seconds = int(kept["taken"]), float(kept["seconds"])
            if self.halves:
                self.halves.kept = {half: kept[f"half{half}"] for half in (0, 1) if f"half{half}" in kept}
        self.keep()

    def keep(self) -> None:
        """Write what is done, where there is a checkpoint."""
        if self.checkpoint:
            halves = {f"half{half}": own for half, own in self.halves.kept.items()} if self.halves else {}
            self.checkpoint.save(
                accumulator=self.accumulator, tally=self.tally, taken=self.schedule.taken,
                seconds=self.schedule.seconds, **halves,
            )  # fmt: skip

    def noise(self) -> float:
        """The relative error so far, of as many pixels as can be looked at in no time."""
        step = max(1, math.isqrt(self.schedule.width * self.schedule.height // LOOK))
        return Image(*estimate(self.accumulator[:, ::step, ::step], self.independent)).relative_error

    def image(self, complete: bool) -> Image:
        """The picture so far, and how it was made."""
        accumulator = self.halves.picture(self.accumulator) if self.halves else self.accumulator
        mean, error, counts = estimate(accumulator, self.independent)
        lost = invalid(accumulator)
        report = {
            "sampler": self.sampler,
            "seed": self.seed,
            "threads": self.schedule.threads,
            "streams": self.schedule.plan.streams,
            "seconds": {"compile": self.compile_seconds, "render": self.schedule.seconds},
            "rays": {"camera": int(accumulator[..., COUNT].sum()) + lost, "shadow": int(self.tally[SHADOW_RAYS])},
        }
        return Image(
            mean, error, counts, lost, int(self.tally[INVALID_RAYS]), int(self.tally[DEGENERATE_SAMPLES]), complete,
            report,
        )  # fmt: skip
