"""The pixel loop: eye ray, first hit, shade, and the running mean and variance of each pixel."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from raylab.embree import LANES, trace_packet
from raylab.jit import cached_njit, njit
from raylab.surface import BACK, FRONT, INVALID_RAYS, hit_of, is_valid_ray
from raylab.vec3 import Vec3, black, is_finite, normalize
from raylab.view import View

# Columns of the accumulator: mean and sum of squared deviations (Welford) of each channel, samples, invalid samples.
MEAN, SQUARES, COUNT, INVALID, COLUMNS = 0, 3, 6, 7, 8


def new_accumulator(streams: int, width: int, height: int) -> npt.NDArray[np.float64]:
    """(streams, height, width, COLUMNS): each stream of the sampler keeps its own mean."""
    return np.zeros((streams, height, width, COLUMNS))


def radiance(scene, strategy, o, d, geometry, primitive, rng):
    """Radiance along an eye ray: what the surface emits that it meets first, and what it reflects."""
    if geometry < 0:
        return strategy.visible(scene.environment.eval(normalize(d)))
    hit = hit_of(scene, geometry, primitive, o, d, 0.0)
    result = black
    if hit.front:
        result = strategy.visible(scene.emission.of_shape(hit.shape))
    material = scene.shapes[hit.shape, FRONT if hit.front else BACK]
    if material >= 0:
        brdf = scene.materials.at(material, hit.N, hit.uv)
        result += strategy.shade(hit.x, normalize(-d), brdf, hit.N, scene, rng)
    return result


def accumulate(scene, camera, strategy, sampler, packet, pixels, width, height, rows, samples):
    """Add samples first .. last - 1 of each stream to the pixels of `rows` = (top, bottom).

    `pixels` has a row for each (stream, pixel). Eye rays of a pixel go in packets, the streams in turn.
    """
    streams = len(pixels) // (width * height)
    end = streams * samples[1]
    for row in range(rows[0], rows[1]):
        for column in range(width):
            pixel = row * width + column
            for first in range(streams * samples[0], end, LANES):
                last = min(first + LANES, end)
                drawn = send(scene, camera, sampler, packet, column, row, pixel, streams, first, last)
                for i in range(first, last):
                    rng = sampler.stream(pixel, i % streams, i // streams)
                    sampler.counter.next[0] = drawn
                    o, d = packet.o(i - first), packet.d(i - first)
                    geometry, primitive = packet.hit(i - first)
                    add(
                        pixels,
                        i % streams * width * height + pixel,
                        _radiance(scene, strategy, o, d, geometry, primitive, rng),
                    )


@njit
def send(scene, camera, sampler, packet, column, row, pixel, streams, first, last):
    """Trace eye rays first .. last - 1 of a pixel; returns how many dimensions of its stream each has drawn."""
    for i in range(first, last):
        o, d, tfar = camera.ray(column, row, sampler.stream(pixel, i % streams, i // streams))
        packet.put(i - first, o, d, tfar)
        if not is_valid_ray(o, d):
            packet.switch_off(i - first)
            scene.tally[INVALID_RAYS] += 1
    for lane in range(last - first, LANES):
        packet.switch_off(lane)
    trace_packet(scene.embree, packet)
    return sampler.counter.next[0]


@njit
def add(pixels, place, value):
    """Welford's update of mean and squares; a value that is not finite is counted and left out."""
    if not is_finite(value):
        pixels[place, INVALID] += 1.0
        return
    mean = Vec3(pixels[place, MEAN], pixels[place, MEAN + 1], pixels[place, MEAN + 2])
    squares = Vec3(pixels[place, SQUARES], pixels[place, SQUARES + 1], pixels[place, SQUARES + 2])
    count = pixels[place, COUNT] + 1.0
    step = value - mean
    mean += step * (1.0 / count)
    squares += step * (value - mean)
    pixels[place, MEAN], pixels[place, MEAN + 1], pixels[place, MEAN + 2] = mean.x, mean.y, mean.z
    pixels[place, SQUARES], pixels[place, SQUARES + 1], pixels[place, SQUARES + 2] = squares.x, squares.y, squares.z
    pixels[place, COUNT] = count


_radiance = njit(radiance)
cached_accumulate = cached_njit(accumulate)
fresh_accumulate = njit(accumulate)


def view(accumulator: npt.NDArray[np.float64]) -> Any:
    """The accumulator as the kernel reads it; shares its memory."""
    return View(accumulator.reshape(-1, COLUMNS))
