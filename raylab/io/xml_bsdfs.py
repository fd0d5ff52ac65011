"""Materials: each reader returns what reflects in front and behind, None where nothing does."""

from __future__ import annotations

from collections.abc import Callable

from raylab.description import Conductor, Dielectric, Diffuse, Material, Phong
from raylab.io.xml_colours import complex_index, constant_reflectance, index, reflectance
from raylab.io.xml_context import Context
from raylab.io.xml_node import Node
from raylab.io.xml_rough import rough_conductor, rough_plastic

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


def _conductor(node: Node, context: Context) -> Sides:
    """A smooth metal, by name or by eta and k; a perfect mirror unless told otherwise."""
    eta, k = complex_index(node, context)
    return Conductor(eta, k, constant_reflectance(node, "specular_reflectance", 1.0, context)), None


def _dielectric(node: Node, context: Context) -> Sides:
    """Smooth glass: `int_ior` and `ext_ior` as numbers or by name, BK7 in air by default."""
    glass = Dielectric(
        index(node, "int_ior", "bk7"),
        index(node, "ext_ior", "air"),
        constant_reflectance(node, "specular_reflectance", 1.0, context),
        constant_reflectance(node, "specular_transmittance", 1.0, context),
    )
    return glass, glass.inside


def _twosided(node: Node, context: Context) -> Sides:
    """One material for both sides, or two: front, back; they must not let light through."""
    children = node.children("bsdf", 2)
    nested = [context.read(child, BSDFS)[0] for child in children]
    for child, material in zip(children, nested, strict=True):
        if isinstance(material, Dielectric):
            raise child.error("a material that lets light through has two sides already; take it out of the twosided")
    if not nested:
        raise node.error("a <bsdf> for the two sides is missing")
    return nested[0], nested[-1]


BSDFS: dict[str, Callable[[Node, Context], Sides]] = {
    "conductor": _conductor,
    "dielectric": _dielectric,
    "diffuse": _diffuse,
    "phong": _phong,
    "roughconductor": rough_conductor,
    "roughplastic": rough_plastic,
    "twosided": _twosided,
}
