"""Closed forms for the lobe f_r = (n + 2) / (2 pi) max(0, r . w)^n of the modified Phong model.

They rest on moments of the cosine to the mirror direction r, over a region of the unit sphere:

    tau_n = integral of (r . w)^n d sigma(w),   tau_{n,1} = integral of (r . w)^n (v . w) d sigma(w)

and the radiance reflected from light of radiance 1 in that region is (n + 2) / (2 pi) tau_{n,1}, v being the normal.
Source: Arvo 1995, "Analytic methods for simulated light transport", chapter 4. Whole exponents n only.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from raylab.closed_forms.irradiance import UP, clip

Array = npt.NDArray[np.float64]


def lobe(n: int, tau_n1: float) -> float:
    """(n + 2) / (2 pi) tau_{n,1}: radiance reflected by a lobe of specular reflectance 1."""
    return (n + 2) / (2.0 * math.pi) * tau_n1


# --- a constant sky ---


def lune_moments(n: int, cosine: float) -> tuple[float, float]:
    """tau_n and tau_{n,1} over {w . N > 0, w . r > 0} with cosine C = N . r.

    With S = sqrt(1 - C^2), gamma = acos C: tau_0 = 2 (pi - gamma), tau_1 = pi (1 + C) / 2 and
    (n + 1) tau_n = (n - 1) tau_{n-2} + C S^{n-1} sqrt(pi) Gamma(n/2) / Gamma((n+1)/2);
    tau_{0,1} = pi (1 + C) / 2, tau_{1,1} = (C tau_0 + 2 S) / 3 and
    (n + 2) tau_{n,1} = (n - 1) tau_{n-2,1} + C tau_{n-1}. Derived from Arvo's recurrences.
    """
    sine = math.sqrt((1.0 - cosine) * (1.0 + cosine))
    single = [2.0 * (math.pi - math.acos(cosine)), math.pi * (1.0 + cosine) / 2.0]
    double = [math.pi * (1.0 + cosine) / 2.0, (cosine * single[0] + 2.0 * sine) / 3.0]
    for k in range(2, n + 1):
        edge = math.sqrt(math.pi) * math.exp(math.lgamma(k / 2) - math.lgamma((k + 1) / 2))
        single.append(((k - 1) * single[k - 2] + cosine * sine ** (k - 1) * edge) / (k + 1))
        double.append(((k - 1) * double[k - 2] + cosine * single[k - 1]) / (k + 2))
    return single[n], double[n]


def constant_sky(n: int, cosine: float) -> float:
    """Radiance that the lobe reflects from a sky of radiance 1, with cosine N . r: the M of the slides, 1 at r = N."""
    return lobe(n, lune_moments(n, cosine)[1])


def gradient_sky(n: int, a: float, b: float) -> float:
    """Radiance that the lobe reflects from L(w) = a + b (w . N) with r = N: a + b (n + 2) / (n + 3)."""
    return a + b * (n + 2) / (n + 3)


# --- a polygon ---


def polygon_moments(vertices: npt.ArrayLike, n: int, r: npt.ArrayLike, v: npt.ArrayLike = UP) -> tuple[float, float]:
    """tau_n and tau_{n,1} of the convex polygon (k, 3) seen from the origin, clipped by r . w > 0 and v . w > 0.

    With u on the boundary, nu its outward normals, tau_{-1} = 0 and tau_0 the solid angle:
    (n + 1) tau_n = (n - 1) tau_{n-2} - oint (r . u)^{n-1} (r . nu) ds,
    (n + 2) tau_{n,1} = (n - 1) tau_{n-2,1} + (r . v) tau_{n-1} - oint (r . u)^{n-1} (v . u) (r . nu) ds.
    """
    r, v = np.asarray(r, np.float64), np.asarray(v, np.float64)
    p = clip(clip(np.asarray(vertices, np.float64), v), r)
    p = p[(p != np.roll(p, 1, axis=0)).any(axis=1)]
    if len(p) < 3:
        return 0.0, 0.0
    if np.linalg.det(p[:3]) < 0.0:
        p = p[::-1]  # counterclockwise, so that the outward normals are known
    edges = [_edge(a, b, n, r, v) for a, b in zip(p, np.roll(p, -1, axis=0), strict=True)]
    boundary = np.sum([e[0] for e in edges], axis=0)  # oint (r . u)^{k-1} (r . nu), k = 0 .. n; entry 0 unused
    weighted = np.sum([e[1] for e in edges], axis=0)
    single = [_solid_angle(p), -boundary[1] / 2.0 if n else 0.0]
    double = [0.5 * sum(e[2] for e in edges), 0.0]
    if n:
        double[1] = (float(r @ v) * single[0] - weighted[1]) / 3.0
    for k in range(2, n + 1):
        single.append(((k - 1) * single[k - 2] - boundary[k]) / (k + 1))
        double.append(((k - 1) * double[k - 2] + float(r @ v) * single[k - 1] - weighted[k]) / (k + 2))
    return float(single[n]), float(double[n])


def polygon(vertices: npt.ArrayLike, n: int, r: npt.ArrayLike, normal: npt.ArrayLike = UP) -> float:
    """Radiance that the lobe around r reflects at the origin from a polygon of radiance 1."""
    return lobe(n, polygon_moments(vertices, n, r, normal)[1])


def _edge(a: Array, b: Array, n: int, r: Array, v: Array) -> tuple[Array, Array, float]:
    """Of the great arc from a to b: integrals of (r . u)^{k-1} (r . nu) and of the same times v . u, for k = 0 .. n,
    and Lambert's term Theta (v . Gamma) of the edge."""
    inward = np.cross(a, b)
    sine = float(np.linalg.norm(inward))
    inward /= sine
    angle = math.atan2(sine, float(a @ b))
    s = a / np.linalg.norm(a)
    t = np.cross(inward, s)
    phase, size = math.atan2(r @ t, r @ s), math.hypot(r @ s, r @ t)
    along, across = (math.cos(phase) * s + math.sin(phase) * t), (-math.sin(phase) * s + math.cos(phase) * t)
    low, high = -phase, angle - phase
    powers = _cosine_integrals(low, high, n)
    plain, weighted = np.zeros(n + 1), np.zeros(n + 1)
    for k in range(1, n + 1):
        odd = (math.cos(low) ** k - math.cos(high) ** k) / k  # integral of cos^{k-1} sin
        plain[k] = size ** (k - 1) * powers[k - 1]
        weighted[k] = size ** (k - 1) * (float(v @ along) * powers[k] + float(v @ across) * odd)
    outward = -float(r @ inward)
    return plain * outward, weighted * outward, angle * float(v @ inward)


def _cosine_integrals(low: float, high: float, n: int) -> list[float]:
    """Integrals of cos^k from low to high, k = 0 .. n: k I_k = [cos^{k-1} sin] + (k - 1) I_{k-2}."""
    found = [high - low, math.sin(high) - math.sin(low)]
    for k in range(2, n + 1):
        ends = math.cos(high) ** (k - 1) * math.sin(high) - math.cos(low) ** (k - 1) * math.sin(low)
        found.append((ends + (k - 1) * found[k - 2]) / k)
    return found


def _solid_angle(p: Array) -> float:
    """Of a convex polygon seen from the origin, fan by fan. Source: Van Oosterom and Strackee 1983."""
    total = 0.0
    a = p[0]
    for b, c in pairwise(p[1:]):
        la, lb, lc = (float(np.linalg.norm(q)) for q in (a, b, c))
        volume = float(a @ np.cross(b - a, c - a))
        total += 2.0 * math.atan2(volume, la * lb * lc + a @ b * lc + b @ c * la + c @ a * lb)
    return total
