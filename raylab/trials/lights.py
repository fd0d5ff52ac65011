"""Trials under lights: points and suns, polygons, round lights. x is the origin, its normal +z, before the move.

Bounds of one sample, for a light of radiance L at the least distance r_min, whose plane is h away from x:

    uniform in area, p = 1 / A:       L f_r cos(theta_r) cos(theta_s) A / r^2  <=  L f_r A h / r_min^3
    uniform in solid angle, p = 1/Omega:  L f_r cos(theta_r) Omega  <=  the same, as Omega <= A h / r_min^3
    sphere by its cone:                <= L f_r 2 pi (1 - cos theta_max)
    BRDF sampling of a diffuse surface with a lobe, k_d / k_s chosen with probabilities D, 1 - D:
        L f_r cos / p  <=  L max(pi k_d / D, k_s (n + 2) / ((n + 1) (1 - D)))      (mediant inequality)
    two techniques combined by a heuristic, whose weights are at most 1: no more than the sum of both bounds
    one light i of many with probability q_i: the largest bound_i / q_i;  q_i = 1 / n, or in proportion to A L
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from raylab import description as d
from raylab.closed_forms import irradiance as forms
from raylab.closed_forms import phong
from raylab.trials.polygon import area_of, box, corners_in, facing, polygon, steepness
from raylab.trials.trial import BLACK, LUMINANCE, Answer, Array, Trial, X, Z, affine, colour, stage, unit

# --- bounds ---


def by_brdf(light: Array, diffuse: Array, specular: Array, n: int) -> Array:
    """The bound of BRDF sampling, see above; `diffuse` and `specular` are reflectances."""
    both = float(LUMINANCE @ diffuse + LUMINANCE @ specular)
    share = float(LUMINANCE @ diffuse) / both
    lobe = specular * (n + 2) / ((n + 1) * (1.0 - share)) if share < 1.0 else BLACK
    return light * np.maximum(diffuse / share, lobe)


def by_all(truth: Array, bounds: Array, brdf: Array, powers: Sequence[float]) -> dict[str, Answer]:
    """Answers of all techniques for area lights: `bounds` (lights, 3) by area, `brdf` (3,) by the BRDF."""
    total, q = bounds.sum(axis=0), np.asarray(powers) / np.sum(powers)
    answers = {name: Answer.of(truth, total) for name in ("area_diffuse", "area", "area_solid_angle")}
    answers |= {name: Answer.of(truth, total + brdf) for name in ("direct", "mis_balance", "mis_power")}
    answers["one_light_uniform"] = Answer.of(truth, len(bounds) * bounds.max(axis=0))
    answers["one_light_power"] = Answer.of(truth, (bounds / q[:, None]).max(axis=0))
    return answers


# --- lights without area ---


def points_and_suns(rng: np.random.Generator, glossy: bool = False) -> Trial:
    """Three points and three suns: one of each to be seen, one behind a screen, one below the horizon. Exact."""
    view = unit(rng.uniform(35, 60), rng.uniform(0, 360))
    diffuse, n = colour(rng, 0.1, 0.5), int(2 * rng.integers(1, 5) + 1)
    specular = colour(rng, 0.1, 0.5) if glossy else BLACK
    material: d.Material = d.Phong(diffuse, specular, float(n)) if glossy else d.Diffuse(diffuse)
    turn = rng.uniform(0, 360)
    seen, hidden, below = unit(rng.uniform(30, 60), turn), unit(60, turn + 180), unit(-20, turn + 90)
    sun, shaded, set_ = unit(rng.uniform(25, 50), turn + 40), unit(55, turn + 185), unit(-30, turn)
    colours = [colour(rng, 0.5, 5.0) for _ in range(6)]
    y = rng.uniform(1.2, 2.0) * seen
    lights = (
        d.PointLight(y, colours[0]), d.PointLight(2.0 * hidden, colours[1]), d.PointLight(1.5 * below, colours[2]),
        d.DirectionalLight(-sun, colours[3]), d.DirectionalLight(-shaded, colours[4]),
        d.DirectionalLight(-set_, colours[5]),
    )  # fmt: skip
    screen = polygon(corners_in(facing(rng, 57.5, turn + 182.5, 0.6, 0.0), box(0.2, 0.2)), None)
    r = 2.0 * view[2] * Z - view

    def f_r(w: Array) -> Array:
        return diffuse / math.pi + specular * (n + 2) / (2.0 * math.pi) * max(0.0, float(r @ w)) ** n

    points = colours[0] * f_r(seen) * float(forms.point_light(y))
    suns = colours[3] * f_r(sun) * sun[2]
    sums = {"point_light": points, "directional_light": suns, "direct": points + suns, "basic": points + suns}
    answers = {name: Answer.of(truth, truth) for name, truth in sums.items()}
    return stage(
        "glossy_points_and_suns" if glossy else "points_and_suns",
        rng, answers, material=material, shapes=(screen,), lights=lights, view=view,
    )  # fmt: skip


# --- area lights ---


def polygons(rng: np.random.Generator) -> Trial:
    """A rectangle half behind a screen with a slanted edge, a triangle through the horizon, a rectangle turned away."""
    reflectance, turn = colour(rng), rng.uniform(0, 360)
    a, b = rng.uniform(0.25, 0.45), rng.uniform(0.2, 0.4)
    plane = facing(rng, rng.uniform(55, 70), turn, rng.uniform(1.0, 1.5), 20.0)
    lamp, (screen, keep) = corners_in(plane, box(a, b)), screen_before(rng, plane, a, b)
    triangle = corners_in(
        facing(rng, rng.uniform(0, 12), turn + rng.uniform(120, 140), rng.uniform(1.1, 1.5), 20.0),
        [(0.5, 0.1), (-0.3, 0.45), (-0.2, -0.5)],
    )
    back = corners_in(facing(rng, 45.0, turn + 240.0, 1.3, 20.0), box(0.3, 0.2))[::-1]
    colours = [colour(rng, 0.5, 5.0) for _ in range(3)]
    truth = colours[0] * float(forms.polygon(lamp, keep=[keep])) + colours[1] * float(forms.polygon(triangle))
    f_r, lights = reflectance / math.pi, list(zip((lamp, triangle, back), colours, strict=True))
    bounds = np.array([f_r * c * steepness(p) for p, c in lights])
    powers = [area_of(p) * float(LUMINANCE @ c) for p, c in lights]
    answers = by_all(f_r * truth, bounds, reflectance * np.max(colours, axis=0), powers)
    shapes = (
        polygon(lamp, colours[0]), polygon(triangle, colours[1]), polygon(back, colours[2]), polygon(screen, None),
    )  # fmt: skip
    return stage("polygons", rng, answers, material=d.Diffuse(reflectance), shapes=shapes, view=unit(50, turn + 20))


def screen_before(rng: np.random.Generator, plane: Array, a: float, b: float) -> tuple[Array, tuple[Array, Array]]:
    """A screen about halfway to a rectangle of half edges a, b that hides its part beyond a slanted line.

    In the plane of the light the screen's shadow reaches from the line to a distance 3 a, far beyond the light.
    Returns its corners, and the half space that can be seen.
    """
    angle, start = math.radians(rng.uniform(-25, 25)), rng.uniform(-0.3, 0.3) * a
    along, across = np.array([-math.sin(angle), math.cos(angle)]), np.array([math.cos(angle), math.sin(angle)])
    p = np.array([start, 0.0])
    ends = [p - 2.0 * (a + b) * along, p + 2.0 * (a + b) * along]
    shadow = [ends[0], ends[0] + 3.0 * a * across, ends[1] + 3.0 * a * across, ends[1]]
    corners = rng.uniform(0.4, 0.6) * corners_in(plane, [(s, t) for s, t in shadow])
    lit = corners_in(plane, [tuple(p - a * across)])[0]
    return corners, forms.behind_edge(BLACK, corners[0], corners[3], lit)


def round_lights(rng: np.random.Generator) -> Trial:
    """A sphere cut by the horizon, a level disk off the axis and an upright disk."""
    reflectance, turn = colour(rng), rng.uniform(0, 360)
    distance, radius, elevation = rng.uniform(1.5, 2.2), rng.uniform(0.4, 0.7), rng.uniform(-12, 12)
    level, height, offset = rng.uniform(0.4, 0.6), rng.uniform(1.0, 1.4), rng.uniform(0.3, 0.7)
    upright, far, up = rng.uniform(0.3, 0.5), rng.uniform(1.2, 1.6), rng.uniform(0.8, 1.1)
    colours = [colour(rng, 0.5, 5.0) for _ in range(3)]
    centre, side = distance * unit(elevation, turn), offset * unit(0, turn + 90) + height * Z
    wall = far * unit(0, turn + 180) + up * Z
    shapes = (
        d.Sphere(center=centre, radius=radius, radiance=colours[0], front=None),
        _disk(side, -Z, level, colours[1]),
        _disk(wall, unit(0, turn), upright, colours[2]),
    )
    sine = radius / distance
    truth = (
        colours[0] * float(forms.sphere(radius, distance, math.sin(math.radians(elevation))))
        + colours[1] * forms.disk_parallel(level, height, offset)
        + colours[2] * forms.disk_perpendicular(upright, far, up)
    )
    steep = (
        2.0 * math.pi * (1.0 - math.sqrt(1.0 - sine * sine)),
        math.pi * level**2 * height / math.hypot(height, max(0.0, offset - level)) ** 3,
        math.pi * upright**2 * far / math.hypot(far, max(0.0, up - upright)) ** 3,
    )
    f_r, areas = reflectance / math.pi, (4.0 * radius**2, level**2, upright**2)
    bounds = np.array([f_r * c * s for c, s in zip(colours, steep, strict=True)])
    powers = [a * float(LUMINANCE @ c) for a, c in zip(areas, colours, strict=True)]
    answers = by_all(f_r * truth, bounds, reflectance * np.max(colours, axis=0), powers)
    return stage("round_lights", rng, answers, material=d.Diffuse(reflectance), shapes=shapes, view=unit(60, turn + 30))


def _disk(centre: Array, n: Array, radius: float, radiance: Array) -> d.Disk:
    a = X if abs(n[2]) > 0.5 else Z
    b = np.cross(n, a)
    return d.Disk(to_world=affine(np.stack([a, b, n], axis=1) @ np.diag([radius, radius, 1.0]), centre),
                  radiance=radiance, front=None)  # fmt: skip


def glossy_polygons(rng: np.random.Generator) -> Trial:
    """A surface with a lobe of odd exponent, seen askew, under a rectangle near its mirror direction and a triangle."""
    diffuse, specular, n = colour(rng, 0.1, 0.5), colour(rng, 0.1, 0.5), int(2 * rng.integers(1, 5) + 1)
    turn, tilt = rng.uniform(0, 360), rng.uniform(30, 55)
    view, r = unit(tilt, turn + 180), unit(tilt, turn)
    lamp = corners_in(facing(rng, tilt + rng.uniform(-10, 20), turn, rng.uniform(1.1, 1.5), 20.0), box(0.45, 0.3))
    triangle = corners_in(facing(rng, 10.0, turn + 110.0, 1.3, 20.0), [(0.5, 0.1), (-0.3, 0.45), (-0.2, -0.5)])
    colours = [colour(rng, 0.5, 5.0) for _ in range(2)]
    lights = list(zip((lamp, triangle), colours, strict=True))
    lobe = specular * np.sum([c * phong.polygon(p, n, r) for p, c in lights], axis=0)
    truth = lobe + diffuse / math.pi * np.sum([c * float(forms.polygon(p)) for p, c in lights], axis=0)
    largest = diffuse / math.pi + specular * (n + 2) / (2.0 * math.pi)
    bounds, brightest = np.array([c * largest * steepness(p) for p, c in lights]), np.maximum(*colours)
    powers = [area_of(p) * float(LUMINANCE @ c) for p, c in lights]
    answers = by_all(truth, bounds, by_brdf(brightest, diffuse, specular, n), powers)
    del answers["area_diffuse"]
    answers["glossy_phong"] = Answer.of(lobe, brightest * specular * (n + 2) / (n + 1))
    shapes = tuple(polygon(p, c) for p, c in lights)
    return stage(
        "glossy_polygons", rng, answers, material=d.Phong(diffuse, specular, float(n)), shapes=shapes, view=view
    )


def everything(rng: np.random.Generator) -> Trial:
    """All kinds of light at once: what the polygons hide of a constant sky is known, as all of it shines alike."""
    reflectance, turn = colour(rng), rng.uniform(0, 360)
    lamp = corners_in(facing(rng, 60.0, turn, rng.uniform(1.0, 1.4), 20.0), box(0.4, 0.3))
    triangle = corners_in(facing(rng, 8.0, turn + 130.0, 1.3, 20.0), [(0.5, 0.1), (-0.3, 0.45), (-0.2, -0.5)])
    back = corners_in(facing(rng, 45.0, turn + 240.0, 1.3, 20.0), box(0.3, 0.2))[::-1]
    lamps = [(lamp, colour(rng, 0.5, 5.0)), (triangle, colour(rng, 0.5, 5.0)), (back, colour(rng, 0.5, 5.0))]
    sky, intensity, sunlight = colour(rng, 0.2, 1.0), colour(rng, 0.5, 2.0), colour(rng, 0.5, 2.0)
    y, w = 1.8 * unit(35, turn + 300), unit(50, turn + 290)
    exact = intensity * float(forms.point_light(y)) + sunlight * w[2]
    free = math.pi - sum(float(forms.polygon(p)) for p, _ in lamps)
    truth = exact + sky * free + sum(c * float(forms.polygon(p)) for p, c in lamps[:2])
    bound = exact + sky * math.pi + sum(c * steepness(p) for p, c in lamps)
    f_r = reflectance / math.pi
    return stage(
        "everything", rng, {"direct": Answer.of(f_r * truth, f_r * bound)}, material=d.Diffuse(reflectance),
        shapes=tuple(polygon(p, c) for p, c in lamps),
        lights=(d.PointLight(y, intensity), d.DirectionalLight(-w, sunlight)),
        sky=lambda _: d.GradientEnvironment(sky, np.zeros((3, 3))), view=unit(45, turn + 10),
    )  # fmt: skip
