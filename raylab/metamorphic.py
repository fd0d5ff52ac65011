"""Metamorphic relations: changes of a scene after which an estimator must answer the same. No truth is needed.

Each relation changes the description of any scene, and says what is to be expected of the samples there, by any
shade() whatever, at the place that corresponds:

    bitwise        each sample the same, bit for bit, with the same random numbers
    rounding       each sample the same but for rounding, of which a few may fall on the other side of an edge
    distribution   other random numbers meet other places, but samples are spread alike
    mean           only the mean is the same

"Same" means `factor` times the original. A relation that does not apply to a scene is None.
Source: Chen, Cheung, Yiu 1998, "Metamorphic testing".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.probe import Pixel, Place
from raylab.trials.trial import Trial, affine, random_pose

Array = npt.NDArray[np.float64]
Expected = Literal["bitwise", "rounding", "distribution", "mean"]


@dataclass(frozen=True, eq=False)
class Relation:
    """A changed scene, the map of its points (4, 4), and what to expect there."""

    name: str
    description: d.SceneDescription
    expected: Expected
    factor: float = 1.0
    points: Array | None = None

    def place(self, place: Place | Pixel) -> Place | Pixel:
        """Where a place of the original scene has gone."""
        if self.points is None:
            return place
        if isinstance(place, Pixel):
            mirrored = np.linalg.det(self.points[:3, :3]) < 0.0
            return Pixel(self.description.camera.width - 1 - place.column, place.row) if mirrored else place
        linear, offset = self.points[:3, :3], self.points[:3, 3]
        return Place(linear @ place.origin + offset, linear @ place.direction)

    def trial(self, trial: Trial) -> Trial:
        """A trial after the change; its answers are those of before, and to be multiplied by `factor`."""
        look: Any = trial.look
        if isinstance(look, Pixel):
            look = self.place(look)
        elif self.points is not None:
            linear, offset = self.points[:3, :3], self.points[:3, 3]
            look = (linear @ look[0] + offset, linear @ look[1])
        return replace(trial, description=self.description, look=look)


Maker = Callable[[d.SceneDescription, np.random.Generator], Relation | None]


# --- maps of space: a similarity, `m` with the scale `size` ---


def mapped(described: d.SceneDescription, m: Array, size: float = 1.0) -> d.SceneDescription:
    """The scene seen through the similarity m. Radiance has no length in it, W/sr of a point light has its square."""
    turn = m[:3, :3] / size
    return replace(
        described,
        camera=_mapped_camera(described.camera, m, turn, size),
        shapes=tuple(_mapped_shape(shape, m) for shape in described.shapes),
        lights=tuple(_mapped_light(light, m, turn, size) for light in described.lights),
        environment=_turned(described.environment, turn),
    )


def _mapped_camera(camera: d.Camera, m: Array, turn: Array, size: float) -> d.Camera:
    across = -1.0 if np.linalg.det(turn) < 0.0 else 1.0  # a mirrored picture from a camera that is not mirrored itself
    own = np.diag([across / size, 1.0 / size, 1.0 / size, 1.0])
    x, y = camera.principal_point_offset
    return replace(
        camera,
        to_world=m @ camera.to_world @ own,
        motion=camera.motion and replace(camera.motion, matrices=m @ camera.motion.matrices @ own),
        near_clip=camera.near_clip * size, far_clip=camera.far_clip * size,
        aperture_radius=camera.aperture_radius * size, focus_distance=camera.focus_distance * size,
        principal_point_offset=(across * x, y),
    )  # fmt: skip


def _mapped_shape(shape: d.Shape, m: Array) -> d.Shape:
    motion = shape.motion and replace(shape.motion, matrices=m @ shape.motion.matrices)
    flips = np.linalg.det(m[:3, :3]) < 0.0 and isinstance(shape, d.Mesh) and shape.normals is None
    return replace(shape, to_world=m @ shape.to_world, motion=motion, flip_normals=shape.flip_normals != flips)


def _mapped_light(light: d.Light, m: Array, turn: Array, size: float) -> d.Light:
    if isinstance(light, d.PointLight):
        position = m[:3, :3] @ light.position + m[:3, 3]
        return replace(light, position=position, intensity=light.intensity * size**2)
    return replace(light, direction=turn @ light.direction)


def _turned(sky: d.Environment | None, turn: Array) -> d.Environment | None:
    if isinstance(sky, d.GradientEnvironment):
        return replace(sky, gradient=sky.gradient @ turn.T)
    if isinstance(sky, d.ImageEnvironment):
        return replace(sky, to_world=affine(turn @ sky.to_world[:3, :3], np.zeros(3)))
    return sky


def scaled(size: float) -> Maker:
    """All lengths times `size`. Scenes are brought to a standard size, by a power of two, so those change no bit."""
    expected: Expected = "bitwise" if math.frexp(size)[0] == 0.5 else "rounding"

    def make(described: d.SceneDescription, rng: np.random.Generator) -> Relation:
        m = np.diag([size, size, size, 1.0])
        return Relation(f"times {size:g}", mapped(described, m, size), expected, 1.0, m)

    return make


def translated(described: d.SceneDescription, rng: np.random.Generator) -> Relation:
    m = affine(np.eye(3), rng.uniform(-5.0, 5.0, 3))
    return Relation("translated", mapped(described, m), "rounding", 1.0, m)


def rotated(described: d.SceneDescription, rng: np.random.Generator) -> Relation:
    m = affine(random_pose(rng)[:3, :3], np.zeros(3))
    return Relation("rotated", mapped(described, m), "distribution", 1.0, m)


def mirrored(described: d.SceneDescription, rng: np.random.Generator) -> Relation:
    """In a plane of random direction: 1 - 2 n n^T."""
    n = rng.normal(size=3)
    m = affine(np.eye(3) - 2.0 * np.outer(n, n) / (n @ n), np.zeros(3))
    return Relation("mirrored", mapped(described, m), "distribution", 1.0, m)


def sky_rolled(described: d.SceneDescription, rng: np.random.Generator) -> Relation | None:
    """The columns of the sky's image rolled by k, and the rest of the scene turned with it about the sky's pole."""
    sky = described.environment
    if not isinstance(sky, d.ImageEnvironment):
        return None
    columns = sky.pixels.shape[1]
    k = int(rng.integers(1, columns))
    c, s = math.cos(2.0 * math.pi * k / columns), math.sin(2.0 * math.pi * k / columns)
    own = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])  # about the image's pole, +y
    m = affine(sky.to_world[:3, :3] @ own @ sky.to_world[:3, :3].T, np.zeros(3))
    rolled = replace(sky, pixels=np.roll(sky.pixels, k, axis=1))
    return Relation("sky rolled", replace(mapped(described, m), environment=rolled), "distribution", 1.0, m)


# --- changes of light ---


def brighter(factor: float) -> Maker:
    """All light times `factor`; a power of two changes no other bit."""
    expected: Expected = "bitwise" if math.frexp(factor)[0] == 0.5 else "rounding"

    def make(described: d.SceneDescription, rng: np.random.Generator) -> Relation:
        shapes = tuple(s if s.radiance is None else replace(s, radiance=s.radiance * factor) for s in described.shapes)
        lights = tuple(_dimmed(light, factor) for light in described.lights)
        changed = replace(described, shapes=shapes, lights=lights, environment=_exposed(described.environment, factor))
        return Relation(f"exposure times {factor:g}", changed, expected, factor)

    return make


def _dimmed(light: d.Light, factor: float) -> d.Light:
    if isinstance(light, d.PointLight):
        return replace(light, intensity=light.intensity * factor)
    return replace(light, irradiance=light.irradiance * factor)


def _exposed(sky: d.Environment | None, factor: float) -> d.Environment | None:
    if isinstance(sky, d.ConstantEnvironment):
        return replace(sky, radiance=sky.radiance * factor)
    if isinstance(sky, d.GradientEnvironment):
        return replace(sky, radiance=sky.radiance * factor, gradient=sky.gradient * factor)
    if isinstance(sky, d.ImageEnvironment):
        return replace(sky, pixels=sky.pixels * factor)
    return None


def reordered(described: d.SceneDescription, rng: np.random.Generator) -> Relation | None:
    """Half a turn about z: lights, which stand in the order of their places (`raylab.order`), change theirs."""
    if len(described.lights) < 2 and sum(shape.radiance is not None for shape in described.shapes) < 2:
        return None
    m = np.diag([-1.0, -1.0, 1.0, 1.0])
    return Relation("lights in another order", mapped(described, m), "distribution", 1.0, m)


def split(described: d.SceneDescription, rng: np.random.Generator) -> Relation | None:
    """Each rectangular light cut in two, each light without area replaced by two of half the strength."""
    shapes: list[d.Shape] = []
    for shape in described.shapes:
        shapes += _halves(shape, rng.uniform(-0.3, 0.3)) if _is_lamp(shape) else [shape]
    lights = tuple(_dimmed(light, 0.5) for light in described.lights for _ in range(2))
    if len(shapes) + len(lights) == len(described.shapes) + len(described.lights):
        return None
    return Relation("lights split in two", replace(described, shapes=tuple(shapes), lights=lights), "mean")


def _is_lamp(shape: d.Shape) -> bool:
    return isinstance(shape, d.Rectangle) and shape.radiance is not None and shape.motion is None


def _halves(shape: d.Shape, at: float) -> list[d.Shape]:
    """The parts x < at and x > at of the square [-1, 1]^2."""
    parts = []
    for low, high in ((-1.0, at), (at, 1.0)):
        part = affine(np.diag([0.5 * (high - low), 1.0, 1.0]), (0.5 * (low + high), 0.0, 0.0))
        parts.append(replace(shape, to_world=shape.to_world @ part))
    return parts


RELATIONS: Mapping[str, Maker] = {
    "times_8": scaled(8.0),
    "times_3": scaled(3.0),
    "translated": translated,
    "rotated": rotated,
    "mirrored": mirrored,
    "sky_rolled": sky_rolled,
    "exposure_4": brighter(4.0),
    "exposure_3": brighter(3.0),
    "light_order": reordered,
    "light_split": split,
}


def relate(name: str, described: d.SceneDescription, seed: int) -> Any:
    """The relation called `name` for a scene, with the random numbers of `seed`; None where it does not apply."""
    if name not in RELATIONS:
        raise ValueError(f"unknown relation {name!r}; expected one of {', '.join(RELATIONS)}")
    return RELATIONS[name](described, np.random.default_rng(seed))
