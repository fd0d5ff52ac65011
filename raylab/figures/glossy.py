"""Slide "Creating glossy reflections": three jitters, their lobes and their pictures."""

from __future__ import annotations

import functools
import math
from pathlib import Path
from typing import Any

import numpy as np

from raylab import description as d
from raylab import glossy
from raylab.brdf import reflect
from raylab.closed_forms import glossy as forms
from raylab.closed_forms import phong
from raylab.figures import panels
from raylab.figures.registry import figure
from raylab.sampling import pdf_phong_lobe
from raylab.scene import Scene
from raylab.study.look import COLOURS
from raylab.vec3 import Vec3

SLIDE = "Creating glossy reflections"
N = Vec3(0.0, 0.0, 1.0)
JITTERS = {
    "glossy_jitter": "mirror direction jittered",
    "glossy_phong": "Phong, exactly",
    "glossy_normal": "normal jittered",
}


def reflected(name: str, n: float, V: Vec3, w: Vec3) -> float:
    """f_r cos(theta) of a jitter, 1/sr: what comes out of light from the direction w."""
    if name == "glossy_jitter":
        return glossy.pdf_jitter(reflect(V, N), glossy.jitter_radius(n), w)
    if name == "glossy_normal":
        return glossy.pdf_normal(V, N, glossy.normal_exponent(n), w)
    return (n + 2.0) / (n + 1.0) * pdf_phong_lobe(reflect(V, N), n, w) * w.z


def lobes(axes: Any, n: float, degrees: float, low: float, high: float) -> None:
    """f_r cos(theta) in the plane of incidence, against the angle from the normal."""
    V = Vec3(-math.sin(math.radians(degrees)), 0.0, math.cos(math.radians(degrees)))
    angles = np.linspace(low, high, 721)
    for colour, (name, label) in zip(COLOURS, JITTERS.items(), strict=False):
        values = [reflected(name, n, V, Vec3(math.sin(t), 0.0, math.cos(t))) for t in np.radians(angles)]
        axes.plot(angles, values, color=colour, label=label)
    axes.axvline(degrees, color="0.4", linewidth=1.2, linestyle=(0, (6, 4)))
    axes.set(title=f"n = {n:g}, incidence {degrees:g}°", xlabel="angle of w from the normal, degrees")


@figure(
    "glossy_lobes",
    SLIDE,
    """Light reflected per solid angle in the plane of incidence, f_r cos θ, by the three jitters. Left: a narrow lobe
    seen from above, where a jittered normal (exponent 4n + 1) and Phong are nearly the same curve, and the disk of
    offsets has their width but a rim. Middle: a broad lobe at a grazing angle. The horizon at 90° cuts all of them;
    the jittered normal is high because it is narrow across this plane; Phong's cosine takes most away, so that the
    mirror direction (dashed) is not the brightest. Right: what is left of a constant sky, by closed forms: the two
    that only look lose what the horizon cuts off, Phong loses by its cosine long before.""",
)
def glossy_lobes(path: Path) -> None:
    with panels.plots(path, 1, 3, 17.0, 6.0) as (narrow, grazing, share):
        lobes(narrow, 200.0, 10.0, -15.0, 35.0)
        lobes(grazing, 20.0, 75.0, 0.0, 90.0)
        narrow.set_ylabel("f_r cos θ, 1/sr")
        degrees = np.linspace(0.0, 89.0, 90)
        cosines = np.cos(np.radians(degrees))
        n = 20
        values = {
            "glossy_jitter": [forms.jitter_constant_sky(glossy.jitter_radius(n), c) for c in cosines],
            "glossy_phong": [phong.constant_sky(n, c) for c in cosines],
            "glossy_normal": [forms.normal_constant_sky(glossy.normal_exponent(n), c) for c in cosines],
        }
        for colour, (name, label) in zip(COLOURS, JITTERS.items(), strict=False):
            share.plot(degrees, values[name], color=colour, label=label)
        share.set(title=f"Share reflected, n = {n}", xlabel="angle of incidence, degrees", ylim=(0.0, 1.1))
        share.legend(loc="lower left", fontsize=16)


@functools.cache
def stage(height: float, exponent: float) -> Scene:
    """A glossy floor and ball before three upright lamps; a `height` of 6 is 56 degrees of incidence, 1 is 82."""
    shiny = d.Phong(np.zeros(3), np.array([0.9, 0.9, 0.9]), exponent)
    floor = np.diag([12.0, 12.0, 1.0, 1.0])
    lamps = []
    for x, colour in ((-2.2, (9.0, 6.0, 3.0)), (0.0, (7.0, 7.0, 7.0)), (2.2, (3.0, 6.0, 9.0))):
        upright = np.array([[0.22, 0.0, 0.0, x], [0.0, 0.0, -1.0, 4.0], [0.0, 0.7, 0.0, 1.2], [0.0, 0.0, 0.0, 1.0]])
        lamps.append(d.Rectangle(to_world=upright, radiance=np.array(colour) / 4.0, front=None))
    shapes = (
        d.Rectangle(to_world=floor, front=shiny),
        d.Sphere(center=np.array([-1.1, 0.6, 0.6]), radius=0.6, front=shiny),
        *lamps,
    )
    camera = d.Camera(to_world=panels.look_at((0.0, -7.0, height), (0.0, 1.0, 0.4)), fov=38.0, width=200, height=130)
    sky = d.GradientEnvironment(np.full(3, 0.03), np.zeros((3, 3)))
    return Scene(d.SceneDescription(camera=camera, shapes=shapes, environment=sky))


@figure(
    "glossy_jitters",
    SLIDE,
    """One reflected ray per sample, 64 samples, exponent 60; floor and ball reflect the lamps only. Phong's lobe is
    round and blurs sideways as far as lengthwise, and it darkens with the angle of incidence; so is the disk of
    offsets, with a rim instead of a tail. A jittered normal blurs sideways only cos θ times as far: a little
    narrower above, streaks as on a wet street below.""",
)
def glossy_jitters(path: Path) -> None:
    shown = []
    for where, height in (("56°", 6.0), ("82°", 1.0)):
        for name, label in JITTERS.items():
            image = panels.picture(stage(height, 60.0), name, spp=64, sampler="sobol")
            shown.append(panels.Panel(f"{label}, at {where}", image.mean, name))
    panels.row(path, shown, columns=3)
