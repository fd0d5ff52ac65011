"""Trials through a lens: how much of a luminous strip, out of focus, a single thin ray of pixels sees."""

from __future__ import annotations

import math

import numpy as np

from raylab import description as d
from raylab.closed_forms import blur
from raylab.probe import Pixel
from raylab.trials.trial import Answer, Trial, affine, colour, moved, random_pose

FOV = 1e-3  # degrees: the pixel is a point; across it the share of the lens changes by FOV^2, not in the first order


def through_a_lens(rng: np.random.Generator, before: bool) -> Trial:
    """A strip with two parallel edges, nearer than the focus or beyond it; a sample is its radiance or nothing.

    The camera stands at the origin and looks along +z; the strip is x in [left, right] at the given depth.
    """
    focus, aperture = rng.uniform(3.0, 5.0), rng.uniform(0.1, 0.2)
    depth = focus * (rng.uniform(0.5, 0.7) if before else rng.uniform(1.5, 2.0))
    blurred = blur.circle_of_confusion(aperture, focus, depth)
    # The pixel is aimed at x = 0 on the focus plane and at depth; rays cross the strip's plane within a |f - z| / f.
    spread = blurred * depth / focus
    left, right = -rng.uniform(0.2, 0.7) * spread, rng.uniform(0.1, 0.8) * spread
    below = _share(right, aperture, focus, depth) - _share(left, aperture, focus, depth)
    radiance, pose, turn = colour(rng, 0.5, 5.0), random_pose(rng), rng.uniform(0, 2 * math.pi)
    strip = d.Rectangle(
        to_world=_turned(turn) @ affine(np.diag([0.5 * (right - left), -3.0 * spread, -1.0]),
                                        (0.5 * (left + right), 0.0, depth)),
        radiance=radiance, front=None,
    )  # fmt: skip
    camera = d.Camera(
        to_world=pose, fov=FOV, width=1, height=1, aperture_radius=aperture, focus_distance=focus
    )  # fmt: skip
    described = d.SceneDescription(
        camera=camera, shapes=(moved(pose, strip),), sampler="independent", name="through_a_lens"
    )
    answers = {name: Answer.of(radiance * below, radiance, radiance**2 * below * (1.0 - below)) for name in ("direct",)}
    name = "lens_before_focus" if before else "lens_behind_focus"
    return Trial(name, described, answers, Pixel(0, 0), 1e-5)


def _share(edge: float, aperture: float, focus: float, depth: float) -> float:
    """Share of the lens that sees x < edge at `depth`, from a pixel aimed at x = 0: the formula's edge is at 0."""
    return float(blur.half_plane_through_lens(-edge * focus / depth, aperture, focus, depth))


def _turned(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return affine(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.zeros(3))
