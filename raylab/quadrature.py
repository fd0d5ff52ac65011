"""Deterministic sums: the steps of both "Illumination as integration" slides, each on top of the one before.

Step 1 is a point or a direction, step 2 a small area or a small solid angle, step 3 a bunch of them. As the parts
shrink the sums go to step 4, the integral, with an error of order 1/m^2: the ground truth where nothing is known in
closed form (`raylab.closed_forms`). Nothing here casts shadows. `f_r` is a function of the directions w (..., 3) to
the light, or a number k_d (1/sr); x is the receiver and n its unit normal, both (3,).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Brdf = float | Callable[[Array], npt.ArrayLike]
Radiance = float | Callable[[Array], npt.ArrayLike]


def _of(function: Brdf | Radiance, w: Array) -> Array:
    return np.asarray(function(w) if callable(function) else function, np.float64)


def _unit(v: Array) -> tuple[Array, Array]:
    """Unit vectors and squared lengths of v (..., 3)."""
    r2 = (v * v).sum(axis=-1)
    return v / np.sqrt(r2)[..., None], r2


# --- over the light source ---


def point_source(x: npt.ArrayLike, n: npt.ArrayLike, y: npt.ArrayLike, intensity: float, f_r: Brdf) -> Array:
    """Step 1, a point source: L_r = I f_r(v, w) |n . w| / |x - y|^2; y (..., 3), I in W/sr."""
    w, r2 = _unit(np.asarray(y, np.float64) - np.asarray(x, np.float64))
    return intensity * _of(f_r, w) * np.maximum(0.0, w @ np.asarray(n, np.float64)) / r2


def small_area_source(
    x: npt.ArrayLike,
    n: npt.ArrayLike,
    y: npt.ArrayLike,
    n_y: npt.ArrayLike,
    area: npt.ArrayLike,
    radiance: float,
    f_r: Brdf,
) -> Array:
    """Step 2, a small area source: L_r = L_s A f_r(v, w) |n_x . w| |n_y . w| / |x - y|^2.

    Only the side of n_y shines.
    """
    w, _ = _unit(np.asarray(y, np.float64) - np.asarray(x, np.float64))
    cos_y = np.maximum(0.0, -(w * np.asarray(n_y, np.float64)).sum(axis=-1))
    return radiance * np.asarray(area) * cos_y * point_source(x, n, y, 1.0, f_r)


def parallelogram_source(
    x: npt.ArrayLike,
    n: npt.ArrayLike,
    p: npt.ArrayLike,
    e1: npt.ArrayLike,
    e2: npt.ArrayLike,
    radiance: float,
    f_r: Brdf,
    m: int,
) -> float:
    """Step 3, a bunch of small area sources: m x m equal parts of the parallelogram at the corner p with edges e1, e2.

    L_r = sum_i L_s f_r(v, w_i) |n_x . w_i| |n_y . w_i| / |x - y_i|^2 dA_i, y_i the middle of each part; n_y = e1 x e2.
    """
    p, e1, e2 = (np.asarray(v, np.float64) for v in (p, e1, e2))
    t = (np.arange(m) + 0.5) / m
    normal = np.cross(e1, e2)
    area = np.linalg.norm(normal)
    y = p + t[:, None, None] * e1 + t[None, :, None] * e2
    return float(small_area_source(x, n, y, normal / area, area / m**2, radiance, f_r).sum())


# --- over incoming directions ---


def directional_source(n: npt.ArrayLike, w: npt.ArrayLike, irradiance: npt.ArrayLike, f_r: Brdf) -> Array:
    """Step 1, a directional source: L_r = I f_r(v, w) cos(theta); w (..., 3), I in W/m^2."""
    w = np.asarray(w, np.float64)
    return np.asarray(irradiance) * _of(f_r, w) * np.maximum(0.0, w @ np.asarray(n, np.float64))


def small_angle_source(
    n: npt.ArrayLike, w: npt.ArrayLike, sigma: npt.ArrayLike, radiance: Radiance, f_r: Brdf
) -> Array:
    """Step 2, a small area at infinity: L_r = L_i sigma f_r(v, w) cos(theta); sigma in sr."""
    return directional_source(n, w, _of(radiance, np.asarray(w, np.float64)) * np.asarray(sigma), f_r)


def environment(n: npt.ArrayLike, radiance: Radiance, f_r: Brdf, m: int) -> float:
    """Step 3, a bunch of small solid angles: the hemisphere over n in 4 m^2 parts of the same size.

    L_r = sum_i L_i f_r(v, w_i) cos(theta_i) d sigma, d sigma = 2 pi / (4 m^2), equal steps of cos(theta) and phi.
    """
    z, phi = (np.arange(m) + 0.5) / m, 2.0 * np.pi * (np.arange(4 * m) + 0.5) / (4 * m)
    r = np.sqrt(1.0 - z * z)
    local = np.stack(
        [np.outer(r, np.cos(phi)), np.outer(r, np.sin(phi)), np.repeat(z[:, None], 4 * m, axis=1)], axis=-1
    )
    w = local @ frame(np.asarray(n, np.float64))
    return float(small_angle_source(n, w, 2.0 * np.pi / (4 * m * m), radiance, f_r).sum())


def frame(n: Array) -> Array:
    """(3, 3): rows s, t, n, an orthonormal frame around the unit vector n."""
    s = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
    s /= np.linalg.norm(s)
    return np.stack([s, np.cross(n, s), n])
