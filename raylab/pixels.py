"""The pixel loop: eye ray, first hit, shade, and the running mean and variance of each pixel."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from raylab.jit import cached_njit, njit
from raylab.lanes import FILM, LENS
from raylab.packet import LANES, trace_packet
from raylab.surface import BACK, FRONT, INVALID_RAYS, hit_of, is_valid_ray
from raylab.vec3 import Vec3, black, is_finite, normalize
from raylab.view import View

# Columns of the accumulator: mean and sum of squared deviations (Welford) of each channel, samples, invalid samples.
MEAN, SQUARES, COUNT, INVALID, COLUMNS = 0, 3, 6, 7, 8


def new_accumulator(streams: int, width: int, height: int) -> npt.NDArray[np.float64]:
    """(streams, height, width, COLUMNS): each stream of the sampler keeps its own mean."""
    return np.zeros((streams, height, width, COLUMNS))


def radiance(scene, strategy, o, d, first, rng):
    """Radiance along an eye ray that meets `first` = (geometry, primitive): what that emits and what it reflects."""
    geometry, primitive = first
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

    `pixels` has a row for each (stream, pixel). The eye rays of a pixel go in packets, a part to each stream.
    """
    streams = len(pixels) // (width * height)
    share = LANES // streams
    for row in range(rows[0], rows[1]):
        for column in range(width):
            pixel = row * width + column
            for first in range(samples[0], samples[1], share):
                last = min(first + share, samples[1])
                drawn = send(scene, camera, sampler, packet, column, row, pixel, streams, first, last)
                for stream in range(streams):
                    lane = stream * (last - first)
                    place = stream * width * height + pixel
                    receive(scene, strategy, sampler, packet, lane, drawn, pixels, place, pixel, stream, first, last)


@njit
def send(scene, camera, sampler, packet, column, row, pixel, streams, first, last):
    """Trace a pixel's eye rays of samples first .. last - 1, stream by stream.

    Returns how many dimensions of its stream each has drawn.
    """
    lanes, used = sampler.lanes(packet, pixel, streams, first, last), streams * (last - first)
    scene.motion.draw_lanes(lanes)
    camera.draw_lanes(lanes)
    for i in range(LANES):  # one after the other or side by side, as the compiler likes
        time = packet.drawn_time(i)
        o, d, tfar = camera.ray(column, row, packet.point(FILM, i), packet.point(LENS, i), time)
        packet.put(i, o, d, tfar, time, is_valid_ray(o, d))
    scene.tally[INVALID_RAYS] += packet.invalid(used)
    packet.clear(used)
    trace_packet(scene.embree, packet)
    return sampler.counter.next[0]


@njit
def receive(scene, strategy, sampler, packet, lane, drawn, pixels, place, pixel, stream, first, last):
    """Shade one stream's samples, lanes `lane`, lane + 1, ... of the packet, and add them to its running mean.

    A value that is not finite is counted and left out. The update of mean and squares is Welford's.
    """
    mean = Vec3(pixels[place, MEAN], pixels[place, MEAN + 1], pixels[place, MEAN + 2])
    squares = Vec3(pixels[place, SQUARES], pixels[place, SQUARES + 1], pixels[place, SQUARES + 2])
    count = pixels[place, COUNT]
    for sample in range(first, last):
        rng = sampler.stream(pixel, stream, sample)
        sampler.counter.next[0] = drawn
        scene.motion.set(packet.time(lane))
        value = _radiance(scene, strategy, packet.o(lane), packet.d(lane), packet.hit(lane), rng)
        if is_finite(value):
            count += 1.0
            step = value - mean
            mean += step * (1.0 / count)
            squares += step * (value - mean)
        else:
            pixels[place, INVALID] += 1.0
        lane += 1
    pixels[place, MEAN], pixels[place, MEAN + 1], pixels[place, MEAN + 2] = mean.x, mean.y, mean.z
    pixels[place, SQUARES], pixels[place, SQUARES + 1], pixels[place, SQUARES + 2] = squares.x, squares.y, squares.z
    pixels[place, COUNT] = count


_radiance = njit(radiance)
cached_accumulate = cached_njit(accumulate)
fresh_accumulate = njit(accumulate)


def view(accumulator: npt.NDArray[np.float64]) -> Any:
    """The accumulator as the kernel reads it; shares its memory."""
    return View(accumulator.reshape(-1, COLUMNS))
