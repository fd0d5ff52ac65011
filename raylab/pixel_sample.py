"""PixelSample: one sample of a picture by its numbers: to find the first that is not finite, and to see it again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import astuple, dataclass, replace
from typing import Any

import numpy as np

from raylab import samplers
from raylab.embree import trace
from raylab.errors import InvalidSampleError, UserError
from raylab.jit import interpreted
from raylab.packet import LANES
from raylab.pixels import INVALID, new_accumulator, radiance
from raylab.run import Run
from raylab.scene import Scene
from raylab.strategies import strategy
from raylab.surface import TALLIES, is_valid_ray
from raylab.vec3 import Vec3
from raylab.view import View

FORM = "SHADE/SAMPLER/CELLS/SEED/COLUMN/ROW/STREAM/SAMPLE"


@dataclass(frozen=True)
class PixelSample:
    """What determines a sample of a scene's picture; as text, the token of `raylab replay`."""

    shade: str
    sampler: str
    cells: int  # samples of a stream that the sampler was made for
    seed: int
    column: int
    row: int
    stream: int
    sample: int

    def __str__(self) -> str:
        return "/".join(map(str, astuple(self)))

    @classmethod
    def parse(cls, token: str) -> PixelSample:
        """UserError unless `token` has the FORM of one."""
        shade, sampler, *numbers = [*token.strip().split("/"), ""]
        try:
            return cls(shade, sampler, *(int(n) for n in numbers[:-1]))
        except (TypeError, ValueError):
            raise UserError(f"expected a token {FORM}, got {token!r}") from None

    def value(
        self, scene: Scene, shade: Callable[..., Any] | None = None, say: Callable[[str], None] = lambda _: None
    ) -> Vec3:
        """The sample again, in plain Python, where a debugger can stop; `say` is told what it is made of.

        `shade`: a function of one's own, in place of the slide's called `self.shade`.
        """
        camera, data = scene.camera, scene.data._replace(tally=View(np.zeros(TALLIES, np.int64)))
        described = scene.description.camera
        if not (0 <= self.column < described.width and 0 <= self.row < described.height):
            raise UserError(f"the picture has {described.width} x {described.height} pixels, got {self}")
        used = strategy(shade or self.shade, scene)
        with interpreted():
            pixel = self.row * described.width + self.column
            rng = samplers.make(self.sampler, self.seed, self.cells).stream(pixel, self.stream, self.sample)
            time = data.motion.draw(rng)
            film, lens = camera.draw(rng)
            o, d, tfar = camera.ray(self.column, self.row, film, lens, time)
            say(f"film      {film}\nlens      {lens}\ntime      {time}\norigin    {o}\ndirection {d}")
            data.motion.set(time)
            first = trace(data.embree, o, d, 0.0, tfar, time) if is_valid_ray(o, d) else (-1, -1)
            say(f"meets     shape {first[0]}, primitive {first[1]}")
            found = radiance(data, used, o, d, first, rng)
        say(f"radiance  {found}")
        return found


def first_invalid(run: Run, samples: tuple[int, int]) -> InvalidSampleError:
    """Of a render that has met one in samples first .. last - 1 of its streams: which, and how to see it again.

    Packet by packet, as in the picture, then sample by sample.
    """
    _, rows, columns = np.nonzero(run.accumulator[..., INVALID])
    row, column = min(zip(rows.tolist(), columns.tolist(), strict=True))
    share = LANES // run.schedule.plan.streams
    for first in range(*samples, share):
        last = min(first + share, samples[1])
        for stream in _streams(run, row, column, first, last):
            each = (k for k in range(first, last) if stream in _streams(run, row, column, k, k + 1))
            sample = PixelSample(
                run.name, run.sampler, run.cells, run.seed, column, row, stream, next(each, first)
            )  # fmt: skip
            where = run.scene.description.path or run.scene.description.name
            return InvalidSampleError(
                f"a sample is not finite: pixel ({column}, {row}), stream {stream}, sample {sample.sample}, seed "
                f"{run.seed} of {where} by {run.name}; see it again with: raylab replay {sample} {where}"
            )
    raise AssertionError("the sample was there a moment ago")


def _streams(run: Run, row: int, column: int, first: int, last: int) -> list[int]:
    """Which streams of a pixel have a sample that is not finite among first .. last - 1."""
    camera = run.scene.description.camera
    alone = replace(run, accumulator=new_accumulator(run.schedule.plan.streams, camera.width, camera.height))
    alone.band((row, row + 1), (first, last))
    return [int(k) for k in np.flatnonzero(alone.accumulator[:, row, column, INVALID])]
