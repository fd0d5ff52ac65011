"""Skies: images with a sun in them, with nothing in them, of one texel, and their poles and seams."""

from __future__ import annotations

import functools
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.environment import angles, cell_pdf, choose, choose_column
from raylab.errors import SceneError
from raylab.jit import njit
from raylab.sampling import PI, sample_cos_hemisphere, turn
from raylab.sky import make_environment
from raylab.stress.case import Found, case
from raylab.stress.lamps import SAMPLES, off, squares
from raylab.stress.oracle import exact, gauss, worst
from raylab.stress.single import single, vector
from raylab.vec3 import Vec3, dot

Array = npt.NDArray[np.float64]
TOP = Vec3(0.0, 1.0, 0.0)  # the pole of an image
ROW, COLUMN, SUN_SIZE = 256, 700, (1024, 2048)  # the texel of the sun, 45 degrees high


def image(brightness: npt.ArrayLike, filter: Any = "nearest") -> Any:
    """The environment of a grey image (h, w)."""
    grey = np.repeat(np.asarray(brightness, float)[..., None], 3, axis=2)
    return make_environment(d.ImageEnvironment(grey, filter=filter))


@functools.cache
def sunny(sun: float) -> tuple[Array, Any]:
    """A sky of radiance 1 with one bright texel, as an array and as an environment."""
    brightness = np.ones(SUN_SIZE)
    brightness[ROW, COLUMN] = sun
    return brightness, image(brightness)


@njit
def _samples(env, N, u, g):
    """By brightness: L cos / p, and -1 for a density that is not positive."""
    for i in range(len(g)):
        w, p = env.sample(N, (u[i, 0], u[i, 1]))
        g[i] = env.eval(w).x * max(0.0, dot(w, N)) / p if p > 0.0 else -1.0


@njit
def _samples_by_cosine(env, N, u, g):
    for i in range(len(g)):
        g[i] = env.eval(sample_cos_hemisphere(N, (u[i, 0], u[i, 1]))).x * PI


@njit
def _evaluate(env, N, w, found):
    """L and p towards each direction."""
    for i in range(len(w)):
        toward = Vec3(w[i, 0], w[i, 1], w[i, 2])
        found[i, 0] = env.eval(toward).x
        found[i, 1] = env.pdf(N, toward)


def looked_up(env: Any, w: npt.ArrayLike) -> Array:
    """L and p towards directions (n, 3)."""
    found = np.empty((len(np.asarray(w)), 2))
    _evaluate(env, TOP, np.asarray(w, float), found)
    return found


def latitudes(rows: int, columns: int) -> tuple[Array, Array]:
    """Cosines of the circles of latitude between the rows of an image, and the solid angle of a texel in each row."""
    heights = np.cos(np.pi * np.arange(rows + 1) / rows)
    return heights, -np.diff(heights) * 2.0 * np.pi / columns


@case(
    "D01", "an image that is black all over", usual="the cumulated sum over its total: 0 / 0",
    rule="black, and sampled uniformly", truth="no light", unit="samples that are not 0", allowed=0.0,
)  # fmt: skip
def black_all_over() -> Found:
    env, g = image(np.zeros((4, 8))), np.empty(1000)
    _samples(env, TOP, squares(1000), g)
    with np.errstate(invalid="ignore"):
        cdf = np.cumsum(np.zeros(32)) / np.sum(np.zeros(32))
    return Found(int((g != 0.0).sum()), float(np.isnan(cdf).sum()))


@case(
    "D02", "an image of a single texel, nearest and bilinear", usual="texels [i] and [i + 1] without wrapping round",
    rule="columns wrap, a single row is doubled", truth="L everywhere, p = 1 / (4 pi), E = pi L",
    unit="relative error of any of them (usual: 1 for an index that is none)", allowed=1e-12,
)  # fmt: skip
def a_single_texel() -> Found:
    z, weights = gauss(16, 0.0, 1.0)
    phi = 2.0 * np.pi * (np.arange(32) + 0.5) / 32
    r = np.sqrt(1.0 - z * z)[:, None]
    w = np.stack([r * np.cos(phi), np.broadcast_to(z[:, None], (16, 32)), r * np.sin(phi)], axis=-1).reshape(-1, 3)
    error = 0.0
    for filter in ("nearest", "bilinear"):
        found = looked_up(image([[2.5]], filter), w)
        E = float((found[:, 0].reshape(16, 32).mean(axis=1) * weights * z).sum() * 2.0 * np.pi)
        error = max(error, abs(E / (np.pi * 2.5) - 1.0), float(np.abs(found / (2.5, 0.25 / np.pi) - 1.0).max()))
    return Found(error, float((np.floor(phi / (2.0 * np.pi) - 0.5) + 1 > 0).any() or error))


@case(
    "D03", "a single bright texel, two of them, and rows of zeros, for u on every step of the cumulated sums",
    usual="searchsorted(cdf, u), side left", rule="the first share above u, never one of chance 0",
    truth="bright texels only", unit="dark or impossible texels", allowed=0.0,
)  # fmt: skip
def on_a_step() -> Found:
    wrong = usual = 0
    for bright in ([(2, 3)], [(1, 2), (1, 5)], [(0, 0), (3, 7)]):
        brightness = np.zeros((4, 8))
        for at in bright:
            brightness[at] = 1.0
        env = image(brightness)
        steps = {0.0, 0.25, 0.5, 1.0 - 2.0**-53, *env.row_cdf.array.tolist(), *env.cell_cdf.array.ravel().tolist()}
        for u in sorted({v for s in steps for v in (s, np.nextafter(s, 0.0), np.nextafter(s, 1.0)) if 0.0 <= v < 1.0}):
            row, _ = choose(env.row_cdf, float(u))
            for t in (0.0, float(u), 1.0 - 2.0**-53):
                column, h = choose_column(env.cell_cdf, row, 8, t)
                wrong += not (brightness[row, column] > 0.0 and cell_pdf(env, row, column) > 0.0 and 0.0 <= h < 1.0)
            flat = np.cumsum(brightness.ravel()) / brightness.sum()
            usual += bool(brightness.ravel()[min(int(np.searchsorted(flat, u)), 31)] == 0.0)
    return Found(wrong, usual)


@case(
    "D04", "a sky with a sun of one texel of 2048 x 1024, a million times as bright, 45 degrees high",
    usual="directions by the cosine: relative variance 2.4e5", rule="directions by the brightness: 0.69",
    truth="sum over the texels", unit="exact standard errors of raylab's mean of 1e5", allowed=4.5,
)  # fmt: skip
def a_sun() -> Found:
    brightness, env = sunny(1e6)
    h, sizes = latitudes(*SUN_SIZE)
    above = np.maximum(h, 0.0)
    rows = brightness.sum(axis=1) * 2.0 * np.pi / SUN_SIZE[1]
    total = float((brightness.sum(axis=1) * sizes).sum())
    mean = float((rows * -np.diff(above**2)).sum() / 2.0)
    variance = total * float((rows * -np.diff(above**3)).sum() / 3.0) / mean**2 - 1.0
    ours, usual = np.empty(SAMPLES), np.empty(SAMPLES)
    _samples(env, TOP, squares(SAMPLES), ours)
    _samples_by_cosine(env, TOP, squares(SAMPLES), usual)
    note = f"E = {mean:.5g}, relative variance {variance:.2g}"
    return Found(off(ours, mean, variance), off(usual, mean, variance), note=note)


@case(
    "D05", "the same with a sun of 1e9 times the radiance of the sky", usual="one cumulated sum in float32",
    rule="rows, then columns, in float64", truth="every texel has its chance",
    unit="texels of 2,097,152 that are never chosen, and those off by 1e-6", allowed=0.0,
)  # fmt: skip
def out_of_reach() -> Found:
    brightness, env = sunny(1e9)
    rows = np.diff(env.row_cdf.array, prepend=0.0)
    columns = np.diff(env.cell_cdf.array, axis=1, prepend=0.0)
    _, sizes = latitudes(*SUN_SIZE)
    flat = np.cumsum((brightness * sizes[:, None]).astype(np.float32).ravel())
    usual = np.diff(flat / flat[-1], prepend=np.float32(0.0))
    truth = brightness * sizes[:, None] / math.fsum((brightness * sizes[:, None]).ravel())
    wrong = [int((np.abs(p.reshape(truth.shape) / truth - 1.0) > 1e-6).sum()) for p in (rows[:, None] * columns, usual)]
    return Found(wrong[0], wrong[1], note=f"usual: {int((usual <= 0.0).sum())} are never chosen")


@case(
    "D06", "the density of an image, summed over the sphere, and at its poles", usual="p(u, v) / (2 pi^2 sin theta)",
    rule="chance of a texel over its solid angle, a difference of cosines", truth="1",
    unit="error of the sum over texels of p times solid angle, NaN if a pole has no density", allowed=1e-12,
)  # fmt: skip
def at_the_poles() -> Found:
    rows, columns = 32, 64
    brightness = squares(rows * columns)[:, 0].reshape(rows, columns)
    env, (_, sizes) = image(brightness), latitudes(rows, columns)
    theta, phi = np.meshgrid(np.pi * (np.arange(rows) + 0.5) / rows, 2 * np.pi * (np.arange(columns) + 0.5) / columns)
    w = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)], axis=-1).reshape(-1, 3)
    p = looked_up(env, w)[:, 1].reshape(columns, rows).T
    poles = looked_up(env, [(0, 1, 0), (0, -1, 0), (1e-300, 1, 0), (-0.0, -1, 1e-17)])
    error = abs(float((p * sizes[:, None]).sum()) - 1.0) if (poles > 0).all() and np.isfinite(poles).all() else math.nan
    chances = brightness * sizes[:, None] / (brightness * sizes[:, None]).sum()
    usual = chances * rows * columns / (2.0 * np.pi**2 * np.sin(theta.T))
    return Found(error, abs(float((usual * sizes[:, None]).sum()) - 1.0))


@case(
    "D07", "longitudes of -1e-20, -5e-324, -2^-60 and a half turn", usual="column = int((phi / 2 pi) % 1 * 2048)",
    rule="a fraction of a turn in [0, 1)", truth="columns 0 to 2047", unit="columns that are none", allowed=0.0,
)  # fmt: skip
def at_the_seam() -> Found:
    places = [(y, x) for y in (-1e-20, -5e-324, -0.0, 0.0, -(2.0**-60), 1e-20) for x in (1.0, -1.0, 1e-3, 0.0)]
    ours = sum(not 0 <= int(turn(y, x) * 2048) < 2048 for y, x in places)
    usual = sum(not 0 <= int((math.atan2(y, x) / (2.0 * math.pi)) % 1.0 * 2048) < 2048 for y, x in places)
    in_float32 = sum(not 0 <= int(single(turn)(np.float32(y), np.float32(x)) * 2048) < 2048 for y, x in places)
    return Found(ours, usual, in_float32)


@case(
    "D08", "the polar angle of directions 4.5e-9 and 1e-12 from a pole", usual="acos(w.y)",
    rule="atan2(sqrt(x^2 + z^2), y)", truth="60 digits", unit="relative error of the angle", allowed=1e-15,
)  # fmt: skip
def next_to_a_pole() -> Found:
    m, env = exact(), image(np.ones((2, 4)))
    w = [Vec3(a, 1.0, b) for a, b in ((4.5e-9, 0.0), (2.7e-9, 3.6e-9), (6e-13, -8e-13))]
    truths = [m.atan2(m.sqrt(m.mpf(v.x) ** 2 + m.mpf(v.z) ** 2), m.mpf(v.y)) for v in w]
    axes = SimpleNamespace(**{name: vector(getattr(env, name)) for name in ("right", "up", "back")})
    in_float32 = [single(angles)(axes, vector(v))[0] for v in w]
    usual = [math.acos(v.y / math.sqrt(dot(v, v))) for v in w]
    return Found(worst([angles(env, v)[0] for v in w], truths), worst(usual, truths), worst(in_float32, truths))


@case(
    "D09", "texels that are NaN, infinite (float16 above 65504) and negative", usual="whatever the file says",
    rule="refused with the number of bad texels and the place of the first", truth="a sentence",
    unit="refusals missing (usual: cumulated sums that are none)", allowed=0.0,
)  # fmt: skip
def bad_texels() -> Found:
    missing = usual = 0
    for bad in (math.nan, float(np.float16(np.inf)), -1.0):
        brightness = np.ones((4, 8))
        brightness[2, 5] = bad
        cdf = np.cumsum(brightness)
        usual += not (np.isfinite(cdf).all() and (np.diff(cdf) >= 0.0).all())
        try:
            image(brightness)
            missing += 1
        except SceneError as refusal:
            missing += "1 texels" not in str(refusal) or "row 2, column 5" not in str(refusal)
    return Found(missing, usual)
