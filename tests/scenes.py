"""Small scenes that many tests share; few kinds, so that few kernels are compiled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from raylab import description as d
from raylab.scene import Scene

GREY = d.Diffuse(np.full(3, 0.5))
GLOSSY = d.Phong(np.array([0.3, 0.2, 0.1]), np.full(3, 0.4), 40.0)


def look_at(origin, target, up=(0.0, 0.0, 1.0)) -> np.ndarray:
    origin, target = np.asarray(origin, float), np.asarray(target, float)
    forward = (target - origin) / np.linalg.norm(target - origin)
    left = np.cross(up, forward)
    left /= np.linalg.norm(left)
    matrix = np.eye(4)
    matrix[:3, :3] = np.stack([left, np.cross(forward, left), forward], axis=1)
    matrix[:3, 3] = origin
    return matrix


def moved(x: float, y: float, z: float, *size: float) -> np.ndarray:
    matrix = np.diag([*(size or (1.0, 1.0, 1.0)), 1.0])
    matrix[:3, 3] = (x, y, z)
    return matrix


def camera(width: int, fov: float = 45.0) -> d.Camera:
    return d.Camera(to_world=look_at((0, -5, 3), (0, 0, 0.5)), fov=fov, width=width, height=width)


def lamp(size: float = 0.7, radiance: float = 8.0) -> d.Rectangle:
    return d.Rectangle(to_world=moved(1, -1, 3, size, -size, -1), radiance=np.full(3, radiance), front=None)


def room(width: int = 16, material: d.Material = GREY, fov: float = 45.0) -> Scene:
    """A floor, a cube and a rectangular lamp."""
    shapes = (
        d.Rectangle(to_world=moved(0, 0, 0, 4, 4, 1), front=material, back=material, name="floor"),
        d.Cube(to_world=moved(0, 0, 0.5, 0.5, 0.5, 0.5), front=material, name="cube"),
        lamp(),
    )
    return Scene(d.SceneDescription(camera=camera(width, fov), shapes=shapes))


def outdoors(environment: d.Environment, width: int = 16, material: d.Material = GREY, fov: float = 45.0) -> Scene:
    """A floor and a cube under a sky."""
    shapes = (
        d.Rectangle(to_world=moved(0, 0, 0, 4, 4, 1), front=material, back=material, name="floor"),
        d.Cube(to_world=moved(0, 0, 0.5, 0.5, 0.5, 0.5), front=material, name="cube"),
    )
    return Scene(d.SceneDescription(camera=camera(width, fov), shapes=shapes, environment=environment))


# --- motion ---


def turned(degrees, axis=(0.0, 0.0, 1.0), offset=(0.0, 0.0, 0.0), size=(1.0, 1.0, 1.0)):
    m = np.eye(4)
    m[:3, :3] = Rotation.from_rotvec(np.radians(degrees) * np.array(axis)).as_matrix() * np.array(size)
    m[:3, 3] = offset
    return m


def animation(*matrices, times=None):
    return d.Animation(
        np.linspace(0, 1, len(matrices)) if times is None else np.array(times, float), np.array(matrices)
    )


def shutter(eye, opened=0.0, closed=1.0):
    return replace(eye, shutter_open=opened, shutter_close=closed)


def dance(**eye):
    """Everything moves: a mesh, a quadric, a lamp and the camera."""
    lamp_motion = animation(lamp().to_world, moved(0, -1, 3, 0.7, -0.7, -1))
    pan = animation(camera(8).to_world, look_at((0.3, -5, 3), (0.1, 0, 0.5)))
    shapes = (
        d.Rectangle(to_world=moved(0, 0, 0, 4, 4, 1), front=GREY, back=GREY),
        d.Cube(motion=animation(moved(0, 0, 0.5, 0.5, 0.5, 0.5), turned(80, size=(0.5,) * 3, offset=(0.5, 0, 0.6))),
               front=GREY),
        d.Sphere(motion=animation(moved(-1, 0, 0.4, 0.3, 0.3, 0.3), moved(-1, 1, 0.4, 0.3, 0.3, 0.3)), front=GREY),
        replace(lamp(), motion=lamp_motion),
    )  # fmt: skip
    return d.SceneDescription(camera=replace(camera(8), motion=pan, **eye), shapes=shapes)
