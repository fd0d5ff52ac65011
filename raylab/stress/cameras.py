"""Camera and lens at their limits: a closed aperture, focus at 0 and at infinity, a view of nothing."""

from __future__ import annotations

import math
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.geometry import Placement
from raylab.lens import lens_direction
from raylab.sensor import make_camera
from raylab.stress.case import U53, Found, case
from raylab.stress.meshes import refused
from raylab.stress.oracle import exact
from raylab.stress.single import single, vector
from raylab.vec3 import Vec3

Array = npt.NDArray[Any]
HERE = Placement(np.zeros(3), 1.0)
TOWARD = Vec3(0.3, -0.2, 1.0)


def unit(v: Array) -> Array:
    with np.errstate(all="ignore"):
        made: Array = v / np.linalg.norm(v)
    return made


@case(
    "E01", "aperture radius 0, 1000 focus distances", usual="normalise(f toward - p)", rule="no aperture: a pinhole",
    truth="the pinhole's rays, bit for bit", unit="focus distances with another ray",
)  # fmt: skip
def closed_aperture() -> Found:
    rng = np.random.default_rng(1)
    pinhole = make_camera(d.Camera(width=8, height=8), HERE)
    ours = theirs = 0
    for focus in 10.0 ** rng.uniform(-3, 6, 1000):
        eye = make_camera(d.Camera(width=8, height=8, aperture_radius=0.0, focus_distance=float(focus)), HERE)
        film, lens = tuple(rng.random(2)), tuple(rng.random(2))
        ours += eye.ray(3, 5, film, lens, 0.0) != pinhole.ray(3, 5, film, lens, 0.0)
        toward = np.array([*rng.uniform(-0.4, 0.4, 2), 1.0])
        theirs += not np.array_equal(unit(focus * toward - np.zeros(3)), unit(toward))
    return Found(ours, theirs)


@case(
    "E02", "focus at 1e300 and at infinity", usual="normalise(f toward - p)", rule="toward - p / f", truth="mpmath",
    unit="relative error of the direction", allowed=1e-15,
)  # fmt: skip
def focus_at_infinity() -> Found:
    ours = theirs = in_float32 = 0.0
    for focus in (1e300, math.inf):
        truth = np.array(tuple(TOWARD))  # p / f is below 1e-300
        errors = [np.abs(np.array(tuple(w)) - truth).max() for w in (
            lens_direction(TOWARD, focus, 0.1, 0.2),
            single(lens_direction)(vector(TOWARD), np.float32(min(focus, 3e38)), np.float32(0.1), np.float32(0.2)),
        )]  # fmt: skip
        ours, in_float32 = max(ours, errors[0]), max(in_float32, errors[1])
        with np.errstate(all="ignore"):
            usual = unit(focus * truth - np.array([0.1, 0.2, 0.0]))
        theirs = max(theirs, float(np.nan_to_num(np.abs(usual - unit(truth)).max(), nan=np.inf)))
        eye = make_camera(d.Camera(aperture_radius=0.1, focus_distance=focus), HERE)
        o, w, _ = eye.ray(3, 5, (0.25, 0.75), (0.3, 0.6), 0.0)
        if not np.isfinite([*o, *w]).all():
            ours = math.nan
    return Found(ours, theirs, in_float32)


@case(
    "E03", "focus at 0, 1e-300, -1, NaN, -infinity", usual="anything goes", rule="refused, with what is expected",
    truth="SceneError", unit="refusals missing",
)  # fmt: skip
def focus_at_nothing() -> Found:
    missing = 0
    for focus in (0.0, 1e-300, -1.0, math.nan, -math.inf):
        eye = d.Camera(aperture_radius=0.1, focus_distance=focus)
        missing += not refused(partial(make_camera, eye, HERE), "focus_distance must")
    return Found(missing)


@case(
    "E04", "aperture of radius 1e6, focus at 1, depths 0.5 to 1000", usual="normalise(f toward - p)",
    rule="toward - p / f", truth="radius of the blur R |1/f - 1/z|", unit="relative error of the radius",
    allowed=1e-12,
)  # fmt: skip
def huge_aperture() -> Found:
    radius, focus = 1e6, 1.0
    worst = [0.0, 0.0, 0.0]
    for turn in np.linspace(0.0, 1.0, 7):
        px, py = radius * math.cos(2 * math.pi * turn), radius * math.sin(2 * math.pi * turn)
        toward, p = np.array(tuple(TOWARD)), np.array([px, py, 0.0])
        usual = unit(focus * toward - p)
        directions = (
            np.array(tuple(lens_direction(TOWARD, focus, px, py))),
            usual / usual[2],
            np.array(tuple(single(lens_direction)(vector(TOWARD), *map(np.float32, (focus, px, py)))), float),
        )
        for depth in (0.5, 2.0, 10.0, 1000.0):
            blur = math.hypot(px, py) * abs(1.0 / focus - 1.0 / depth)
            for k, w in enumerate(directions):
                found = np.linalg.norm((p + depth * w) / depth - toward)
                worst[k] = max(worst[k], abs(float(found) / blur - 1.0))
    return Found(worst[0], worst[1], worst[2])


@case(
    "E05", "a point in the plane of focus, depths 0.5 to 1e6, aperture up to half the depth",
    usual="normalise(f toward - p)", rule="toward - p / f", truth="all rays meet in f toward",
    unit="spread over the depth", allowed=4 * U53,
)  # fmt: skip
def in_focus() -> Found:
    m = exact()
    rng = np.random.default_rng(2)
    worst = [0.0, 0.0, 0.0]
    for depth in (0.5, 1.0, 3.7, 1e3, 1e6):
        for _ in range(50):
            px, py = (float(x) for x in rng.uniform(-0.35, 0.35, 2) * depth)
            usual = unit(depth * np.array(tuple(TOWARD)) - [px, py, 0.0])
            in_float32 = single(lens_direction)(vector(TOWARD), *map(np.float32, (depth, px, py)))
            for k, w in enumerate((lens_direction(TOWARD, depth, px, py), usual / usual[2], in_float32)):
                for start, step, aim in zip((px, py), w, TOWARD, strict=False):
                    off = m.mpf(start) + m.mpf(depth) * m.mpf(float(step)) - m.mpf(depth) * m.mpf(aim)
                    worst[k] = max(worst[k], abs(float(off)) / depth)
    return Found(worst[0], worst[1], worst[2])


LOOKS = {
    "target at the origin": ("1 2 3", "1 2 3", "0 1 0", "must not be the same point"),
    "up along the view": ("1 2 3", "1 2 9", "0 0 5", "must not be parallel"),
    "up against the view": ("0.1 0.2 0.3", "1.3 0.5 0.4", "-1.2 -0.3 -0.1", "must not be parallel"),
}


@case(
    "E10", "look_at with the target where the eye is, with up along and against the view", usual="cross and normalise",
    rule="refused, with file and line", truth="SceneError", unit="refusals missing (usual: NaN)",
)  # fmt: skip
def looking_nowhere() -> Found:
    missing = theirs = 0
    for origin, target, up, words in LOOKS.values():
        missing += not refused(partial(read_look, origin, target, up), rf"scene\.xml:2: .*{words}")
        eye, at, above = (np.array(text.split(), float) for text in (origin, target, up))
        theirs += bool(np.isnan(unit(np.cross(above, unit(at - eye)))).any())
    return Found(missing, theirs)


def read_look(origin: str, target: str, up: str) -> object:
    """Read a scene whose camera looks so."""
    from raylab.io.mitsuba_xml import read

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.xml"
        look = f'<lookat origin="{origin}" target="{target}" up="{up}"/>'
        path.write_text(
            '<scene version="3.0.0"><integrator type="direct"/><sensor type="perspective">\n'
            f'<transform name="to_world">{look}</transform></sensor></scene>'
        )
        return read(path, {})
