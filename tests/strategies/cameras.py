"""Cameras of 2 x 2 pixels: at an ordinary place, on the floor, in a light's plane, or far away."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from hypothesis import strategies as st
from scenes import look_at

from raylab import description as d
from strategies.numbers import far_place, points

ORDINARY = (0.5,) * 6
filters = st.builds(d.Filter, st.just("box"), st.sampled_from((*ORDINARY, 1e-300, 100.0, 1e6)))
other_filters = st.builds(
    d.Filter,
    st.sampled_from(("tent", "gaussian", "gaussian")),
    st.sampled_from((0.5, 2.0, 1e-8, 1e6, 1e-300)),
    st.sampled_from((0.5, 1e-2, 1e-8, 1e3, 1e6, 1e-300)),
)


@st.composite
def cameras(draw: Any, lens: bool = False) -> d.Camera:
    origin = draw(st.one_of(st.just(np.array([0.0, -5.0, 3.0])), points(far_place)))
    target = draw(st.one_of(*[st.just(np.array([0.0, 0.0, 0.5]))] * 3, points()))
    if not draw(st.integers(0, 9)):
        target = origin + np.array([0.0, 0.0, 1.0])
    up = np.array(draw(st.sampled_from(((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.3, 0.5, 0.8)))))
    gaze = target - origin
    if not np.linalg.norm(np.cross(up, gaze)) > 1e-6 * np.linalg.norm(gaze):
        up, target = np.array([0.0, 1.0, 0.0]), origin - np.array([0.0, 0.0, 1.0])
    camera = d.Camera(
        to_world=look_at(origin, target, up),
        fov=draw(st.sampled_from((45.0, 45.0, 45.0, 60.0, 20.0, 1e-6, 1e-300, 120.0, 179.999999, 180.0 - 1e-13))),
        near_clip=draw(st.sampled_from((1e-2, 1e-2, 0.0, 1e-300, 1.0))),
        far_clip=draw(st.sampled_from((1e4, 1e4, np.inf, 1e308, 5.0))),
        width=2,
        height=2,
        filter=draw(filters),
    )
    if not lens:
        return camera
    return replace(
        camera,
        aperture_radius=draw(st.sampled_from((0.2, 1e-300, 1e-12, 1e3, 1e9))),
        focus_distance=draw(st.sampled_from((4.0, 1e-3, 1e-9, 1e9, 1e300, np.inf))),
    )


@st.composite
def lenses(draw: Any) -> d.Camera:
    """Lenses of blades, from none to huge, in focus anywhere, and pixel filters of other kinds."""
    return replace(
        draw(cameras()),
        aperture_radius=draw(st.sampled_from((0.2, 0.2, 0.0, 5e-324, 1e-38, 1e-6, 1e6, 1e30, 1e150, 1e300))),
        focus_distance=draw(st.sampled_from((4.0, 5e-324, 1e-160, 1e-3, 2.0**24, 1e38, 1.7e308, np.inf))),
        aperture_blades=draw(st.sampled_from((6, 3, 4, 1000, 2**31))),
        aperture_rotation=draw(st.sampled_from((0.0, 30.0, -1e-300, 1e9, 1e300))),
        principal_point_offset=draw(st.sampled_from(((0.0, 0.0), (0.5, -0.5), (1e-300, 1e6), (1e150, 0.0)))),
        fov_axis=draw(st.sampled_from(("x", "y", "diagonal", "smaller", "larger"))),
        filter=draw(other_filters),
    )
