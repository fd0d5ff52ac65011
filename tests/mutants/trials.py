"""Trials: a point under a light, the light that leaves it by a closed form, and a bound that no correct sample passes.

All quantities are relative: a sample is the mean over the three channels of value / truth, so the truth is 1. Colours
differ between the channels, the normal is no axis, nothing is a unit square: what is generic hides no mistake.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from raylab import description as d
from raylab.closed_forms import blur, irradiance, phong

RHO, L = np.array([0.75, 0.5, 0.3]), np.array([3.0, 2.0, 4.0])
ERROR = 1e-4  # of a truth: lights and receiver stand where float32 puts them


@dataclass(frozen=True)
class Trial:
    """`shapes` above a small receiver at the origin with normal `n`; `truth` is the radiance of each channel."""

    shade: str
    truth: Any
    high: float  # largest sample, relative to the truth
    shapes: tuple[d.Shape, ...] = ()
    n: Any = (0.0, 0.0, 1.0)
    material: Any = field(default_factory=lambda: d.Diffuse(RHO))
    environment: Any = None
    lights: tuple[d.Light, ...] = ()
    view: Any = None
    variance: float | None = None  # of a sample, relative to the squared truth, where it is known
    atoms: bool = False  # a right sample may have some value other than 0 again and again


def unit(*v: float) -> np.ndarray:
    return np.array(v) / np.linalg.norm(v)


def frame(n: Any) -> np.ndarray:
    """Rows: two unit vectors and n, right-handed."""
    n = np.asarray(n, float)
    s = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
    s /= np.linalg.norm(s)
    return np.stack([s, np.cross(n, s), n])


def affine(linear: Any, offset: Any) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, offset
    return matrix


def mesh(points: Any, radiance: Any = None, **more: Any) -> d.Mesh:
    """A fan; the side from which its corners run counterclockwise shines."""
    faces = np.array([[0, i, i + 1] for i in range(1, len(points) - 1)])
    return d.Mesh(vertices=np.array(points, float), faces=faces, radiance=radiance, **{"front": None, **more})


def rectangle(corner: Any, a: Any, b: Any, radiance: Any = L) -> d.Rectangle:
    """Edges a, b from the corner, at right angles; it shines to the side of a x b."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    normal = np.cross(a, b)
    linear = np.stack([a / 2, b / 2, normal / np.linalg.norm(normal)], axis=1)
    return d.Rectangle(to_world=affine(linear, np.asarray(corner) + (a + b) / 2), radiance=radiance, front=None)


def corners(corner: Any, a: Any, b: Any) -> np.ndarray:
    corner, a, b = (np.asarray(v, float) for v in (corner, a, b))
    return np.array([corner, corner + a, corner + a + b, corner + b])


STEPS = 400


def highest(corner: Any, a: Any, b: Any, n: Any, share: float = 1.0) -> float:
    """Largest cos cos A / r^2 over a parallelogram (or share of it): on a grid, and 2 % for what lies between."""
    corner, a, b = (np.asarray(v, float) for v in (corner, a, b))
    normal = np.cross(a, b)
    u, v = np.meshgrid(*[np.linspace(0.0, 1.0, STEPS)] * 2)
    y = corner + u[..., None] * a + v[..., None] * b
    r2 = (y * y).sum(-1)
    cosines = np.maximum(0, y @ np.asarray(n)) * np.maximum(0, -(y @ normal))
    return 1.02 * share * float((cosines / r2**2).max())


def leaving(irradiances: Any) -> np.ndarray:
    return RHO * L * np.asarray(irradiances) / math.pi


N1 = unit(0.36, 0.2, 0.9)
A1, B1 = unit(0.25, 0.9, 0.3), np.cross(unit(0.25, 0.9, 0.3), unit(0.2, 0.25, -1.0))
B1 /= np.linalg.norm(B1)
RECT = (np.array([-0.9, -0.5, 1.3]), 1.1 * A1, -1.4 * B1)  # corner, edges: tilted, and above the horizon of N1
if np.cross(RECT[1], RECT[2])[2] > 0.0:
    RECT = (RECT[0], RECT[2], RECT[1])


def area_rectangle(shade: str = "area_diffuse") -> Trial:
    """Slide "Area source by Monte Carlo (diffuse)": a tilted rectangle over a tilted receiver."""
    truth = float(irradiance.polygon(corners(*RECT), n=N1))
    return Trial(shade, leaving(truth), highest(*RECT, N1) / truth, (rectangle(*RECT),), N1)


def small_rectangle() -> Trial:
    """The same, 30 times as large: powers of lengths that a size of about 1 hides."""
    big = tuple(30.0 * v for v in RECT)
    truth = float(irradiance.polygon(corners(*big), n=N1))
    return Trial("area_diffuse", leaving(truth), highest(*big, N1) / truth, (rectangle(*big),), N1)


def solid_angle_rectangle() -> Trial:
    """Slide "Area source by Monte Carlo", uniform in solid angle: a sample is at most Omega max cos(theta)."""
    truth = float(irradiance.polygon(corners(*RECT), n=N1))
    p = corners(*RECT)
    omega = sum(abs(phong._solid_angle(t)) for t in (p[[0, 1, 2]], p[[0, 2, 3]]))
    return Trial("area_solid_angle", leaving(truth), omega / truth, (rectangle(*RECT),), N1)


LOW = (np.array([0.7, -0.5, -0.8]), np.array([0.0, 0.0, 1.4]), np.array([0.0, 1.0, 0.0]))


def horizon() -> Trial:
    """A light that goes down through the horizon."""
    n = np.array([0.0, 0.0, 1.0])
    corner, a, b = LOW
    if np.cross(a, b)[0] > 0.0:
        a, b = b, a
    truth = float(irradiance.polygon(corners(corner, a, b), n=n))
    return Trial("area_diffuse", leaving(truth), highest(corner, a, b, n) / truth, (rectangle(corner, a, b),), n)


def facing_away() -> Trial:
    """The rectangle, and a second light that turns its back on the point."""
    one = area_rectangle()
    back = rectangle((1.0, -0.6, 0.8), (0.0, 0.8, 0.0), (-0.3, 0.0, 0.6))
    normal = np.cross((0.0, 0.8, 0.0), (-0.3, 0.0, 0.6))
    if normal @ np.array([1.0, -0.6, 0.8]) < 0.0:
        back = rectangle((1.0, -0.6, 0.8), (-0.3, 0.0, 0.6), (0.0, 0.8, 0.0))
    return Trial("area_diffuse", one.truth, one.high, (*one.shapes, back), N1)


CENTRED = (np.array([-1.0, 0.5, 1.0]), np.array([2.0, 0.0, 0.0]), np.array([0.0, -1.0, 0.0]))


def blocked(behind: bool = False, thin: bool = False) -> Trial:
    """Half of the light behind an opaque half plane; with `behind`, another blocker beyond the light."""
    n = np.array([0.0, 0.0, 1.0])
    edge = irradiance.behind_edge(np.zeros(3), (0.1, 0.0, 0.5), (0.1, 1.0, 0.5), (-1.0, 0.0, 1.0))
    truth = float(irradiance.polygon(corners(*CENTRED), n=n, keep=[edge]))
    shapes = [rectangle(*CENTRED), mesh([(0.1, -9, 0.5), (9, -9, 0.5), (9, 9, 0.5), (0.1, 9, 0.5)])]
    if behind:
        shapes.append(mesh([(-2, -2, 1.4), (0, -2, 1.4), (0, 2, 1.4), (-2, 2, 1.4)]))
    if thin:  # nearer than 0.05, and no wider than a twentieth of the light seen from here
        edge = irradiance.behind_edge(np.zeros(3), (0.004, 0.0, 0.02), (0.004, 1.0, 0.02), (-1.0, 0.0, 1.0))
        truth = float(irradiance.polygon(corners(*CENTRED), n=n, keep=[edge]))
        shapes[1] = mesh([(0.004, -1, 0.02), (1, -1, 0.02), (1, 1, 0.02), (0.004, 1, 0.02)])
    return Trial("area_diffuse", leaving(truth), highest(*CENTRED, n) / truth, tuple(shapes), n)


def two_lights() -> Trial:
    """Two rectangles of different size and brightness."""
    n = N1
    second = (np.array([-1.5, 0.2, 0.9]), np.array([0.0, 1.2, 0.3]), np.array([0.1, -0.06, 0.24]))
    a, b = second[1], second[2] - second[1] * (second[2] @ second[1]) / (second[1] @ second[1])
    if np.cross(a, b) @ second[0] > 0.0:
        a, b = b, a
    second = (second[0], a, b)
    e1, e2 = (float(irradiance.polygon(corners(*s), n=n)) for s in (RECT, second))
    bright = 4.0
    truth = e1 + bright * e2
    high = (highest(*RECT, n) + bright * highest(*second, n)) / truth
    return Trial("area_diffuse", leaving(truth), high, (rectangle(*RECT), rectangle(*second, radiance=bright * L)), n)


def lights_by_power() -> Trial:
    """Two rectangles, of which one is chosen: nine times in ten the brighter one."""
    both = two_lights()
    one, two = both.shapes
    area, powers = (lambda s: 4.0 * float(np.prod(np.linalg.norm(s.to_world[:3, :2], axis=0)))), []
    for shape in (one, two):
        powers.append(area(shape) * float(shape.radiance[0]))
    # a sample is at most the bound of one light over its share, and the sum of the bounds is known
    return replace(both, shade="one_light_power", high=both.high * sum(powers) / min(powers))


def triangle() -> Trial:
    corner, a, b = np.array([0.1, 0.8, 0.7]), np.array([0.8, -0.9, 0.4]), np.array([-0.4, -1.3, -0.1])
    n = np.array([0.0, 0.0, 1.0])
    points = [corner, corner + a, corner + b]
    truth = float(irradiance.polygon(points, n=n))
    return Trial("area_diffuse", leaving(truth), highest(corner, a, b, n, 0.5) / truth, (mesh(points, L),), n)


def disk() -> Trial:
    """A disk parallel to the receiver, off its axis."""
    n, r, h, offset = np.array([0.0, 0.0, 1.0]), 0.8, 1.0, 0.6
    truth = irradiance.disk_parallel(r, h, offset)
    turned = affine(np.diag([r, -r, -1.0]), (offset * 0.6, offset * 0.8, h))
    shape = d.Disk(to_world=turned, radiance=L, front=None)
    return Trial("area_diffuse", leaving(truth), math.pi * r * r / h**2 / truth, (shape,), n)


def ball() -> Trial:
    """A sphere seen from outside: uniform in its cone."""
    radius, centre = 0.8, 2.0 * unit(0.3, 0.5, 0.9)
    cosine = float(unit(0.3, 0.5, 0.9) @ N1)
    truth = float(irradiance.sphere(radius, 2.0, cosine))
    omega = 2.0 * math.pi * (1.0 - math.sqrt(1.0 - (radius / 2.0) ** 2))
    shape = d.Sphere(center=centre, radius=radius, radiance=L, front=None)
    return Trial("area_diffuse", leaving(truth), omega / truth, (shape,), N1)


def inside_ball() -> Trial:
    """In a glowing sphere: E = pi; a sample is A cos cos / r^2 with |y| >= R - d."""
    radius, off = 1.5, np.array([0.2, 0.1, -0.3])
    shape = d.Sphere(center=off, radius=radius, radiance=L, front=None, flip_normals=True)
    area = 4.0 * math.pi * radius**2
    nearest = radius - float(np.linalg.norm(off))
    return Trial("area_diffuse", leaving(math.pi), area / nearest**2 / math.pi, (shape,), N1)


def moving() -> Trial:
    """Slide "Motion blur": a disk light that rises evenly above the point while the shutter is open."""
    radius, first, last = 1.5, 1.0, 3.0
    truth = math.pi * blur.moving_disk_light(radius, first, last)
    places = [affine(np.diag([radius, -radius, -1.0]), (0.0, 0.0, h)) for h in (first, last)]
    motion = d.Animation(np.array([0.0, 1.0]), np.stack(places))
    shape = d.Disk(to_world=places[0], motion=motion, radiance=L, front=None)
    return Trial("area_diffuse", leaving(truth), math.pi * radius**2 / first**2 / truth, (shape,))


# --- skies ---

NS, SLOPE, LEVEL = unit(0.48, 0.6, 0.64), np.array([0.36, -0.24, 0.6]), 1.1


def hemisphere(n: Any, f: Callable[[Any], Any], z_order: int = 24, turns: int = 64) -> float:
    """The integral of f(w) over the hemisphere around n: exact for polynomials of degree 24."""
    x, weight = np.polynomial.legendre.leggauss(z_order)
    z, phi = 0.5 * (x + 1.0), 2.0 * np.pi * np.arange(turns) / turns
    r = np.sqrt(1.0 - z * z)
    local = np.stack(np.broadcast_arrays(r[:, None] * np.cos(phi), r[:, None] * np.sin(phi), z[:, None]), axis=-1)
    return float((f(local @ frame(n)) * (0.5 * weight)[:, None]).sum() * 2.0 * np.pi / turns)


def sky(shade: str) -> Trial:
    """Slide "Diffuse surface in env. by Monte Carlo": L(w) = a + b . w, the same in each channel but for its colour."""
    environment = d.GradientEnvironment(LEVEL * L, L[:, None] * SLOPE)
    truth = float(irradiance.gradient_sky(LEVEL, SLOPE, NS))
    largest = LEVEL + float(np.linalg.norm(SLOPE))
    pdfs = {  # 1 / p, and the largest of cos / p
        "env_uniform": (lambda w: 2.0 * np.pi + 0.0 * (w @ NS), 2.0 * math.pi * largest),
        "env_cosine": (lambda w: np.pi / (w @ NS), math.pi * largest),
        "env_brdf": (lambda w: np.pi / (w @ NS), math.pi * largest),
        "env_brightness": (lambda w: 4.0 * np.pi * LEVEL / (LEVEL + w @ SLOPE), 4.0 * math.pi * LEVEL),
    }
    inverse, high = pdfs[shade]
    second = hemisphere(NS, lambda w: ((LEVEL + w @ SLOPE) * (w @ NS)) ** 2 * inverse(w))
    return Trial(
        shade, leaving(truth), high / truth, _far_dark(), NS, environment=environment, variance=second / truth**2 - 1.0
    )


def _far_dark() -> tuple[d.Shape, ...]:
    """Something below the horizon that blocks nothing: a scene must hold more than its receiver."""
    return (mesh([(-0.2, 0, -3), (0.2, 0, -3), (0, 0.2, -3.0)]),)


def blocked_sky(shade: str = "env_cosine") -> Trial:
    """A constant sky behind a black ball."""
    radius, distance, to = 1.0, 1.9, unit(0.3, 0.2, 0.9)
    truth = float(irradiance.sphere_before_sky(radius, distance, float(to @ N1)))
    ball = d.Sphere(center=distance * to, radius=radius, front=None)
    high = {"env_cosine": math.pi, "env_uniform": 2.0 * math.pi}[shade]
    sky = d.ConstantEnvironment(L)
    return Trial(shade, leaving(truth), high / truth, (ball,), N1, environment=sky, atoms=shade == "env_cosine")


def image_sky(filter: str = "nearest") -> Trial:
    """An image sampled by its brightness: dark below 60 degrees, so that E is a sum over texels."""
    height, width = 16, 32
    rng = np.random.default_rng(5)
    values = rng.uniform(0.2, 2.0, (height, width))
    values[4, 7], values[2, 20] = 40.0, 15.0
    values[5:] = 0.0
    tilt = unit(0.25, -0.2, 1.0)
    v, omega = irradiance.texels(height, width)
    # Mitsuba's image: row 0 at local +y; longitude from -z towards +x. Local +y is world +z here.
    to_world = affine(np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), (0, 0, 0))
    truth = float((values * (v @ tilt)).sum())
    high = float((values * omega).sum()) / truth
    pixels = (values[..., None] * L).astype(np.float64)
    environment = d.ImageEnvironment(pixels, to_world, filter)
    return Trial("env_brightness", leaving(truth), high, _far_dark(), tilt, environment=environment)


def image_breaks() -> dict[str, Any]:
    """Where the texels of `image_sky` have their edges, about its pole."""
    rows, columns = np.cos(np.pi * np.arange(1, 16) / 16), np.pi * (np.arange(1, 32) / 16 - 1.0)
    return {"axis": (0.0, 0.0, 1.0), "rows": tuple(rows), "columns": tuple(columns)}


def lobe_sky() -> Trial:
    """A lobe seen aslant under a constant sky, sampled by itself: k_s (n + 2) / (n + 1) at most."""
    n, cosine = 10, 0.3
    k_s = np.array([0.8, 0.6, 0.9])
    truth = k_s * L * phong.constant_sky(n, cosine)
    s, _, up = frame(N1)
    view = cosine * up + math.sqrt(1.0 - cosine**2) * s
    material = d.Phong(np.zeros(3), k_s, float(n))
    high = (n + 2.0) / (n + 1.0) / phong.constant_sky(n, cosine)
    return Trial("env_brdf", truth, high, _far_dark(), N1, material, d.ConstantEnvironment(L), view=view)


def mixture_sky() -> Trial:
    """Diffuse and lobe, seen along the normal, under a gradient about it."""
    n, a, b = 10, 1.1, 0.5
    k_d, k_s = np.full(3, 0.4), np.full(3, 0.5)
    one = 0.4 * (a + 2.0 * b / 3.0) + 0.5 * phong.gradient_sky(n, a, b)
    environment = d.GradientEnvironment(a * L, L[:, None] * (b * N1))
    high = max(0.4 / (4 / 9), 0.5 / (5 / 9) * (n + 2.0) / (n + 1.0)) * (a + b) / one
    return Trial("env_brdf", one * L, high, _far_dark(), N1, d.Phong(k_d, k_s, float(n)), environment, view=N1)


def combined(shade: str = "direct") -> Trial:
    """Two methods of sampling weighed against each other: a lobe and a diffuse part under a rectangle."""
    n, (corner, a, b) = 12, RECT
    k_d, k_s = 0.3 * np.ones(3), 0.6 * np.ones(3)
    mirror = unit(-0.1, 0.1, 1.0)
    normal = N1
    view = 2.0 * (mirror @ normal) * normal - mirror
    e = float(irradiance.polygon(corners(corner, a, b), n=normal))
    lobe = phong.polygon(corners(corner, a, b), n, mirror, normal)
    one = 0.3 * e / math.pi + 0.6 * lobe
    # both samples are f / (p + p'), each at most f / p of its own: cos A / (pi r^2) times the lobe, and the albedo
    by_light = highest(corner, a, b, normal) / math.pi * (0.3 + 0.6 * (n + 2) / 2.0)
    by_brdf = 0.3 * 3.0 + 0.6 * 1.5 * (n + 2.0) / (n + 1.0)
    shapes = (rectangle(*RECT),)
    return Trial(shade, one * L, (by_light + by_brdf) / one, shapes, N1, d.Phong(k_d, k_s, float(n)), view=view)


# --- lights without area: step 1 of both "Illumination as integration" slides ---


def point() -> Trial:
    y = np.array([1.0, 0.7, 1.9])
    truth = RHO / math.pi * L * float(irradiance.point_light(y, n=N1))
    return Trial("point_light", truth, 1.001, _far_dark(), N1, lights=(d.PointLight(y, L),), atoms=True)


def sun() -> Trial:
    w = unit(0.6, -0.2, 0.8)
    truth = RHO / math.pi * L * float(irradiance.directional_light(w, N1))
    return Trial("directional_light", truth, 1.001, _far_dark(), N1, lights=(d.DirectionalLight(-w, L),), atoms=True)


TRIALS: dict[str, Callable[[], Trial]] = {
    "rectangle": area_rectangle,
    "large rectangle": small_rectangle,
    "rectangle, any BRDF": lambda: area_rectangle("area"),
    "rectangle, solid angle": solid_angle_rectangle,
    "horizon": horizon,
    "facing away": facing_away,
    "blocked": blocked,
    "blocked, and one behind": lambda: blocked(behind=True),
    "blocked nearby": lambda: blocked(thin=True),
    "two lights": two_lights,
    "lights by power": lights_by_power,
    "triangle": triangle,
    "disk": disk,
    "ball": ball,
    "inside a ball": inside_ball,
    "moving light": moving,
    "sky, uniform": lambda: sky("env_uniform"),
    "sky, cosine": lambda: sky("env_cosine"),
    "sky, brdf": lambda: sky("env_brdf"),
    "sky, brightness": lambda: sky("env_brightness"),
    "blocked sky": blocked_sky,
    "image": image_sky,
    "lobe": lobe_sky,
    "diffuse and lobe": mixture_sky,
    "two methods": combined,
    "point": point,
    "point, directly": lambda: replace(point(), shade="direct"),
    "sun": sun,
}
