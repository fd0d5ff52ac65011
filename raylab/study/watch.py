"""Watch: has an estimator a variance at all? Asked before its scatter is called an error."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from raylab import description as d
from raylab.render import render
from raylab.scene import Scene
from raylab.stats.tails import infinite_variance

PAIRS = 1 << 18


def watch(scene: Scene, shade: str | Callable[..., Any], sampler: str, seeds: tuple[int, int], threads: int) -> str:
    """Empty, or why no interval holds: the tail of the differences of PAIRS or more pairs of single samples.

    The two samples of a pair go through the same one of as many pixels, into which the picture is divided. So what
    is the same for both falls out, such as a light that is seen, and what is left has the tail of a sample. Nothing
    is brighter than the brightest light but by a large f / p.
    """
    finer = divided(scene)
    pair = [render(finer, shade, sampler=sampler, spp=1, seed=seed, threads=threads) for seed in seeds]
    if not all(image.complete for image in pair):
        raise KeyboardInterrupt
    return infinite_variance(np.linalg.norm(np.nan_to_num(pair[0].mean - pair[1].mean), axis=2), brightest(scene))


def divided(scene: Scene) -> Scene:
    """The same view in at least PAIRS pixels, each pixel of the picture in m x m."""
    described = scene.description
    width, height = described.camera.width, described.camera.height
    m = math.ceil(math.sqrt(PAIRS / (width * height)))
    camera = replace(described.camera, width=m * width, height=m * height)
    return scene if m == 1 else Scene(replace(described, camera=camera))


def brightest(scene: Scene) -> float:
    """A radiance that no light of the scene exceeds, all channels together."""
    described, sky = scene.description, scene.description.environment
    colours = [np.asarray(shape.radiance) for shape in described.shapes if shape.radiance is not None]
    if isinstance(sky, d.ConstantEnvironment):
        colours.append(np.asarray(sky.radiance))
    if isinstance(sky, d.GradientEnvironment):
        colours.append(sky.radiance + np.linalg.norm(sky.gradient, axis=1))
    if isinstance(sky, d.ImageEnvironment):
        colours.append(np.max(sky.pixels, axis=(0, 1)))
    return float(np.linalg.norm(np.max([np.broadcast_to(c, 3) for c in colours], axis=0))) if colours else 0.0
