"""Examples: small scenes and rows of numbers on which a submission runs first.

They hold no truth. Each has what makes a difference: a light that is partly hidden, one that shows its back, one below
the horizon; a surface that is seen at an angle; colours that differ by channel.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np

from raylab import description as d
from raylab.errors import UserError
from raylab.probe import Place
from raylab.scene import Scene
from raylab.strategies import BUILT_IN
from raylab.submission.task import Task

PLACE = Place.seen((0.9, -2.1, 1.7), (0.0, 0.0, 0.0))
SAMPLES, ROWS, SEED = 32, 32, 4620


@dataclass(frozen=True, eq=False)
class Example:
    """A scene and where to look."""

    scene: Scene
    place: Place


def examples(task: Task) -> Iterator[Example]:
    """Scenes to run in, made when they are asked for: the quick ones first, last the task's own trial if it has one.

    The last one is also what is compiled for. A kernel belongs to the kinds of things in a scene: one that is graded in
    such scenes is compiled but once.
    """
    for needs in (BUILT_IN[task.like][1] or "area lights").split(" or "):
        yield Example(_scene(needs, "k_d" in task.arguments), PLACE)
    if task.trial:
        yield _trial(task.trial)


def _trial(name: str) -> Example:
    from raylab import trials

    made = trials.make(name, 0)
    if not isinstance(made.place, Place):
        raise UserError(f"trial {name!r} looks through a pixel; expected one at a point of a surface")
    return Example(made.scene, made.place)


@cache
def _scene(needs: str, diffuse: bool) -> Scene:
    colour, shine = np.array([0.7, 0.4, 0.2]), np.array([0.1, 0.3, 0.4])
    material: d.Material = d.Diffuse(colour) if diffuse else d.Phong(0.5 * colour, shine, 20.0)
    shapes = [d.Rectangle(to_world=_at((0, 0, 0), 3.0), front=material), _screen()]
    lights: tuple[d.Light, ...] = ()
    environment: d.Environment | None = None
    if "area lights" in needs or "glossy" in needs:
        shapes += [_lamp((0.5, 0.2, 1.5), 0.5, (3, 4, 5)), _lamp((-1.0, 1.0, 2.0), 0.3, (7, 2, 1))]
        shapes += [_lamp((1.0, 1.5, 1.0), 0.2, (1, 2, 3), up=True), _lamp((0.2, 0.3, -1.0), 0.4, (5, 5, 5))]
    if "point lights" in needs:
        places, colours = ((0.5, 0.2, 1.5), (0.9, 0.3, 1.5), (1.0, 1.0, -1.0)), ((3, 4, 5), (5, 4, 3), (1, 1, 1))
        lights = tuple(d.PointLight(np.array(p), np.array(c, float)) for p, c in zip(places, colours, strict=True))
    if "directional lights" in needs:
        ways, colours = ((-0.5, 0.2, -1.5), (0.9, 0.3, -0.9), (1.0, 1.0, 1.0)), ((3, 4, 5), (5, 4, 3), (1, 1, 1))
        lights = tuple(d.DirectionalLight(np.array(w), np.array(c, float)) for w, c in zip(ways, colours, strict=True))
    if "environment" in needs:
        environment = d.ImageEnvironment(np.linspace(0.0, 3.0, 96).reshape(4, 8, 3) ** 2)
    return Scene(d.SceneDescription(shapes=tuple(shapes), lights=lights, environment=environment))


def _at(centre: tuple[float, float, float], size: float, flip: float = 1.0) -> d.Array:
    matrix = np.diag([size, size * flip, flip, 1.0])
    matrix[:3, 3] = centre
    return matrix


def _lamp(
    centre: tuple[float, float, float], size: float, colour: tuple[float, float, float], up: bool = False
) -> d.Shape:
    return d.Rectangle(to_world=_at(centre, size, 1.0 if up else -1.0), radiance=np.array(colour, float), front=None)


def _screen() -> d.Shape:
    """Hides half of the first lamp, and one of the points and suns."""
    return d.Rectangle(to_world=_at((0.4, 0.1, 0.75), 0.15), front=None)


def example_rows(task: Task) -> np.ndarray:
    """Rows of inputs of a map: the task's own, or random unit vectors and uniform numbers."""
    if task.examples:
        return np.array(task.examples, np.float64)
    random, columns = np.random.default_rng(SEED), []
    for kind in task.takes:
        if kind == "vector":
            v = random.normal(size=(ROWS, 3))
            columns.append(v / np.linalg.norm(v, axis=1, keepdims=True))
        else:
            columns.append(random.random((ROWS, 1 if kind == "number" else 2)))
    return np.hstack(columns) if columns else np.zeros((1, 0))
