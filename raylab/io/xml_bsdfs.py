"""Materials: each reader returns what reflects in front and behind, None where nothing does."""

from __future__ import annotations

from collections.abc import Callable

from raylab.description import Diffuse, Material, Phong
from raylab.io.xml_colours import constant_reflectance, reflectance
from raylab.io.xml_context import Context
from raylab.io.xml_node import Node

Sides = tuple[Material | None, Material | None]


def _diffuse(node: Node, context: Context) -> Sides:
    return Diffuse(reflectance(node, "reflectance", 0.5, context)), None


def _phong(node: Node, context: Context) -> Sides:
    """Modified Phong, with the parameters of Mitsuba 0.6; Mitsuba 3 has no such plug-in."""
    exponent = node.number("exponent", 30.0)
    if exponent < 0:
        raise node.error(f'"exponent" must not be negative, got {exponent:g}', "exponent")
    phong = Phong(
        diffuse_reflectance=reflectance(node, "diffuse_reflectance", 0.5, context),
        specular_reflectance=constant_reflectance(node, "specular_reflectance", 0.2, context),
        exponent=exponent,
    )
    return phong, None


def _twosided(node: Node, context: Context) -> Sides:
    """One material for both sides, or two: front, back."""
    nested = [context.read(child, BSDFS)[0] for child in node.children("bsdf", 2)]
    if not nested:
        raise node.error("a <bsdf> for the two sides is missing")
    return nested[0], nested[-1]


BSDFS: dict[str, Callable[[Node, Context], Sides]] = {
    "diffuse": _diffuse,
    "phong": _phong,
    "twosided": _twosided,
}
