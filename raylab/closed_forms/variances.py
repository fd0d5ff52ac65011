"""Exact variances of one sample of the slides' estimators, where the integral of the square is known.

All for k_d = 1/pi (a white surface), radiance 1 and a receiver in the open: the estimator is the reflected radiance,
its mean E / pi. For another reflectance or radiance multiply by the square. Those that agree with a sampler that
claims to sample in another way, or to take one sample, are found out by them: a wrong density is often unbiased.
"""

from __future__ import annotations

import math


def env_uniform_gradient(a: float, b: float) -> float:
    """Uniform hemisphere under L = a + b cos theta: 4 (a^2/3 + a b/2 + b^2/5) - (a + 2 b/3)^2; 1/3 for a = 1, b = 0."""
    return 4.0 * (a * a / 3.0 + a * b / 2.0 + b * b / 5.0) - (a + 2.0 * b / 3.0) ** 2


def env_cosine_gradient(b: float) -> float:
    """Cosine-proportional sampling under L = a + b cos theta: b^2 / 18, whatever a."""
    return b * b / 18.0


def env_brightness_gradient(a: float, b: float) -> float:
    """p = L / (pi M) over the hemisphere, L = a + b cos theta: 2 M (a/3 + b/4) - m^2; M = 2 a + b, m = a + 2 b/3."""
    return 4.0 * (a + b / 2.0) * (a / 3.0 + b / 4.0) - (a + 2.0 * b / 3.0) ** 2


def env_brightness_gradient_sphere(a: float, b: float) -> float:
    """The same over the whole sphere, p = L / (4 pi a), as `GradientEnvironment` samples: 8 a (a/3 + b/4) - m^2."""
    return 8.0 * a * (a / 3.0 + b / 4.0) - (a + 2.0 * b / 3.0) ** 2


def env_uniform_cap(half_angle: float) -> float:
    """Uniform hemisphere, light within `half_angle` of n, c = cos: 4 (1 - c^3) / 3 - sin^4."""
    c = math.cos(half_angle)
    return 4.0 * (1.0 - c**3) / 3.0 - math.sin(half_angle) ** 4


def env_cosine_cap(half_angle: float) -> float:
    """Cosine-proportional sampling, light within `half_angle` of n: p (1 - p), p = sin^2."""
    p = math.sin(half_angle) ** 2
    return p * (1.0 - p)


def cone_cap(half_angle: float) -> float:
    """Uniform in the cone of light around n: (2 (1 - c))^2 (1 - c)^2 / 12; a sphere light sampled from afar."""
    x = 2.0 * math.sin(0.5 * half_angle) ** 2  # 1 - c
    return 4.0 * x * x * x * x / 12.0


def area_disk(radius: float, height: float) -> float:
    """Disk above x by area: R^2 h^4/3 (h^-6 - (R^2 + h^2)^-3) - (R^2 / (R^2 + h^2))^2, R^2 / (3 h^2) for R >> h."""
    r2, h2 = radius**2, height**2
    return r2 * h2 * h2 / 3.0 * (h2**-3 - (r2 + h2) ** -3) - (r2 / (r2 + h2)) ** 2


def phong_brdf(n: float) -> float:
    """Lobe of reflectance 1 sampled by itself, r = N, constant sky: 1 / ((n + 1) (n + 3))."""
    return 1.0 / ((n + 1.0) * (n + 3.0))


def phong_uniform(n: float) -> float:
    """The same lobe by a uniform hemisphere: (n + 2)^2 / (2 n + 3) - 1."""
    return (n + 2.0) ** 2 / (2.0 * n + 3.0) - 1.0


def phong_cosine(n: float) -> float:
    """The same lobe by cosine-proportional sampling: (n + 2)^2 / (4 (n + 1)) - 1."""
    return (n + 2.0) ** 2 / (4.0 * (n + 1.0)) - 1.0
