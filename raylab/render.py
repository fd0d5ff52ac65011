"""render(scene, shade): passes over the picture, bands of rows over threads, until enough samples are taken.

What a pixel gets depends on seed, pixel, stream and sample number alone; threads and bands change nothing.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed, wait
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from raylab import samplers
from raylab.checkpoint import INTERVAL, Checkpoint
from raylab.errors import UserError
from raylab.image import Image, estimate, invalid
from raylab.jit import entry_point
from raylab.motion import own_copy
from raylab.packet import new_packet
from raylab.pixel_sample import first_invalid
from raylab.pixels import COUNT, cached_accumulate, fresh_accumulate, new_accumulator, view
from raylab.plan import MAX_SAMPLES, Plan
from raylab.scene import Scene
from raylab.schedule import Schedule
from raylab.stopping import Halves
from raylab.strategies import strategy
from raylab.surface import DEGENERATE_SAMPLES, INVALID_RAYS, SHADOW_RAYS, TALLIES
from raylab.view import View

LOOK = 1 << 14  # pixels that the progress bar takes the noise of


@dataclass
class Progress:
    """What a progress bar shows; `done` and `total` are samples of the whole picture, total None when unknown."""

    done: int = 0
    total: int | None = None
    rays: int = 0
    seconds: float = 0.0
    relative_error: float = float("nan")


@dataclass
class _Run:
    """A render under way: its picture so far, its tallies and its clocks."""

    scene: Scene
    strategy: Any
    sampler: str
    seed: int
    plan: Plan
    schedule: Schedule
    strict: bool
    name: str  # of the strategy
    accumulator: Any
    band_rows: int | None = None
    progress: Callable[[Progress], None] | None = None
    kernel: Any = None
    tally: Any = field(default_factory=lambda: np.zeros(TALLIES, np.int64))
    halves: Halves | None = None  # where it stops at an error
    checkpoint: Checkpoint | None = None
    compile_seconds: float = 0.0

    @property
    def cells(self) -> int:
        """Of a stratified sampler: the samples of a stream, where they are known beforehand."""
        return self.plan.samples if self.plan.samples < MAX_SAMPLES else 16

    def band(self, rows: tuple[int, int], samples: tuple[int, int]) -> tuple[int, Any]:
        """Take some samples of some rows; how many rows, and what was counted."""
        tally = np.zeros(TALLIES, np.int64)
        self.kernel(*_arguments(self, tally, rows, samples))
        return rows[1] - rows[0], tally

    def band_in_time(self, rows: tuple[int, int], samples: tuple[int, int]) -> tuple[int, Any]:
        """The same, but nothing once the time is up."""
        return (0, 0) if self.schedule.late() else self.band(rows, samples)


def render(
    scene: Scene,
    shade: str | Callable[..., Any] = "direct",
    *,
    sampler: str | None = None,
    spp: int | None = None,
    seconds: float | None = None,
    relative_error: float | None = None,
    seed: int | None = None,
    threads: int | None = None,
    band_rows: int | None = None,
    progress: Callable[[Progress], None] | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    strict: bool = False,
) -> Image:
    """Render `scene` with a slide's shade(), by name or as a function.

    Parameters
    ----------
    shade : a name from `raylab.strategies.NAMES`, or shade(x, V, brdf, N, scene, rng), or shade(x, k_d, N, scene, rng).
    sampler : "independent", "stratified", "latin", "sobol" or "centre"; the scene's own by default.
    spp, seconds, relative_error : stop after so many samples a pixel, after a time of sampling, or at a noise level
        (`Image.relative_error`); at most one of them, spp of the scene by default.
    seed : picture number; the same seed gives the same bits for every number of threads.
    threads : default: all cores. band_rows : rows of a work item, chosen by default.
    progress : called now and then from this thread.
    checkpoint : a file that keeps what is done, even if the process is killed. Where there is one, the render goes on
        from it, and ends with the picture that it would have been without the stop, bit by bit.
    strict : raise for the first sample that is not finite, instead of leaving it out and counting it.

    Returns
    -------
    Image; after Ctrl-C what was done so far, with `complete` False.

    Raises
    ------
    UserError : an argument that cannot be used.
    InvalidSampleError : in strict mode, with the sample: `raylab replay` shows it.
    """
    described = scene.description
    name = sampler or described.sampler
    if name not in samplers.ALL_NAMES:
        raise UserError(f"unknown sampler {name!r}; expected one of {', '.join(samplers.ALL_NAMES)}")
    if name != "centre" and spp is None and seconds is None and relative_error is None:
        spp = described.spp
    plan = Plan.make(name, spp, seconds, relative_error)
    threads = default_threads() if threads is None else threads
    if threads < 1:
        raise UserError(f"threads must be at least 1, got {threads}")
    seed = described.seed if seed is None else seed
    camera = described.camera
    run = _Run(
        scene, strategy(shade, scene), name, seed, plan, Schedule(plan, camera.width, camera.height, threads), strict,
        shade if isinstance(shade, str) else getattr(shade, "__name__", "shade"),
        new_accumulator(plan.streams, camera.width, camera.height), band_rows, progress,
    )  # fmt: skip
    if plan.relative_error > 0.0:
        run.halves = Halves(plan.relative_error, name == "independent")
    if checkpoint is not None:
        run.checkpoint = Checkpoint(Path(checkpoint), described, shade, name, seed, plan)
        run.schedule.at_risk = INTERVAL
        _resume(run, run.checkpoint)
    return _execute(run)


def default_threads() -> int:
    """The cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _execute(run: _Run) -> Image:
    start = time.perf_counter()
    _compile(run)
    run.compile_seconds = time.perf_counter() - start
    complete = True
    try:
        with ThreadPoolExecutor(run.schedule.threads) as pool:
            for first, last in _passes(run):
                _one_pass(run, pool, first, last)
        if run.checkpoint:
            with suppress(UserError):  # the picture is complete: it can still be written elsewhere
                _keep(run, run.checkpoint)
    except KeyboardInterrupt:
        complete = False
    if run.halves:
        run.accumulator = run.halves.picture(run.accumulator)
    return _image(run, complete)


def _arguments(run: _Run, tally: Any, rows: tuple[int, int], samples: tuple[int, int]) -> tuple[Any, ...]:
    camera = run.scene.description.camera
    sampler = samplers.make(run.sampler, run.seed, run.cells)
    data = own_copy(run.scene.data._replace(tally=View(tally)))
    pixels = view(run.accumulator)
    return (
        data, run.scene.camera, run.strategy, sampler, new_packet(), pixels, camera.width, camera.height, rows, samples
    )  # fmt: skip


def _compile(run: _Run) -> None:
    """Compile the kernel of this scene and strategy, or load it from the cache."""
    kernel = cached_accumulate if run.strategy.cached else fresh_accumulate
    run.kernel = entry_point(kernel, _arguments(run, run.tally, (0, 0), (0, 0)))


def _passes(run: _Run) -> Iterator[tuple[int, int]]:
    """Ranges of samples, until there are enough, or the time is up."""
    schedule = run.schedule
    schedule.begin()
    while schedule.taken < run.plan.samples and not schedule.late():
        if run.halves and is_power_of_two(schedule.taken) and run.halves.stop(run.accumulator):
            return
        first, last = schedule.taken, schedule.next_end()
        yield first, last
        schedule.taken = last
        if run.strict and invalid(run.accumulator):
            raise first_invalid(run, (first, last))
        if run.checkpoint and not schedule.late() and run.checkpoint.due(run.plan.seconds - schedule.seconds):
            _keep(run, run.checkpoint)


def is_power_of_two(n: int) -> bool:
    return n > 0 and n & (n - 1) == 0


def _one_pass(run: _Run, pool: ThreadPoolExecutor, first: int, last: int) -> None:
    """Render samples first .. last - 1 of each stream, a band of rows to each work item."""
    schedule, height = run.schedule, run.schedule.height
    rows = run.band_rows or schedule.rows(last - first)
    noise = _noise(run) if run.progress and schedule.seconds > 1.0 else math.nan
    bands = [(top, min(top + rows, height)) for top in range(0, height, rows)]
    waiting = [pool.submit(run.band_in_time, band, (first, last)) for band in bands]
    finished_rows = 0
    try:
        for future in as_completed(waiting):
            count, tally = future.result()
            finished_rows += count
            run.tally += tally
            schedule.look()
            if run.progress:
                run.progress(_so_far(run, first + (last - first) * finished_rows / height, noise))
    finally:
        for future in waiting:
            future.cancel()
        wait(waiting)
        schedule.look()


def _so_far(run: _Run, samples: float, noise: float) -> Progress:
    """After so many samples of each stream."""
    done = int(samples * run.plan.streams)
    rays = done * run.schedule.width * run.schedule.height + int(run.tally[SHADOW_RAYS])
    total = None if run.plan.samples == MAX_SAMPLES else run.plan.samples * run.plan.streams
    return Progress(done, total, rays, run.schedule.seconds, noise)


def _noise(run: _Run) -> float:
    """The relative error so far, of as many pixels as can be looked at in no time."""
    step = max(1, math.isqrt(run.schedule.width * run.schedule.height // LOOK))
    return Image(*estimate(run.accumulator[:, ::step, ::step], run.sampler == "independent")).relative_error


def _keep(run: _Run, checkpoint: Checkpoint) -> None:
    """Write what is done."""
    halves = {f"half{half}": own for half, own in run.halves.kept.items()} if run.halves else {}
    checkpoint.save(
        accumulator=run.accumulator, tally=run.tally, taken=run.schedule.taken, seconds=run.schedule.seconds, **halves
    )  # fmt: skip


def _resume(run: _Run, checkpoint: Checkpoint) -> None:
    """Go on from what was written, if there is something; write at once, so that who cannot is told before the work."""
    if kept := checkpoint.load():
        run.accumulator, run.tally = kept["accumulator"], kept["tally"]
        run.schedule.taken, run.schedule.seconds = int(kept["taken"]), float(kept["seconds"])
        if run.halves:
            run.halves.kept = {half: kept[f"half{half}"] for half in (0, 1) if f"half{half}" in kept}
    _keep(run, checkpoint)


def _image(run: _Run, complete: bool) -> Image:
    mean, error, counts = estimate(run.accumulator, run.sampler == "independent")
    taken = int(run.accumulator[..., COUNT].sum()) + invalid(run.accumulator)
    report = {
        "sampler": run.sampler,
        "seed": run.seed,
        "threads": run.schedule.threads,
        "streams": run.plan.streams,
        "seconds": {"compile": run.compile_seconds, "render": run.schedule.seconds},
        "rays": {"camera": taken, "shadow": int(run.tally[SHADOW_RAYS])},
    }
    return Image(
        mean, error, counts, invalid(run.accumulator), int(run.tally[INVALID_RAYS]),
        int(run.tally[DEGENERATE_SAMPLES]), complete, report,
    )  # fmt: skip
