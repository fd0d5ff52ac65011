"""The pixel loop: eye ray, first hit, shade, and the running mean and variance of each pixel."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from raylab.jit import cached_njit, njit
from raylab.surface import BACK, FRONT, intersect
from raylab.vec3 import Vec3, black, is_finite, normalize
from raylab.view import View

# Columns of the accumulator: mean and sum of squared deviations (Welford) of each channel, samples, invalid samples.
MEAN, SQUARES, COUNT, INVALID, COLUMNS = 0, 3, 6, 7, 8


def new_accumulator(streams: int, width: int, height: int) -> npt.NDArray[np.float64]:
    """(streams, height, width, COLUMNS): each stream of the sampler keeps its own mean."""
    return np.zeros((streams, height, width, COLUMNS))


def radiance(scene, camera, strategy, column, row, rng):
    """Radiance along one eye ray through a pixel: what the surface emits and what it reflects."""
    o, d, tfar = camera.ray(column, row, rng)
    hit = intersect(scene, o, d, 0.0, tfar)
    if not hit.found:
        return strategy.visible(scene.environment.eval(normalize(d)))
    result = black
    if hit.front:
        result = strategy.visible(scene.emission.of_shape(hit.shape))
    material = scene.shapes[hit.shape, FRONT if hit.front else BACK]
    if material >= 0:
        brdf = scene.materials.at(material, hit.N, hit.uv)
        result += strategy.shade(hit.x, normalize(-d), brdf, hit.N, scene, rng)
    return result


def accumulate(scene, camera, strategy, sampler, pixels, width, height, rows, samples):
    """Add samples first .. last - 1 of each stream to the pixels of `rows` = (top, bottom).

    `pixels` has a row for each (stream, pixel). A sample that is not finite is counted and left out.
    """
    streams = len(pixels) // (width * height)
    for row in range(rows[0], rows[1]):
        for column in range(width):
            for stream in range(streams):
                pixel = row * width + column
                place = stream * width * height + pixel
                mean = Vec3(pixels[place, MEAN], pixels[place, MEAN + 1], pixels[place, MEAN + 2])
                squares = Vec3(pixels[place, SQUARES], pixels[place, SQUARES + 1], pixels[place, SQUARES + 2])
                count, invalid = pixels[place, COUNT], pixels[place, INVALID]
                for sample in range(samples[0], samples[1]):
                    rng = sampler.stream(pixel, stream, sample)
                    value = _radiance(scene, camera, strategy, column, row, rng)
                    if is_finite(value):
                        count += 1.0
                        step = value - mean
                        mean += step * (1.0 / count)
                        squares += step * (value - mean)
                    else:
                        invalid += 1.0
                store(pixels, place, mean, squares, count, invalid)


@njit
def store(pixels, place, mean, squares, count, invalid):
    pixels[place, MEAN], pixels[place, MEAN + 1], pixels[place, MEAN + 2] = mean.x, mean.y, mean.z
    pixels[place, SQUARES], pixels[place, SQUARES + 1], pixels[place, SQUARES + 2] = squares.x, squares.y, squares.z
    pixels[place, COUNT] = count
    pixels[place, INVALID] = invalid


_radiance = njit(radiance)
cached_accumulate = cached_njit(accumulate)
fresh_accumulate = njit(accumulate)


def view(accumulator: npt.NDArray[np.float64]) -> Any:
    """The accumulator as the kernel reads it; shares its memory."""
    return View(accumulator.reshape(-1, COLUMNS))
