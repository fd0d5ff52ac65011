"""Probe: independent samples of a shade() at one point of a surface, or of one pixel, as arrays and at full speed.

A probe answers "what does this estimator return, and how does it scatter", without a picture around it. The surface
point is found once, by a ray; then shade() is called n times, call number i with the `independent` stream i. What is
drawn depends on the seed and on the number of the call alone, not on the threads. Values are not looked at: a NaN is
handed on.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import samplers
from raylab.embree import TNEAR
from raylab.errors import UserError
from raylab.jit import cached_njit, entry_point, njit
from raylab.motion import own_copy
from raylab.packet import LANES, new_packet
from raylab.pixels import radiance, send
from raylab.render import default_threads
from raylab.scene import Scene
from raylab.strategies import strategy
from raylab.surface import BACK, FRONT, SHADOW_RAYS, TALLIES, intersect, round32
from raylab.vec3 import Vec3, normalize
from raylab.view import View

Array = npt.NDArray[np.float64]
Tally = npt.NDArray[np.int64]
BLOCK = 1 << 14  # calls that are worth a thread of their own
SEEDS = (1 << 63) - 1  # the bits of a seed that count
HEIGHT = 2.0**-8  # of the scene: how far off the surface the ray starts that finds a given point


def sample_point(scene, strategy, sampler, o, d, first, values, place):
    """Call shade() at the first hit of o + t d with the streams first, first + 1, ...; `values` (n, 3).

    `place` (2, 3) receives the hit point and its normal, zeros if there is none. The point stands still, and is found
    as the shutter opens; what moves around it stands in each call where it is at a time of its own.
    """
    scene.motion.set(0.0)
    hit = intersect(scene, round32(o), round32(d), TNEAR, math.inf)
    put(place, 0, hit.x.p)
    put(place, 1, hit.N)
    if not hit.found:
        return
    material = scene.shapes[hit.shape, FRONT if hit.front else BACK]
    if material < 0:
        put(place, 1, Vec3(0.0, 0.0, 0.0))
        return
    brdf = scene.materials.at(material, hit.N, hit.uv)
    V = normalize(-round32(d))
    for i in range(len(values)):
        rng = sampler.stream(0, 0, first + i)
        scene.motion.set(scene.motion.draw(rng))
        put(values, i, strategy.shade(hit.x, V, brdf, hit.N, scene, rng))


def sample_pixel(scene, camera, strategy, sampler, packet, column, row, first, values):
    """Radiance along eye rays first, first + 1, ... of one pixel; `values` (n, 3)."""
    done = 0
    while done < len(values):
        last = min(done + LANES, len(values))
        drawn = send(scene, camera, sampler, packet, column, row, 0, 1, first + done, first + last)
        for lane in range(last - done):
            rng = sampler.stream(0, 0, first + done + lane)
            sampler.counter.next[0] = drawn
            scene.motion.set(packet.time(lane))
            light = _radiance(scene, strategy, packet.o(lane), packet.d(lane), packet.hit(lane), rng)
            put(values, done + lane, light)
        done = last


@njit
def put(values, i, v):
    """Write a vector into row i."""
    values[i, 0], values[i, 1], values[i, 2] = v.x, v.y, v.z


_radiance = njit(radiance)
_point_kernels = {True: cached_njit(sample_point), False: njit(sample_point)}
_pixel_kernels = {True: cached_njit(sample_pixel), False: njit(sample_pixel)}


@dataclass(frozen=True, eq=False)
class Place:
    """Where a probe stands: the first hit of a ray, in world coordinates. V is the direction to its origin."""

    origin: Array
    direction: Array

    @classmethod
    def seen(cls, eye: npt.ArrayLike, target: npt.ArrayLike) -> Place:
        """What an eye sees that looks at a target."""
        origin = np.asarray(eye, np.float64)
        return cls(origin, np.asarray(target, np.float64) - origin)

    @classmethod
    def at(cls, scene: Scene, point: npt.ArrayLike, view: npt.ArrayLike) -> Place:
        """A point of a surface; `view` points from there to the eye, and to the side of the surface that is meant."""
        view = np.asarray(view, np.float64) / np.linalg.norm(view)
        return cls(np.asarray(point, np.float64) + view * (HEIGHT / scene.placement.scale), -view)


@dataclass(frozen=True)
class Pixel:
    """Where a probe stands that sees through the camera of the scene."""

    column: int
    row: int


class Draws:
    """Samples one after the other: each call continues where the last one ended."""

    def __init__(self, sample: Callable[[int, int], Array], channel: int | None) -> None:
        self.sample, self.channel, self.taken = sample, channel, 0

    def __call__(self, n: int) -> Array:
        values = self.sample(self.taken, n)
        self.taken += n
        return values if self.channel is None else values[:, self.channel].copy()


@dataclass(frozen=True, eq=False)
class Probe:
    """A shade(), by name or as a function, at a place of a scene."""

    scene: Scene
    shade: str | Callable[..., Any]
    place: Place | Pixel
    threads: int = 0  # 0: all cores

    def sample(self, seed: int, n: int, first: int = 0) -> Array:
        """Samples first .. first + n - 1 of the sequence that belongs to `seed`, (n, 3)."""
        return self._fill(self._kernel(seed), n, first)

    def _fill(self, run: Callable[..., None], n: int, first: int) -> Array:
        values = np.empty((n, 3))
        if n < 2 * BLOCK:
            run(values, first)
            return values
        with ThreadPoolExecutor(self.threads or default_threads()) as pool:
            list(pool.map(lambda i: run(values[i : i + BLOCK], first + i), range(0, n, BLOCK)))
        return values

    def draws(self, seed: int, channel: int | None = None) -> Draws:
        """A function n -> (n, 3), or (n,) for one colour channel, that goes on drawing."""
        run = self._kernel(seed)
        return Draws(lambda first, n: self._fill(run, n, first), channel)

    def means(self, seed: int, channel: int) -> Callable[[int, int], Array]:
        """A function (N, n) -> (n,): means of N samples each, for claims about how errors shrink."""
        draw = self.draws(seed, channel)
        return lambda samples, n: draw(samples * n).reshape(n, samples).mean(axis=1)

    def rays(self, seed: int, n: int) -> int:
        """How many rays the first n calls of shade() trace: `Image.report` counts the same ones as shadow rays."""
        tally = np.zeros(TALLIES, np.int64)
        self._kernel(seed, tally)(np.empty((n, 3)), 0)
        return int(tally[SHADOW_RAYS])

    def found(self) -> tuple[Array, Array]:
        """The surface point in world coordinates, and its normal, where shade() is called."""
        if isinstance(self.place, Pixel):
            raise UserError("a pixel has no single point; expected a probe at a Place")
        place = np.zeros((2, 3))
        self._point_kernel(0)(np.zeros((0, 3)), 0, place)
        if not place[1].any():
            raise UserError(f"a probe from {self.place.origin} toward {self.place.direction} met no surface to shade")
        placement = self.scene.placement
        return place[0] / placement.scale + placement.centre, place[1]

    def _kernel(self, seed: int, tally: Tally | None = None) -> Callable[..., None]:
        if isinstance(self.place, Pixel):
            return self._pixel_kernel(seed, self.place, tally)
        self.found()
        return self._point_kernel(seed, tally)

    def _common(self, seed: int, tally: Tally | None) -> tuple[Any, Any]:
        """Strategy, and a function that makes what each thread has of its own: (scene data, camera, sampler).

        A `tally` that is given is that of one thread.
        """
        chosen = strategy(self.shade, self.scene)

        def own() -> tuple[Any, Any, Any]:
            counts = np.zeros(TALLIES, np.int64) if tally is None else tally
            data = self.scene.data._replace(tally=View(counts))
            return own_copy(data), self.scene.camera, samplers.make("independent", seed & SEEDS, 1)

        return chosen, own

    def _point_kernel(self, seed: int, tally: Tally | None = None) -> Callable[..., None]:
        assert isinstance(self.place, Place)
        chosen, own = self._common(seed, tally)
        placement = self.scene.placement
        o = Vec3(*placement.points(self.place.origin))
        d = Vec3(*(self.place.direction / np.linalg.norm(self.place.direction)))

        def arguments(values: Array, first: int, place: Array) -> tuple[Any, ...]:
            data, _, sampler = own()
            return data, chosen, sampler, o, d, first, View(values), View(place)

        kernel = entry_point(_point_kernels[chosen.cached], arguments(np.zeros((0, 3)), 0, np.zeros((2, 3))))

        def run(values: Array, first: int, place: Array | None = None) -> None:
            kernel(*arguments(values, first, np.zeros((2, 3)) if place is None else place))

        return run

    def _pixel_kernel(self, seed: int, pixel: Pixel, tally: Tally | None) -> Callable[..., None]:
        chosen, own = self._common(seed, tally)

        def arguments(values: Array, first: int) -> tuple[Any, ...]:
            data, camera, sampler = own()
            return data, camera, chosen, sampler, new_packet(), pixel.column, pixel.row, first, View(values)

        kernel = entry_point(_pixel_kernels[chosen.cached], arguments(np.zeros((0, 3)), 0))
        return lambda values, first: kernel(*arguments(values, first))
