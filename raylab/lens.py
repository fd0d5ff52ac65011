"""Slides "Depth of field" and "Motion blur" as plain functions, in the coordinates of a camera that looks along +z.

What `raylab.camera` and `raylab.motion` do in a scene, for those who want to see it by itself.
"""

from __future__ import annotations

from raylab.jit import njit
from raylab.sampling import sample_disk
from raylab.vec3 import Vec3


@njit  # exercise a6.aperture
def sample_aperture(a, u):
    """A point uniform on the lens, a disk of radius a around the origin."""
    x, y = sample_disk(u)
    return a * x, a * y


@njit  # exercise a6.lens
def lens_direction(toward, f, px, py):
    """From the lens point (px, py, 0) to the point f toward on the focus plane; `toward` and the result have z = 1."""
    return toward - Vec3(px, py, 0.0) / f


@njit  # exercise a6.time
def shutter_time(open, close, u):
    """A time uniform in the shutter interval."""
    return open + u * (close - open)


@njit  # exercise a6.motion
def position(p0, p1, t0, t1, t):
    """Where a thing is that moves evenly from p0 at t0 to p1 at t1, and stands still before and after."""
    s = min(max((t - t0) / (t1 - t0), 0.0), 1.0)
    return p0 * (1.0 - s) + p1 * s
