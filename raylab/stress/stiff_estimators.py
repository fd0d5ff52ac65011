"""Stiff estimators: right on average, of a variance that is huge or not there; each by its formula, beside its cure.

Of the samples g of one estimator, relative variance = Var(g) / (E g)^2; for 1 % error it takes 1e4 times as many. The
usual strategy and its cure are held to their formulas, and the cure to the bound of theory.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.closed_forms import variances
from raylab.jit import njit
from raylab.sampling import sample_cos_hemisphere
from raylab.scene import Scene
from raylab.stress.case import Found, case
from raylab.stress.lamps import UP, Lamp, cap_variance, squares
from raylab.stress.nearness import WHITE, placed, seen
from raylab.stress.oracle import gauss

Array = npt.NDArray[np.float64]
MANY = 1_000_000
UNIT = "relative variance of a sample (NaN if one, or its mean, is not what theory says)"
TOLD = 4.5  # standard errors


def relative(g: Array, mean: float, truth: float) -> float:
    """Relative variance of samples; NaN where it is further than TOLD of its standard errors from the truth, or the
    mean further than TOLD exact ones."""
    squares_of = (g / mean - 1.0) ** 2
    found, error = float(squares_of.mean()), float(squares_of.std() / math.sqrt(len(g)))
    right_mean = abs(float(g.mean()) / mean - 1.0) <= TOLD * math.sqrt(truth / len(g)) + 2.0**-40
    return found if right_mean and abs(found - truth) <= TOLD * error + 2.0**-40 else math.nan


def largest(values: Sequence[float]) -> float:
    """The largest, a NaN if there is one."""
    return float(np.max(np.asarray(values)))


@njit
def hits(u, cosine, g):
    """1 for each direction of a diffuse surface within a cone around its normal."""
    for i in range(len(u)):
        g[i] = 1.0 if sample_cos_hemisphere(UP, (u[i, 0], u[i, 1])).z > cosine else 0.0


@case(
    "S01", "a disk of radius 1 from 0.3 and 0.1 above its centre", usual="uniform in area: R^2 / (3 h^2)",
    rule="uniform in solid angle: 4 (1 - c) (1 - c^3) / (3 (1 - c^2)^2) - 1, at most 1/3; cosine: (1 - p) / p = h^2",
    truth="closed forms", unit=UNIT, allowed=1.0 / 3.0, limit=60.0,
)  # fmt: skip
def disk_near() -> Found:
    lamp, by_area, by_angle, by_cosine = Lamp(d.Disk, np.eye(4)), [], [], []
    for h in (0.3, 0.1):
        mean, area = math.pi / (1.0 + h * h), variances.area_disk(1.0, h) * (1.0 + h * h) ** 2
        cosine, hit = h / math.hypot(1.0, h), np.empty(MANY)
        by_area.append(relative(lamp.irradiances((0.0, 0.0, h), -UP, False, MANY), mean, area))
        by_angle.append(relative(lamp.irradiances((0.0, 0.0, h), -UP, True, MANY), mean, cap_variance(cosine)))
        hits(squares(MANY), cosine, hit)
        by_cosine.append(relative(hit, 1.0 / (1.0 + h * h), h * h))
    return Found(largest(by_angle + by_cosine), largest(by_area), note=f"By cosine {largest(by_cosine):.2g}")


def on_the_sphere(u: Array, sine: float) -> Array:
    """g of points uniform in area on a unit sphere 1 / sine below, p = 1 / (4 pi)."""
    distance = 1.0 / sine
    z = 1.0 - 2.0 * u[:, 0]  # of a point of the sphere, its axis toward the receiver
    dd = distance**2 - 2.0 * distance * z + 1.0
    return 4.0 * math.pi * np.maximum(0.0, distance * z - 1.0) * (distance - z) / dd**2


@case(
    "S03", "a sphere of radius 1 from 0.1 and 0.03 above its surface, and from 1000",
    usual="uniform in area: 4 R^2 / (3 d^2), from afar 5/3", rule="uniform in its cone: at most 1/3",
    truth="closed form; by area quadrature over the visible cap", unit=UNIT, allowed=1.0 / 3.0, limit=60.0,
)  # fmt: skip
def sphere_near() -> Found:
    lamp, by_area, by_cone = Lamp(d.Sphere, np.eye(4)), [], []
    for above in (0.1, 0.03, 1000.0):
        s = 1.0 / (1.0 + above)
        t, w = gauss(64)
        x = t**4  # more points near the nearest
        u, weight = np.column_stack([0.5 * (1.0 - s) * x, x]), 0.5 * (1.0 - s) * 4.0 * t**3 * w
        truth = float(on_the_sphere(u, s) ** 2 @ weight) / (math.pi * s * s) ** 2 - 1.0
        by_area.append(relative(on_the_sphere(squares(MANY), s), math.pi * s * s, truth))
        g = lamp.irradiances((0.0, 0.0, -1.0 - above), UP, n=MANY)
        by_cone.append(relative(g, math.pi * s * s, cap_variance(math.sqrt((1.0 - s) * (1.0 + s)))))
    return Found(largest(by_cone), largest(by_area), note=f"By area from afar {by_area[-1]:.3g}")


@case(
    "S10", "16 small lights, one of which has all the power", usual="each as often as the others: M - 1 = 15",
    rule="in proportion to power: 0", truth="M - 1; the light's own range, 4e-6, squared: Popoviciu's inequality",
    unit=UNIT, allowed=4e-12, limit=60.0,
)  # fmt: skip
def one_of_many() -> Found:
    lamps = tuple(
        d.Rectangle(
            to_world=placed(0.1 * i, 0, 1, 1e-3, 1e-3, -1), radiance=np.full(3, 1e6 if i == 0 else 1e-12), front=None
        )
        for i in range(16)
    )
    scene = Scene(d.SceneDescription(shapes=(d.Rectangle(to_world=placed(0, 0, 0, 4, 4), front=WHITE), *lamps)))
    mean = 4e-6 * 1e6 / math.pi
    g, cure = (seen(scene, f"one_light_{how}", (0.0, 0.0, 0.0), n=200_000) for how in ("uniform", "power"))
    left = float(cure.var() / mean**2)
    return Found(left if abs(cure.mean() / mean - 1.0) < 4e-6 else math.nan, relative(g, mean, 15.0))


@case(
    "S12", "a sphere light half below the horizon, of half angle 0.5 and 0.05",
    usual="uniform in area: half of the points face away, of the others half are below",
    rule="uniform in its cone: pi^2 E[s^2] / (4 E[s]^2) - 1, s the sine to its axis; half are worth nothing",
    truth="quadrature over the cone", unit="relative variance over its bound, (largest g) / (mean g) - 1", allowed=1.0,
)  # fmt: skip
def half_below() -> Found:
    error, usual, told, lamp = [], [], [], Lamp(d.Sphere, np.eye(4))
    for half_angle in (0.5, 0.05):
        t, wt = gauss(64)
        x = 2.0 * math.sin(half_angle / 2.0) ** 2 * t**2  # 1 - cos, uniform up to its end
        s, weight = np.sqrt(x * (2.0 - x)), 2.0 * t * wt
        one, two = float(s @ weight), float(s**2 @ weight)
        solid_angle, sine = 4.0 * math.pi * math.sin(half_angle / 2.0) ** 2, math.sin(half_angle)
        truth, mean = math.pi**2 * two / (4.0 * one**2) - 1.0, solid_angle * one / math.pi
        bound = solid_angle * sine / mean - 1.0  # a variable of [0, m] has at most the variance E (m - E)
        g = lamp.irradiances((-1.0 / sine, 0.0, 0.0), UP, n=MANY)
        error.append(relative(g, mean, truth) / bound)
        usual.append(float((beside_the_sphere(sine) ** 2).mean() / mean**2 - 1.0) / bound)
        told.append(f"{truth:.3f}")
    return Found(largest(error), largest(usual), note=f"Relative variances: {', '.join(told)}")


def beside_the_sphere(sine: float) -> Array:
    """g of points uniform in area on a unit sphere that stands 1 / sine beside the receiver, at its height."""
    u = squares(MANY)
    z, phi = 1.0 - 2.0 * u[:, 0], 2.0 * math.pi * u[:, 1]
    n = np.column_stack([np.sqrt(1.0 - z * z) * np.cos(phi), np.sqrt(1.0 - z * z) * np.sin(phi), z])
    to = n + np.array([1.0 / sine, 0.0, 0.0])
    facing = np.maximum(0.0, -(to * n).sum(axis=1))
    return 4.0 * math.pi * np.maximum(0.0, to[:, 2]) * facing / (to * to).sum(axis=1) ** 2
