"""Closed forms: irradiance at a point, under lights whose integral is known. The ground truth of tests and scenes.

Everything here is for radiance 1, and irradiance is in units of that radiance: a surface of reflectance rho reflects
the radiance rho / pi * L * E. x is the receiver, n its unit normal. Plain float64 numpy, no kernels.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
UP = (0.0, 0.0, 1.0)
ORIGIN = (0.0, 0.0, 0.0)
SMALL = 0.02  # size of a polygon divided by its distance


# --- polygons ---


def clip(polygon: npt.ArrayLike, normal: npt.ArrayLike, offset: npt.ArrayLike = 0.0) -> Array:
    """The part of convex polygons (..., k, 3) in the half space normal . p >= offset, as (..., 2 k, 3).

    Corners that fall away are repeated neighbours, which add edges of length zero; what lies outside altogether
    shrinks to a point. `normal` (..., 3), `offset` (...). Sutherland and Hodgman 1974, "Reentrant polygon clipping".
    """
    p = np.asarray(polygon, np.float64)
    h = p @ np.asarray(normal, np.float64)[..., None]
    h = h[..., 0] - np.asarray(offset, np.float64)[..., None]
    q, g = np.roll(p, -1, axis=-2), np.roll(h, -1, axis=-1)
    crosses = (h >= 0.0) != (g >= 0.0)
    t = np.divide(h, h - g, out=np.zeros_like(h), where=crosses)
    slots = np.stack([np.broadcast_to(p, (*h.shape, 3)), p + (q - p) * t[..., None]], axis=-2)
    filled = np.stack([h >= 0.0, crosses], axis=-1)
    slots, filled = slots.reshape(*h.shape[:-1], -1, 3), filled.reshape(*h.shape[:-1], -1)
    numbers = np.where(filled, np.arange(filled.shape[-1]), -1)
    last = np.maximum(np.maximum.accumulate(numbers, axis=-1), -1)
    last = np.where(last < 0, numbers.max(axis=-1, keepdims=True), last)  # before the first: the last one, cyclically
    return np.where(last[..., None] < 0, 0.0, np.take_along_axis(slots, np.maximum(last, 0)[..., None], axis=-2))


def polygon(
    vertices: npt.ArrayLike,
    x: npt.ArrayLike = ORIGIN,
    n: npt.ArrayLike = UP,
    keep: Sequence[tuple[npt.ArrayLike, npt.ArrayLike]] = (),
) -> Array:
    """Irradiance of a convex polygon: E = 1/2 |sum_i Theta_i n . Gamma_i| over the edges of what x sees of it.

    Parameters
    ----------
    vertices : (k, 3) corners, in either order: both sides shine. x, n : (..., 3).
    keep : half spaces a . p >= b, pairs (a (..., 3), b (...)), that an occluder leaves of the light; for a straight
        edge that is the plane through x and the edge.

    What is smaller than SMALL of its distance is summed as differences from its first corner (`_far`).
    Source: Lambert 1760, Photometria; Arvo 1995, "Analytic methods for simulated light transport", eq. 3.1.
    """
    x, n = np.asarray(x, np.float64), np.asarray(n, np.float64)
    seen = np.asarray(vertices, np.float64) - x[..., None, :]
    for a, b in keep:
        a = np.asarray(a, np.float64)
        seen = clip(seen, a, np.asarray(b, np.float64) - (a * x).sum(axis=-1))
    seen = clip(seen, n)
    following = np.roll(seen, -1, axis=-2)
    cross = np.cross(seen, following - seen)
    sine, cosine = np.linalg.norm(cross, axis=-1), (seen * following).sum(axis=-1)
    ratio = np.divide(np.arctan2(sine, cosine), sine, out=np.zeros_like(sine), where=sine > 0.0)
    near = 0.5 * np.abs((ratio * (cross @ n[..., None])[..., 0]).sum(axis=-1))
    size, distance = (np.linalg.norm(v, axis=-1).max(axis=-1) for v in (seen - seen[..., :1, :], seen[..., :1, :]))
    return np.where(size < SMALL * distance, _far(seen, cross, n), near)


def _far(p: Array, cross: Array, n: Array) -> Array:
    """Lambert's sum for a small polygon: 1/2 |sum_i (w_i - w) n . c_i + w n . 2A|, w = 1 / |p_0|^2, of small terms.

    c_i = p_i x p_{i+1} have the sum 2A, twice the area vector, which differences give; with x_i = sin Theta_i
    w_i = asin(x_i) / x_i / (|p_i| |p_{i+1}|), where asin(x) / x - 1 = x^2/6 + 3x^4/40 + 15x^6/336 + 105x^8/3456 + ...
    """
    d, r = p - p[..., :1, :], np.linalg.norm(p[..., :1, :], axis=-1)
    size = np.linalg.norm(p, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        shorter = -(d * (p + p[..., :1, :])).sum(axis=-1) / (r + size)  # |p_0| - |p_i|
        product = size * np.roll(size, -1, axis=-1)
        xx = (cross * cross).sum(axis=-1) / product**2
        bent = xx * (1.0 / 6.0 + xx * (3.0 / 40.0 + xx * (15.0 / 336.0 + xx * (105.0 / 3456.0))))
        weight = (bent + (r * shorter + size * np.roll(shorter, -1, axis=-1)) / r**2) / product  # w_i - w
        twice_area = np.cross(d, np.roll(d, -1, axis=-2)).sum(axis=-2)
        total = (weight * (cross @ n[..., None])[..., 0]).sum(axis=-1) + (twice_area * n).sum(axis=-1) / r[..., 0] ** 2
    return np.asarray(0.5 * np.abs(total))


def behind_edge(x: npt.ArrayLike, a: npt.ArrayLike, b: npt.ArrayLike, lit: npt.ArrayLike) -> tuple[Array, Array]:
    """The half space `keep` of `polygon` for an opaque half plane with the edge a b: the side of the point `lit`."""
    x, a, b = (np.asarray(v, np.float64) for v in (x, a, b))
    normal = np.cross(a - x, b - a)
    normal = normal * np.sign(((np.asarray(lit) - x) * normal).sum(axis=-1, keepdims=True))
    return normal, (normal * x).sum(axis=-1)


def rectangle_parallel(a: float, b: float, c: float) -> float:
    """Rectangle a x b at height c with a corner above x, parallel to the receiver; X = a / c, Y = b / c.

    E = 1/2 [X/sqrt(1+X^2) atan(Y/sqrt(1+X^2)) + Y/sqrt(1+Y^2) atan(X/sqrt(1+Y^2))].
    Source: Howell, A catalog of radiation heat transfer configuration factors, section B.
    """
    u, v = math.hypot(c, a), math.hypot(c, b)
    return 0.5 * (a / u * math.atan2(b, u) + b / v * math.atan2(a, v))


def rectangle_perpendicular(a: float, b: float, c: float) -> float:
    """Upright rectangle of height a and width b at distance c, its lower corner nearest to x; X = a / b, Y = c / b.

    E = 1/2 [atan(1/Y) - Y/sqrt(X^2+Y^2) atan(1/sqrt(X^2+Y^2))]. Source: as `rectangle_parallel`.
    """
    r = math.hypot(a, c)
    return 0.5 * (math.atan2(b, c) - c / r * math.atan2(b, r))


# --- disks and spheres ---


def disk_coaxial(radius: float, height: float) -> float:
    """Disk above x, parallel to the receiver: E = pi R^2 / (R^2 + h^2)."""
    return math.pi / (1.0 + (height / radius) ** 2)


def disk_parallel(radius: float, height: float, offset: npt.ArrayLike) -> Array:
    """Disk whose axis passes x at the distance `offset`, parallel to the receiver.

    E = pi/2 [1 - (Z - 2 R^2) / sqrt(Z^2 - 4 R^2)], H = h/a, R = r/a, Z = 1 + H^2 + R^2. Source: Howell, section B.
    """
    square = np.asarray(offset, np.float64) ** 2
    z = square + height**2 + radius**2  # all times a^2, so that offset 0 is allowed
    return np.asarray(0.5 * math.pi * (1.0 - (z - 2.0 * radius**2) / np.sqrt(z**2 - 4.0 * radius**2 * square)))


def disk_perpendicular(radius: float, distance: float, height: float) -> float:
    """Upright disk whose centre is `distance` away and `height` above the receiver, height >= radius, facing it.

    E = pi/2 H [Z / sqrt(Z^2 - 4 R^2) - 1], H = distance/height, R = radius/height, Z = 1 + H^2 + R^2. Source: Howell.
    """
    z = height**2 + distance**2 + radius**2
    root = math.sqrt(z**2 - 4.0 * (radius * height) ** 2)
    return 0.5 * math.pi * (distance / height) * (z / root - 1.0)


def sphere(radius: npt.ArrayLike, distance: npt.ArrayLike, cosine: npt.ArrayLike) -> Array:
    """Sphere with its centre at `distance` > radius, in a direction of that cosine to n; eta = distance / radius.

    Above the horizon (eta c >= 1): E = pi c / eta^2. Below (eta c <= -1): 0. Cut by it, with s = sqrt(1 - c^2),
    x = sqrt(eta^2 - 1), y = -x c / s, q = sqrt(1 - y^2): E = (c acos y - x s q) / eta^2 + atan(s q / x).
    Source: Lagarde and de Rousiers 2014, "Moving Frostbite to physically based rendering", after Quilez 2006.
    """
    eta, c = np.broadcast_arrays(
        np.asarray(distance, np.float64) / np.asarray(radius, np.float64), np.asarray(cosine, np.float64)
    )
    s, x = np.sqrt(np.maximum(0.0, (1.0 - c) * (1.0 + c))), np.sqrt((eta - 1.0) * (eta + 1.0))
    y = np.clip(-x * c / np.where(s > 0.0, s, 1.0), -1.0, 1.0)
    q = np.sqrt((1.0 - y) * (1.0 + y))
    cut = (c * np.arccos(y) - x * s * q) / eta**2 + np.arctan(s * q / x)
    return np.where(eta * c >= 1.0, np.pi * c / eta**2, np.where(eta * c <= -1.0, 0.0, cut))


# --- skies ---


def constant_sky() -> float:
    """Radiance 1 from everywhere: E = pi."""
    return math.pi


def gradient_sky(a: npt.ArrayLike, b: npt.ArrayLike, n: npt.ArrayLike = UP) -> Array:
    """L(w) = a + b . w: E = pi a + 2 pi / 3 b . n. Source: the first two bands of Ramamoorthi and Hanrahan 2001."""
    return np.asarray(math.pi * np.asarray(a) + 2.0 * math.pi / 3.0 * (np.asarray(b) @ np.asarray(n)))


def overcast_sky() -> float:
    """L(w) = (1 + 2 cos theta) / 3, the CIE overcast sky of zenith 1 over a level surface: E = 7 pi / 9."""
    return 7.0 * math.pi / 9.0


def cap_sky(half_angle: float) -> float:
    """Radiance 1 within `half_angle` (radians, up to pi/2) of n: E = pi sin^2."""
    return math.pi * math.sin(half_angle) ** 2


def sphere_before_sky(radius: npt.ArrayLike, distance: npt.ArrayLike, cosine: npt.ArrayLike) -> Array:
    """A constant sky behind a black ball: E = pi - E_sphere, pi (1 - (R/d)^2 cos) while it is above the horizon."""
    return math.pi - sphere(radius, distance, cosine)


def texels(height: int, width: int) -> tuple[Array, Array]:
    """Vectors V (h, w, 3) with E = n . V, and solid angles (h, w), of the cells of a latitude-longitude image.

    The pole is +z, longitude counts from +x towards +y; a cell must lie wholly above the horizon of n.
    V = (g (sin phi2 - sin phi1), g (cos phi1 - cos phi2), 1/2 dphi (sin^2 t2 - sin^2 t1)), g = 1/2 [t - sin t cos t];
    solid angle dphi (cos t1 - cos t2).
    """
    theta, phi = np.linspace(0.0, np.pi, height + 1), np.linspace(0.0, 2.0 * np.pi, width + 1)
    g = 0.5 * np.diff(theta - np.sin(theta) * np.cos(theta))
    up = 0.5 * np.diff(np.sin(theta) ** 2)[:, None] * np.diff(phi)
    v = np.stack([np.outer(g, np.diff(np.sin(phi))), np.outer(g, -np.diff(np.cos(phi))), up], axis=-1)
    return v, np.outer(-np.diff(np.cos(theta)), np.diff(phi))


# --- lights without area: step 1 of both "Illumination as integration" slides ---


def point_light(y: npt.ArrayLike, x: npt.ArrayLike = ORIGIN, n: npt.ArrayLike = UP) -> Array:
    """Radiant intensity 1 at y: E = max(0, cos theta) / r^2. x, n : (..., 3)."""
    d = np.asarray(y, np.float64) - np.asarray(x, np.float64)
    r2 = (d * d).sum(axis=-1)
    return np.maximum(0.0, (d * np.asarray(n)).sum(axis=-1)) / (r2 * np.sqrt(r2))


def directional_light(w: npt.ArrayLike, n: npt.ArrayLike = UP) -> Array:
    """Irradiance 1 across the unit direction w to the light: E = max(0, w . n)."""
    return np.maximum(0.0, (np.asarray(w) * np.asarray(n)).sum(axis=-1))
