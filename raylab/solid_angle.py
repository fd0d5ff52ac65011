"""Uniform points of the solid angle of a flat light: triangle, rectangle, disk (slide "Creating soft shadows").

A light is given as seen from x: `a` is the vector from x to its corner (or centre), e1 and e2 are its edges (half
axes). Per shape: `X_angle`, its solid angle in sr, `sample_X_angle(..., u)` -> coordinates (s, t) on the light, the
point a + s e1 + t e2, and `pdf_X_angle`, 1/sr. Everything is built of differences, never of 1 - cos or of sums of
angles that cancel; docs/precision.md has the limits. A light below FAR of its distance is sampled by area: there the
density varies by less than FAR over the light, and the relative variance by less than FAR^2, while the rounding of
an angle would move a point by 2^-53 / FAR^2 of the light.
"""

from __future__ import annotations

import math

from raylab.jit import njit
from raylab.sampling import PI, turn
from raylab.vec3 import cross, dot, length

FAR = 2.0**-10  # size of a light divided by its distance
SMALL = 0.1  # sr; below, the angle of a rectangle is the sum of two triangles'
TINY = 2.0**-18  # sr; below, it is sampled as two triangles as well, for Urena's angles are known to 2^-50 sr or so
FLAT = 4.0 * 2.0**-53  # height over the plane of a light, in sizes, that is rounding


@njit
def is_far(a, e1, e2):
    """Is the light so small from here that a point uniform in area is uniform in solid angle?"""
    return dot(e1, e1) + dot(e2, e2) < FAR * FAR * dot(a, a)


@njit
def is_flat(a, e1, e2):
    """Is x in the plane of the light, up to rounding?"""
    n = cross(e1, e2)
    size = length(n)
    return abs(dot(a, n)) <= FLAT * (length(e1) + length(e2) + length(a)) * size


# --- triangle ---


@njit
def triangle_angle(a, e1, e2):
    """Van Oosterom and Strackee 1983: tan(Omega / 2) = a . (e1 x e2) / (abc + (a . b) c + (b . c) a + (c . a) b)."""
    b, c = a + e1, a + e2
    la, lb, lc = length(a), length(b), length(c)
    return 2.0 * math.atan2(abs(dot(a, cross(e1, e2))), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)


@njit
def sample_triangle_angle(a, e1, e2, u):
    """Arvo 1995: the triangle a, b, c' with c' on the side a c has the share u1; then a point of the arc b c'.

    With half = u1 Omega / 2, T the unit tangent from a towards c, and |a| = 1, the formula of `triangle_angle` solved
    for c' (after Peters 2021) gives tan(ac' / 2) = sin(half) (1 + a . b) / (cos(half) |a x b . T| - sin(half) b . T).
    """
    half = 0.5 * u[0] * triangle_angle(a, e1, e2)
    b = a + e1
    la, lb = length(a), length(b)
    A, B = a / la, b / lb
    T = e2 - A * dot(A, e2)
    T = T / length(T)
    p = math.sin(half) * (lb + dot(A, b))
    q = math.cos(half) * abs(dot(cross(A, e1), T)) - math.sin(half) * dot(e1, T)
    pp_qq = p * p + q * q
    if not pp_qq > 0.0:
        return 0.0, 0.0
    # c' - b as a sum of small vectors: (c' - A) + (A - B)
    arc = T * (2.0 * p * q / pp_qq) - A * (2.0 * p * p / pp_qq)
    arc = arc + A * (dot(e1, a + b) / ((la + lb) * lb)) - e1 / lb
    versine = 0.5 * dot(arc, arc)  # 1 - cos of the angle between b and c'
    x = u[1] * versine
    along = arc + B * versine
    size = length(along)
    w = B * (1.0 - x)
    if size > 0.0:
        w = w + along * (math.sqrt(max(0.0, x * (2.0 - x))) / size)
    return on_triangle(a, e1, e2, w)


@njit
def on_triangle(a, e1, e2, w):
    """Where the ray along w from x meets the triangle; what rounding brings outside is brought back."""
    across = cross(w, e2)
    det = dot(e1, across)
    if det == 0.0:
        return 0.0, 0.0
    s = min(max(-dot(a, across) / det, 0.0), 1.0)
    t = min(max(dot(w, cross(e1, a)) / det, 0.0), 1.0 - s)
    return s, t


@njit
def pdf_triangle_angle(a, e1, e2):
    """p(w) = 1 / Omega, 1/sr."""
    return 1.0 / triangle_angle(a, e1, e2)


# --- rectangle ---


@njit
def local_rectangle(a, e1, e2):
    """x0, x1, y0, y1, z > 0: the rectangle in a frame along its edges."""
    l1 = length(e1)
    x_axis = e1 / l1
    y_axis = e2 - x_axis * dot(x_axis, e2)
    l2 = length(y_axis)
    y_axis = y_axis / l2
    x0, y0 = dot(a, x_axis), dot(a, y_axis)
    return x0, x0 + l1, y0, y0 + l2, abs(dot(a, cross(x_axis, y_axis)))


@njit
def is_square(e1, e2):
    """Are the edges at right angles, as far as float32 corners can say?"""
    return abs(dot(e1, e2)) <= 2.0**-20 * length(e1) * length(e2)


@njit
def rectangle_angle(a, e1, e2):
    """Sum of atan(x y / (z r)) over the corners; where that cancels, or for a parallelogram, two triangles."""
    if is_square(e1, e2):
        x0, x1, y0, y1, z = local_rectangle(a, e1, e2)
        angle = corner(x1, y1, z) - corner(x0, y1, z) - corner(x1, y0, z) + corner(x0, y0, z)
        if angle >= SMALL:
            return angle
    return triangle_angle(a, e1, e2) + triangle_angle(a + e1 + e2, -e1, -e2)


@njit
def corner(x, y, z):
    return math.atan2(x * y, z * math.sqrt(x * x + y * y + z * z))


@njit
def sample_rectangle_angle(a, e1, e2, u):
    """Urena, Fajardo, King 2013; where that cancels, or for a parallelogram, one of two triangles."""
    if is_square(e1, e2) and rectangle_angle(a, e1, e2) >= TINY:
        x0, x1, y0, y1, z = local_rectangle(a, e1, e2)
        return urena(x0, x1, y0, y1, -z, u)
    first, second = triangle_angle(a, e1, e2), triangle_angle(a + e1 + e2, -e1, -e2)
    share = first / (first + second)
    if u[0] < share:
        return sample_triangle_angle(a, e1, e2, (u[0] / share, u[1]))
    u1 = min((u[0] - share) / (1.0 - share), 1.0 - 2.0**-53)
    s, t = sample_triangle_angle(a + e1 + e2, -e1, -e2, (u1, u[1]))
    return 1.0 - s, 1.0 - t


@njit
def urena(x0, x1, y0, y1, z, u):
    """(s, t) in [0, 1]^2 of a rectangle at z < 0: x by the angle cut off, y by the height h of the arc."""
    n0, n1 = -y0 / math.hypot(y0, z), x1 / math.hypot(x1, z)
    n2, n3 = y1 / math.hypot(y1, z), -x0 / math.hypot(x0, z)
    opposite = 2.0 * PI - math.acos(-n2 * n3) - math.acos(-n3 * n0)
    angle = u[0] * (math.acos(-n0 * n1) + math.acos(-n1 * n2) - opposite) + opposite
    sine = math.sin(angle)
    f = (math.cos(angle) * n0 - n2) / (sine if sine != 0.0 else 2.0**-60)
    edge = z / math.hypot(y0, z)  # n0^2 + edge^2 = 1
    rest = (f - edge) * (f + edge)
    x = math.copysign(-z / math.sqrt(rest) if rest > 0.0 else 2.0**100, f)
    x = min(max(x, x0), x1)
    d = math.hypot(x, z)
    h0, h1 = y0 / math.hypot(d, y0), y1 / math.hypot(d, y1)
    h = h0 + u[1] * (h1 - h0)
    y = h * d / math.sqrt((1.0 - h) * (1.0 + h)) if h * h < 1.0 else y1
    return (x - x0) / (x1 - x0), min(max((y - y0) / (y1 - y0), 0.0), 1.0)


@njit
def pdf_rectangle_angle(a, e1, e2):
    """p(w) = 1 / Omega, 1/sr."""
    return 1.0 / rectangle_angle(a, e1, e2)


# --- disk ---
# A disk is seen as an elliptic cone of half angles alpha and beta. Projected along its axis, its outline on the unit
# sphere is the ellipse (sin alpha cos psi, sin beta sin psi), cos theta(psi) = |(cos alpha cos psi, cos beta sin psi)|
# (Guillen et al. 2017 have the geometry), and the solid angle of a sector is sin alpha sin beta g(psi) d psi with
# g = 1 / (1 + cos theta(psi)), an elliptic integral. Here psi is drawn from g's polygon through PARTS points of each
# quadrant, in closed form; the density says so, hence nothing is biased; p is uniform within 3 %.

PARTS = 4


@njit
def disk_cone(a, e1, e2):
    """f, y', h, D, sines and cosines of alpha and beta, and the vector f: the disk's cone without cancellation.

    In the plane of x, the axis of the disk and its centre: h is the height, f points to the centre, d is how far;
    r0 and r1 are the distances of the near and far rim, y' is where the axis of the cone meets the disk's plane.
    """
    radius = length(e1)
    n = cross(e1, e2) / (radius * radius)
    h = dot(a, n)
    n = n if h >= 0.0 else -n
    h = abs(h)
    f = a - n * h
    d = length(f)
    f = f / d if d > 0.0 else e1 / radius
    r0, r1 = math.hypot(d - radius, h), math.hypot(d + radius, h)
    cos2 = (d - radius) * (d + radius) + h * h  # r0 r1 cos(2 alpha)
    sum_sqr, product = (r0 + r1) * (r0 + r1), r0 * r1
    if cos2 < 0.0:
        y = 8.0 * d * (radius * h) ** 2 / ((product - cos2) * sum_sqr)
        sin_a = math.sqrt(0.5 * (product - cos2) / product)
        cos_a = radius * h / (product * sin_a)
    else:
        y = 2.0 * d * (product + cos2) / sum_sqr
        cos_a = math.sqrt(0.5 * (product + cos2) / product)
        sin_a = radius * h / (product * cos_a)
    D, chord = math.hypot(y, h), 2.0 * radius * math.sqrt(product) / (r0 + r1)
    size = math.hypot(D, chord)
    axis, across = (f * y + n * h) / D, (f * h - n * y) / D
    return axis, across, cross(n, f), sin_a, cos_a, chord / size, D / size


@njit
def sector(cos_a, cos_b, psi):
    """g(psi) = 1 / (1 + cos theta(psi)), between 1/2 and 1."""
    return 1.0 / (1.0 + math.hypot(cos_a * math.cos(psi), cos_b * math.sin(psi)))


@njit
def sector_polygon(cos_a, cos_b):
    """g at PARTS + 1 points of a quadrant."""
    step = 0.5 * PI / PARTS
    return (
        sector(cos_a, cos_b, 0.0), sector(cos_a, cos_b, step), sector(cos_a, cos_b, 2.0 * step),
        sector(cos_a, cos_b, 3.0 * step), sector(cos_a, cos_b, 4.0 * step),
    )  # fmt: skip


@njit
def polygon_total(g):
    """The integral of the polygon over all four quadrants."""
    return 0.5 * PI / PARTS * 2.0 * (g[0] + 2.0 * (g[1] + g[2] + g[3]) + g[4])


@njit
def polygon_at(g, psi):
    """The polygon at the angle psi of the first quadrant."""
    x = psi / (0.5 * PI / PARTS)
    part = min(int(x), PARTS - 1)
    return g[part] + (g[part + 1] - g[part]) * (x - part)


@njit
def sample_polygon(g, u):
    """psi in [0, 2 pi) with the polygon's density: the quadrant by u's first digit to the base of 4, then a part."""
    quadrant = min(int(4.0 * u), 3)
    rest = (4.0 * u - quadrant) * (g[0] + 2.0 * (g[1] + g[2] + g[3]) + g[4])
    part = 0
    while part < PARTS - 1 and rest >= g[part] + g[part + 1]:
        rest -= g[part] + g[part + 1]
        part += 1
    left, right = g[part], g[part + 1]
    x = rest / (left + math.sqrt(max(0.0, left * left + (right - left) * rest)))
    psi = (part + min(max(x, 0.0), 1.0)) * (0.5 * PI / PARTS)
    if quadrant & 1:
        psi = 0.5 * PI - psi  # every second quadrant backwards: the map has no seam there
    return psi + 0.5 * PI * quadrant


@njit
def sample_disk_angle(a, e1, e2, u):
    axis, across, aside, sin_a, cos_a, sin_b, cos_b = disk_cone(a, e1, e2)
    psi = sample_polygon(sector_polygon(cos_a, cos_b), u[1])
    x, y = sin_a * math.cos(psi), sin_b * math.sin(psi)
    edge = math.hypot(x, y)
    versine = u[0] * edge * edge * sector(cos_a, cos_b, psi)  # 1 - cos theta
    sine = math.sqrt(versine * (2.0 - versine)) / edge
    w = across * (x * sine) + aside * (y * sine) + axis * (1.0 - versine)
    n = cross(e1, e2)
    reach = dot(w, n)
    p = w * (dot(a, n) / reach) - a if reach != 0.0 else e1
    radius_sqr = dot(e1, e1)
    s, t = dot(p, e1) / radius_sqr, dot(p, e2) / radius_sqr
    outside = max(1.0, math.hypot(s, t))
    return s / outside, t / outside


@njit
def pdf_disk_angle(a, e1, e2, w):
    """p(w), 1/sr, towards a point of the disk; w of any length."""
    _, across, aside, sin_a, cos_a, sin_b, cos_b = disk_cone(a, e1, e2)
    psi = 2.0 * PI * turn(dot(w, aside) * sin_a, dot(w, across) * sin_b)
    psi = math.atan2(abs(math.sin(psi)), abs(math.cos(psi)))
    g = sector_polygon(cos_a, cos_b)
    return polygon_at(g, psi) / (polygon_total(g) * sin_a * sin_b * sector(cos_a, cos_b, psi))


@njit
def is_round(e1, e2):
    """Is the disk a circle, up to the rounding of its matrix?"""
    r1, r2 = dot(e1, e1), dot(e2, e2)
    return abs(r1 - r2) <= 2.0**-40 * r1 and abs(dot(e1, e2)) <= 2.0**-40 * r1
