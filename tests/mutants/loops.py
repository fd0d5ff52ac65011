"""What happens to samples after shade() and before it: the running mean, random numbers, strata, the lens.

Each trial gives draws(n) of something bounded whose mean, or variance, is known.
"""

from __future__ import annotations

import math
import secrets
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from raylab import description as d
from raylab import pixels, samplers
from raylab.closed_forms import blur
from raylab.jit import njit
from raylab.sensor import make_camera
from raylab.vec3 import Vec3
from raylab.view import View

SPP = 16


@dataclass
class Loop:
    """`draws` has the mean `mean` and, if given, the variance `variance`, and lies in [low, high]."""

    draws: Callable[[int], Any]
    mean: float
    high: float
    low: float = 0.0
    variance: float | None = None
    delta: float = 0.01


# --- the running mean of `raylab.pixels.receive`: 16 samples of 2 u ---


class _Still(NamedTuple):
    """In place of a scene and its motion."""

    @property
    def motion(self):
        return self

    def set(self, time):
        pass


class _Lanes(NamedTuple):
    """In place of a packet of eye rays."""

    def time(self, lane):
        return 0.0

    def o(self, lane):
        return Vec3(0.0, 0.0, 0.0)

    d = o

    def hit(self, lane):
        return -1, -1


def running_mean() -> Loop:
    """The mean of 16 values 2 u of the pixel loop, which must be 1, with the variance 1 / 48."""
    pixels._radiance = lambda scene, strategy, o, d, first, rng: _value(2.0 * rng.number())
    seed, taken = secrets.randbits(62), [0]

    def draws(n: int) -> Any:
        sampler = samplers.Independent(seed, samplers.new_counter())
        out = np.empty(n)
        for i in range(n):
            accumulator = np.zeros((1, pixels.COLUMNS))
            arguments = (sampler, _Lanes(), 0, 0, View(accumulator), 0, taken[0] + i, 0)
            pixels.receive(_Still(), None, *arguments, 0, SPP)
            out[i] = accumulator[0, pixels.MEAN]
        taken[0] += n
        return out

    return Loop(draws, 1.0, 2.0, variance=1.0 / (3.0 * SPP))


def _value(v: float) -> Vec3:
    return Vec3(v, v, v)


# --- strata: the mean of 16 points of a 4 x 4 grid ---


def strata(name: str = "stratified", curved: bool = False) -> Loop:
    """The mean of 2 u over one grid has the variance 1 / (3 N^2), over a Latin square 1 / (3 N^3); of the curved
    e^(4 u) only the mean is known, and that no grid's mean is beyond 1 / (1 - 1/e) of it."""
    seed, taken = secrets.randbits(62), [0]

    def draws(n: int) -> Any:
        sampler = samplers.make(name, seed, SPP)
        out = np.empty(n)
        fill_strata(sampler, taken[0], curved, View(out))
        taken[0] += n
        return out

    exact = {"stratified": 1.0 / (3.0 * SPP**2), "latin": 1.0 / (3.0 * SPP**3)}[name]
    return Loop(draws, 1.0, 1.6 if curved else 2.0, variance=None if curved else exact)


@njit
def fill_strata(sampler, first, curved, out):
    for i in range(len(out)):
        total = 0.0
        for k in range(SPP):
            u = sampler.stream(first + i, 0, k).square()
            total += (
                (math.exp(4.0 * u[0]) + math.exp(4.0 * u[1])) * 2.0 / (math.exp(4.0) - 1.0) if curved else 2.0 * u[0]
            )
        out[i] = total / SPP


# --- independence: neighbours in sample, pixel, stream, dimension and seed ---


def unrelated(which: int) -> Loop:
    """Correlation 12 (u - 1/2) (u' - 1/2) of numbers whose sample (0), pixel (1), stream (2) or seed (3) differs."""
    taken, mask = [0], (1 << 62) - 1
    start = secrets.randbits(30)

    def draws(n: int) -> Any:
        out = np.empty(n)
        for i in range(n):
            k = start + 3 * (taken[0] + i)  # odd and even in turn
            seed = secrets.randbits(62)
            pair = []
            for shift in (0, 1):
                place = [k, 7, 3]  # sample, pixel, stream
                if which < 3:
                    place[which] += shift
                sampler = samplers.Independent((seed + shift * (which == 3)) & mask, samplers.new_counter())
                stream = sampler.stream(place[1], place[2], place[0])
                pair.append(stream.number() if i % 2 else stream.square()[0])
            out[i] = 12.0 * (pair[0] - 0.5) * (pair[1] - 0.5)
        taken[0] += n
        return out

    return Loop(draws, 0.0, 3.0, -3.0, delta=0.05)


def dimensions() -> Loop:
    """The same for the two numbers of a square."""
    taken, seed = [0], secrets.randbits(62)

    def draws(n: int) -> Any:
        sampler = samplers.Independent(seed, samplers.new_counter())
        u = np.array([sampler.stream(7, 3, taken[0] + i).square() for i in range(n)])
        taken[0] += n
        return 12.0 * (u[:, 0] - 0.5) * (u[:, 1] - 0.5)

    return Loop(draws, 0.0, 3.0, -3.0, delta=0.05)


# --- the lens: how much of it sees past an edge ---

APERTURE, FOCUS, DEPTH, AIM = 0.1, 4.0, 2.5, 0.02


def lens() -> Loop:
    """Slide "Depth of field": 1 where an eye ray of a camera at AIM passes the plane at DEPTH at x < 0."""
    matrix = np.eye(4)
    matrix[0, 3] = AIM
    camera = d.Camera(
        to_world=matrix, fov=1e-4, width=1, height=1, aperture_radius=APERTURE, focus_distance=FOCUS, near_clip=1e-3
    )
    return _lens(camera)


def _lens(camera: d.Camera) -> Loop:
    from raylab.geometry import Placement

    placement = Placement.around([(np.full(3, -6.0), np.full(3, 6.0))])
    made = make_camera(camera, placement)
    zero = placement.points(np.array([[0.0, 0.0, DEPTH]]))[0]
    seed, taken = secrets.randbits(62), [0]
    truth = float(blur.half_plane_through_lens(AIM * FOCUS / DEPTH, APERTURE, FOCUS, DEPTH))

    def draws(n: int) -> Any:
        sampler = samplers.Independent(seed, samplers.new_counter())
        out = np.empty(n)
        fill_lens(made, sampler, taken[0], float(zero[0]), float(zero[2]), View(out))
        taken[0] += n
        return out / truth

    return Loop(draws, 1.0, 1.0 / truth, variance=(1.0 - truth) / truth)


@njit
def fill_lens(camera, sampler, first, x0, z0, out):
    for i in range(len(out)):
        o, d, _ = camera.ray(0, 0, sampler.stream(0, 0, first + i))
        out[i] = 1.0 if o.x + d.x * ((z0 - o.z) / d.z) < x0 else 0.0


LOOPS: dict[str, Callable[[], Loop]] = {
    "running mean": running_mean,
    "strata": strata,
    "curved strata": lambda: strata(curved=True),
    "latin": lambda: strata("latin"),
    "unrelated samples": lambda: unrelated(0),
    "unrelated pixels": lambda: unrelated(1),
    "unrelated streams": lambda: unrelated(2),
    "unrelated seeds": lambda: unrelated(3),
    "unrelated dimensions": dimensions,
    "lens": lens,
}
