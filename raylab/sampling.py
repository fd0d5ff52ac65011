"""Maps from the unit square: "start with uniform in square" (slide "Creating soft shadows").

Three functions for each target, in this order: `sample_X(..., u)` maps u = (u1, u2) to X, `pdf_X` is its density
(1/sr for directions, 1/area for points), `invert_X` finds the u that `sample_X` maps to a given point. Directions
have unit length; N and the other axes must have it too.
"""

from __future__ import annotations

import math

import numpy as np

from raylab.jit import njit
from raylab.vec3 import Vec3, cross, dot, length

PI = math.pi


@njit
def frame(n):
    """Two unit vectors s, t with s x t = n. Source: Duff et al. 2017, JCGT 6(1), listing 3."""
    sign = math.copysign(1.0, n.z)
    a = -1.0 / (sign + n.z)
    b = n.x * n.y * a
    return Vec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3(b, sign + n.y * n.y * a, -n.y)


@njit
def from_frame(n, x, y, z):
    """x s + y t + z n, with s, t = frame(n)."""
    s, t = frame(n)
    return s * x + t * y + n * z


@njit
def turn(y, x):
    """The angle of (x, y) as a fraction of a full turn in [0, 1)."""
    fraction = math.atan2(y, x) / (2.0 * PI)
    if fraction < 0.0:
        fraction += 1.0
    return fraction if fraction < 1.0 else 0.0


@njit
def lift(n, z, sin_theta, u2):
    """The direction at height z = cos(theta) over n, at the fraction u2 of a turn around it."""
    phi = 2.0 * PI * u2
    return from_frame(n, sin_theta * math.cos(phi), sin_theta * math.sin(phi), z)


@njit
def drop(n, w):
    """The fraction of a turn at which w stands around n: what `lift` calls u2."""
    s, t = frame(n)
    return turn(dot(w, t), dot(w, s))


# --- hemisphere, uniform: slide "Diffuse surface in env. by Monte Carlo" ---


@njit  # exercise a3.hemisphere
def sample_hemisphere(N, u):
    """A direction uniform over the hemisphere around N: z = u1."""
    z = u[0]
    return lift(N, z, math.sqrt((1.0 - z) * (1.0 + z)), u[1])


@njit
def pdf_hemisphere(N, w):
    """p(w) = 1 / (2 pi), 1/sr, above the horizon."""
    return 0.5 / PI if dot(w, N) > 0.0 else 0.0


@njit
def invert_hemisphere(N, w):
    return max(0.0, dot(w, N)), drop(N, w)


# --- hemisphere, proportional to the cosine: the same slide ---


@njit  # exercise a3.cos_hemisphere
def sample_cos_hemisphere(N, u):
    """A direction with density proportional to cos(theta) around N: z = sqrt(1 - u1)."""
    return lift(N, math.sqrt(1.0 - u[0]), math.sqrt(u[0]), u[1])


@njit
def pdf_cos_hemisphere(N, w):
    """p(w) = cos(theta) / pi, 1/sr."""
    return max(0.0, dot(w, N)) / PI


@njit
def invert_cos_hemisphere(N, w):
    sine = cross(N, w)
    return dot(sine, sine), drop(N, w)


# --- sphere, uniform ---


@njit
def sample_sphere(u):
    """A direction uniform over the sphere: z = 1 - 2 u1."""
    r = 2.0 * math.sqrt(u[0] * (1.0 - u[0]))
    phi = 2.0 * PI * u[1]
    return Vec3(r * math.cos(phi), r * math.sin(phi), 1.0 - 2.0 * u[0])


@njit
def pdf_sphere(w):
    """p(w) = 1 / (4 pi), 1/sr."""
    return 0.25 / PI


@njit
def invert_sphere(w):
    return (1.0 - w.z) / 2.0, turn(w.y, w.x)


# --- disk ---


@njit
def sample_disk(u):
    """A point (x, y) uniform over the unit disk: r = sqrt(u1)."""
    r, phi = math.sqrt(u[0]), 2.0 * PI * u[1]
    return r * math.cos(phi), r * math.sin(phi)


@njit
def pdf_disk(x, y):
    """p = 1 / pi inside, 1/area."""
    return 1.0 / PI if x * x + y * y <= 1.0 else 0.0


@njit
def invert_disk(x, y):
    return x * x + y * y, turn(y, x)


# --- disk, keeping squares compact: a lens ---


@njit
def sample_concentric_disk(u):
    """A point uniform over the unit disk: concentric squares become circles.

    Source: Shirley and Chiu 1997, "A low distortion map between disk and square".
    """
    a, b = 2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0
    flat = abs(a) > abs(b)  # nobody can foretell which, so a choice of values is quicker than a jump
    radius, other = (a, b) if flat else (b, a)
    sine, cosine = sin_cos_eighth(PI / 4.0 * (other / (radius if radius != 0.0 else 1.0)))
    along, across = radius * cosine, radius * sine
    return (along, across) if flat else (across, along)


_SIN = tuple((-1.0) ** k / math.factorial(2 * k + 1) for k in range(6))
_COS = tuple((-1.0) ** k / math.factorial(2 * k) for k in range(7))


@njit
def sin_cos_eighth(x):
    """sin and cos for |x| <= pi / 4 by their series, which costs a fraction of a library call.

    The first terms left out, x^13 / 13! and x^14 / 14!, are below 2^-37: a thousandth of what is lost when an eye ray
    is rounded to float32. Terms are taken in pairs, since what costs is the chain of operations that wait for one
    another.
    """
    y, s, c = x * x, _SIN, _COS
    z = y * y
    sine = (s[0] + y * s[1]) + z * ((s[2] + y * s[3]) + z * (s[4] + y * s[5]))
    cosine = (c[0] + y * c[1]) + z * ((c[2] + y * c[3]) + z * ((c[4] + y * c[5]) + z * c[6]))
    return x * sine, cosine


@njit
def sin_cos_turns(t):
    """sin and cos of t turns, without a jump: those of the nearest quarter, exchanged and with its signs."""
    t = 4.0 * (t - np.floor(t))
    quarter = np.floor(t + 0.5)  # 0 to 4
    s, c = sin_cos_eighth(PI / 2.0 * (t - quarter))
    odd = quarter == 1.0 or quarter == 3.0
    sine, cosine = (c, s) if odd else (s, c)
    return -sine if 1.5 < quarter < 3.5 else sine, -cosine if 0.5 < quarter < 2.5 else cosine


@njit
def pdf_concentric_disk(x, y):
    """p = 1 / pi inside, 1/area."""
    return 1.0 / PI if x * x + y * y <= 1.0 else 0.0


@njit
def invert_concentric_disk(x, y):
    r = math.sqrt(x * x + y * y)
    if r == 0.0:
        return 0.5, 0.5
    if abs(x) > abs(y):
        a = math.copysign(r, x)
        b = a * math.atan(y / x) * 4.0 / PI
    else:
        b = math.copysign(r, y)
        a = b * math.atan(x / y) * 4.0 / PI
    return 0.5 * (a + 1.0), 0.5 * (b + 1.0)


# --- triangle ---


@njit
def sample_triangle(u):
    """Barycentric coordinates (b1, b2) uniform over a triangle: b0 = 1 - sqrt(u1), b2 = u2 sqrt(u1)."""
    root = math.sqrt(u[0])
    return root * (1.0 - u[1]), root * u[1]


@njit
def pdf_triangle(b1, b2):
    """p = 2 inside, for (b1, b2) in the unit right triangle; 1/A over a triangle of area A."""
    return 2.0 if min(b1, b2) >= 0.0 and b1 + b2 <= 1.0 else 0.0


@njit
def invert_triangle(b1, b2):
    root = b1 + b2
    return root * root, b2 / root if root > 0.0 else 0.0


# --- cone: the directions towards a sphere ---


@njit
def one_minus_cos(sin_max):
    """1 - cos of the angle in [0, pi/2] with the given sine, without cancellation."""
    return sin_max * sin_max / (1.0 + math.sqrt((1.0 - sin_max) * (1.0 + sin_max)))


@njit
def sample_cone(axis, sin_max, u):
    """A direction uniform over the cone around `axis` whose half angle has the sine `sin_max`."""
    x = u[0] * one_minus_cos(sin_max)
    return lift(axis, 1.0 - x, math.sqrt(x * (2.0 - x)), u[1])


@njit
def pdf_cone(axis, sin_max, w):
    """p(w) = 1 / (2 pi (1 - cos theta_max)), 1/sr; 0 outside."""
    if dot(axis, w) <= 0.0 or length(cross(axis, w)) > sin_max + 2.0**-50:  # directions are rounded to 2^-53
        return 0.0
    return 0.5 / (PI * one_minus_cos(sin_max))


@njit
def invert_cone(axis, sin_max, w):
    sine = cross(axis, w)
    return dot(sine, sine) / (1.0 + dot(axis, w)) / one_minus_cos(sin_max), drop(axis, w)


# --- Phong lobe: slide "Creating glossy reflections" ---


@njit  # exercise a5.lobe
def sample_phong_lobe(R, n, u):
    """A direction with density proportional to cos(alpha)^n around R: cos(alpha) = (1 - u1)^(1 / (n + 1))."""
    x = -math.expm1(math.log1p(-u[0]) / (n + 1.0))
    return lift(R, 1.0 - x, math.sqrt(x * (2.0 - x)), u[1])


@njit  # exercise a5.pdf
def pdf_phong_lobe(R, n, w):
    """p(w) = (n + 1) / (2 pi) cos(alpha)^n, 1/sr."""
    return (n + 1.0) / (2.0 * PI) * cos_power(R, n, w)


@njit
def invert_phong_lobe(R, n, w):
    return (-math.expm1((n + 1.0) * log_cos(R, w)) if dot(R, w) > 0.0 else 1.0), drop(R, w)


@njit
def cos_power(R, n, w):
    """max(0, R . w)^n"""
    return math.exp(n * log_cos(R, w)) if dot(R, w) > 0.0 else 0.0


@njit
def log_cos(R, w):
    """log(R . w) for R . w > 0. Near 0, where n = 1e7 magnifies each digit, from the sine: log1p(-sin^2) / 2.

    R x (w - R) = R x w, and does not cancel."""
    sine = cross(R, w - R)
    sin_sqr = dot(sine, sine)
    return 0.5 * math.log1p(-sin_sqr) if sin_sqr < 0.5 else math.log(dot(R, w))
