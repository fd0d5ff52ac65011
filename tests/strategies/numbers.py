"""Numbers, points and transforms: ordinary ones, and planted among them zero, tiny, huge, just beside another."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from scenes import turned

ORDINARY = st.integers(-16, 16).map(lambda k: k / 8.0)
NEAR_ONE = (1.0 - 2.0**-53, 1.0 + 2.0**-52, 1.0 + 2.0**-24, 1.0 - 2.0**-25, 1.0 + 1e-6)
TINY = (0.0, -0.0, 5e-324, 2.0**-300, 1e-160, 1e-30, 1e-18, 1e-12, 2.0**-24, 1e-6, 1e-3)
HUGE = (1e3, 1e6, 1e9, 1e12, 1e18, 1e30, 1e38, 1e150, 1e160, 2.0**300, 1e300, 1.7e308)

place = st.one_of(ORDINARY, ORDINARY, ORDINARY, st.sampled_from((*NEAR_ONE, *TINY, *(-t for t in TINY))))
far_place = st.one_of(*[place] * 11, st.sampled_from((1e3, 1e6, -1e9, 1e12)))
stretch = st.one_of(
    st.sampled_from((1.0, 1.0, 2.0, 0.5, -1.0)), st.sampled_from((1e-8, 1e-6, 1e-3, 2.0**-18, 2.0**-24, 1e3, 1e5))
)
degrees = st.one_of(st.sampled_from((0.0, 90.0, 180.0, 45.0, 1e-9, 90.0 + 1e-12, 1e-300)), st.floats(-360.0, 360.0))
brightness = st.one_of(st.sampled_from((1.0, 3.0, 0.5)), st.sampled_from((0.0, 5e-324, 1e-300, 1e-30, 1e30, 1e150)))
share = st.one_of(st.sampled_from((0.5, 0.2, 0.9)), st.sampled_from((0.0, 1.0, 5e-324, 1e-30, 1.0 - 2.0**-53)))


def triple(number: st.SearchStrategy[float]) -> st.SearchStrategy[np.ndarray]:
    """Three numbers, mostly the same one."""
    return st.one_of(number.map(lambda x: np.full(3, x)), st.tuples(number, number, number).map(np.array))


def points(number: st.SearchStrategy[float] = place) -> st.SearchStrategy[np.ndarray]:
    return st.tuples(number, number, number).map(np.array)


axes = st.sampled_from((np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), np.array([0.6, 0.0, 0.8])))
similarities = st.builds(
    lambda angle, axis, at, size: turned(angle, axis, at, (size, size, size)), degrees, axes, points(far_place), stretch
)
transforms = st.one_of(
    similarities,
    st.builds(turned, degrees, axes, points(far_place), st.tuples(stretch, stretch, stretch)),
)
