"""render(scene, shade): passes over the picture, bands of rows over threads, until enough samples are taken.

The samples of each stream are taken in passes that end at powers of two, so that an Owen-scrambled sequence is
complete after each, the error is known early, and Ctrl-C always leaves a whole picture. What a pixel gets depends on
seed, pixel, stream and sample number alone; threads and bands change nothing.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
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
from raylab.packet import LANES, new_packet
from raylab.pixel_sample import first_invalid
from raylab.pixels import COUNT, cached_accumulate, fresh_accumulate, new_accumulator, view
from raylab.plan import MAX_SAMPLES, Plan
from raylab.scene import Scene
from raylab.stopping import Halves
from raylab.strategies import strategy
from raylab.surface import DEGENERATE_SAMPLES, INVALID_RAYS, SHADOW_RAYS, TALLIES
from raylab.view import View

SHORT = 0.5  # seconds: what can be done in this time is one pass
FIRST_PASS = 1 << 22  # camera rays that the first pass may take over the whole picture


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
    threads: int
    plan: Plan
    strict: bool = False
    name: str = ""  # of the strategy
    accumulator: Any = None
    kernel: Any = None
    tally: Any = field(default_factory=lambda: np.zeros(TALLIES, np.int64))
    halves: Halves | None = None  # where it stops at an error
    checkpoint: Checkpoint | None = None
    taken: int = 0  # samples of each stream, complete over the picture
    compile_seconds: float = 0.0
    render_seconds: float = 0.0

    @property
    def cells(self) -> int:
        """Of a stratified sampler: the samples of a stream, where they are known beforehand."""
        return self.plan.samples if self.plan.samples < MAX_SAMPLES else 16

    def band(self, rows: tuple[int, int], samples: tuple[int, int]) -> tuple[int, Any]:
        """Take some samples of some rows; how many rows, and what was counted."""
        tally = np.zeros(TALLIES, np.int64)
        self.kernel(*_arguments(self, tally, rows, samples))
        return rows[1] - rows[0], tally


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
    spp, seconds, relative_error : stop after so many samples a pixel, after a time, or at a noise level
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
    run = _Run(scene, strategy(shade, scene), name, seed, threads, plan, strict)
    run.name = shade if isinstance(shade, str) else getattr(shade, "__name__", "shade")
    if checkpoint is not None:
        run.checkpoint = Checkpoint(Path(checkpoint), described, shade, name, seed, plan)
    return _execute(run, band_rows, progress or _silent)


def _silent(progress: Progress) -> None:
    """No progress bar."""


def default_threads() -> int:
    """The cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _execute(run: _Run, band_rows: int | None, progress: Callable[[Progress], None]) -> Image:
    camera = run.scene.description.camera
    run.accumulator = new_accumulator(run.plan.streams, camera.width, camera.height)
    if run.plan.relative_error > 0.0:
        run.halves = Halves(run.plan.relative_error, run.sampler == "independent")
    if run.checkpoint:
        _resume(run, run.checkpoint)
    start = time.perf_counter()
    _compile(run)
    run.compile_seconds = time.perf_counter() - start
    complete = True
    try:
        with ThreadPoolExecutor(run.threads) as pool:
            for first, last in _passes(run):
                _one_pass(run, pool, first, last, band_rows, progress)
        if run.checkpoint:
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
    """Ranges of samples that end at powers of two, the last one cut to what the plan allows.

    A pass ends at 1 or at a multiple of LANES, so that which eye rays share a packet does not depend on the clock; and
    where it is the noise that ends the render, it is looked at after every power of two, for the same reason.
    """
    while run.taken < run.plan.samples:
        if run.halves and is_power_of_two(run.taken) and run.halves.stop(run.accumulator):
            return
        last = min(_next_end(run) if run.taken > 0 else _first_pass(run), run.plan.samples)
        if last <= run.taken:
            return
        yield run.taken, last
        if run.strict and invalid(run.accumulator):
            raise first_invalid(run, (run.taken, last))
        run.taken = last
        if run.checkpoint and run.checkpoint.due():
            _keep(run, run.checkpoint)


def _next_end(run: _Run) -> int:
    """Where the next pass ends: what can be done in a SHORT time, or as much again as is done; less if time is up."""
    rate = run.taken / run.render_seconds if run.render_seconds > 0.0 else math.inf
    fast = int(rate * SHORT).bit_length() - 1 if rate < math.inf and not run.halves else 0
    last = max(LANES, 1 << max(run.taken.bit_length(), fast))
    if run.checkpoint and rate < math.inf:  # a pass that is killed is lost
        last = min(last, LANES * max(1, int(run.taken + rate * INTERVAL) // LANES))
        last = max(last, LANES * (run.taken // LANES + 1))
    if run.plan.seconds < math.inf:
        last = min(last, run.taken + max(0, int((run.plan.seconds - run.render_seconds) * rate)))
    return last


def is_power_of_two(n: int) -> bool:
    return n > 0 and n & (n - 1) == 0


def _keep(run: _Run, checkpoint: Checkpoint) -> None:
    """Write what is done."""
    halves = {f"half{half}": own for half, own in run.halves.kept.items()} if run.halves else {}
    checkpoint.save(
        accumulator=run.accumulator, tally=run.tally, taken=run.taken, seconds=run.render_seconds, **halves
    )  # fmt: skip


def _resume(run: _Run, checkpoint: Checkpoint) -> None:
    """Go on from what was written, if there is something."""
    kept = checkpoint.load()
    if not kept:
        return
    run.accumulator, run.tally = kept["accumulator"], kept["tally"]
    run.taken, run.render_seconds = int(kept["taken"]), float(kept["seconds"])
    if run.halves:
        run.halves.kept = {half: kept[f"half{half}"] for half in (0, 1) if f"half{half}" in kept}


def _first_pass(run: _Run) -> int:
    """How many samples of each stream to begin with: a packet in a small picture whose number is given, else one."""
    if run.plan.samples == MAX_SAMPLES:
        return 1
    camera = run.scene.description.camera
    return LANES if LANES * camera.width * camera.height * run.plan.streams <= FIRST_PASS else 1


def _so_far(run: _Run) -> Image:
    mean, error, counts = estimate(run.accumulator, run.sampler == "independent")
    return Image(mean, error, counts)


def _one_pass(
    run: _Run,
    pool: ThreadPoolExecutor,
    first: int,
    last: int,
    band_rows: int | None,
    progress: Callable[[Progress], None],
) -> None:
    """Render samples first .. last - 1 of each stream, a band of rows to each work item."""
    camera = run.scene.description.camera
    start, base = time.perf_counter(), run.render_seconds
    shown = Progress(total=None if run.plan.samples == MAX_SAMPLES else run.plan.samples * run.plan.streams)
    if progress is not _silent and base > 1.0:
        shown.relative_error = _so_far(run).relative_error
    per_row = camera.width * run.plan.streams * (last - first)
    rows = band_rows or max(1, min(-(-camera.height // (4 * run.threads)), 200_000 // per_row))
    waiting: set[Future[Any]] = set()
    finished_rows = 0
    try:
        for top in range(0, camera.height, rows):
            bottom = min(top + rows, camera.height)
            waiting.add(pool.submit(run.band, (top, bottom), (first, last)))
        while waiting:
            done, waiting = wait(waiting, timeout=0.1, return_when=FIRST_COMPLETED)
            for future in done:
                count, tally = future.result()
                finished_rows += count
                run.tally += tally
            run.render_seconds = base + time.perf_counter() - start
            share = finished_rows / camera.height
            shown.done = int((first + (last - first) * share) * run.plan.streams)
            pixels = camera.width * camera.height
            shown.rays, shown.seconds = shown.done * pixels + int(run.tally[SHADOW_RAYS]), run.render_seconds
            progress(shown)
    except BaseException:
        for future in waiting:
            future.cancel()
        wait(waiting)
        run.render_seconds = base + time.perf_counter() - start
        raise


def _image(run: _Run, complete: bool) -> Image:
    mean, error, counts = estimate(run.accumulator, run.sampler == "independent")
    taken = int(run.accumulator[..., COUNT].sum()) + invalid(run.accumulator)
    report = {
        "sampler": run.sampler,
        "seed": run.seed,
        "threads": run.threads,
        "streams": run.plan.streams,
        "seconds": {"compile": run.compile_seconds, "render": run.render_seconds},
        "rays": {"camera": taken, "shadow": int(run.tally[SHADOW_RAYS])},
    }
    return Image(
        mean, error, counts, invalid(run.accumulator), int(run.tally[INVALID_RAYS]),
        int(run.tally[DEGENERATE_SAMPLES]), complete, report,
    )  # fmt: skip
