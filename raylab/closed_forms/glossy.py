"""Closed forms for the two jitters of `raylab.glossy` that are not Phong: what they reflect of a sky.

The specular reflectance is 1; C = N . R = N . V.
"""

from __future__ import annotations

import math

import numpy as np


def jitter_constant_sky(a: float, cosine: float) -> float:
    """The share of offsets in the disk of radius a whose ray is above the horizon.

    w . N is proportional to C + S a s, s the coordinate of a point uniform in the unit disk, S = sqrt(1 - C^2): the
    part of the disk with s > -h, h = C / (a S), which is 1/2 + (h sqrt(1 - h^2) + asin h) / pi, and 1 for h >= 1.
    """
    sine = math.sqrt((1.0 - cosine) * (1.0 + cosine))
    if cosine >= a * sine:
        return 1.0
    h = cosine / (a * sine)
    return 0.5 + (h * math.sqrt(1.0 - h * h) + math.asin(h)) / math.pi


def jitter_gradient_sky(a: float, radiance: float, slope: float) -> float:
    """L = radiance + slope cos(theta), R = N: the mean of cos alpha is (2 / a^2) (sqrt(1 + a^2) - 1)."""
    return radiance + slope * 2.0 / (a * a) * (math.sqrt(1.0 + a * a) - 1.0)


def normal_constant_sky(e: float, cosine: float) -> float:
    """The share of normals, of density (e + 1) / (2 pi) cos^e, that mirror V to above the horizon.

    At the azimuth phi from V these are theta_m < pi/4 + psi/2, sin psi = S cos phi / sqrt(C^2 + S^2 cos^2 phi), so the
    share is 1 - mean over phi of ((1 - sin psi) / 2)^((e + 1) / 2); 1 - 2^(-(e + 1) / 2) at C = 1. The mean is a sum
    over equal steps of phi, exact to rounding as the integrand is smooth and periodic (C > 0.01).
    """
    phi = 2.0 * np.pi * (np.arange(4096) + 0.5) / 4096
    s = math.sqrt((1.0 - cosine) * (1.0 + cosine)) * np.cos(phi)
    sin_psi = s / np.sqrt(cosine**2 + s * s)
    return float(1.0 - np.mean((0.5 * (1.0 - sin_psi)) ** (0.5 * (e + 1.0))))


def normal_gradient_sky(e: float, radiance: float, slope: float) -> float:
    """L = radiance + slope cos(theta), V = N: (e + 1) c^e (radiance + slope (2 c^2 - 1)) over c = m . N > 1/sqrt 2."""
    low = 0.5 ** (0.5 * (e + 1.0))
    return (radiance - slope) * (1.0 - low) + 2.0 * slope * (e + 1.0) / (e + 3.0) * (1.0 - 0.5 * low)
