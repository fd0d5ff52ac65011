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
from raylab.geometry import Placement
from raylab.jit import njit
from raylab.pixels import COLUMNS, MEAN, receive
from raylab.record import record
from raylab.samplers import Independent
from raylab.sensor import make_camera
from raylab.vec3 import Vec3
from raylab.view import View

SPP = 16


@dataclass
class Loop:
    """`draws` has the mean `mean` and, if given, the variance `variance`, and lies in [low, high].

    `values` has the mean 1 and is what a test of means can look at, `spp` samples in each.
    """

    draws: Callable[[int], Any]
    mean: float
    high: float
    low: float = 0.0
    variance: float | None = None
    delta: float = 0.01
    values: Callable[[int], Any] | None = None
    spp: int = 1
    atoms: bool = False


# --- the running mean of `raylab.pixels.receive`: 16 samples of 2 u ---


@record
class Fixed(NamedTuple):
    """In place of motion."""

    tag: int = 0

    def set(self, time):
        pass


class Still(NamedTuple):
    """In place of a scene."""

    motion: Fixed = Fixed()


@record
class Lanes(NamedTuple):
    """In place of a packet of eye rays."""

    tag: int = 0

    def time(self, lane):
        return 0.0

    def o(self, lane):
        return Vec3(0.0, 0.0, 0.0)

    def d(self, lane):
        return Vec3(0.0, 0.0, 1.0)

    def hit(self, lane):
        return -1, -1


@njit
def _uniform(scene, strategy, o, d, first, rng):
    v = 2.0 * rng.number()
    return Vec3(v, v, v)


@njit
def fill_means(scene, sampler, lanes, pixels, first, out):
    for i in range(len(out)):
        for column in range(COLUMNS):
            pixels[0, column] = 0.0
        receive(scene, 0, sampler, lanes, 0, 0, pixels, 0, first + i, 0, 0, SPP)
        out[i] = pixels[0, MEAN]


def running_mean() -> Loop:
    """The mean of 16 values 2 u of the pixel loop, which must be 1, with the variance 1 / 48."""
    pixels._radiance = _uniform
    seed, taken = secrets.randbits(62), [0]

    def draws(n: int) -> Any:
        sampler, out = samplers.Independent(seed, samplers.new_counter()), np.empty(n)
        fill_means(Still(), sampler, Lanes(), View(np.zeros((1, COLUMNS))), taken[0], View(out))
        taken[0] += n
        return out

    return Loop(draws, 1.0, 2.0, variance=1.0 / (3.0 * SPP), spp=SPP)


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
    return Loop(draws, 1.0, 1.6 if curved else 2.0, variance=None if curved else exact, spp=SPP)


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


SAMPLE, PIXEL, STREAM, SEED, DIMENSION = range(5)


@njit
def fill_pairs(seeds, counter, which, first, products, values):
    """12 (u - 1/2) (u' - 1/2) of two numbers that differ in one thing only, and 2 u."""
    for i in range(len(products)):
        k, u, v = first + 3 * i, 0.0, 0.0  # odd and even in turn
        for shift in range(2):
            sample, pixel, stream, seed = k, 7, 3, seeds[i]
            if which == SAMPLE:
                sample += shift
            elif which == PIXEL:
                pixel += shift
            elif which == STREAM:
                stream += shift
            elif which == SEED:
                seed += shift
            rng = Independent(seed, counter).stream(pixel, stream, sample)
            u = v
            if which == DIMENSION:
                u, v = rng.square()
            else:
                v = rng.number() if i % 2 == 1 else rng.square()[0]
        products[i] = 12.0 * (u - 0.5) * (v - 0.5)
        values[i] = 2.0 * u


def unrelated(which: int) -> Loop:
    """The correlation of neighbours in sample, pixel, stream, seed or dimension; each pair has a seed of its own."""
    taken, start = [0], secrets.randbits(30)
    rng = np.random.default_rng(secrets.randbits(64))

    def both(n: int) -> Any:
        out = np.empty((2, n))
        seeds = rng.integers(0, 1 << 62, n)
        fill_pairs(View(seeds), samplers.new_counter(), which, start + 3 * taken[0], View(out[0]), View(out[1]))
        taken[0] += n
        return out

    # what a picture shows: numbers of one seed, samples, pixels and streams in turn
    return Loop(lambda n: both(n)[0], 0.0, 3.0, -3.0, delta=0.05, values=_numbers().draws)


@njit
def fill_numbers(sampler, first, out):
    for i in range(len(out)):
        k = first + i
        out[i] = 2.0 * sampler.stream(k // 64 % 64, k // 4096, k % 64).number()


def _numbers() -> Loop:
    """2 u of the samples of many pixels and streams, with one seed."""
    seed, taken = secrets.randbits(62), [0]

    def draws(n: int) -> Any:
        out = np.empty(n)
        fill_numbers(Independent(seed, samplers.new_counter()), taken[0], View(out))
        taken[0] += n
        return out

    return Loop(draws, 1.0, 2.0, variance=1.0 / 3.0)


# --- the lens: how much of it sees past an edge ---

APERTURE, FOCUS, DEPTH, AIM = 0.1, 4.0, 2.5, 0.02


PLACEMENT = Placement.around([(np.full(3, -6.0), np.full(3, 6.0))])
ASLANT, WIDTH = math.radians(30.0), 1 << 17


def lens() -> Loop:
    """Slide "Depth of field": 1 where an eye ray of a camera at AIM passes the plane at DEPTH at x < 0."""
    return _lens(AIM, fov=1e-4, width=1)


def lens_aslant() -> Loop:
    """The same for a pixel 30 degrees off the axis: its focus point is on the plane, further away than FOCUS."""
    fov = 2.0 * math.degrees(math.atan(math.tan(ASLANT) / (1.0 - 1.0 / WIDTH)))
    seen = _camera(0.0, fov, WIDTH)
    toward = seen.corner + (seen.across + seen.down) * 0.5  # of pixel 0
    return _lens(AIM - DEPTH * toward.x / toward.z, fov, WIDTH)


def _camera(x: float, fov: float, width: int) -> Any:
    matrix = np.eye(4)
    matrix[0, 3] = x
    return make_camera(
        d.Camera(
            to_world=matrix,
            fov=fov,
            width=width,
            height=1,
            aperture_radius=APERTURE,
            focus_distance=FOCUS,
            near_clip=1e-3,
        ),
        PLACEMENT,
    )


def _lens(x: float, fov: float, width: int) -> Loop:
    made = _camera(x, fov, width)
    zero = PLACEMENT.points(np.array([[0.0, 0.0, DEPTH]]))[0]
    seed, taken = secrets.randbits(62), [0]
    truth = float(blur.half_plane_through_lens(AIM * FOCUS / DEPTH, APERTURE, FOCUS, DEPTH))

    def draws(n: int) -> Any:
        sampler = samplers.Independent(seed, samplers.new_counter())
        out = np.empty(n)
        fill_lens(made, sampler, taken[0], float(zero[0]), float(zero[2]), View(out))
        taken[0] += n
        return out / truth

    return Loop(draws, 1.0, 1.0 / truth, variance=(1.0 - truth) / truth, atoms=True)


@njit
def fill_lens(camera, sampler, first, x0, z0, out):
    for i in range(len(out)):
        film, lens = camera.draw(sampler.stream(0, 0, first + i))
        o, d, _ = camera.ray(0, 0, film, lens, 0.0)
        out[i] = 1.0 if o.x + d.x * ((z0 - o.z) / d.z) < x0 else 0.0


LOOPS: dict[str, Callable[[], Loop]] = {
    "running mean": running_mean,
    "strata": strata,
    "curved strata": lambda: strata(curved=True),
    "latin": lambda: strata("latin"),
    "unrelated samples": lambda: unrelated(SAMPLE),
    "unrelated pixels": lambda: unrelated(PIXEL),
    "unrelated streams": lambda: unrelated(STREAM),
    "unrelated seeds": lambda: unrelated(SEED),
    "unrelated dimensions": lambda: unrelated(DIMENSION),
    "numbers": _numbers,
    "lens": lens,
    "lens aslant": lens_aslant,
}
