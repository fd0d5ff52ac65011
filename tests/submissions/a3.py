# ruff: noqa
# fmt: off
"""Right answers to assignment a3, each in another manner: `hemisphere_M`, `cos_hemisphere_M`, `uniform_M`, `cosine_M`."""
import math
import numpy as np
from raylab.lecture import PI, Vec3, black, cross, dot, frame, from_frame, length, normalize, shadow_toward

TWO_PI = 2.0 * math.pi


# as on the slide
def hemisphere_slide(N, u):
    r, phi = math.sqrt(1.0 - u[0] * u[0]), 2.0 * PI * u[1]
    return from_frame(N, r * math.cos(phi), r * math.sin(phi), u[0])


def cos_hemisphere_slide(N, u):
    r, phi = math.sqrt(u[0]), 2.0 * PI * u[1]
    return from_frame(N, r * math.cos(phi), r * math.sin(phi), math.sqrt(1.0 - u[0]))


def uniform_slide(x, k_d, N, scene, rng):
    result = black
    w = hemisphere_slide(N, rng.square())
    if not shadow_toward(scene, x, w):
        result += scene.environment.eval(w) * k_d * dot(w, N) * (2.0 * PI)
    return result


def cosine_slide(x, k_d, N, scene, rng):
    result = black
    w = cos_hemisphere_slide(N, rng.square())
    if not shadow_toward(scene, x, w):
        result += scene.environment.eval(w) * k_d * PI
    return result


# the other order of random numbers
def hemisphere_turned(N, u):
    s, t = frame(N)
    z, phi = u[1], TWO_PI * u[0]
    r = math.sqrt(max(0.0, 1.0 - z * z))
    return s * (r * math.cos(phi)) + t * (r * math.sin(phi)) + N * z


def cos_hemisphere_turned(N, u):
    s, t = frame(N)
    r, phi = math.sqrt(u[1]), TWO_PI * u[0]
    return s * (r * math.cos(phi)) + t * (r * math.sin(phi)) + N * math.sqrt(1.0 - u[1])


def uniform_turned(x, k_d, N, scene, rng):
    w = hemisphere_turned(N, rng.square())
    if shadow_toward(scene, x, w):
        return black
    return TWO_PI * k_d * scene.environment.eval(w) * dot(N, w)


def cosine_turned(x, k_d, N, scene, rng):
    w = cos_hemisphere_turned(N, rng.square())
    if shadow_toward(scene, x, w):
        return black
    return PI * k_d * scene.environment.eval(w)


# 1 - u for u
def hemisphere_mirrored(N, u):
    cos_theta = 1.0 - u[0]
    sin_theta = math.sqrt(1.0 - cos_theta ** 2)
    phi = -2.0 * PI * u[1]
    return from_frame(N, sin_theta * math.sin(phi), sin_theta * math.cos(phi), cos_theta)


def cos_hemisphere_mirrored(N, u):
    cos_theta = math.sqrt(u[0])
    sin_theta = math.sqrt(1.0 - u[0])
    phi = -2.0 * PI * u[1]
    return from_frame(N, sin_theta * math.sin(phi), sin_theta * math.cos(phi), cos_theta)


def uniform_mirrored(x, k_d, N, scene, rng):
    w = hemisphere_mirrored(N, rng.square())
    lit = 0.0 if shadow_toward(scene, x, w) else 1.0
    return scene.environment.eval(w) * k_d * (2 * math.pi * lit * max(0.0, dot(w, N)))


def cosine_mirrored(x, k_d, N, scene, rng):
    w = cos_hemisphere_mirrored(N, rng.square())
    lit = 0.0 if shadow_toward(scene, x, w) else 1.0
    return scene.environment.eval(w) * k_d * (math.pi * lit)


# by angles
def hemisphere_angles(N, u):
    theta, phi = math.acos(1.0 - u[0]), TWO_PI * u[1]
    return from_frame(N, math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta))


def cos_hemisphere_angles(N, u):
    theta, phi = math.asin(math.sqrt(u[0])), TWO_PI * u[1]
    return from_frame(N, math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta))


def uniform_angles(x, k_d, N, scene, rng):
    w = hemisphere_angles(N, rng.square())
    L = black if shadow_toward(scene, x, w) else scene.environment.eval(w)
    p_w = 1 / TWO_PI
    return L * k_d * dot(w, N) / p_w


def cosine_angles(x, k_d, N, scene, rng):
    w = cos_hemisphere_angles(N, rng.square())
    L = black if shadow_toward(scene, x, w) else scene.environment.eval(w)
    p_w = dot(w, N) / PI
    if p_w <= 0.0:
        return black
    return L * k_d * dot(w, N) / p_w


# a frame of one's own
def basis(n):
    a = Vec3(1.0, 0.0, 0.0) if abs(n.x) < 0.7 else Vec3(0.0, 1.0, 0.0)
    s = normalize(cross(a, n))
    return s, cross(n, s)


def around(n, x, y, z):
    s, t = basis(n)
    return x * s + y * t + z * n


def hemisphere_own_frame(N, u):
    z = u[0]
    r = math.sqrt((1 - z) * (1 + z))
    return around(N, r * math.cos(TWO_PI * u[1]), r * math.sin(TWO_PI * u[1]), z)


def cos_hemisphere_own_frame(N, u):
    r = math.sqrt(u[0])
    x, y = r * math.cos(TWO_PI * u[1]), r * math.sin(TWO_PI * u[1])
    return around(N, x, y, math.sqrt(max(0.0, 1.0 - x * x - y * y)))


def uniform_own_frame(x, k_d, N, scene, rng):
    result = black
    w = hemisphere_own_frame(N, (rng.number(), rng.number()))
    if not shadow_toward(scene, x, w):
        L_env = scene.environment.eval(w)
        result += 2 * PI * L_env * k_d * dot(w, N)
    return result


def cosine_own_frame(x, k_d, N, scene, rng):
    result = black
    w = cos_hemisphere_own_frame(N, (rng.number(), rng.number()))
    if not shadow_toward(scene, x, w):
        L_env = scene.environment.eval(w)
        result += PI * L_env * k_d
    return result


# the sphere, folded
def on_sphere(u):
    z = 1.0 - 2.0 * u[0]
    r = math.sqrt(max(0.0, 1.0 - z * z))
    return Vec3(r * math.cos(TWO_PI * u[1]), r * math.sin(TWO_PI * u[1]), z)


def hemisphere_sphere(N, u):
    w = on_sphere(u)
    if dot(w, N) < 0.0:
        w = -w
    return w


def cos_hemisphere_sphere(N, u):
    w = N + on_sphere(u)
    if dot(w, w) < 1e-18:
        return N
    return normalize(w)


def uniform_sphere(x, k_d, N, scene, rng):
    w = hemisphere_sphere(N, rng.square())
    if shadow_toward(scene, x, w):
        return black
    return scene.environment.eval(w) * (k_d * (dot(w, N) * TWO_PI))


def cosine_sphere(x, k_d, N, scene, rng):
    w = cos_hemisphere_sphere(N, rng.square())
    if shadow_toward(scene, x, w):
        return black
    return scene.environment.eval(w) * (k_d * PI)


# mirrored at the horizon; rotated with a matrix
def hemisphere_flipped(N, u):
    w = on_sphere((u[1], u[0]))
    c = dot(w, N)
    return w - N * (2.0 * c) if c < 0.0 else w


def cos_hemisphere_flipped(N, u):
    m = np.zeros((3, 3))
    s, t = frame(N)
    m[0, 0], m[1, 0], m[2, 0] = s.x, s.y, s.z
    m[0, 1], m[1, 1], m[2, 1] = t.x, t.y, t.z
    m[0, 2], m[1, 2], m[2, 2] = N.x, N.y, N.z
    r = math.sqrt(u[0])
    v = (r * math.cos(TWO_PI * u[1]), r * math.sin(TWO_PI * u[1]), math.sqrt(1.0 - r * r))
    w = [0.0, 0.0, 0.0]
    for i in range(3):
        for j in range(3):
            w[i] += m[i, j] * v[j]
    return Vec3(w[0], w[1], w[2])


def uniform_flipped(x, k_d, N, scene, rng):
    sky = scene.environment
    w = hemisphere_flipped(N, rng.square())
    c = max(0.0, dot(w, N))
    if c == 0.0 or shadow_toward(scene, x, w):
        return black
    L = sky.eval(w)
    return Vec3(L.x * k_d.x, L.y * k_d.y, L.z * k_d.z) * c * TWO_PI


def cosine_flipped(x, k_d, N, scene, rng):
    sky = scene.environment
    w = cos_hemisphere_flipped(N, rng.square())
    if shadow_toward(scene, x, w):
        return black
    L = sky.eval(w)
    return Vec3(L.x * k_d.x, L.y * k_d.y, L.z * k_d.z) * PI


# a disk that keeps squares together, lifted
def disk(u):
    a, b = 2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0
    if a == 0.0 and b == 0.0:
        return 0.0, 0.0
    if abs(a) > abs(b):
        r, phi = a, PI / 4 * b / a
    else:
        r, phi = b, PI / 2 - PI / 4 * a / b
    return r * math.cos(phi), r * math.sin(phi)


def hemisphere_disk(N, u):
    x, y = disk(u)
    rr = x * x + y * y
    stretch = math.sqrt(2.0 - rr)
    return from_frame(N, x * stretch, y * stretch, 1.0 - rr)


def cos_hemisphere_disk(N, u):
    x, y = disk(u)
    return from_frame(N, x, y, math.sqrt(max(0.0, 1.0 - x * x - y * y)))


def uniform_disk(x, k_d, N, scene, rng):
    w = hemisphere_disk(N, rng.square())
    g = scene.environment.eval(w) * k_d * dot(w, N) * 2.0 * PI
    if shadow_toward(scene, x, w):
        g = black
    return g


def cosine_disk(x, k_d, N, scene, rng):
    w = cos_hemisphere_disk(N, rng.square())
    g = scene.environment.eval(w) * k_d * PI
    if shadow_toward(scene, x, w):
        g = black
    return g


# vectors by hand
def hemisphere_by_hand(N, u):
    s, t = frame(N)
    z, phi = u[0], TWO_PI * u[1]
    r = (1.0 - z * z) ** 0.5
    a, b = r * np.cos(phi), r * np.sin(phi)
    return Vec3(a * s.x + b * t.x + z * N.x, a * s.y + b * t.y + z * N.y, a * s.z + b * t.z + z * N.z)


def cos_hemisphere_by_hand(N, u):
    s, t = frame(N)
    phi = TWO_PI * u[1]
    a, b, z = u[0] ** 0.5 * np.cos(phi), u[0] ** 0.5 * np.sin(phi), (1.0 - u[0]) ** 0.5
    return Vec3(a * s.x + b * t.x + z * N.x, a * s.y + b * t.y + z * N.y, a * s.z + b * t.z + z * N.z)


def uniform_by_hand(x, k_d, N, scene, rng):
    w = hemisphere_by_hand(N, rng.square())
    if shadow_toward(scene, x, w):
        return Vec3(0, 0, 0)
    L = scene.environment.eval(w)
    c = 2 * np.pi * (w.x * N.x + w.y * N.y + w.z * N.z)
    return Vec3(L.x * k_d.x * c, L.y * k_d.y * c, L.z * k_d.z * c)


def cosine_by_hand(x, k_d, N, scene, rng):
    w = cos_hemisphere_by_hand(N, rng.square())
    if shadow_toward(scene, x, w):
        return Vec3(0, 0, 0)
    L = scene.environment.eval(w)
    return Vec3(L.x * k_d.x * np.pi, L.y * k_d.y * np.pi, L.z * k_d.z * np.pi)


# the z axis mirrored onto N
def reflected(N, x, y, z):
    h = Vec3(N.x, N.y, N.z - 1.0)
    hh = dot(h, h)
    v = Vec3(x, y, z)
    return v if hh < 1e-12 else v - h * (2.0 * dot(h, v) / hh)


def hemisphere_reflected(N, u):
    r, phi = math.sqrt(u[0] * (2.0 - u[0])), TWO_PI * u[1]
    return normalize(reflected(N, r * math.cos(phi), r * math.sin(phi), 1.0 - u[0]))


def cos_hemisphere_reflected(N, u):
    r, phi = math.sqrt(1.0 - u[0]), TWO_PI * u[1]
    return normalize(reflected(N, r * math.cos(phi), r * math.sin(phi), math.sqrt(u[0])))


def gathered(scene, x, w, weight):
    return black if shadow_toward(scene, x, w) else weight * scene.environment.eval(w)


def uniform_reflected(x, k_d, N, scene, rng):
    w = hemisphere_reflected(N, rng.square())
    return gathered(scene, x, w, k_d * (max(0, dot(w, N)) * TWO_PI))


def cosine_reflected(x, k_d, N, scene, rng):
    return gathered(scene, x, cos_hemisphere_reflected(N, rng.square()), k_d * PI)
