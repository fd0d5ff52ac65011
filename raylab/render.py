"""render(scene, shade): passes over the picture, bands of rows over threads, until enough samples are taken.

What a pixel gets depends on seed, pixel, stream and sample number alone; threads and bands change nothing.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed, wait
from contextlib import suppress
from pathlib import Path
from typing import Any

from raylab import samplers
from raylab.checkpoint import Checkpoint
from raylab.errors import UserError
from raylab.image import Image, invalid
from raylab.pixel_sample import first_invalid
from raylab.plan import MAX_SAMPLES, Plan
from raylab.progress import Progress
from raylab.run import Run
from raylab.scene import Scene
from raylab.schedule import Schedule
from raylab.strategies import strategy
from raylab.surface import SHADOW_RAYS


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
    run = Run(
        scene, strategy(shade, scene), shade if isinstance(shade, str) else getattr(shade, "__name__", "shade"), name,
        seed, strict, Schedule(plan, camera.width, camera.height, threads, band_rows),
    )  # fmt: skip
    if checkpoint is not None:
        run.resume(Checkpoint(Path(checkpoint), described, shade, name, seed, plan))
    return _execute(run, progress)


def default_threads() -> int:
    """The cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _execute(run: Run, progress: Callable[[Progress], None] | None) -> Image:
    run.compile()
    complete = True
    try:
        with ThreadPoolExecutor(run.schedule.threads) as pool:
            for first, last in _passes(run):
                _one_pass(run, pool, first, last, progress)
        with suppress(UserError):  # a picture that is complete can still be written elsewhere
            run.keep()
    except KeyboardInterrupt:
        complete = False
    return run.image(complete)


def _passes(run: Run) -> Iterator[tuple[int, int]]:
    """Ranges of samples, until there are enough, or the time is up."""
    schedule, plan = run.schedule, run.schedule.plan
    schedule.begin()
    while schedule.taken < plan.samples and not schedule.late():
        if run.halves and is_power_of_two(schedule.taken) and run.halves.stop(run.accumulator):
            return
        first, last = schedule.taken, schedule.next_end()
        yield first, last
        schedule.taken = last
        if run.strict and invalid(run.accumulator):
            raise first_invalid(run, (first, last))
        if run.checkpoint and not schedule.late() and run.checkpoint.due(plan.seconds - schedule.seconds):
            run.keep()


def is_power_of_two(n: int) -> bool:
    return n > 0 and n & (n - 1) == 0


def _one_pass(
    run: Run, pool: ThreadPoolExecutor, first: int, last: int, progress: Callable[[Progress], None] | None
) -> None:
    """Render samples first .. last - 1 of each stream, a band of rows to each work item."""
    schedule = run.schedule
    noise = run.noise() if progress and schedule.seconds > 1.0 else math.nan
    waiting = [pool.submit(run.band_in_time, band, (first, last)) for band in schedule.bands(last - first)]
    finished_rows = 0
    try:
        for future in as_completed(waiting):
            count, tally = future.result()
            finished_rows += count
            run.tally += tally
            schedule.look()
            if progress:
                progress(_so_far(run, first + (last - first) * finished_rows / schedule.height, noise))
    finally:
        for future in waiting:
            future.cancel()
        wait(waiting)
        schedule.look()


def _so_far(run: Run, samples: float, noise: float) -> Progress:
    """After so many samples of each stream."""
    schedule, plan = run.schedule, run.schedule.plan
    done = int(samples * plan.streams)
    rays = done * schedule.width * schedule.height + int(run.tally[SHADOW_RAYS])
    total = None if plan.samples == MAX_SAMPLES else plan.samples * plan.streams
    return Progress(done, total, rays, schedule.seconds, noise)
