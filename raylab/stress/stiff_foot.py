"""Stiff foot: a wall light on the floor. By area its samples have no variance in a pixel with the foot in it.

At the distance e from the foot g = A e z / r^4 and E g^2 = pi A / (24 e^2), whose integral over e diverges. In units of
e, with e = s sqrt(A / t), P(g > t) = C t^(-3/2): the tail index is 3/2, and means of N fall as N^(-1/3).
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.jit import njit
from raylab.probe import Pixel, Probe
from raylab.sampling import sample_cos_hemisphere
from raylab.scene import Scene
from raylab.stats.tails import infinite_variance, tail_index
from raylab.stress.case import Found, case
from raylab.stress.lamps import UP, Lamp, squares
from raylab.stress.nearness import WHITE, placed
from raylab.stress.oracle import gauss
from raylab.stress.stiff_estimators import MANY, TOLD, UNIT, largest, relative
from raylab.stress.stiff_lights import touching

Array = npt.NDArray[np.float64]
WALL = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 1], [0, 0, 0, 1]], float)  # [-1, 1] x [0, 2] at x = 0


def foot() -> Scene:
    """A wall light [-1, 1] x [0, 2] on a floor, seen by one pixel at its foot, [0, 1/2] x [-1/4, 1/4]."""
    eye = np.diag([1.0, -1.0, -1.0, 1.0])
    eye[:3, 3] = (0.25, 0.0, 8.0)
    camera = d.Camera(eye, fov=math.degrees(2.0 * math.atan(1.0 / 32.0)), width=1, height=1)
    floor = d.Rectangle(to_world=placed(0, 0, 0, 4, 4), front=WHITE)
    lamp = d.Rectangle(to_world=WALL, radiance=np.ones(3), front=None)
    return Scene(d.SceneDescription(camera=camera, shapes=(floor, lamp)))


def foot_irradiance() -> float:
    """Mean irradiance of that pixel: 1/2 sum over the corners of Lambert's formula, by quadrature over the pixel."""
    from raylab.closed_forms.irradiance import polygon

    u, wu = gauss(200)
    x, wx = 0.5 * u**2, 2.0 * u * wu  # many points at the foot
    y, wy = gauss(32, -0.25, 0.25)
    at = np.stack([*np.meshgrid(x, y, indexing="ij"), np.zeros((len(x), len(y)))], axis=-1).reshape(-1, 3)
    light = np.array([(0.0, -1.0, 0.0), (0.0, 1.0, 0.0), (0.0, 1.0, 2.0), (0.0, -1.0, 2.0)])
    up = np.broadcast_to((0.0, 0.0, 1.0), at.shape)
    return float(polygon(light, at, up) @ np.outer(wx, 2.0 * wy).ravel())


@njit
def _meets_the_wall(u, epsilon, g):
    """1 for each direction of a diffuse surface that meets the wall."""
    for i in range(len(u)):
        w = sample_cos_hemisphere(UP, (u[i, 0], u[i, 1]))
        g[i] = 1.0 if w.x < 0.0 and abs(w.y) * epsilon <= -w.x and w.z * epsilon <= -2.0 * w.x else 0.0


def by_area(epsilon: float, mean: float) -> float:
    """Relative variance by area: A times the integral of (epsilon z / r^4)^2, about pi / (6 epsilon^2) for A = 4."""
    t, wt = gauss(400, 0.0, math.asinh(2.0 / epsilon))
    s, ws = gauss(400, 0.0, math.asinh(1.0 / epsilon))
    z, y = epsilon * np.sinh(t)[:, None], epsilon * np.sinh(s)
    square = (epsilon * z) ** 2 / (epsilon**2 + y**2 + z**2) ** 4
    return 8.0 * float((wt * epsilon * np.cosh(t)) @ square @ (ws * epsilon * np.cosh(s))) / mean**2 - 1.0


@case(
    "S02", "points 0.1 and 0.03 from the foot of a light that stands on the floor",
    usual="uniform in area: pi A / (24 e^2) over E^2",
    rule="uniform in solid angle: at most Omega / E - 1, about 1; cosine: (1 - p) / p, p about 1/2",
    truth="quadrature, closed form", unit=UNIT, allowed=1.0, limit=60.0,
)  # fmt: skip
def near_the_foot() -> Found:
    lamp, usual, angle, cosine = Lamp(d.Rectangle, WALL), [], [], []
    for epsilon in (0.1, 0.03):
        mean, variance = touching(epsilon)
        x, hit = (epsilon, 0.0, 0.0), np.empty(MANY)
        usual.append(relative(lamp.irradiances(x, UP, False, MANY), mean, by_area(epsilon, mean)))
        angle.append(relative(lamp.irradiances(x, UP, True, MANY), mean, variance))
        _meets_the_wall(squares(MANY), epsilon, hit)
        p = mean / math.pi
        cosine.append(relative(hit, p, (1.0 - p) / p))
    by_cosine = largest(cosine)
    error = math.nan if math.isnan(by_cosine) else largest(angle)
    return Found(error, largest(usual), note=f"By cosine {by_cosine:.2g}")


@case(
    "S02y", "a pixel with that foot in it", usual="uniform in area: P(g > t) ~ t^(-3/2), no variance",
    rule="solid angle, or area and BRDF combined: g at most pi and 2 pi; the study says which is which",
    truth="tail index 3/2; a variable of [0, m] has at most the variance E (m - E)",
    unit="relative variance over its bound, m / E - 1 (NaN if Hill's index is not 3/2 or the study is wrong)",
    allowed=1.0, limit=90.0,
)  # fmt: skip
def the_foot_of_a_light() -> Found:
    scene, mean = foot(), foot_irradiance()
    area = math.pi * Probe(scene, "area", Pixel(0, 0)).sample(6, MANY)[:, 0]
    index, error = tail_index(area, 2.0**-8)
    wrong, shares, told = not infinite_variance(area) or abs(index - 1.5) > TOLD * error, [], []
    for name, most in (("area_solid_angle", math.pi), ("mis_balance", 2.0 * math.pi)):
        g = math.pi * Probe(scene, name, Pixel(0, 0)).sample(6, MANY)[:, 0]
        found = float(((g / mean - 1.0) ** 2).mean())
        wrong |= bool(infinite_variance(g)) or abs(float(g.mean()) / mean - 1.0) > TOLD * math.sqrt(found / MANY)
        shares.append(found / (most / mean - 1.0))
        told.append(f"{found:.2g}")
    note = f"Hill's index {index:.3f} +- {error:.3f}; relative variances of the cures {' and '.join(told)}"
    return Found(math.nan if wrong else largest(shares), math.inf if infinite_variance(area) else None, note=note)


@case(
    "S02x", "means of 2^7, 2^10 and 2^13 samples by area of the same pixel, 8e6 in all",
    usual="error ~ N^(-1/2)", rule="the median error falls as N^(-1/3): halves as N grows eightfold",
    truth="the law of index 3/2 that the mean tends to, the same for all N",
    unit="standard errors (of the binomial law) of the share above half of the median error before from 1/2",
    allowed=4.5, limit=90.0, slow=True,
)  # fmt: skip
def the_median_error() -> Found:
    g = math.pi * Probe(foot(), "area", Pixel(0, 0)).sample(6, 1 << 23)[:, 0]
    truth, error = foot_irradiance(), 0.0
    errors = [np.abs(g.reshape(-1, n).mean(axis=1) - truth) for n in (1 << 7, 1 << 10, 1 << 13)]
    slopes = np.diff(np.log([np.median(e) for e in errors])) / math.log(8.0)
    for before, after in ((errors[1], errors[2]),):
        share, spread = np.mean(after > np.median(before) / 2.0), math.sqrt(0.25 / len(after) + 0.25 / len(before))
        error = max(error, float(abs(share - 0.5) / spread))
    return Found(error, note=f"slopes {slopes[0]:.3f}, {slopes[1]:.3f}")
