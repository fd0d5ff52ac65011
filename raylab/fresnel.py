"""Fresnel: how much of unpolarised light a smooth boundary reflects, and how much passes.

With c = cos(theta_i) >= 0, the index eta = n_t / n_i (complex n + ik for a metal), q = eta^2 - 1 and
g = eta cos(theta_t) = sqrt(q + c^2), the amplitudes (c - g) / (c + g) and (eta^2 c - g) / (eta^2 c + g) become

    r_s = -q / (c + g)^2,    r_p = q ((q + 2) c^2 - 1) / (eta^2 c + g)^2,

in which nothing cancels except at Brewster's angle, c^2 = 1 / (eta^2 + 1), where r_p is zero.
Source: Born and Wolf, "Principles of Optics", sections 1.5 and 14.2.
"""

from __future__ import annotations

import cmath
import math

from raylab.jit import njit
from raylab.vec3 import Vec3, dot


@njit
def dielectric(c, eta):
    """R, T = 1 - R and cos(theta_t) at the boundary of two clear media; (1, 0, 0) at total internal reflection."""
    q = (eta - 1.0) * (eta + 1.0)
    gg = q + c * c
    if q == 0.0:
        return 0.0, 1.0, c
    if gg <= 0.0:
        return 1.0, 0.0, 0.0
    g = math.sqrt(gg)
    s, p = c + g, eta * eta * c + g
    r_s, r_p = q / (s * s), q * ((q + 2.0) * c * c - 1.0) / (p * p)
    T = 2.0 * c * g * (1.0 / (s * s) + (eta / p) * (eta / p))
    return 0.5 * (r_s * r_s + r_p * r_p), T, g / eta


@njit
def conductor(c, eta, k):
    """R for each colour at a metal of index eta + i k."""
    return Vec3(metal(c, eta.x, k.x), metal(c, eta.y, k.y), metal(c, eta.z, k.z))


@njit
def metal(c, n, k):
    """R at a medium of index n + i k."""
    q = complex((n - 1.0) * (n + 1.0) - k * k, 2.0 * n * k)
    if q == 0.0:
        return 0.0
    g = cmath.sqrt(q + c * c)
    r_s = q / ((c + g) * (c + g))
    p = (q + 1.0) * c + g
    r_p = q * ((q + 2.0) * (c * c) - 1.0) / (p * p)
    return 0.5 * (norm(r_s) + norm(r_p))


@njit
def norm(z):
    """|z|^2"""
    return z.real * z.real + z.imag * z.imag


@njit
def refract(V, N, eta, cos_t):
    """The direction that continues V = toward the eye on the other side of N (Snell); cos_t from `dielectric`."""
    return N * (dot(N, V) / eta - cos_t) - V / eta
