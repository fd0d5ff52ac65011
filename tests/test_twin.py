"""The same source, compiled and in plain Python, gives the same picture; `make test` runs this file both ways.

Compiled, the pictures are written down in numbers by a second process without the compiler, and compared.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scenes import GLOSSY, camera, lamp, moved, outdoors, room

from raylab import description as d
from raylab.render import render
from raylab.scene import Scene


def quadrics() -> Scene:
    """A sphere, a disk and a cylinder under a spherical lamp and a point light."""
    grey = d.Diffuse(np.full(3, 0.5))
    return Scene(
        d.SceneDescription(
            camera=camera(4),
            shapes=(
                d.Sphere(center=np.array([0, 0, 0.6]), radius=0.6, front=grey),
                d.Disk(to_world=moved(0, 0, 0, 3, 3, 1), front=grey),
                d.Cylinder(p0=np.array([1.0, 0, 0]), p1=np.array([1.0, 0.2, 1]), radius=0.3, front=grey, back=grey),
                d.Sphere(center=np.array([1, -2, 3.0]), radius=0.5, radiance=np.full(3, 9.0), front=None),
            ),
            lights=(d.PointLight(np.array([-2.0, -2, 4]), np.full(3, 5.0)),),
        )
    )


def through_lens(blades: int) -> Scene:
    """The room through a thin lens."""
    eye = replace(camera(4), aperture_radius=0.2, focus_distance=4.0, aperture_blades=blades, aperture_rotation=10.0)
    return Scene(replace(room(4).description, camera=eye))


def mirrors() -> Scene:
    """A metal ball and a glass ball on a floor, under a lamp, a point light and a sky."""
    glass = d.Dielectric(1.5, 1.0, np.array([1.0, 0.9, 0.8]), np.array([0.9, 1.0, 0.9]))
    gold = d.Conductor(np.array([0.2, 0.4, 1.3]), np.array([3.9, 2.4, 1.9]))
    return Scene(
        d.SceneDescription(
            camera=camera(4),
            shapes=(
                d.Rectangle(to_world=moved(0, 0, 0, 4, 4, 1), front=d.Diffuse(), back=d.Diffuse()),
                d.Sphere(center=np.array([-0.7, 0, 0.8]), radius=0.7, front=glass, back=glass.inside),
                d.Sphere(center=np.array([0.9, 0, 0.8]), radius=0.7, front=gold),
                lamp(),
            ),
            lights=(d.PointLight(np.array([-2.0, -2, 4]), np.full(3, 5.0)),),
            environment=d.ConstantEnvironment(np.full(3, 0.5)),
        )
    )


def dance() -> Scene:
    """A mesh turns, a ball and two lamps move, and so does a camera with a lens."""

    def moving(*matrices: np.ndarray) -> d.Animation:
        return d.Animation(np.array([0.0, 1.0]), np.array(matrices))

    turned = moved(0, 0, 0.5, 0.5, 0.5, 0.5)
    turned[:2, :2] = [[0.3, -0.4], [0.4, 0.3]]
    ball = np.asarray([[-1.0, 0, 0.4], [-1, 0.5, 0.4]])
    shapes = (
        *room(4).description.shapes[:1],
        d.Cube(motion=moving(moved(0, 0, 0.5, 0.5, 0.5, 0.5), turned), front=GLOSSY),
        d.Sphere(radius=0.3, motion=moving(*(moved(*p) for p in ball)), front=GLOSSY),
        replace(lamp(), motion=moving(lamp().to_world, moved(0, -1, 3, 0.7, -0.7, -1))),
        d.Sphere(radius=0.3, motion=moving(moved(0, -2, 3), moved(1, -2, 3)), radiance=np.full(3, 5.0), front=None),
    )
    pan = moving(camera(4).to_world, moved(0.1, 0, 0) @ camera(4).to_world)
    eye = replace(camera(4), motion=pan, shutter_close=1.0, aperture_radius=0.1, focus_distance=5.0)
    return Scene(d.SceneDescription(camera=eye, shapes=shapes))


def scenes() -> dict[str, tuple[Scene, str, str]]:
    image = np.random.default_rng(3).random((6, 12, 3))
    texture = d.Diffuse(d.Bitmap(np.random.default_rng(4).random((3, 5, 3))))
    sun = d.SceneDescription(
        camera=camera(4),
        shapes=(d.Rectangle(to_world=moved(0, 0, 0, 4, 4, 1), front=texture), lamp()),
        lights=(d.DirectionalLight(np.array([0.2, 0.1, -1.0]), np.ones(3)),),
    )
    return {
        "area": (room(4), "area", "sobol"),
        "area_diffuse": (room(4), "area_diffuse", "stratified"),
        "glossy": (room(4, GLOSSY), "direct", "independent"),
        "uniform": (outdoors(d.ConstantEnvironment(np.ones(3)), 4), "env_uniform", "independent"),
        "cosine": (outdoors(d.GradientEnvironment(np.ones(3), 0.5 * np.eye(3)), 4), "env_cosine", "sobol"),
        "image": (outdoors(d.ImageEnvironment(image), 4, GLOSSY), "direct", "independent"),
        "brightness": (outdoors(d.ImageEnvironment(image, filter="nearest"), 4), "env_brightness", "independent"),
        "quadrics": (quadrics(), "direct", "independent"),
        "motion": (dance(), "direct", "sobol"),
        "lens": (through_lens(0), "area", "sobol"),
        "lens with blades": (through_lens(5), "area", "stratified"),
        "mirrors": (mirrors(), "direct", "independent"),
        "basic": (mirrors(), "basic", "independent"),
        "rough": (room(4, d.RoughConductor(alpha_u=0.3, alpha_v=0.3)), "direct", "sobol"),
        "texture and sun": (Scene(sun), "direct", "independent"),
    }


def pictures() -> dict[str, list[float]]:
    return {
        name: render(scene, shade, sampler=sampler, spp=4, seed=2, threads=1).mean.ravel().tolist()
        for name, (scene, shade, sampler) in scenes().items()
    }


def test_plain_python_renders_every_kind_of_scene():
    """Runs in whichever world this process is in: no NaN, nothing black."""
    for name, picture in pictures().items():
        assert np.isfinite(picture).all(), name
        assert max(picture) > 0, name


@pytest.mark.compiled(reason="compares with a process that has no compiler")
def test_compiled_and_plain_python_agree():
    """To rounding: the compiler may fuse nothing, but the C library's sin and exp may differ in the last digit."""
    environment = dict(os.environ, NUMBA_DISABLE_JIT="1", PYTHONPATH=str(Path(__file__).parent))
    program = "import json, test_twin; print(json.dumps(test_twin.pictures()))"
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    plain, compiled = json.loads(done.stdout), pictures()
    assert plain.keys() == compiled.keys()
    for name, picture in compiled.items():
        np.testing.assert_allclose(picture, plain[name], rtol=1e-9, atol=1e-12, err_msg=name)
