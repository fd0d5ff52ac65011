# ruff: noqa
# fmt: off
"""Right answers to assignment a5, each in another manner: `lobe_MANNER`, `pdf_MANNER`, `shade_MANNER`."""
import math
import numpy as np
from raylab.lecture import PI, Vec3, black, cross, dot, frame, from_frame, length, light_from, normalize, reflect

TWO_PI = 2.0 * math.pi


# as on the slide
def lobe_slide(R, n, u):
    z = (1.0 - u[0]) ** (1.0 / (n + 1.0))
    r, phi = math.sqrt((1.0 - z) * (1.0 + z)), 2.0 * PI * u[1]
    return from_frame(R, r * math.cos(phi), r * math.sin(phi), z)


def pdf_slide(R, n, w):
    return (n + 1.0) / (2.0 * PI) * max(0.0, dot(R, w)) ** n


def shade_slide(x, V, brdf, N, scene, rng):
    k_s, n = brdf.lobe()
    w = lobe_slide(reflect(V, N), n, rng.square())
    return k_s * light_from(scene, x, w, N) * max(0.0, dot(w, N)) * (n + 2.0) / (n + 1.0)


# u for 1 - u
def lobe_mirrored(R, n, u):
    z = u[0] ** (1 / (n + 1)) if u[0] > 0.0 else 0.0
    r, phi = math.sqrt(1 - z * z), TWO_PI * u[1]
    return from_frame(R, r * math.cos(phi), r * math.sin(phi), z)


def pdf_mirrored(R, n, w):
    c = dot(w, R)
    if c <= 0.0:
        return 0.0
    return (n + 1) * c**n / (2 * math.pi)


def shade_mirrored(x, V, brdf, N, scene, rng):
    k_s, n = brdf.lobe()
    R = 2.0 * dot(V, N) * N - V
    w = lobe_mirrored(R, n, rng.square())
    L = light_from(scene, x, w, N)
    return L * k_s * ((n + 2) * max(0.0, dot(N, w)) / (n + 1))


# the other order of random numbers
def lobe_turned(R, n, u):
    s, t = frame(R)
    z = math.pow(1.0 - u[1], 1.0 / (1.0 + n))
    r, phi = math.sqrt(max(0.0, 1.0 - z * z)), TWO_PI * u[0]
    return r * math.cos(phi) * s + r * math.sin(phi) * t + z * R


def pdf_turned(R, n, w):
    c = dot(R, w)
    return (n + 1.0) / TWO_PI * math.pow(c, n) if c > 0.0 else 0.0


def shade_turned(x, V, brdf, N, scene, rng):
    k_s, n = brdf.lobe()
    w = lobe_turned(reflect(V, N), n, rng.square())
    if dot(w, N) <= 0.0:
        return black
    return light_from(scene, x, w, N) * k_s * dot(w, N) * ((n + 2.0) / (n + 1.0))


# f / p
def lobe_f_over_p(R, n, u):
    s, t = frame(R)
    alpha = math.acos((1.0 - u[0]) ** (1.0 / (n + 1.0)))
    phi = TWO_PI * u[1]
    return s * (math.sin(alpha) * math.cos(phi)) + t * (math.sin(alpha) * math.sin(phi)) + R * math.cos(alpha)


def pdf_f_over_p(R, n, w):
    if dot(R, w) < 0:
        return 0.0
    power = dot(R, w) ** n
    norm = (n + 1) / TWO_PI
    return norm * power


def shade_f_over_p(x, V, brdf, N, scene, rng):
    k_s, n = brdf.lobe()
    R = reflect(V, N)
    w = lobe_f_over_p(R, n, rng.square())
    p = pdf_f_over_p(R, n, w)
    if p == 0.0:
        return black
    f_r = k_s * ((n + 2) / TWO_PI * max(0.0, dot(R, w)) ** n)
    return light_from(scene, x, w, N) * f_r * max(0.0, dot(w, N)) / p


# by logarithms
def lobe_logarithms(R, n, u):
    z = math.exp(math.log(1.0 - u[0]) / (n + 1.0))
    r = math.sqrt(-math.expm1(2.0 * math.log(1.0 - u[0]) / (n + 1.0)))
    return from_frame(R, r * math.cos(TWO_PI * u[1]), r * math.sin(TWO_PI * u[1]), z)


def pdf_logarithms(R, n, w):
    c = dot(R, w)
    return math.exp(n * math.log(c) + math.log((n + 1.0) / TWO_PI)) if c > 0.0 else 0.0


def shade_logarithms(x, V, brdf, N, scene, rng):
    k_s, n = brdf.lobe()
    w = lobe_logarithms(reflect(V, N), n, (rng.number(), rng.number()))
    cosine = dot(w, N)
    if cosine > 0.0:
        return k_s * light_from(scene, x, w, N) * cosine * (1.0 + 1.0 / (n + 1.0))
    return black


# a frame of one's own
def around(axis, x, y, z):
    a = Vec3(0.0, 0.0, 1.0) if abs(axis.z) < 0.5 else Vec3(1.0, 0.0, 0.0)
    s = normalize(cross(axis, a))
    return s * x + cross(axis, s) * y + axis * z


def lobe_own_frame(R, n, u):
    c = (1 - u[0]) ** (1 / (n + 1))
    s = (1 - c**2) ** 0.5
    return around(R, s * math.cos(TWO_PI * u[1]), s * math.sin(TWO_PI * u[1]), c)


def pdf_own_frame(R, n, w):
    c = R.x * w.x + R.y * w.y + R.z * w.z
    if c > 0:
        return c**n * (n + 1) / 2 / PI
    else:
        return 0.0


def shade_own_frame(x, V, brdf, N, scene, rng):
    k_s, n = brdf.lobe()
    c = dot(V, N)
    R = Vec3(2 * c * N.x - V.x, 2 * c * N.y - V.y, 2 * c * N.z - V.z)
    w = lobe_own_frame(R, n, rng.square())
    L = light_from(scene, x, w, N)
    f = max(0, dot(w, N)) * (n + 2) / (n + 1)
    return Vec3(k_s.x * L.x * f, k_s.y * L.y * f, k_s.z * L.z * f)


# numpy
def lobe_numpy(R, n, u):
    z = np.power(1.0 - u[0], 1.0 / (n + 1.0))
    r = np.sqrt(1.0 - z * z)
    s, t = frame(R)
    w = np.array([s.x, s.y, s.z]) * (r * np.cos(2 * np.pi * u[1])) + np.array([t.x, t.y, t.z]) * (r * np.sin(2 * np.pi * u[1])) + np.array([R.x, R.y, R.z]) * z
    return Vec3(w[0], w[1], w[2])


def pdf_numpy(R, n, w):
    return (n + 1) / (2 * np.pi) * np.maximum(0.0, dot(R, w)) ** n


def shade_numpy(x, V, brdf, N, scene, rng):
    k_s, n = brdf.lobe()
    w = lobe_numpy(reflect(V, N), n, rng.square())
    c = np.maximum(0.0, dot(w, N))
    return light_from(scene, x, w, N) * k_s * (c * (n + 2) / (n + 1))


# helpers
def cosine_of(n, u):
    return (1.0 - u) ** (1.0 / (n + 1.0))


def sine_of(c):
    return math.sqrt(max(0.0, (1.0 - c) * (1.0 + c)))


def lobe_helpers(R, n, u):
    c = cosine_of(n, u[0])
    return from_frame(R, sine_of(c) * math.cos(TWO_PI * u[1]), sine_of(c) * math.sin(TWO_PI * u[1]), c)


def clamped(c):
    return c if c > 0.0 else 0.0


def norm(n, m):
    return (n + m) / TWO_PI


def pdf_helpers(R, n, w):
    return norm(n, 1) * clamped(dot(R, w)) ** n


def shade_helpers(x, V, brdf, N, scene, rng):
    k_s, n = brdf.lobe()
    w = lobe_helpers(reflect(V, N), n, rng.square())
    return k_s * light_from(scene, x, w, N) * (clamped(dot(w, N)) * norm(n, 2) / norm(n, 1))


# the other way around the axis
def lobe_backwards(R, n, u):
    c = (1.0 - u[0]) ** (1.0 / (n + 1.0))
    s, t = frame(R)
    phi = PI - TWO_PI * u[1]
    return normalize(t * (math.sqrt(1.0 - c * c) * math.cos(phi)) + s * (math.sqrt(1.0 - c * c) * math.sin(phi)) + c * R)


def pdf_backwards(R, n, w):
    c = max(dot(R, w), 0.0)
    return 0.5 * (1 + n) / PI * c**n


def shade_backwards(x, V, brdf, N, scene, rng):
    k_s, n = brdf.lobe()
    w = lobe_backwards(-(V - N * (2.0 * dot(N, V))), n, rng.square())
    weight = (n + 2) / (n + 1) * max(0.0, dot(N, w))
    return weight * (k_s * light_from(scene, x, w, N))


# early ends
def lobe_early_ends(R, n, u):
    if n == 0.0:
        z = 1.0 - u[0]
    else:
        z = (1.0 - u[0]) ** (1.0 / (n + 1.0))
    r = math.sqrt(1.0 - z * z)
    a, b = r * math.sin(TWO_PI * u[1]), r * math.cos(TWO_PI * u[1])
    return from_frame(R, a, b, z)


def pdf_early_ends(R, n, w):
    c = dot(R, w)
    if not c > 0.0:
        return 0.0
    result = n + 1.0
    result /= 2.0 * PI
    result *= c**n
    return result


def shade_early_ends(x, V, brdf, N, scene, rng):
    k_s, n = brdf.lobe()
    w = lobe_early_ends(reflect(V, N), n, rng.square())
    if dot(w, N) <= 0:
        return black
    if dot(w, x.n) <= 0:
        return black
    L = light_from(scene, x, w, N)
    return L * k_s * dot(w, N) * (n + 2) / (n + 1)
