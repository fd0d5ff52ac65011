"""Trials in motion: a light that rises, and an edge that crosses a pixel, while the shutter is open."""

from __future__ import annotations

import math

import numpy as np

from raylab import description as d
from raylab.closed_forms import blur
from raylab.closed_forms import irradiance as forms
from raylab.probe import Pixel
from raylab.trials.lights import by_all
from raylab.trials.trial import LUMINANCE, Answer, Array, Trial, Z, affine, colour, moved, random_pose, stage, unit


def rising_light(rng: np.random.Generator) -> Trial:
    """A level disk rises above x; an upright disk stands still. The bound is that of the lowest place."""
    reflectance, turn = colour(rng), rng.uniform(0, 360)
    level, first, last = rng.uniform(0.3, 0.4), rng.uniform(0.8, 1.0), rng.uniform(1.6, 2.4)
    upright, far, up = rng.uniform(0.3, 0.5), rng.uniform(1.3, 1.6), rng.uniform(0.6, 0.9)
    colours = [colour(rng, 0.5, 5.0) for _ in range(2)]
    facing = np.diag([level, -level, -1.0])
    path = np.array([affine(facing, height * Z) for height in (first, last)])
    wall, n = far * unit(0, turn) + up * Z, -unit(0, turn)
    standing = affine(np.stack([Z, np.cross(n, Z), n], axis=1) @ np.diag([upright, upright, 1.0]), wall)
    shapes = (
        d.Disk(motion=d.Animation(np.array([0.0, 1.0]), path), radiance=colours[0], front=None),
        d.Disk(to_world=standing, radiance=colours[1], front=None),
    )
    truth = colours[0] * math.pi * blur.moving_disk_light(level, first, last)
    truth = truth + colours[1] * forms.disk_perpendicular(upright, far, up)
    steep = (math.pi * level**2 / first**2, math.pi * upright**2 * far / math.hypot(far, max(0.0, up - upright)) ** 3)
    f_r = reflectance / math.pi
    bounds = np.array([f_r * c * s for c, s in zip(colours, steep, strict=True)])
    powers = [r**2 * float(LUMINANCE @ c) for r, c in zip((level, upright), colours, strict=True)]
    answers = by_all(f_r * truth, bounds, reflectance * np.max(colours, axis=0), powers)
    material, view = d.Diffuse(reflectance), unit(50, turn + 130)
    return stage("rising_light", rng, answers, material=material, shapes=shapes, view=view)


def crossing_edge(rng: np.random.Generator) -> Trial:
    """A luminous half plane enters a pixel and covers part of it in the end; a sample is its radiance or nothing."""
    depth, fov, radiance, pose = rng.uniform(2.0, 4.0), rng.uniform(0.5, 1.5), colour(rng, 0.5, 5.0), random_pose(rng)
    half = depth * math.tan(math.radians(0.5 * fov))
    first, speed = rng.uniform(-1.6, -0.8) * half, rng.uniform(1.2, 2.2) * half

    def at(edge: float) -> Array:  # x < edge, 20 pixels wide and high; the camera looks along +z
        return affine(np.diag([20.0 * half, -20.0 * half, -1.0]), (edge - 20.0 * half, 0.0, depth))

    path = d.Animation(np.array([0.0, 1.0]), np.array([at(first), at(first + speed)]))
    share = blur.moving_edge(first, speed, (-half, half))
    camera = d.Camera(to_world=pose, fov=fov, width=1, height=1, shutter_open=0.0, shutter_close=1.0)
    light = moved(pose, d.Rectangle(motion=path, radiance=radiance, front=None))
    described = d.SceneDescription(camera=camera, shapes=(light,), sampler="independent", name="crossing_edge")
    answer = Answer.of(radiance * share, radiance, radiance**2 * share * (1.0 - share))
    # the edge is off by 2^-24 of the scene, which is some 20 pixels wide and as far away as 200 of them
    return Trial("crossing_edge", described, {"direct": answer}, Pixel(0, 0), 1e-4)
