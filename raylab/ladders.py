"""Slides "Illumination as integration": the four steps, over the light source and over incoming directions.

Each step stands on the one before: a point, a small area, a bunch of small areas, the integral. `f_r` is a function of
the directions w (..., 3) to the light in 1/sr, or a number: the k_d of the Lambertian slides, so that each function is
both slides of its kind. x is the receiver, n_x its unit normal; |n . w| is max(0, n . w), and nothing casts shadows.

How fast step 3 tends to step 4, with n = m x m parts of side h ~ 1/m in two dimensions, for parts of equal size:
where the integrand is smooth the middle of a part is exact up to second order, so that the error is h^2 ~ 1/n; where it
jumps, the parts along the edge, 1/h of them, are each wrong by about their size h^2: the error is h ~ n^-1/2 if all err
to the same side (an edge along the parts), and h^(3/2) ~ n^-3/4 if they err to random sides. Monte Carlo: N^-1/2.

These sums are also the ground truth where nothing is known in closed form (`raylab.closed_forms`).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Like = npt.ArrayLike
Function = float | Callable[[Array], npt.ArrayLike]
NODES = 96  # of step 4 along each side


# --- over the light source ---


def point_source(x: Like, n_x: Like, y: Like, I: float, f_r: Function) -> Array:  # noqa: E741
    """1. A point source: L_r = I f_r(v, w) |n . w| / |x - y|^2 = I k_d cos(theta_r) / r^2; y (..., 3), I in W/sr."""
    w, r2 = _unit(_array(y) - _array(x))
    return I * _of(f_r, w) * np.maximum(0.0, w @ _array(n_x)) / r2


def small_area_source(x: Like, n_x: Like, y: Like, n_y: Like, A: Like, L_s: float, f_r: Function) -> Array:
    """2. A small area source: L_r = L_s A f_r(v, w) |n_x . w| |n_y . w| / |x - y|^2; A in m^2.

    A point source with I = L_s A cos(theta_s); only the side of n_y shines.
    """
    w, _ = _unit(_array(y) - _array(x))
    cos_theta_s = np.maximum(0.0, -(w * _array(n_y)).sum(axis=-1))
    return L_s * _array(A) * cos_theta_s * point_source(x, n_x, y, 1.0, f_r)


def area_sources(x: Like, n_x: Like, y: Like, n_y: Like, dA: Like, L_s: float, f_r: Function) -> float:
    """3. A bunch of small area sources: L_r = sum_i L_s f_r(v, w_i) |n_x . w_i| |n_y . w_i| / |x - y_i|^2 dA_i."""
    return float(small_area_source(x, n_x, y, n_y, dA, L_s, f_r).sum())


def area_source(x: Like, n_x: Like, p: Like, e1: Like, e2: Like, L_s: float, f_r: Function) -> float:
    """4. A large area source: L_r = integral over S of L_s f_r(v, w(y)) |n_x . w| |n_y . w| / |x - y|^2 dA(y).

    S is the parallelogram of `area_parts`; Gauss-Legendre points, exact to rounding where the integrand is smooth.
    """
    return area_sources(x, n_x, *_parallelogram(p, e1, e2, *_gauss(NODES)), L_s, f_r)


def area_parts(p: Like, e1: Like, e2: Like, m: int) -> tuple[Array, Array, Array]:
    """y, n_y, dA of m x m equal parts of the parallelogram at the corner p with edges e1, e2; n_y along e1 x e2."""
    return _parallelogram(p, e1, e2, *_middles(m))


# --- over incoming directions ---


def directional_source(n: Like, w: Like, I: Like, f_r: Function) -> Array:  # noqa: E741
    """1. A directional source: L_r = I f_r(v, w) cos(theta); w (..., 3), I in W/m^2."""
    w = _array(w)
    return _array(I) * _of(f_r, w) * np.maximum(0.0, w @ _array(n))


def small_solid_angle(n: Like, w: Like, sigma: Like, L_i: Function, f_r: Function) -> Array:
    """2. A small area at infinity: L_r = L_i sigma f_r(v, w) cos(theta); sigma in sr. A directional I = L_i sigma."""
    return directional_source(n, w, _of(L_i, _array(w)) * _array(sigma), f_r)


def solid_angles(n: Like, w: Like, dsigma: Like, L_i: Function, f_r: Function) -> float:
    """3. A bunch of small solid angles: L_r = sum_i L_i(w_i) f_r(v, w_i) cos(theta_i) dsigma_i."""
    return float(small_solid_angle(n, w, dsigma, L_i, f_r).sum())


def environment(n: Like, L_i: Function, f_r: Function) -> float:
    """4. An entire environment: L_r = integral over the hemisphere of L_i(w) f_r(v, w) (w . n) dsigma(w).

    Gauss-Legendre points in cos(theta), equal steps of phi: exact to rounding where the integrand is smooth.
    """
    return solid_angles(n, *_hemisphere(n, *_gauss(NODES), 4 * NODES), L_i, f_r)


def direction_parts(n: Like, m: int) -> tuple[Array, Array]:
    """w, dsigma of 4 m^2 parts of the hemisphere over n, all of one size: equal steps of cos(theta) and phi."""
    return _hemisphere(n, *_middles(m), 4 * m)


def frame(n: Like) -> Array:
    """(3, 3): rows s, t, n, an orthonormal frame around the unit vector n."""
    n = _array(n)
    s = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
    s /= np.linalg.norm(s)
    return np.stack([s, np.cross(n, s), n])


# --- points and weights ---


def _middles(m: int) -> tuple[Array, Array]:
    return (np.arange(m) + 0.5) / m, np.full(m, 1.0 / m)


def _gauss(m: int) -> tuple[Array, Array]:
    nodes, weights = np.polynomial.legendre.leggauss(m)
    return 0.5 * (nodes + 1.0), 0.5 * weights


def _parallelogram(p: Like, e1: Like, e2: Like, t: Array, weights: Array) -> tuple[Array, Array, Array]:
    p, e1, e2 = _array(p), _array(e1), _array(e2)
    normal = np.cross(e1, e2)
    area = np.linalg.norm(normal)
    y = p + t[:, None, None] * e1 + t[None, :, None] * e2
    return y, normal / area, area * np.outer(weights, weights)


def _hemisphere(n: Like, z: Array, weights: Array, around: int) -> tuple[Array, Array]:
    phi, r = 2.0 * np.pi * (np.arange(around) + 0.5) / around, np.sqrt(1.0 - z * z)
    local = np.stack([np.outer(r, np.cos(phi)), np.outer(r, np.sin(phi)), np.outer(z, np.ones(around))], axis=-1)
    return local @ frame(n), np.outer(weights, np.full(around, 2.0 * np.pi / around))


def _array(v: Like) -> Array:
    return np.asarray(v, np.float64)


def _of(function: Function, w: Array) -> Array:
    return _array(function(w) if callable(function) else function)


def _unit(v: Array) -> tuple[Array, Array]:
    """Unit vectors and squared lengths of v (..., 3)."""
    r2 = (v * v).sum(axis=-1)
    return v / np.sqrt(r2)[..., None], r2
