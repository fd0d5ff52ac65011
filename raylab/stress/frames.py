"""Frames: directions around a normal that is odd, missing, or not that of the facet."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.errors import SceneError
from raylab.geometry import local_mesh
from raylab.sampling import frame, sample_cos_hemisphere
from raylab.scene import Scene
from raylab.stress.case import U24, U53, Found, case
from raylab.stress.lamps import UP, squares
from raylab.stress.nearness import WHITE, seen
from raylab.stress.oracle import exact
from raylab.stress.single import single, vector
from raylab.surface import SmoothNormals
from raylab.vec3 import Vec3
from raylab.view import View

Array = npt.NDArray[np.float64]


def deviation(frame: tuple[Any, Any], normal: Any) -> float:
    """How far s, t and n are from orthonormal: the largest error of a product of two."""
    m = exact()
    s, t, n = ([m.mpf(float(x)) for x in v] for v in (*frame, normal))
    products = [(s, s, 1), (t, t, 1), (s, t, 0), (s, n, 0), (t, n, 0)]
    return float(max(abs(sum(a * b for a, b in zip(p, q, strict=True)) - r) for p, q, r in products))


def frisvad(n: Any) -> tuple[Any, Any]:
    """Frisvad 2012, without a branch for n.z near -1."""
    x, y, z = n
    a = 1.0 / (1.0 + z)
    b = -x * y * a
    return (1.0 - x * x * a, b, -x), (b, 1.0 - y * y * a, -y)


@case(
    "C11", "the frame of n = (6e-3, 8e-3, -0.99995)", usual="Frisvad 2012", rule="Duff et al. 2017, copysign",
    truth="orthonormal, 60 digits", unit="largest error of a product of two of s, t, n", allowed=4 * U53,
)  # fmt: skip
def steep_normals() -> Found:
    n = Vec3(*(np.array([6e-3, 8e-3, -0.99995]) / np.linalg.norm([6e-3, 8e-3, -0.99995])))
    in_float32 = deviation(single(frame)(vector(n)), vector(n))
    return Found(deviation(frame(n), n), deviation(frisvad(tuple(n)), n), in_float32)


def mesh(normals: npt.ArrayLike | None) -> d.Mesh:
    """A square in the plane z = 0 with vertex normals."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
    faces, n = np.array([[0, 1, 2], [0, 2, 3]]), None if normals is None else np.asarray(normals, float)
    return d.Mesh(vertices=corners, faces=faces, normals=n, front=WHITE)


@case(
    "C12", "the frame of (0, 0, -1) and of z = -0; vertex normals that are 0, NaN or of length 2",
    usual="Frisvad 2012; any normal", rule="copysign; not finite: refused; the rest is brought to length 1 or left out",
    truth="orthonormal", unit="largest error of a product, 1 for a NaN that is not refused", allowed=4 * U53,
)  # fmt: skip
def odd_normals() -> Found:
    error = usual = 0.0
    for n in ((0.0, 0.0, -1.0), (1.0, 0.0, -0.0), (0.6, -0.8, -0.0)):
        error = max(error, deviation(frame(Vec3(*n)), n))
        with np.errstate(all="ignore"):
            around = frisvad(np.array(n))
        usual = max(usual, deviation(around, n) if np.isfinite(around).all() else math.inf)
    for size in (2.0, 0.0):
        normals = interpolated([(0.0, 0.0, size)] * 3, (0.3, 0.3, 0.4))
        error = max(error, deviation(frame(normals), normals))
    try:
        local_mesh(mesh([(0.0, 0.0, math.nan)] * 4))
        error = 1.0
    except SceneError as refusal:
        error = error if "normals must be finite" in str(refusal) else 1.0
    return Found(error, usual)


def interpolated(normals: Any, b: tuple[float, float, float]) -> Vec3:
    """The shading normal at barycentric coordinates b of a facet in the plane z = 0 with these vertex normals."""
    still = Scene(d.SceneDescription()).data.motion
    rows = SmoothNormals(View(np.asarray(normals, np.float32)))
    found: Vec3 = rows.at(still, 0, 0, 1, 2, Vec3(*b), UP)
    return found


@case(
    "C13", "directions by the cosine for u1 in {1 - 2^-24, 1 - 2^-53, 1}, 1000 of u2 each, and 17,000 others",
    usual="z = sqrt(1 - x^2 - y^2) of a point of the disk, in float32", rule="z = sqrt(1 - u1)",
    truth="z is at least 0", unit="directions with a NaN or below the horizon", allowed=0.0,
)  # fmt: skip
def at_the_horizon() -> Found:
    others = [(float(u), float(v)) for u, v in squares(17_000)]
    places = [(u, v) for u in (1.0 - 2.0**-24, 1.0 - 2.0**-53, 1.0) for _, v in others[:1000]] + others
    ours = sum(not sample_cos_hemisphere(UP, u).z >= 0.0 for u in places)
    few = single(sample_cos_hemisphere)
    in_float32 = sum(not few(vector(UP), (np.float32(u), np.float32(v))).z >= 0.0 for u, v in places[:5000])
    u = np.array(places, np.float32)
    r, phi = np.sqrt(u[:, 0]), np.float32(2.0 * math.pi) * u[:, 1]
    x, y = r * np.cos(phi), r * np.sin(phi)
    return Found(ours, int((np.float32(1.0) - x * x - y * y < 0.0).sum()), in_float32)


@case(
    "C14", "vertex normals that cancel, that all but cancel, and that are not numbers", usual="N / |N|",
    rule="the facet's normal where they cancel; NaN is refused", truth="a unit normal, or a sentence",
    unit="normals that are not of length 1", allowed=0.0,
)  # fmt: skip
def opposite_normals() -> Found:
    wrong = usual = 0
    for tiny in (0.0, 1e-30, 1e-6):
        corners = [(1.0, 0.0, 0.0), (-1.0, 0.0, tiny), (0.0, 0.0, 0.0)]
        N = np.array(tuple(interpolated(corners, (0.5, 0.5, 0.0))))
        wrong += not abs(float(N @ N) - 1.0) <= 4 * U53
        with np.errstate(all="ignore"):
            mean = np.asarray(corners, np.float32)[:2].mean(axis=0)
            mean = mean / np.sqrt((mean * mean).sum())
        usual += not abs(float(mean @ mean) - 1.0) <= 1e-6
    for bad in (math.nan, math.inf):
        try:
            local_mesh(mesh([(bad, 0.0, 1.0)] * 4))
            wrong += 1
        except SceneError:
            continue  # refused, as it must be
    return Found(wrong, usual)


@case(
    "C15", "a facet whose shading normal leans by 40 degrees, under a sun that goes from horizon to horizon",
    usual="max(0, w . N) alone", rule="no light from below the facet's horizon, or below that of the shading normal",
    truth="cos to the shading normal, 0 below either horizon", unit="largest error of the radiance, times pi",
    allowed=4 * U24, limit=60.0,  # normals are float32
)  # fmt: skip
def another_horizon() -> Found:
    lean = math.radians(40.0)
    leaning = mesh([(math.sin(lean), 0.0, math.cos(lean))] * 4)
    error = usual = 0.0
    for degrees in range(-85, 95, 10):
        w = np.array([math.sin(math.radians(degrees)), 0.0, math.cos(math.radians(degrees))])
        for height in (w, w * (1.0, 1.0, -1.0)):  # and from below
            sun = d.DirectionalLight(direction=-height, irradiance=np.ones(3))
            scene = Scene(d.SceneDescription(shapes=(leaning,), lights=(sun,)))
            g = math.pi * float(seen(scene, "directional_light", (0.0, 0.0, 0.0), (0.1, 0.2, 1.0), 1)[0])
            cosine = max(0.0, height[0] * math.sin(lean) + height[2] * math.cos(lean))
            truth = cosine if height[2] > 0.0 else 0.0
            error, usual = max(error, abs(g - truth)), max(usual, abs(cosine - truth))
    return Found(error, usual)
