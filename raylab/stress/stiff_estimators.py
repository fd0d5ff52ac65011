"""Stiff estimators: right on average, of a variance that is huge or not there; each by its formula, beside its cure.

Of the samples g of one estimator, relative variance = Var(g) / (E g)^2; for 1 % error it takes 1e4 times as many.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.closed_forms import variances
from raylab.figures.after_lecture import relative_variances
from raylab.jit import njit
from raylab.mis import balance
from raylab.probe import Pixel, Probe
from raylab.sampling import (
    pdf_cone,
    pdf_phong_lobe,
    sample_cone,
    sample_cos_hemisphere,
    sample_disk,
    sample_hemisphere,
    sample_phong_lobe,
    sample_sphere,
)
from raylab.scene import Scene
from raylab.stats.tails import infinite_variance, tail_index
from raylab.stress.case import Found, case
from raylab.stress.lamps import UP, Lamp, cap_variance, squares
from raylab.stress.nearness import FEW, WHITE, placed, seen
from raylab.stress.oracle import gauss

Array = npt.NDArray[np.float64]
MANY = 1_000_000
UNIT = "largest distance of a variance from its formula, in standard errors"


def astray(g: Array, mean: float, relative_variance: float) -> float:
    """How far the variance of samples is from the truth, in standard errors."""
    squares_of = (g / mean - 1.0) ** 2
    return float(abs(squares_of.mean() - relative_variance) / (squares_of.std() / math.sqrt(len(g))))


@case(
    "S01", "a disk of radius 1 from 0.3 and 0.1 above its centre", usual="uniform in area: R^2 / (3 h^2)",
    rule="uniform in solid angle: 4 (1 - c) (1 - c^3) / (3 (1 - c^2)^2) - 1, at most 1/3", truth="closed forms",
    unit=UNIT, allowed=4.5,
)  # fmt: skip
def disk_near() -> Found:
    error, lamp, seen_variances = 0.0, Lamp(d.Disk, np.eye(4)), []
    for h in (0.3, 0.1):
        mean, by_area = math.pi / (1.0 + h * h), variances.area_disk(1.0, h) * (1.0 + h * h) ** 2
        by_angle = cap_variance(h / math.hypot(1.0, h))
        for flag, truth in ((False, by_area), (True, by_angle)):
            error = max(error, astray(lamp.irradiances((0.0, 0.0, h), -UP, flag, MANY), mean, truth))
        seen_variances.append(f"{by_area:.3g} and {by_angle:.2g}")
    return Found(error, note=f"Relative variances: {'; '.join(seen_variances)}")


def foot() -> Scene:
    """A wall light [-1, 1] x [0, 2] on a floor, seen by one pixel at its foot, [0, 1/2] x [-1/4, 1/4]."""
    eye = np.diag([1.0, -1.0, -1.0, 1.0])
    eye[:3, 3] = (0.25, 0.0, 8.0)
    camera = d.Camera(eye, fov=math.degrees(2.0 * math.atan(1.0 / 32.0)), width=1, height=1)
    wall = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 1], [0, 0, 0, 1]], float)
    floor = d.Rectangle(to_world=placed(0, 0, 0, 4, 4), front=WHITE)
    lamp = d.Rectangle(to_world=wall, radiance=np.ones(3), front=None)
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


@case(
    "S02", "a pixel with the foot of a light that stands on the floor",
    usual="uniform in area: P(g > t) ~ t^(-3/2), no variance",
    rule="solid angle, or area and BRDF combined: bounded; the study says which is which",
    truth="tail index 3/2", unit="standard errors of Hill's index from 3/2 (NaN if the study is wrong)", allowed=4.5,
    limit=90.0,
)  # fmt: skip
def the_foot_of_a_light() -> Found:
    scene = foot()
    by_area = Probe(scene, "area", Pixel(0, 0)).sample(6, MANY)[:, 0]
    cures = [Probe(scene, name, Pixel(0, 0)).sample(6, MANY)[:, 0] for name in ("area_solid_angle", "mis_balance")]
    index, error = tail_index(by_area, 2.0**-8)
    wrong = not infinite_variance(by_area) or any(infinite_variance(g) for g in cures)
    return Found(math.nan if wrong else abs(index - 1.5) / error, note=f"Hill's index {index:.3f} +- {error:.3f}")


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


@case(
    "S03", "a sphere of radius 1 from 0.1 and 0.03 above its surface",
    usual="uniform in area: 4 R^2 / (3 d^2)", rule="uniform in its cone: at most 1/3", truth="closed form", unit=UNIT,
    allowed=4.5,
)  # fmt: skip
def sphere_near() -> Found:
    error, lamp = 0.0, Lamp(d.Sphere, np.eye(4))
    for above in (0.1, 0.03):
        s = 1.0 / (1.0 + above)
        g = lamp.irradiances((0.0, 0.0, -1.0 - above), UP, n=MANY)
        error = max(error, astray(g, math.pi * s * s, cap_variance(math.sqrt((1.0 - s) * (1.0 + s)))))
    return Found(error)


@njit
def _lobe(n, sin_max, u, v, by_light, by_brdf, both):
    """A Phong lobe within a round light around its middle, f = p_brdf there: by light, by BRDF, one of each."""
    for i in range(len(u)):
        w = sample_cone(UP, sin_max, (u[i, 0], u[i, 1]))
        p, q = pdf_cone(UP, sin_max, w), pdf_phong_lobe(UP, n, w)
        by_light[i] = q / p
        both[i] = q / p * balance(p, q)
        w = sample_phong_lobe(UP, n, (v[i, 0], v[i, 1]))
        p, q = pdf_cone(UP, sin_max, w), pdf_phong_lobe(UP, n, w)
        by_brdf[i] = 1.0 if p > 0.0 else 0.0
        both[i] += by_brdf[i] * balance(q, p)


def lobe(n: float, half_angle: float) -> tuple[float, Array, Array, Array]:
    """The mean, and samples by light, by BRDF and by both."""
    g = [np.empty(MANY) for _ in range(3)]
    _lobe(n, math.sin(half_angle), squares(MANY), squares(MANY, 7), *g)
    most = 2.0 * math.sin(half_angle / 2.0) ** 2
    return -math.expm1((n + 1.0) * math.log1p(-most)), g[0], g[1], g[2]


@case(
    "S04", "a lobe of exponent 100 and 1000 in a light of half angle 1", usual="points on the light: Omega n / (4 pi)",
    rule="combined with the BRDF by the balance heuristic", truth="quadrature", unit=UNIT, allowed=4.5,
)  # fmt: skip
def narrow_lobe() -> Found:
    error, told = 0.0, []
    for n in (100.0, 1000.0):
        by_light, _, both = relative_variances(n, 1.0)
        mean, g, _, h = lobe(n, 1.0)
        error = max(error, astray(g, mean, by_light), astray(h, mean, both))
        told.append(f"{by_light:.3g} and {both:.2g}")
    return Found(error, note=f"Relative variances: {'; '.join(told)}")


@case(
    "S05", "a round light of half angle 0.05 and 0.01 over a diffuse surface, and in a lobe of exponent 100",
    usual="directions of the BRDF: (1 - p) / p", rule="combined with points on the light by the balance heuristic",
    truth="closed form, quadrature", unit=UNIT, allowed=4.5,
)  # fmt: skip
def tiny_light() -> Found:
    error, told = 0.0, []
    for half_angle in (0.05, 0.01):
        p = math.sin(half_angle) ** 2
        hits = np.empty(MANY)
        _hits(squares(MANY), math.cos(half_angle), hits)
        error = max(error, astray(hits, p, (1.0 - p) / p))
        _, by_brdf, both = relative_variances(100.0, half_angle)
        mean, _, g, h = lobe(100.0, half_angle)
        error = max(error, astray(g, mean, by_brdf), astray(h, mean, both))
        told.append(f"{by_brdf:.3g} and {both:.2g}")
    return Found(error, note=f"Relative variances in the lobe: {'; '.join(told)}")


@njit
def _hits(u, cosine, g):
    for i in range(len(u)):
        g[i] = 1.0 if sample_cos_hemisphere(UP, (u[i, 0], u[i, 1])).z > cosine else 0.0


@njit
def _everywhere(n, u, half, whole):
    for i in range(len(u)):
        w = sample_hemisphere(UP, (u[i, 0], u[i, 1]))
        half[i] = pdf_phong_lobe(UP, n, w) * 2.0 * math.pi
        w = sample_sphere((u[i, 0], u[i, 1]))
        whole[i] = pdf_phong_lobe(UP, n, w) * 4.0 * math.pi


@case(
    "S06", "a lobe of exponent 100 and 1000 under a constant sky", usual="uniform over the hemisphere: about n / 2",
    rule="in proportion to the BRDF", truth="(n + 1)^2 / (2 n + 1) - 1", unit=UNIT, allowed=4.5,
)  # fmt: skip
def uniform_hemisphere() -> Found:
    return Found(max(astray(_over(n)[0], 1.0, (n + 1.0) ** 2 / (2.0 * n + 1.0) - 1.0) for n in (100.0, 1000.0)))


@case(
    "S07", "a sky of 32 x 16 texels with a sun of 1e4 : 1 and of 2 : 1, over a diffuse floor",
    usual="cosine-proportional", rule="by brightness; neither is the better one for both", truth="sums over the texels",
    unit=UNIT, allowed=4.5, limit=60.0,
)  # fmt: skip
def sun_or_not() -> Found:
    error, told = 0.0, []
    floor = d.Rectangle(to_world=np.diag([4.0, 4.0, 4.0, 1.0])[[0, 2, 1, 3]] * [[1], [1], [-1], [1]], front=WHITE)
    cosine = np.cos(np.linspace(0.0, math.pi, 17)).clip(0.0)  # at the ends of the rows
    size = np.diff(-np.cos(np.linspace(0.0, math.pi, 17)))[:, None] * (math.pi / 16.0)
    one, two = (-np.diff(cosine**k)[:, None] / k * (math.pi / 16.0) for k in (2, 3))  # of cos and cos^2
    for sun in (1e4, 2.0):
        sky = np.ones((16, 32))
        sky[2, 5] = sun
        mean = float((sky * one).sum())
        truths = {
            "env_cosine": math.pi * float((sky**2 * one).sum()) / mean**2 - 1.0,
            "env_brightness": float((sky * size).sum() * (sky * two).sum()) / mean**2 - 1.0,
        }
        image = d.ImageEnvironment(np.repeat(sky[..., None], 3, axis=2), filter="nearest")
        scene = Scene(d.SceneDescription(shapes=(floor,), environment=image))
        for name, truth in truths.items():
            g = math.pi * seen(scene, name, (0.0, 0.0, 0.0), (0.1, 1.0, 0.2), 4 * FEW)
            error = max(error, astray(g, mean, truth))
        told.append(" and ".join(f"{truth:.3g}" for truth in truths.values()))
    return Found(error, note=f"Relative variances: {'; '.join(told)}")


@case(
    "S08", "the same lobes, by a constant sky's own samples", usual="uniform over the sphere: about n",
    rule="in proportion to the BRDF", truth="2 (n + 1)^2 / (2 n + 1) - 1", unit=UNIT, allowed=4.5,
)  # fmt: skip
def uniform_sphere() -> Found:
    return Found(max(astray(_over(n)[1], 1.0, 2.0 * (n + 1.0) ** 2 / (2.0 * n + 1.0) - 1.0) for n in (100.0, 1000.0)))


def _over(n: float) -> tuple[Array, Array]:
    half, whole = np.empty(MANY), np.empty(MANY)
    _everywhere(n, squares(MANY), half, whole)
    return half, whole


@case(
    "S09", "a point light 0.05 and 0.02 above the middle of a pixel of 1 x 1", usual="a ray at random: P / (8 pi h^2)",
    rule="the same, in strata where the sampler has them", truth="quadrature over the pixel", unit=UNIT, allowed=4.5,
    limit=60.0,
)  # fmt: skip
def point_over_a_pixel() -> Found:
    error, told = 0.0, []
    eye = np.diag([1.0, -1.0, -1.0, 1.0])
    eye[2, 3] = 8.0
    camera = d.Camera(eye, fov=math.degrees(2.0 * math.atan(1.0 / 16.0)), width=1, height=1)
    floor = d.Rectangle(to_world=placed(0, 0, 0, 4, 4), front=WHITE)
    for h in (0.05, 0.02):
        light = d.PointLight(position=np.array([0.0, 0.0, h]), intensity=np.ones(3))
        scene = Scene(d.SceneDescription(camera=camera, shapes=(floor,), lights=(light,)))
        t, wt = gauss(200, 0.0, math.asinh(0.5 / h))  # x = h sinh t
        x, w = h * np.sinh(t), wt * h * np.cosh(t)
        rr = h * h + x[:, None] ** 2 + x**2
        mean, second = (4.0 * float(w @ f @ w) for f in (h / rr**1.5, h * h / rr**3))
        truth = second / mean**2 - 1.0
        g = math.pi * Probe(scene, "point_light", Pixel(0, 0)).sample(6, MANY)[:, 0]
        error = max(error, astray(g, mean, truth), abs(float(g.mean()) / mean - 1.0) / math.sqrt(truth / MANY))
        told.append(f"{truth:.3g}")
    return Found(error, note=f"Relative variances: {', '.join(told)}")


@case(
    "S10", "16 small lights, one of which has all the power", usual="each as often as the others: 15",
    rule="in proportion to power: 0", truth="M - 1", unit=UNIT, allowed=4.5, limit=60.0,
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
    return Found(astray(g, mean, 15.0) if left < 1e-6 else math.nan, note=f"By power {left:.1g}")


@njit
def _on_lens(u, x):
    for i in range(len(u)):
        x[i, 0], x[i, 1] = sample_disk((u[i, 0], u[i, 1]))


@case(
    "S11", "a highlight that 1e-2 and 1e-3 of the lens see", usual="points of the lens: (1 - p) / p",
    rule="the same; no better one is built in", truth="the binomial law", unit=UNIT, allowed=4.5,
)  # fmt: skip
def seen_through_a_lens() -> Found:
    x = np.empty((MANY, 2))
    _on_lens(squares(MANY), x)
    hits = [((x**2).sum(axis=1) < p).astype(float) for p in (1e-2, 1e-3)]
    return Found(max(astray(g, p, (1.0 - p) / p) for g, p in zip(hits, (1e-2, 1e-3), strict=True)))


@case(
    "S12", "a sphere light half below the horizon, of half angle 0.5 and 0.05",
    usual="uniform in its cone: pi^2 E[s^2] / (4 E[s]^2) - 1, s the sine to its axis",
    rule="the same: half of the samples are worth nothing", truth="quadrature over the cone", unit=UNIT, allowed=4.5,
)  # fmt: skip
def half_below() -> Found:
    error, told, lamp = 0.0, [], Lamp(d.Sphere, np.eye(4))
    for half_angle in (0.5, 0.05):
        t, wt = gauss(64)
        x = 2.0 * math.sin(half_angle / 2.0) ** 2 * t**2  # 1 - cos, uniform up to its end
        s, weight = np.sqrt(x * (2.0 - x)), 2.0 * t * wt
        one, two = float(s @ weight), float(s**2 @ weight)
        solid_angle = 4.0 * math.pi * math.sin(half_angle / 2.0) ** 2
        truth = math.pi**2 * two / (4.0 * one**2) - 1.0
        g = lamp.irradiances((-1.0 / math.sin(half_angle), 0.0, 0.0), UP, n=MANY)
        error = max(error, astray(g, solid_angle * one / math.pi, truth))
        told.append(f"{truth:.3f}")
    return Found(error, note=f"Relative variances: {', '.join(told)}")
