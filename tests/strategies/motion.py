"""Motion with extremes: keyframes at any distance in time and space, and a shutter that is open long, hardly or not."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from hypothesis import strategies as st
from scenes import moved, turned

from raylab import description as d
from strategies.numbers import axes, degrees, far_place, points, stretch, transforms

TIMES = (0.0, 1.0, 0.5, -1.0, 2.0, 0.25, 2.0**-25, 1.0 - 2.0**-53, 1.0 + 2.0**-52, -1e9, 1e9, 1e-30, 1e30)
BEYOND = (5e-324, 1e-300, 1e300, 1.7e308)
SHUTTERS = (
    *[(0.0, 1.0)] * 8, (0.25, 0.75), (0.0, 1e-30), (0.0, 1e30), (1e9, 1e9 + 1e-6),
    (-1.0, 2.0), (0.0, 0.0), (0.0, 5e-324), (0.0, 1e-300), (0.5, 0.5 + 2.0**-53),
    (1.0 - 2.0**-53, 1.0), (0.0, 2.0**-25), (-1e9, 1e9), (1e9, 1e12), (0.0, 1e300), (-1e308, 1e308), (1.0, 0.0),
)  # fmt: skip
shutters = st.sampled_from(SHUTTERS)


@st.composite
def animations(draw: Any, matrices: st.SearchStrategy[np.ndarray] = transforms) -> d.Animation:
    """Two to four keyframes; often the second is the first one shifted, turned by any angle or resized."""
    times = draw(st.sets(st.sampled_from(TIMES), min_size=2, max_size=4))
    if not draw(st.integers(0, 19)):
        times = times | {draw(st.sampled_from(BEYOND))}
    first = draw(matrices)
    poses = [first]
    for _ in range(len(times) - 1):
        how = draw(st.sampled_from(("same", "shift", "shift", "turn", "turn", "grow", "other")))
        if how == "shift":
            offset = np.eye(4)
            offset[:3, 3] = draw(points(far_place))
            poses.append(offset @ poses[-1])
        elif how == "turn":
            poses.append(poses[-1] @ turned(draw(degrees), draw(axes)))
        elif how == "grow":
            size = draw(stretch)
            poses.append(poses[-1] @ moved(0, 0, 0, size, size, size))
        else:
            poses.append(draw(matrices) if how == "other" else poses[-1])
    return d.Animation(np.array(sorted(times)), np.array(poses))


def in_motion(shape: st.SearchStrategy[Any], matrices: st.SearchStrategy[np.ndarray] = transforms) -> Any:
    """A shape that moves."""
    return st.builds(lambda s, motion: replace(s, motion=motion), shape, animations(matrices))


def opened(camera: st.SearchStrategy[d.Camera], moving: bool = False) -> st.SearchStrategy[d.Camera]:
    """A camera with a shutter; it moves a little, or from one place to another."""

    def shut(eye: d.Camera, shutter: tuple[float, float], offset: np.ndarray, angle: float, axis: np.ndarray) -> Any:
        eye = replace(eye, shutter_open=shutter[0], shutter_close=shutter[1])
        if not moving:
            return eye
        last = eye.to_world @ turned(angle, axis)
        last[:3, 3] += offset
        return replace(eye, motion=d.Animation(np.array([-4.0, 4.0]), np.array([eye.to_world, last])))

    return st.builds(shut, camera, shutters, points(far_place), degrees, axes)


def drifting(shape: Any) -> Any:
    """An anchor that moves whenever the shutter is open for some time, so that the scene's types stay the same."""
    matrices = np.array([shape.to_world, moved(0, 0, 0.25) @ shape.to_world])
    return replace(shape, motion=d.Animation(np.array([-2.0, 2.0]), matrices))
