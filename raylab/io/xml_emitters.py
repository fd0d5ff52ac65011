"""Lights: point and directional lights, the environments, and the radiance of area lights."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from raylab.description import (
    Array,
    ConstantEnvironment,
    DirectionalLight,
    Environment,
    ImageEnvironment,
    Light,
    PointLight,
)
from raylab.io.xml_colours import emission
from raylab.io.xml_context import Context
from raylab.io.xml_node import Node
from raylab.io.xml_transform import is_rigid


def _sampling_weight(node: Node) -> None:
    """Mitsuba's hint for choosing lights; raylab chooses by itself, the picture is the same."""
    node.number("sampling_weight", 1.0, above=0)


def _point(node: Node, context: Context) -> PointLight:
    _sampling_weight(node)
    _one_of(node, "position", "to_world")
    offset = node.transform("to_world", np.eye(4))[:3, 3]
    return PointLight(node.point("position", offset), emission(node, "intensity", context))


def _directional(node: Node, context: Context) -> DirectionalLight:
    _sampling_weight(node)
    _one_of(node, "direction", "to_world")
    forward = node.transform("to_world", np.eye(4))[:3, 2]
    direction = node.point("direction", forward)
    if not direction.any():
        raise node.error("the direction must not be zero", "direction")
    direction = direction / np.abs(direction).max()
    return DirectionalLight(direction / np.linalg.norm(direction), emission(node, "irradiance", context))


def _one_of(node: Node, first: str, second: str) -> None:
    if node.has(first) and node.has(second):
        raise node.error(f'give either "{first}" or "{second}", not both', second)


def _constant(node: Node, context: Context) -> ConstantEnvironment:
    _sampling_weight(node)
    node.transform("to_world", np.eye(4))
    return ConstantEnvironment(emission(node, "radiance", context))


def _envmap(node: Node, context: Context) -> ImageEnvironment:
    _sampling_weight(node)
    compensation = node.boolean("mis_compensation", False)
    scale = node.number("scale", 1.0)
    if scale < 0:
        raise node.error(f'"scale" must not be negative, got {scale:g}', "scale")
    to_world = node.transform("to_world", np.eye(4))
    if not is_rigid(to_world):
        raise node.error("to_world of an environment may rotate and mirror, not scale or shear", "to_world")
    pixels = scale * context.image(node, raw=False, upper=np.inf)
    return ImageEnvironment(pixels, to_world, mis_compensation=compensation)


def _area(node: Node, context: Context) -> Array:
    _sampling_weight(node)
    if node.has("to_world"):
        raise node.error("an area light takes its place from its shape; remove to_world", "to_world")
    return emission(node, "radiance", context)


EMITTERS: dict[str, Callable[[Node, Context], Light | Environment]] = {
    "point": _point,
    "directional": _directional,
    "constant": _constant,
    "envmap": _envmap,
}
SHAPE_EMITTERS: dict[str, Callable[[Node, Context], Array]] = {"area": _area}
