"""Colours and textures: numbers, `<rgb>`, `<spectrum>` and bitmaps become linear RGB as in Mitsuba 3."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from raylab.description import Array, Bitmap, Colour
from raylab.io import indices, spectrum
from raylab.io.xml_context import Context
from raylab.io.xml_node import Node
from raylab.io.xml_tag import choices

_KINDS = ("rgb", "spectrum", "float", "integer", "object")


def reflectance(node: Node, name: str, default: float, context: Context) -> Colour:
    """The parameter `name` as a colour in [0, 1] or a bitmap of such colours."""
    value = node.ask(name, _KINDS, default)
    if isinstance(value, Node) and value.kind == "texture":
        return context.read(value, TEXTURES)
    rgb = _rgb(node, name, value, context, emitter=False)
    if rgb.min() < 0 or rgb.max() > 1:
        raise node.error(f"a reflectance must lie in [0, 1], got ({_words(rgb)})", name)
    return rgb


def constant_reflectance(node: Node, name: str, default: float, context: Context) -> Array:
    """The parameter `name` as one colour in [0, 1]."""
    colour = reflectance(node, name, default, context)
    if isinstance(colour, Bitmap):
        raise node.error(f'"{name}" takes one colour here, not a texture', name)
    return colour


def complex_index(node: Node, context: Context) -> tuple[Array, Array]:
    """eta and k of a conductor, both given as colours, or a `material` by name; "none" is a perfect mirror."""
    given = [name for name in ("eta", "k") if node.has(name)]
    if not given:
        name = node.string("material", "none")
        found = indices.metal(name)
        if found is None:
            raise node.error(f'unknown material "{name}"; ' + choices(name, ["none", *indices.METALS]), "material")
        node.asked.update(dict.fromkeys(("eta", "k")))
        return np.array(found[0]), np.array(found[1])
    if len(given) == 1:
        other = "k" if given == ["eta"] else "eta"
        raise node.error(f'"{given[0]}" is given but "{other}" is not; a metal needs both', given[0])
    if node.has("material"):
        raise node.error('give either "material" or "eta" and "k", not both', "material")
    return _index(node, "eta", context), _index(node, "k", context)


def _index(node: Node, name: str, context: Context) -> Array:
    """A part of a refractive index; unlike a reflectance it may be above 1."""
    value = node.ask(name, _KINDS)
    if isinstance(value, Node) and (value.kind != "spectrum" or value.type != "uniform"):
        raise node.error(f'"{name}" takes a number, a colour or a table, not <{value.kind} type="{value.type}">', name)
    if isinstance(value, int | float):
        rgb = np.full(3, float(value))
    elif isinstance(value, tuple):
        rgb = spectrum.integrate(spectrum.tabulated(*value), spectrum.d65())
    else:
        rgb = _rgb(node, name, value, context, emitter=True)
    if rgb.min() < 0:
        raise node.error(f'"{name}" must not be negative, got ({_words(rgb)})', name)
    return rgb


def index(node: Node, name: str, default: str) -> float:
    """A refractive index as a number or by name."""
    value = node.ask(name, ("float", "integer", "string"), default)
    if not isinstance(value, str):
        return node.number(name, above=0)
    if value not in indices.DIELECTRICS:
        raise node.error(f'unknown material "{value}"; ' + choices(value, indices.DIELECTRICS), name)
    return indices.DIELECTRICS[value]


def emission(node: Node, name: str, context: Context) -> Array:
    """The parameter `name` as an emitted colour, (1, 1, 1) by default; any colour that is not negative."""
    value = node.ask(name, _KINDS, 1.0)
    if isinstance(value, Node) and value.kind == "texture":
        raise node.error(f'"{name}" takes one colour; raylab does not support textured emitters', name)
    rgb = _rgb(node, name, value, context, emitter=True)
    if rgb.min() < 0:
        raise node.error(f'"{name}" must not be negative, got ({_words(rgb)})', name)
    return rgb


def _rgb(node: Node, name: str, value: object, context: Context, emitter: bool) -> Array:
    """Linear RGB of a number, a colour, a uniform or tabulated spectrum or a spectrum object."""
    parameter = node.parameters.get(name)
    if isinstance(value, Node):
        if value.kind != "spectrum":
            raise node.error(f'"{name}" must be a colour or a texture, not <{value.kind}>', name)
        if value.type == "blackbody" and not emitter:
            raise node.error("a blackbody spectrum is for emitters only", name)
        return context.read(value, SPECTRA)
    if isinstance(value, np.ndarray):
        return value
    if isinstance(value, tuple):
        return _tabulated(node, name, value, context, emitter)
    number = float(value)  # type: ignore[arg-type]
    if emitter and parameter is not None and parameter.kind == "spectrum":
        return spectrum.uniform(number)
    return np.full(3, number)


def _tabulated(node: Node, name: str, table: tuple[Array, Array], context: Context, emitter: bool) -> Array:
    """RGB of a table; colours outside the gamut are clamped, with a warning."""
    nodes, values = table
    wrong = (values < 0) | (values > (np.inf if emitter else 1.0))
    if wrong.any():
        at = int(np.argmax(wrong))
        limit = "must not be negative" if emitter else "must lie in [0, 1]"
        raise node.error(f'"{name}" {limit}, got {values[at]:g} at {nodes[at]:g} nm', name)
    rgb = spectrum.integrate(spectrum.tabulated(nodes, values), None if emitter else spectrum.d65())
    clamped = np.clip(rgb, 0.0, None if emitter else 1.0)
    if not np.array_equal(rgb, clamped):
        context.warn(node, f"the colour ({_words(rgb)}) is out of gamut and was clamped", name)
    return clamped


def _words(rgb: Array) -> str:
    return ", ".join(f"{v:g}" for v in rgb)


def _d65(node: Node, context: Context) -> Array:
    colour: Array = np.asarray(node.ask("color", ("rgb",), np.ones(3)))
    return node.number("scale", 1.0) * colour


def _uniform(node: Node, context: Context) -> Array:
    node.number("wavelength_min", spectrum.FIRST)
    node.number("wavelength_max", spectrum.LAST)
    return np.full(3, node.number("value"))


def _srgb_spectrum(node: Node, context: Context) -> Array:
    colour: Array = node.ask("color", ("rgb",))
    if not node.boolean("unbounded", False) and (colour.min() < 0 or colour.max() > 1):
        raise node.error(f"the color must lie in [0, 1], got ({_words(colour)})", "color")
    return colour


def _blackbody(node: Node, context: Context) -> Array:
    """Radiance in W/(m^2 sr) weighted with the colour matching functions; infrared is not part of it."""
    first = node.number("wavelength_min", spectrum.FIRST)
    last = node.number("wavelength_max", spectrum.LAST, above=first)
    temperature = node.number("temperature", above=0, below=1e12)  # hotter, and Planck's formula divides by zero
    rgb = spectrum.integrate(spectrum.blackbody(temperature, first, last))
    clamped = np.maximum(rgb, 0.0)
    if not np.array_equal(rgb, clamped):
        context.warn(node, f"the colour ({_words(rgb)}) is out of gamut and was clamped")
    return clamped


def _bitmap(node: Node, context: Context) -> Bitmap:
    """Mitsuba puts the first row of an image at v = 0, a Bitmap has it at v = 1: the rows are reversed."""
    raw = node.boolean("raw", False)
    node.boolean("accel", True)
    node.choice("format", "auto", ("auto", "variant", "float16", "fp16", "uint8"))
    matrix = node.transform("to_uv", np.eye(4))
    return Bitmap(
        pixels=np.ascontiguousarray(context.image(node, raw, upper=1.0)[::-1]),
        filter=node.choice("filter_type", "bilinear", ("bilinear", "nearest")),  # type: ignore[arg-type]
        wrap=node.choice("wrap_mode", "repeat", ("repeat", "mirror", "clamp")),  # type: ignore[arg-type]
        to_uv=matrix[np.ix_([0, 1, 3], [0, 1, 3])],
    )


SPECTRA: dict[str, Callable[[Node, Context], Array]] = {
    "d65": _d65,
    "uniform": _uniform,
    "srgb": _srgb_spectrum,
    "blackbody": _blackbody,
}
TEXTURES: dict[str, Callable[[Node, Context], Bitmap]] = {"bitmap": _bitmap}
