"""Lessons: trials for the assignments, in which one thing at a time is asked of an estimator.

The scenes of a family differ in numbers alone, not in what they contain, so that one kernel serves them all: what a
lesson does not need is there but dark, or below the horizon. The receiver is the origin with the geometric normal +z;
its shading normal N is another one in the lessons called "tilted", where a cosine must be clamped. Kinds:

    plain    everything in sight, one lamp or the open sky; the variance of one sample is known
    hidden   part of the light behind something, a lamp through the horizon, a lamp that faces away
    tilted   the light is cut by the horizon of the shading normal
    several  lamps of three shapes and sizes; a sky of other brightness
    near     a glaring lamp that nearly touches x, a hundredth of the scene away; a sky a million times as bright

Truths are closed forms, or Gauss quadrature where there is none; families: `area`, `sky`, `mix` (both), each for a
diffuse and for a glossy surface. Bounds of one sample as in `raylab.trials.lights` and `raylab.trials.skies`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from raylab import description as d
from raylab.trials.lights import by_brdf, screen_before
from raylab.trials.polygon import area_of, box, corners_in, facing, polygon, steepness
from raylab.trials.receiver import Surface, over_cone, over_rectangle, put_up, surface
from raylab.trials.skies import random_gradient, spans
from raylab.trials.trial import (
    BLACK,
    LUMINANCE,
    Answer,
    Array,
    Trial,
    Z,
    colour,
    unit,
)

KINDS = ("plain", "hidden", "tilted", "several", "near")


# --- lamps ---


@dataclass(frozen=True, eq=False)
class Lamps:
    """A rectangle, a triangle and a ball, and what can be said of them."""

    shapes: list[d.Shape]
    truth: Array
    bound: Array
    main: Array  # corners of the rectangle
    light: Array  # its radiance
    brightest: Array
    behind: list[tuple[Array, tuple[Array, Array] | None]]  # polygons (what is left of them) that hide the sky


def ball(centre: Array, radius: float, light: Array | None) -> d.Sphere:
    return d.Sphere(center=centre, radius=radius, radiance=light, front=None)


def lamps(rng: np.random.Generator, own: Surface, kind: str, alone: bool = False) -> Lamps:
    """The lamps of a kind of lesson; dark ones stand below the horizon. `alone`: none but the rectangle shines."""
    colours = [colour(rng, 0.5, 5.0) for _ in range(3)]
    turn, distance, a, b = rng.uniform(-15, 15), rng.uniform(0.9, 1.3), rng.uniform(0.25, 0.4), rng.uniform(0.2, 0.35)
    elevation = 30.0 if kind == "tilted" else rng.uniform(50, 62)
    if kind == "near":
        distance, a, b = distance / 40.0, a / 40.0, b / 40.0
        colours[0] = 1e4 * colours[0]
    plane = facing(rng, elevation, turn, distance, 20.0)
    main = corners_in(plane, box(a, b))
    dark = [(0.3, 0.1), (-0.2, 0.3), (-0.15, -0.35)]
    triangle, round_at, radius = corners_in(facing(rng, -50, turn + 90, 1.2, 10.0), dark), unit(-50, turn + 180), 0.3
    shapes, keep, lit, behind = [], None, [colours[0], BLACK, BLACK], []
    if kind == "several":
        triangle = corners_in(facing(rng, 40.0, turn + 80.0, 1.3, 20.0), [(2.0 * s, 2.0 * t) for s, t in dark])
        round_at, radius, lit = 1.4 * unit(50, turn - 75.0), rng.uniform(0.2, 0.35), colours
    if kind == "hidden":
        screen, keep = screen_before(rng, plane, a, b)
        shapes, behind = [polygon(screen, None)], [(screen, None)]
    if kind == "hidden" and not alone:
        low = facing(rng, rng.uniform(-2, 8), turn + 100.0, 1.2, 20.0)
        triangle = corners_in(low, [(2.0 * s, 2.0 * t) for s, t in dark])
        lit = [colours[0], colours[1], BLACK]
        away = corners_in(facing(rng, 45.0, turn - 110.0, 1.3, 20.0), box(0.3, 0.2))[::-1]
        shapes += [polygon(away, colours[2])]
    truth = lit[0] * own.under(main, keep) + lit[1] * own.under(triangle)
    bound = own.largest * (lit[0] * steepness(main) + lit[1] * steepness(triangle))
    if kind == "several":
        centre, cosine = round_at / np.linalg.norm(round_at), math.sqrt(1.0 - (radius / 1.4) ** 2)
        truth = truth + lit[2] * over_cone(centre, cosine, lambda w: own.f_r(w) * own.cosine(w), 48)
        bound = bound + own.largest * lit[2] * 2.0 * math.pi * (1.0 - cosine)
    shapes += [polygon(main, lit[0]), polygon(triangle, lit[1]), ball(round_at, radius, lit[2])]
    return Lamps(shapes, truth, 1.001 * bound, main, lit[0], np.max(lit, axis=0), [(main, keep), *behind])


def area(rng: np.random.Generator, kind: str, glossy: bool) -> Trial:
    """Slides "Area source by Monte Carlo" (diffuse), and for any BRDF."""
    own = surface(rng, glossy, kind == "tilted")
    found = lamps(rng, own, kind)
    variance = None
    if kind == "plain":

        def square(w: Array, r2: Array, cos_s: Array) -> Array:
            return area_of(found.main) * (found.light * own.f_r(w) * own.cosine(w) * cos_s / r2) ** 2

        variance = over_rectangle(found.main, square) - found.truth**2
    answer = Answer.of(found.truth, found.bound, variance)
    answers = {"area": answer} if glossy else {"area": answer, "area_diffuse": answer}
    return put_up(f"lesson_area_{_kind(kind, glossy)}", rng, own, answers, found.shapes)


# --- skies ---


def sky(rng: np.random.Generator, kind: str, glossy: bool) -> Trial:
    """Slides "Diffuse surface in env. by Monte Carlo", "Arbitrary surface ..." and "Creating glossy reflections"."""
    own = surface(rng, glossy, kind == "tilted")
    a, rows = random_gradient(rng)
    if kind == "near":
        a, rows = 1e6 * a, 1e6 * rows
    radius, centre = rng.uniform(0.4, 0.6), 1.2 * (unit(55, rng.uniform(-15, 15)) if kind == "hidden" else -Z)
    brightest, total, least = spans(a, rows)

    def light(w: Array) -> Array:
        above = (w @ Z > 0.0)[..., None]
        return np.where(above, a + w @ rows.T, 0.0)

    def integral(f: Callable[[Array], Array]) -> Array:
        """Of f over what is seen of the sky."""
        everything = over_cone(Z, 0.0, f, 160 if kind == "tilted" else 64)
        if kind != "hidden":
            return everything
        return everything - over_cone(centre / 1.2, math.sqrt(1.0 - (radius / 1.2) ** 2), f, 64)

    means: dict[Callable[[Array], Array], Array] = {}
    answers = {}
    for name, (f, p, bound) in _techniques(own, light, a, rows, brightest, float(total) / least).items():
        if f not in means:
            means[f] = integral(f)
        mean = means[f]
        second = None if kind != "plain" else integral(lambda w, f=f, p=p: f(w) ** 2 / p(w))  # type: ignore[misc]
        answers[name] = Answer.of(mean, bound, None if second is None else second - mean**2)
    return put_up(
        f"lesson_sky_{_kind(kind, glossy)}", rng, own, answers, [ball(centre, radius, None)],
        lambda turn: d.GradientEnvironment(a, rows @ turn.T),
    )  # fmt: skip


Technique = tuple[Callable[[Array], Array], Callable[[Array], Array], Array]


def _techniques(
    own: Surface, light: Callable[[Array], Array], a: Array, rows: Array, brightest: Array, spread: float
) -> dict[str, Technique]:
    """Integrand, density and bound of one sample, by the name of the technique."""

    def f(w: Array) -> Array:
        return light(w) * own.f_r(w) * own.cosine(w)

    def by_brightness(w: Array) -> Array:
        return ((a + w @ rows.T) @ LUMINANCE / (4.0 * math.pi * float(a @ LUMINANCE)))[..., None]

    found: dict[str, Technique] = {
        "env_brdf": (f, own.pdf, by_brdf(brightest, own.diffuse, own.specular, own.exponent)),
        "env_brightness": (f, by_brightness, own.largest * brightest * spread),
    }
    if not own.specular.any():
        cosine = own.diffuse * brightest
        found["env_brdf"] = found["env_cosine"] = (f, lambda w: own.cosine(w) / math.pi, cosine)
        found["env_uniform"] = (f, lambda w: np.full((*w.shape[:-1], 1), 0.5 / math.pi), 2.0 * cosine)
        return found
    n = own.exponent

    def lobe(w: Array) -> Array:
        return (n + 1) / (2.0 * math.pi) * np.maximum(1e-30, w @ own.R)[..., None] ** n

    bound = brightest * own.specular * (n + 2) / (n + 1)
    found["glossy_phong"] = (lambda w: light(w) * own.lobe(w) * own.cosine(w), lobe, bound)
    return found


# --- lamps and sky together ---


@dataclass(frozen=True, eq=False)
class Mixture:
    """A lamp in plain sight before an even sky, whose sample has the density 1 / (4 pi)."""

    own: Surface
    lamps: Lamps
    sky: Array
    power: int  # 1: balance heuristic, 2: power heuristic

    def lamp_pdf(self, r2: Array, cos_s: Array) -> Array:
        """Of the lamp's own sample, 1/sr."""
        return np.asarray(r2 / (area_of(self.lamps.main) * np.maximum(cos_s, 1e-12)))

    def over_lamp(self, g: Callable[[Array, Array], Array]) -> Array:
        """The integral of g(w, density of the lamp's sample) over the lamp's solid angle."""
        return over_rectangle(self.lamps.main, lambda w, r2, c: g(w, self.lamp_pdf(r2, c)) * c / r2)

    def over_sky(self, g: Callable[[Array, Array], Array]) -> Array:
        """The same over what the lamp leaves of the sky."""
        even = np.array(0.25 / math.pi)
        behind = over_rectangle(self.lamps.main, lambda w, r2, c: g(w, even) * c / r2)
        return over_cone(self.own.N, 0.0, lambda w: g(w, even), 128) - behind

    def one(self, light: Array, by_brdf: bool) -> Callable[[Array, Array], Array]:
        """Integrand of one technique: light f_r cos weight."""

        def g(w: Array, q: Array) -> Array:
            p = self.own.pdf(w)
            mine, other = (p**self.power, q**self.power) if by_brdf else (q**self.power, p**self.power)
            return np.asarray(light * self.own.f_r(w) * self.own.cosine(w) * mine / (mine + other))

        return g

    def variance(self) -> Array:
        """Of one sample of each of three: the lamp's, the sky's, the BRDF's; they are independent."""
        lamp, sky = self.one(self.lamps.light, False), self.one(self.sky, False)
        found = self.over_lamp(lambda w, q: lamp(w, q) ** 2 / q) - self.over_lamp(lamp) ** 2
        found = found + self.over_sky(lambda w, q: sky(w, q) ** 2 / q) - self.over_sky(sky) ** 2
        lamp, sky = self.one(self.lamps.light, True), self.one(self.sky, True)
        second = self.over_lamp(lambda w, q: lamp(w, q) ** 2 / self.own.pdf(w))
        second = second + self.over_sky(lambda w, q: sky(w, q) ** 2 / self.own.pdf(w))
        return found + second - (self.over_lamp(lamp) + self.over_sky(sky)) ** 2


def mix(rng: np.random.Generator, kind: str, glossy: bool) -> Trial:
    """A lamp before an even sky, part of which it hides: what multiple importance sampling is for."""
    own, even = surface(rng, glossy, kind == "tilted"), colour(rng, 0.1, 0.5)
    found = lamps(rng, own, kind, alone=True)
    hidden = sum((own.under(corners, keep) for corners, keep in found.behind), start=BLACK)
    truth = found.truth + even * (over_cone(own.N, 0.0, lambda w: own.f_r(w) * own.cosine(w), 128) - hidden)
    by_light = found.bound + 4.0 * math.pi * own.largest * even
    by_lobe = by_brdf(np.maximum(found.brightest, even), own.diffuse, own.specular, own.exponent)
    answers = {
        name: Answer.of(
            truth, by_light + by_lobe, Mixture(own, found, even, power).variance() if kind == "plain" else None
        )
        for name, power in (("mis_balance", 1), ("mis_power", 2))
    }
    return put_up(
        f"lesson_mix_{_kind(kind, glossy)}", rng, own, answers, found.shapes,
        lambda _: d.GradientEnvironment(even, np.zeros((3, 3))),
    )  # fmt: skip


def _kind(kind: str, glossy: bool) -> str:
    return f"glossy_{kind}" if glossy else kind


LESSONS: dict[str, Callable[[np.random.Generator], Trial]] = {
    f"lesson_{family.__name__}_{_kind(kind, glossy)}": partial(family, kind=kind, glossy=glossy)
    for family, kinds in (
        (area, KINDS),
        (sky, ("plain", "hidden", "tilted", "near")),
        (mix, ("plain", "hidden", "near")),
    )
    for kind in kinds
    for glossy in (False, True)
}
