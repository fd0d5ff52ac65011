"""Coverage of a pixel by edges out of focus and in motion."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def circle_of_confusion(aperture: float, focus: float, depth: float) -> float:
    """Radius of the blur of a point at `depth`, measured on the focus plane: a |z - f| / z."""
    return aperture * abs(depth - focus) / depth


def half_plane_through_lens(aimed_at: npt.ArrayLike, aperture: float, focus: float, depth: float) -> Array:
    """Share of a round aperture that sees the half-plane x < 0 at `depth` from a pixel aimed at x on the focus plane.

    F(s) = 1/2 + (s sqrt(1 - s^2) + asin s) / pi,  s = -x z / (a |f - z|), measured across the disk of the lens: a
    chord at s cuts the share F off a disk.
    """
    s = np.clip(-np.asarray(aimed_at, float) * depth / (aperture * abs(focus - depth)), -1.0, 1.0)
    share: Array = 0.5 + (s * np.sqrt(1.0 - s * s) + np.arcsin(s)) / math.pi
    return share


def moving_edge(first: float, speed: float, pixel: tuple[float, float]) -> float:
    """Mean over a unit shutter of the share of the pixel that lies below an edge at first + speed t.

    [r(e1 - p0) - r(e1 - p1) - r(e0 - p0) + r(e0 - p1)] / (v w),  r(x) = max(x, 0)^2 / 2
    """

    def ramp(x: float) -> float:
        return 0.5 * max(x, 0.0) ** 2

    last, (low, high) = first + speed, pixel
    area = ramp(last - low) - ramp(last - high) - ramp(first - low) + ramp(first - high)
    return area / (speed * (high - low))


def moving_disk_light(radius: float, first: float, last: float) -> float:
    """Irradiance / (pi L) under a disk that rises evenly from height `first` to `last` above the point.

    Mean of R^2 / (R^2 + h^2): R / (h1 - h0) (atan(h1 / R) - atan(h0 / R))
    """
    return radius / (last - first) * (math.atan(last / radius) - math.atan(first / radius))
