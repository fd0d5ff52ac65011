# ruff: noqa
# fmt: off
"""Right answers to assignment a6, each in another manner: `aperture_M`, `lens_M`, `time_M`, `motion_M`."""
import math
import numpy as np
from raylab.lecture import PI, Vec3, black, dot, length, normalize

TWO_PI = 2.0 * math.pi


# as on the slide
def aperture_slide(a, u):
    r, phi = a * math.sqrt(u[0]), 2.0 * PI * u[1]
    return r * math.cos(phi), r * math.sin(phi)


def lens_slide(toward, f, px, py):
    focus = toward * f
    return (focus - Vec3(px, py, 0.0)) / f


def time_slide(open, close, u):
    return open + (close - open) * u


def motion_slide(p0, p1, t0, t1, t):
    s = (t - t0) / (t1 - t0)
    s = min(1.0, max(0.0, s))
    return p0 + (p1 - p0) * s


# the other order of random numbers
def aperture_turned(a, u):
    r, phi = math.sqrt(u[1]), TWO_PI * u[0]
    return a * r * math.sin(phi), a * r * math.cos(phi)


def lens_turned(toward, f, px, py):
    w = f * toward - Vec3(px, py, 0)
    return w / w.z


def time_turned(open, close, u):
    return (1.0 - u) * open + u * close


def motion_turned(p0, p1, t0, t1, t):
    if t <= t0:
        return p0
    if t >= t1:
        return p1
    return (p0 * (t1 - t) + p1 * (t - t0)) / (t1 - t0)


# by hand
def aperture_by_hand(a, u):
    phi = u[1] * 2 * math.pi
    x = math.cos(phi) * u[0] ** 0.5
    y = math.sin(phi) * u[0] ** 0.5
    return a * x, a * y


def lens_by_hand(toward, f, px, py):
    return Vec3(toward.x - px / f, toward.y - py / f, 1.0)


def time_by_hand(open, close, u):
    length = close - open
    t = open
    t += u * length
    return t


def motion_by_hand(p0, p1, t0, t1, t):
    s = (t - t0) / (t1 - t0)
    if s < 0:
        s = 0.0
    elif s > 1:
        s = 1.0
    return Vec3(p0.x + s * (p1.x - p0.x), p0.y + s * (p1.y - p0.y), p0.z + s * (p1.z - p0.z))


# squares kept together
def aperture_squares(a, u):
    x, y = 2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0
    if x == 0.0 and y == 0.0:
        return 0.0, 0.0
    if abs(x) > abs(y):
        r, phi = x, PI / 4 * y / x
    else:
        r, phi = y, PI / 2 - PI / 4 * x / y
    return a * r * math.cos(phi), a * r * math.sin(phi)


def lens_squares(toward, f, px, py):
    lens = Vec3(px, py, 0.0)
    pinhole = toward / toward.z
    focus = pinhole * f
    direction = focus - lens
    return direction * (1.0 / direction.z)


def time_squares(open, close, u):
    return close - (close - open) * (1.0 - u)


def motion_squares(p0, p1, t0, t1, t):
    t = max(t, t0)
    t = min(t, t1)
    s = (t - t0) / (t1 - t0)
    return s * p1 + (1 - s) * p0


# mirrored
def aperture_mirrored(a, u):
    r = a * math.sqrt(1.0 - u[0])
    return -r * math.cos(TWO_PI * u[1]), r * math.sin(TWO_PI * u[1])


def lens_mirrored(toward, f, px, py):
    to_lens = Vec3(px, py, 0.0) - toward * f
    return -to_lens / f


def time_mirrored(open, close, u):
    return u * close - (u - 1.0) * open


def motion_mirrored(p0, p1, t0, t1, t):
    s = (t1 - t) / (t1 - t0)
    s = 0.0 if s < 0.0 else 1.0 if s > 1.0 else s
    return p1 + (p0 - p1) * s


# helpers
def on_disk(u1, u2):
    r = math.sqrt(u1)
    return r * math.cos(TWO_PI * u2), r * math.sin(TWO_PI * u2)


def aperture_helpers(a, u):
    x, y = on_disk(u[0], u[1])
    return x * a, y * a


def focus_point(toward, f):
    return Vec3(f * toward.x, f * toward.y, f)


def lens_helpers(toward, f, px, py):
    q = focus_point(toward, f)
    return Vec3((q.x - px) / q.z, (q.y - py) / q.z, 1.0)


def between(a, b, s):
    return a + s * (b - a)


def time_helpers(open, close, u):
    return between(open, close, u)


def clamped(s):
    return min(max(s, 0.0), 1.0)


def motion_helpers(p0, p1, t0, t1, t):
    return between(p0, p1, clamped((t - t0) / (t1 - t0)))


# numpy
def aperture_numpy(a, u):
    r, phi = a * np.sqrt(u[0]), 2 * np.pi * u[1]
    return r * np.cos(phi), r * np.sin(phi)


def lens_numpy(toward, f, px, py):
    focus = np.array([toward.x, toward.y, toward.z]) * f
    w = (focus - np.array([px, py, 0.0])) / f
    return Vec3(w[0], w[1], w[2])


def time_numpy(open, close, u):
    return np.sum(np.array([open, close]) * np.array([1.0 - u, u]))


def motion_numpy(p0, p1, t0, t1, t):
    s = np.minimum(np.maximum((t - t0) / (t1 - t0), 0.0), 1.0)
    return p0 * (1.0 - s) + p1 * s


# a corner of the square, turned by quarters
def aperture_quarters(a, u):
    v = 4.0 * u[1]
    quarter = int(v)
    phi = 0.5 * PI * (v - quarter)
    x, y = a * math.sqrt(u[0]) * math.cos(phi), a * math.sqrt(u[0]) * math.sin(phi)
    for i in range(quarter):
        x, y = -y, x
    return x, y


def lens_quarters(toward, f, px, py):
    shift = Vec3(px, py, 0.0) * (1.0 / f)
    return toward - shift


def time_quarters(open, close, u):
    middle, half = 0.5 * (open + close), 0.5 * (close - open)
    return middle + (2.0 * u - 1.0) * half


def motion_quarters(p0, p1, t0, t1, t):
    velocity = (p1 - p0) / (t1 - t0)
    gone = 0.0
    if t > t0:
        gone = t - t0
    if t > t1:
        gone = t1 - t0
    return p0 + velocity * gone


# early ends
def aperture_early_ends(a, u):
    if u[0] == 0.0:
        return 0.0, 0.0
    r = a * math.sqrt(u[0])
    angle = -2 * PI * u[1]
    return r * math.sin(angle), r * math.cos(angle)


def lens_early_ends(toward, f, px, py):
    if px == 0.0 and py == 0.0:
        return toward
    return normalize(toward * f - Vec3(px, py, 0.0)) * (length(toward * f - Vec3(px, py, 0.0)) / f)


def time_early_ends(open, close, u):
    if u == 0.0:
        return open
    return open * (1 - u) + close * u


def motion_early_ends(p0, p1, t0, t1, t):
    if t < t0:
        return p0
    if t > t1:
        return p1
    s = (t - t0) / (t1 - t0)
    return p0 * (1 - s) + p1 * s


# a complex number; angles in degrees
def aperture_degrees(a, u):
    degrees = 360.0 * u[1] - 180.0
    r = math.sqrt(u[0]) * a
    return r * math.cos(math.radians(degrees)), r * math.sin(math.radians(degrees))


def lens_degrees(toward, f, px, py):
    tan_x, tan_y = toward.x, toward.y
    focus_x, focus_y = tan_x * f, tan_y * f
    dx, dy, dz = focus_x - px, focus_y - py, f - 0.0
    return Vec3(dx / dz, dy / dz, dz / dz)


def time_degrees(open, close, u):
    dt = close - open
    return u * dt + open


def motion_degrees(p0, p1, t0, t1, t):
    duration = t1 - t0
    passed = min(max(t - t0, 0.0), duration)
    return p0 + (p1 - p0) * (passed / duration)
