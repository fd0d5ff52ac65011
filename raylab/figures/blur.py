"""Slides "Depth of field" and "Motion blur": the causes in pictures, and how fast their noise falls."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from raylab import description as d
from raylab.closed_forms import blur
from raylab.figures import panels
from raylab.figures.registry import figure
from raylab.scene import Scene

SIZE = {"width": 240, "height": 160}
EXPOSURE = 0.6
SAMPLES = (4, 16, 64, 256)
APERTURE, FOCUS, DEPTH, AIMED_AT = 0.1, 4.0, 2.5, 0.03
PASSES, SPEED = 0.3, 2.0  # when the moving edge passes the pixel, and how fast


@figure(
    "depth_of_field",
    "Depth of field",
    """Six balls in depth, each on its line. A point aperture is in focus everywhere; a finite one at one depth only,
    and pulling the focus chooses which. The last aperture is wider and has five blades.""",
)
def depth_of_field(path: Path) -> None:
    def lens(title: str, **parameters: Any) -> panels.Panel:
        scene = panels.scene("depth_of_field", **SIZE, **parameters)
        return panels.Panel(title, EXPOSURE * panels.picture(scene, spp=64).mean)

    row = [
        lens("point aperture", aperture=0),
        lens("finite aperture, focus on the third ball"),
        lens("focus pulled to the first", focus=3.1),
        lens("wider, with five blades", blades=5, aperture=0.3),
    ]
    panels.row(path, row, columns=2)


@figure(
    "motion_blur",
    "Motion blur",
    """A ball flies and a fan turns while the shutter is open. Frozen, as if by strobe light; the mean of four such
    instants, which is strobing without blur; and times distributed over the shutter interval.""",
)
def motion_blur(path: Path) -> None:
    def shot(opened: float, closed: float, spp: int) -> Any:
        scene = panels.scene("motion_blur", **SIZE, open=opened, close=closed)
        return EXPOSURE * panels.picture(scene, spp=spp).mean

    strobe = np.mean([shot(t, t, 16) for t in 0.3 + 0.4 * (np.arange(4) + 0.5) / 4], axis=0)
    row = [
        panels.Panel("frozen", shot(0.5, 0.5, 64)),
        panels.Panel("strobe: 4 instants", strobe),
        panels.Panel("blurred: random times", shot(0.3, 0.7, 64)),
    ]
    panels.row(path, row)


def lens_edge() -> tuple[Scene, float]:
    """Pixels that all aim beside the edge of a shining half-plane out of focus, and what they see."""
    eye = d.Camera(fov=1e-6, width=32, height=32, aperture_radius=APERTURE, focus_distance=FOCUS)
    place = np.diag([-50.0, 50.0, -1.0, 1.0])
    place[:3, 3] = (-AIMED_AT * DEPTH / FOCUS - 50.0, 0.0, DEPTH)
    plane = d.Rectangle(to_world=place, radiance=np.ones(3), front=None)
    truth = float(blur.half_plane_through_lens(AIMED_AT, APERTURE, FOCUS, DEPTH))
    return Scene(d.SceneDescription(camera=eye, shapes=(plane,))), truth


def moving_edge() -> tuple[Scene, float]:
    """Pixels like points that the edge of a shining half-plane passes while the shutter is open."""
    places = np.stack([np.diag([-50.0, 50.0, -1.0, 1.0])] * 2)
    places[:, :3, 3] = [(-PASSES * SPEED - 50.0, 0.0, 10.0), ((1.0 - PASSES) * SPEED - 50.0, 0.0, 10.0)]
    motion = d.Animation(np.array([0.0, 1.0]), places)
    plane = d.Rectangle(motion=motion, radiance=np.ones(3), front=None)
    eye = d.Camera(fov=1e-6, width=32, height=32, shutter_close=1.0)
    return Scene(d.SceneDescription(camera=eye, shapes=(plane,))), 1.0 - PASSES


def errors(scene: Scene, truth: float, sampler: str) -> list[float]:
    """Root mean square error of a pixel against the closed form, of n samples of one stream."""
    streams = 1 if sampler == "independent" else 2
    found = []
    for n in SAMPLES:
        pixels = panels.picture(scene, sampler=sampler, spp=n * streams).mean[..., 0]
        found.append(float(np.sqrt(((pixels - truth) ** 2).mean() * streams)))
    return found


@figure(
    "blur_convergence",
    "Motion blur (time)",
    """The share of a blurred edge that a pixel sees, against the closed form. Random points: 1/√N. Stratified points on
    the lens: N^-3/4, since only the cells on the edge make noise, √N of N. Stratified times: 1/N, since the edge passes
    in one stratum only.""",
)
def blur_convergence(path: Path) -> None:
    lines = []
    for name, (scene, truth) in (("lens", lens_edge()), ("time", moving_edge())):
        for sampler in ("independent", "stratified"):
            error = errors(scene, truth, sampler)
            lines.append(panels.Line(f"{name}, {sampler}", SAMPLES, error))
    with panels.plot(path) as axes:
        axes.set(
            title="Coverage by an edge: out of focus, and in motion", xlabel="N samples", ylabel="error of a pixel"
        )
        panels.power_laws(axes, lines)
