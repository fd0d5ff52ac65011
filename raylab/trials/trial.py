"""Trial: a scene, where to look, and what must come out; and the parts that trials are made of."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.errors import UserError
from raylab.probe import Pixel, Place, Probe
from raylab.scene import Scene

Array = npt.NDArray[np.float64]
X, Y, Z = np.eye(3)
BLACK = np.zeros(3)
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of linear sRGB, as `raylab.vec3.luminance`
# Vertices are float32 in a scene of extent E: off by 2^-24 E. With E at most ten times the distances that count, and
# radiance at most of order 4 in them (1/r^2 and two cosines), truths are off by 40 * 2^-24; bounds, with 1/r^3, little
# more. Rounded up.
TRUTH_ERROR, SLACK = 2.0**-18, 2.0**-16


@dataclass(frozen=True, eq=False)
class Answer:
    """What a technique must give, per channel: mean `truth`, samples in [0, `bound`], `variance` where it is known."""

    truth: Array
    bound: Array
    variance: Array | None = None

    @classmethod
    def of(cls, truth: npt.ArrayLike, bound: npt.ArrayLike, variance: npt.ArrayLike | None = None) -> Answer:
        """Room for the rounding of the scene is added to the bound."""
        top = np.broadcast_to(np.asarray(bound, np.float64), 3) * (1.0 + SLACK)
        exact = None if variance is None else np.broadcast_to(np.asarray(variance, np.float64), 3)
        return cls(np.broadcast_to(np.asarray(truth, np.float64), 3), top, exact)


@dataclass(frozen=True, eq=False)
class Trial:
    """`answers` by the name of the technique; the truth is known within the relative error `truth_error`."""

    name: str
    description: d.SceneDescription
    answers: Mapping[str, Answer]
    look: tuple[Array, Array] | Pixel  # point and view direction, or a pixel of the camera
    truth_error: float = TRUTH_ERROR

    @cached_property
    def scene(self) -> Scene:
        return Scene(self.description)

    @property
    def place(self) -> Place | Pixel:
        return self.look if isinstance(self.look, Pixel) else Place.at(self.scene, *self.look)

    def probe(self, shade: str | Callable[..., Any], threads: int = 0) -> Probe:
        """Samples of a shade() in this trial."""
        return Probe(self.scene, shade, self.place, threads)

    def answer(self, technique: str) -> Answer:
        """What `technique` must give; UserError where this trial does not know."""
        if technique not in self.answers:
            raise UserError(
                f"trial {self.name!r} has no answer for {technique!r}; expected one of {', '.join(self.answers)}"
            )
        return self.answers[technique]


# --- placing ---


def unit(elevation: float, azimuth: float) -> Array:
    """The unit vector at an elevation over the horizon and an azimuth from +x, degrees."""
    e, a = math.radians(elevation), math.radians(azimuth)
    return np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])


def random_pose(rng: np.random.Generator) -> Array:
    """A rotation, uniform among all, and a translation, as a (4, 4) matrix. Source: Shoemake 1992, quaternions."""
    w, x, y, z = q = rng.normal(size=4)
    n = 2.0 / (q @ q)
    pose = np.eye(4)
    pose[:3, :3] = np.eye(3) - n * np.array(
        [
            [y * y + z * z, w * z - x * y, -w * y - x * z],
            [-w * z - x * y, x * x + z * z, w * x - y * z],
            [w * y - x * z, -w * x - y * z, x * x + y * y],
        ]
    )
    pose[:3, 3] = rng.uniform(-3.0, 3.0, 3)
    return pose


def affine(linear: npt.ArrayLike, offset: npt.ArrayLike) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, offset
    return matrix


def moved(pose: Array, shape: d.Shape) -> d.Shape:
    motion = shape.motion and replace(shape.motion, matrices=pose @ shape.motion.matrices)
    return replace(shape, to_world=pose @ shape.to_world, motion=motion)


def moved_point(pose: Array, p: npt.ArrayLike) -> Array:
    return pose[:3, :3] @ np.asarray(p, np.float64) + pose[:3, 3]


def colour(rng: np.random.Generator, low: float = 0.1, high: float = 0.9) -> Array:
    """Three numbers, no two of them alike: in a shuffled third of the range each."""
    thirds = rng.permutation(3) + rng.uniform(0.2, 0.8, 3)
    return low + (high - low) * thirds / 3.0


def stage(
    name: str,
    rng: np.random.Generator,
    answers: Mapping[str, Answer],
    *,
    material: d.Material,
    shapes: tuple[d.Shape, ...] = (),
    lights: tuple[d.Light, ...] = (),
    sky: Callable[[Array], d.Environment] | None = None,
    view: Array,
) -> Trial:
    """A small receiver at the origin with normal +z, seen along -view, and all else; then everything is moved.

    `lights` are given before the move as well, `sky` is a function of the rotation.
    """
    pose = random_pose(rng)
    receiver = d.Rectangle(to_world=affine(np.diag([0.05, 0.05, 1.0]), BLACK), front=material)
    described = d.SceneDescription(
        camera=d.Camera(to_world=pose, width=1, height=1, shutter_open=0.0, shutter_close=1.0),
        shapes=tuple(moved(pose, shape) for shape in (receiver, *shapes)),
        lights=tuple(_moved_light(pose, light) for light in lights),
        environment=sky(pose[:3, :3]) if sky else None,
        sampler="independent",
        name=name,
    )
    return Trial(name, described, answers, (moved_point(pose, BLACK), pose[:3, :3] @ view))


def _moved_light(pose: Array, light: d.Light) -> d.Light:
    if isinstance(light, d.PointLight):
        return replace(light, position=moved_point(pose, light.position))
    assert isinstance(light, d.DirectionalLight)
    return replace(light, direction=pose[:3, :3] @ light.direction)
