"""Samplers against their densities: the maps of `raylab.sampling`, of BRDFs and of skies.

J: pdf(T(u)) |dT/du| = 1 by central differences. Q: the p that comes with a sample is pdf() of it. I: the pdf integrates
to 1. T: no five of 4096 samples agree. P: samples fall into cells as the pdf says, and none anywhere else; the cells
are those of an inverse map, or of a chart. Cheapest first.
"""

from __future__ import annotations

import math
import secrets
import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from mutants.charts import Chart
from mutants.trial import unit
from raylab import sampling as s
from raylab.jit import njit
from raylab.record import record
from raylab.stats import Counts
from raylab.vec3 import Vec3
from raylab.view import View

N, VIEW = Vec3(*unit(0.48, -0.6, 0.64)), Vec3(*unit(0.9, 0.1, 0.7))
EXPONENT, SINE = 20.0, 0.55
ACROSS, DOWN = 8, 16  # cells of an inverse map
ROWS, COLUMNS = 16, 32  # cells of a chart
STEP = 1e-5
# central differences: STEP^2 / 6 times third derivatives, which grow as u^(-5/2) at the ends, and rounding 1e-16 / STEP
J_TOLERANCE = 1e-4
EXACT = 1e-9  # rounding of a few operations
INTEGRAL = 1e-4  # Gauss' rule of 6 nodes in 16 x 32 cells, of a lobe of exponent 20
LOOK, SAME = 4096, 5  # chance that five of 4096 agree, of numbers with 24 bits: 4096^5 / 5! / 2^96 = 1e-13


@record
class Hemisphere(NamedTuple):
    n: Vec3

    def sample(self, u):
        w = s.sample_hemisphere(self.n, u)
        return w, s.pdf_hemisphere(self.n, w)

    def pdf(self, w):
        return s.pdf_hemisphere(self.n, w)

    def invert(self, w):
        return s.invert_hemisphere(self.n, w)


@record
class Cosine(NamedTuple):
    n: Vec3

    def sample(self, u):
        w = s.sample_cos_hemisphere(self.n, u)
        return w, s.pdf_cos_hemisphere(self.n, w)

    def pdf(self, w):
        return s.pdf_cos_hemisphere(self.n, w)

    def invert(self, w):
        return s.invert_cos_hemisphere(self.n, w)


@record
class Sphere(NamedTuple):
    n: Vec3

    def sample(self, u):
        w = s.sample_sphere(u)
        return w, s.pdf_sphere(w)

    def pdf(self, w):
        return s.pdf_sphere(w)

    def invert(self, w):
        return s.invert_sphere(w)


@record
class Lobe(NamedTuple):
    n: Vec3
    exponent: float

    def sample(self, u):
        w = s.sample_phong_lobe(self.n, self.exponent, u)
        return w, s.pdf_phong_lobe(self.n, self.exponent, w)

    def pdf(self, w):
        return s.pdf_phong_lobe(self.n, self.exponent, w)

    def invert(self, w):
        return s.invert_phong_lobe(self.n, self.exponent, w)


@record
class Cone(NamedTuple):
    n: Vec3
    sine: float

    def sample(self, u):
        w = s.sample_cone(self.n, self.sine, u)
        return w, s.pdf_cone(self.n, self.sine, w)

    def pdf(self, w):
        return s.pdf_cone(self.n, self.sine, w)

    def invert(self, w):
        return s.invert_cone(self.n, self.sine, w)


@record
class Disk(NamedTuple):
    n: Vec3

    def sample(self, u):
        x, y = s.sample_disk(u)
        return Vec3(x, y, 0.0), s.pdf_disk(x, y)

    def pdf(self, w):
        return s.pdf_disk(w.x, w.y)

    def invert(self, w):
        return s.invert_disk(w.x, w.y)


@record
class Concentric(NamedTuple):
    n: Vec3

    def sample(self, u):
        x, y = s.sample_concentric_disk(u)
        return Vec3(x, y, 0.0), s.pdf_concentric_disk(x, y)

    def pdf(self, w):
        return s.pdf_concentric_disk(w.x, w.y)

    def invert(self, w):
        return s.invert_concentric_disk(w.x, w.y)


@record
class Triangle(NamedTuple):
    n: Vec3

    def sample(self, u):
        x, y = s.sample_triangle(u)
        return Vec3(x, y, 0.0), s.pdf_triangle(x, y)

    def pdf(self, w):
        return s.pdf_triangle(w.x, w.y)

    def invert(self, w):
        return s.invert_triangle(w.x, w.y)


@record
class OfBrdf(NamedTuple):
    brdf: Any
    V: Vec3
    n: Vec3

    def sample(self, u):
        return self.brdf.sample(self.V, self.n, u)

    def pdf(self, w):
        return self.brdf.pdf(self.V, w, self.n)

    def invert(self, w):
        return 0.0, 0.0


@record
class OfSky(NamedTuple):
    sky: Any
    n: Vec3

    def sample(self, u):
        return self.sky.sample(self.n, u)

    def pdf(self, w):
        return self.sky.pdf(self.n, w)

    def invert(self, w):
        return 0.0, 0.0


@njit
def draw(thing, squares, points, returned):
    for i in range(len(returned)):
        w, p = thing.sample((squares[i, 0], squares[i, 1]))
        points[i, 0], points[i, 1], points[i, 2] = w.x, w.y, w.z
        returned[i] = p


@njit
def look_up(thing, points, out):
    for i in range(len(out)):
        out[i] = thing.pdf(Vec3(points[i, 0], points[i, 1], points[i, 2]))


@njit
def look_back(thing, points, out):
    for i in range(len(out)):
        out[i, 0], out[i, 1] = thing.invert(Vec3(points[i, 0], points[i, 1], points[i, 2]))


class Map:
    """A sampler at work. `smooth`: one to one and differentiable, so that J applies; `inverse`: `thing.invert` does."""

    def __init__(self, thing: Any, chart: Chart, *, kind: str = "warp", smooth: bool = True, inverse: bool = True):
        self.thing, self.chart, self.kind, self.smooth, self.inverse = thing, chart, kind, smooth, inverse
        self.rng = np.random.default_rng(secrets.randbits(64))

    def at(self, squares: Any) -> tuple[Any, Any]:
        """Points (n, 3) of random numbers (n, 2), and the p that came with them."""
        points, returned = np.empty((len(squares), 3)), np.empty(len(squares))
        draw(self.thing, View(np.ascontiguousarray(squares)), View(points), View(returned))
        return points, returned

    def draws(self, n: int) -> Any:
        return self.at(self.rng.random((n, 2)))[0]

    def pdf(self, points: Any) -> Any:
        out = np.empty(len(points))
        look_up(self.thing, View(np.ascontiguousarray(points)), View(out))
        return out

    def inverted(self, points: Any) -> Any:
        out = np.empty((len(points), 2))
        look_back(self.thing, View(points), View(out))
        return out


def maps() -> dict[str, Callable[[], Map]]:
    from mutants.kills import scene_of
    from mutants.sky_trials import image_breaks
    from mutants.trials import TRIALS
    from raylab.brdf import Lambertian, Phong

    axis, up = tuple(N), Chart(axis=tuple(N), rows=(0.0,))
    phong = Phong(Vec3(0.1, 0.1, 0.1), Vec3(0.5, 0.5, 0.5), EXPONENT, N)
    cone = Chart(axis=axis, rows=(math.sqrt(1.0 - SINE * SINE),))
    loose = {"smooth": False, "inverse": False}
    return {
        "map hemisphere": lambda: Map(Hemisphere(N), up),
        "map cosine": lambda: Map(Cosine(N), up),
        "map sphere": lambda: Map(Sphere(N), Chart(axis=axis)),
        "map Phong": lambda: Map(Lobe(N, EXPONENT), up, kind="BRDF"),
        "map cone": lambda: Map(Cone(N, SINE), cone),
        "map disk": lambda: Map(Disk(N), Chart("disk", low=0.0)),
        "map concentric": lambda: Map(Concentric(N), Chart("disk", low=0.0), smooth=False),
        "map triangle": lambda: Map(Triangle(N), Chart("triangle", low=0.0)),
        "map Lambert": lambda: Map(OfBrdf(Lambertian(Vec3(0.2, 0.3, 0.1)), VIEW, N), up, kind="BRDF", inverse=False),
        "map mixture": lambda: Map(OfBrdf(phong, VIEW, N), up, kind="BRDF", **loose),
        "map gradient": lambda: Map(
            OfSky(scene_of(TRIALS["sky, brightness"]()).data.environment, N), Chart(axis=axis), inverse=False
        ),
        "map image": lambda: Map(
            OfSky(scene_of(TRIALS["image"]()).data.environment, N), Chart(**image_breaks()), **loose
        ),
    }  # fmt: skip


def examine(m: Map, cap: int, alpha: float) -> Iterator[tuple[str, str, int, float, str]]:
    """(test, outcome, samples, seconds, what was seen), cheapest first."""
    m.inverted(m.draws(8))  # compiles
    m.pdf(m.draws(8))
    for name, test in (("J", _jacobian), ("Q", _returned), ("T", _ties), ("I", _integral)):
        start = time.perf_counter()
        wrong, samples, seen = test(m)
        yield name, "FAIL" if wrong else "PASS", samples, time.perf_counter() - start, seen
    start = time.perf_counter()
    outcome, taken = counts(m, cap, alpha)
    yield "P", outcome, taken, time.perf_counter() - start, ""


def _jacobian(m: Map, points: int = 200) -> tuple[bool, int, str]:
    """The largest |pdf(T(u)) |dT/du| - 1| over random u."""
    if not m.smooth:
        return False, 0, "does not apply"
    u = m.rng.uniform(0.02, 0.98, (points, 2))
    across, along = np.array([STEP, 0.0]), np.array([0.0, STEP])
    du, dv = ((m.at(u + h)[0] - m.at(u - h)[0]) / (2.0 * STEP) for h in (across, along))
    worst = float(np.max(np.abs(m.pdf(m.at(u)[0]) * np.linalg.norm(np.cross(du, dv), axis=1) - 1.0)))
    return not worst <= J_TOLERANCE, points, f"pdf times Jacobian off by {worst:.2g}"


def _returned(m: Map, points: int = 200) -> tuple[bool, int, str]:
    w, p = m.at(m.rng.random((points, 2)))
    with np.errstate(all="ignore"):
        worst = float(np.max(np.abs(p / m.pdf(w) - 1.0)))
    return not worst <= EXACT, points, f"p off by {worst:.2g} of pdf()"


def _integral(m: Map) -> tuple[bool, int, str]:
    total = float(m.chart.expected(m.pdf, ROWS, COLUMNS).sum())
    return not abs(total - 1.0) <= INTEGRAL, 0, f"the pdf integrates to {total:.6g}"


def _ties(m: Map) -> tuple[bool, int, str]:
    most = most_alike(m.draws(LOOK)[:, 0])
    return most >= SAME, LOOK, f"{most} of {LOOK} samples agree"


def most_alike(values: Any) -> int:
    """How many of the values that are not 0 are the same number."""
    values = values[values != 0.0]
    return int(np.unique(values, return_counts=True)[1].max(initial=0))


def counts(m: Map, cap: int, alpha: float) -> tuple[str, int]:
    """("FAIL" or "PASS", samples): samples counted in cells; PASS is silence at the cap."""
    cells = np.full((ACROSS, DOWN), 1.0 / (ACROSS * DOWN)) if m.inverse else m.chart.expected(m.pdf, ROWS, COLUMNS)
    total = cells.sum()
    tally, taken, block = Counts((cells / max(total, 1.0)).ravel()), 0, 64
    while taken < cap:
        points = m.draws(block)
        if m.inverse:
            at = m.inverted(points)
            off = (np.abs((points**2).sum(axis=1) - 1.0) > 1e-9) & (m.chart.shape == "sphere")
            inside = (at >= 0.0).all(axis=1) & (at <= 1.0).all(axis=1) & ~off
            a, b = (
                np.minimum((np.nan_to_num(v) * k).astype(int), k - 1) for v, k in zip(at.T, (ACROSS, DOWN), strict=True)
            )
            tally.add(np.where(inside, a * DOWN + b, -1))
        else:
            seen, lost = m.chart.counts(points, ROWS, COLUMNS)
            tally.add(np.concatenate([np.repeat(np.arange(seen.size), seen.ravel()), np.full(lost, -1)]))
        taken += block
        if tally.log_evidence() > -math.log(alpha):
            return "FAIL", taken
        block = min(max(64, taken // 4), 1 << 17, max(cap - taken, 1))
    return "PASS", taken
