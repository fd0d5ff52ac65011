"""Rough metal and plastic, with the parameters of Mitsuba 3."""

from __future__ import annotations

from typing import get_args

from raylab.description import Distribution, RoughConductor, RoughPlastic
from raylab.io.xml_colours import complex_index, constant_reflectance, index, reflectance
from raylab.io.xml_context import Context
from raylab.io.xml_node import Node
from raylab.io.xml_tag import choices
from raylab.palette import LARGEST_ALPHA

DISTRIBUTIONS: tuple[Distribution, ...] = get_args(Distribution)


def rough_conductor(node: Node, context: Context) -> tuple[RoughConductor, None]:
    """Metal by name or by eta and k; `alpha`, or `alpha_u` and `alpha_v` along the texture coordinates."""
    eta, k = complex_index(node, context)
    specular = constant_reflectance(node, "specular_reflectance", 1.0, context)
    alpha_u, alpha_v = _alphas(node)
    return RoughConductor(eta, k, specular, alpha_u, alpha_v, _distribution(node)), None


def rough_plastic(node: Node, context: Context) -> tuple[RoughPlastic, None]:
    """A diffuse base under a rough coat: polypropylene in air unless told otherwise."""
    int_ior, ext_ior = index(node, "int_ior", "polypropylene"), index(node, "ext_ior", "air")
    if int_ior == ext_ior:
        raise node.error(f'"int_ior" and "ext_ior" must differ, got {int_ior:g} twice', "int_ior")
    plastic = RoughPlastic(
        reflectance(node, "diffuse_reflectance", 0.5, context),
        constant_reflectance(node, "specular_reflectance", 1.0, context),
        int_ior,
        ext_ior,
        _alpha(node, "alpha"),
        _distribution(node),
        node.boolean("nonlinear", False),
    )
    return plastic, None


def _alphas(node: Node) -> tuple[float, float]:
    given = [name for name in ("alpha_u", "alpha_v") if node.has(name)]
    if not given:
        alpha = _alpha(node, "alpha")
        node.asked.update(dict.fromkeys(("alpha_u", "alpha_v")))  # known, for the sake of suggestions
        return alpha, alpha
    if len(given) == 1:
        other = "alpha_v" if given == ["alpha_u"] else "alpha_u"
        raise node.error(f'"{given[0]}" is given but "{other}" is not', given[0])
    if node.has("alpha"):
        raise node.error('give either "alpha" or "alpha_u" and "alpha_v", not both', "alpha")
    alpha_u, alpha_v = _alpha(node, "alpha_u"), _alpha(node, "alpha_v")
    if alpha_u != alpha_v:
        raise node.error(f'"alpha_u" and "alpha_v" must be equal, got {alpha_u:g} and {alpha_v:g}', "alpha_v")
    return alpha_u, alpha_v


def _alpha(node: Node, name: str) -> float:
    value = node.number(name, 0.1)
    if not 0.0 < value <= LARGEST_ALPHA:
        smooth = "; for a smooth surface take conductor, dielectric or phong" if value == 0.0 else ""
        limits = f"greater than 0, at most {LARGEST_ALPHA:g}"
        raise node.error(f'the roughness "{name}" must be {limits}, got {value:g}{smooth}', name)
    return value


def _distribution(node: Node) -> Distribution:
    """Beckmann by default. Which normals Mitsuba samples (`sample_visible`) changes no picture: ours are the seen."""
    node.boolean("sample_visible", True)
    name = node.string("distribution", "beckmann")
    for known in DISTRIBUTIONS:
        if name.lower() == known:
            return known
    raise node.error(f'unknown distribution "{name}"; ' + choices(name, DISTRIBUTIONS), "distribution")
