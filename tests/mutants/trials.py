"""Trials of all kinds, by name: a point under area lights of each shape, under the skies, under lights without area."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from mutants.sky_trials import blocked_sky, image_sky, lobe_sky, mixture_sky, sky
from mutants.trial import N1, RECT, RHO, L, Trial, affine, corners, far_dark, highest, leaving, mesh, rectangle, unit
from raylab import description as d
from raylab.closed_forms import blur, irradiance, phong


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
    return Trial("point_light", truth, 1.001, far_dark(), N1, lights=(d.PointLight(y, L),), atoms=True)


def sun() -> Trial:
    w = unit(0.6, -0.2, 0.8)
    truth = RHO / math.pi * L * float(irradiance.directional_light(w, N1))
    return Trial("directional_light", truth, 1.001, far_dark(), N1, lights=(d.DirectionalLight(-w, L),), atoms=True)


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
