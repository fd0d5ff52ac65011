"""From a described environment to the record that kernels sample: cumulated shares in float64, cell by cell."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab import environment as env
from raylab.emitters import LUMINANCE, colour
from raylab.errors import SceneError
from raylab.vec3 import Vec3
from raylab.view import View

Array = npt.NDArray[np.float64]


def make_environment(described: d.Environment | None) -> Any:
    """The environment record; SceneError for what cannot be radiance."""
    if described is None:
        return env.NoEnvironment()
    if isinstance(described, d.ConstantEnvironment):
        return env.ConstantEnvironment(Vec3(*colour(described.radiance, "environment: radiance")))
    if isinstance(described, d.GradientEnvironment):
        return gradient_environment(described)
    if isinstance(described, d.ImageEnvironment):
        return image_environment(described)
    raise SceneError(f"expected an environment of raylab.description, got {type(described).__name__}")


def gradient_environment(described: d.GradientEnvironment) -> env.GradientEnvironment:
    radiance = colour(described.radiance, "environment: radiance")
    gradient = np.asarray(described.gradient, np.float64)
    steepest = np.linalg.norm(gradient, axis=1) if gradient.shape == (3, 3) else np.full(3, np.inf)
    if not np.all(steepest <= radiance):
        raise SceneError(
            f"environment: gradient must be (3, 3), each row no longer than the radiance {radiance.tolist()} (the "
            f"light would be negative somewhere), got\n{gradient}"
        )
    slope = LUMINANCE @ gradient
    b = float(np.linalg.norm(slope))
    axis = slope / b if b > 0.0 else np.array([0.0, 0.0, 1.0])
    red, green, blue = (Vec3(*row) for row in gradient)
    a = max(float(LUMINANCE @ radiance), 1e-300)
    return env.GradientEnvironment(Vec3(*radiance), red, green, blue, a, b, Vec3(*axis))


def image_environment(described: d.ImageEnvironment) -> Any:
    pixels = np.asarray(described.pixels)
    if pixels.ndim != 3 or pixels.shape[2] != 3 or min(pixels.shape[:2]) < 1:
        raise SceneError(f"environment: the image must be (h, w, 3), got {pixels.shape}")
    bad = ~((pixels >= 0.0) & (pixels <= np.finfo(np.float32).max))
    if bad.any():
        row, column, _ = (int(i) for i in np.argwhere(bad)[0])
        raise SceneError(
            f"environment: {int(bad.any(axis=2).sum())} texels are negative, not finite or above float32, the first in "
            f"row {row}, column {column}: {pixels[row, column].tolist()}"
        )
    smooth = described.filter == "bilinear"
    if smooth and len(pixels) < 2:
        pixels = np.repeat(pixels, 2, axis=0)
    height, width = pixels.shape[:2]
    brightness = pixels.astype(np.float64) @ LUMINANCE
    if not brightness.max() > 0.0:
        return env.ConstantEnvironment(Vec3(0.0, 0.0, 0.0))
    if smooth:
        around = brightness + np.roll(brightness, -1, axis=1)
        brightness = around[:-1] + around[1:]
    rows = len(brightness)
    heights = np.cos(np.linspace(0.0, np.pi, rows + 1))
    sizes = (heights[:-1] - heights[1:])[:, None]
    if described.mis_compensation:
        brightness = compensated(brightness, sizes)
    weights = brightness * sizes
    kind = env.Bilinear if smooth else env.Nearest
    texels = kind(View(pixels.reshape(-1, 3).astype(np.float32)), width, height)
    right, up, back = (Vec3(*axis) for axis in rotation(described.to_world))
    totals = weights.sum(axis=1)
    return env.ImageEnvironment(
        right, up, back, rows, width, View(heights), View(shares(totals)), View(shares(weights)), texels
    )


def compensated(brightness: Array, sizes: Array) -> Array:
    """What is above the mean over the sphere, max(0, L - mean L): Karlik et al. 2019, "MIS compensation".

    Where the other technique is as likely everywhere, sampling the mean again would be wasted. A sky without
    contrast stays as it is.
    """
    mean = (brightness * sizes).sum() / (sizes.sum() * brightness.shape[1])
    above = np.maximum(0.0, brightness - mean * (1.0 + 2.0**-40))
    return above if above.max() > 0.0 else brightness


def shares(weights: Array) -> Array:
    """Cumulated shares along the last axis; the last positive weight and all after it have the share 1 exactly."""
    sums = np.cumsum(weights, axis=-1)
    total = sums[..., -1:]
    cdf = np.divide(sums, total, out=np.ones_like(sums), where=total > 0.0)
    return np.where(sums >= total, 1.0, np.minimum(cdf, 1.0 - 2.0**-53))


def rotation(to_world: Array) -> Array:
    """The world-to-local rotation of an environment; SceneError for anything that is not one (translation aside)."""
    whole = np.asarray(to_world, np.float64)
    m = whole[:3, :3]
    numbers = whole.shape == (4, 4) and np.all(np.isfinite(whole)) and np.abs(m).max() <= 2.0  # no square overflows
    if not numbers or np.abs(m @ m.T - np.eye(3)).max() > 1e-6:
        raise SceneError(f"environment: to_world must be a finite (4, 4) rotation (no scale or shear), got\n{whole}")
    return m.T
