"""The camera, its film and pixel filter, and the sampler that a scene file asks for."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from raylab.description import Camera, Filter
from raylab.io.xml_context import Context
from raylab.io.xml_node import Node
from raylab.io.xml_transform import is_rigid

SamplerName = Literal["independent", "stratified", "sobol", "centre"]
_AXES = ("x", "y", "diagonal", "smaller", "larger")
_DIAGONAL_35MM = math.hypot(36, 24)  # mm
_LARGEST = 65536  # pixels along one side


@dataclass(frozen=True)
class Sampling:
    """The sampler that a sensor asks for."""

    sampler: SamplerName
    spp: int
    seed: int


@dataclass(frozen=True)
class Film:
    """Size in pixels and reconstruction filter."""

    width: int
    height: int
    filter: Filter


def _perspective(node: Node, context: Context) -> tuple[Camera, Sampling | None]:
    """A pinhole; a focus distance means nothing to it."""
    node.ask("focus_distance", ("float", "integer"), 0.0)
    offset = tuple(node.number(f"principal_point_offset_{c}", 0.0) for c in "xy")
    return _camera(node, context, principal_point_offset=(offset[0], offset[1]))


def _thinlens(node: Node, context: Context) -> tuple[Camera, Sampling | None]:
    """Mitsuba's, and two additions for a polygonal aperture; focus at infinity is `inf`."""
    radius = node.number("aperture_radius")
    if radius < 0:
        raise node.error(f'"aperture_radius" must not be negative, got {radius:g}', "aperture_radius")
    focus = float(node.ask("focus_distance", ("float", "integer"), node.number("far_clip", 1e4)))
    if not focus > 0:
        raise node.error(f'"focus_distance" must be greater than 0, got {focus:g}', "focus_distance")
    blades = node.integer("aperture_blades", 0, least=0, most=1000)
    if blades in (1, 2):
        raise node.error(f'"aperture_blades" must be 0, a disk, or at least 3, got {blades}', "aperture_blades")
    return _camera(
        node,
        context,
        aperture_radius=radius,
        focus_distance=focus,
        aperture_blades=blades,
        aperture_rotation=node.number("aperture_rotation", 0.0),
    )


def _camera(node: Node, context: Context, **lens: Any) -> tuple[Camera, Sampling | None]:
    film_node, sampler_node = node.child("film"), node.child("sampler")
    film = context.read(film_node, FILMS) if film_node else Film(768, 576, _GAUSSIAN)
    to_world, motion = node.placing("to_world")
    if not all(is_rigid(matrix) for matrix in (to_world[None] if motion is None else motion.matrices)):
        raise node.error("to_world of a camera must not scale or shear", "to_world")
    fov, axis = _field_of_view(node)
    near = node.number("near_clip", 1e-2, above=0)
    far = node.number("far_clip", 1e4, above=near)
    opened = node.number("shutter_open", 0.0)
    closed = node.number("shutter_close", 0.0)
    if closed < opened:
        message = f"the shutter must not close before it opens: shutter_open is {opened:g}, shutter_close {closed:g}"
        raise node.error(message, "shutter_close" if node.has("shutter_close") else "shutter_open")
    camera = Camera(
        to_world=to_world,
        motion=motion,
        shutter_open=opened,
        shutter_close=closed,
        fov=fov,
        fov_axis=axis,
        near_clip=near,
        far_clip=far,
        width=film.width,
        height=film.height,
        filter=film.filter,
        **lens,
    )
    return camera, context.read(sampler_node, SAMPLERS) if sampler_node else None


def _field_of_view(node: Node) -> tuple[float, Any]:
    """Degrees and their axis, from `fov` or from a `focal_length` on 35 mm film, 50 mm by default."""
    if node.has("fov"):
        if node.has("focal_length"):
            raise node.error('give either "fov" or "focal_length", not both', "focal_length")
        axis = node.string("fov_axis", "x").lower()
        if axis not in _AXES:
            node.choice("fov_axis", "x", _AXES)
        return node.number("fov", above=0, below=180), axis
    node.asked["fov"] = None
    if node.has("fov_axis"):
        raise node.error('"fov_axis" says what "fov" means, but "fov" is missing', "fov_axis")
    text = node.string("focal_length", "50mm")
    try:
        length = float(text.removesuffix("mm"))
    except ValueError:
        length = math.nan
    if not 0 < length < math.inf:
        raise node.error(f'expected a focal length such as "50mm", got "{text}"', "focal_length")
    return math.degrees(2 * math.atan(_DIAGONAL_35MM / (2 * length))), "diagonal"


def _hdrfilm(node: Node, context: Context) -> Film:
    """Formats of the output file do not matter here: raylab decides by the name of the file it writes."""
    for name in ("crop_width", "crop_height", "crop_offset_x", "crop_offset_y"):
        if node.has(name):
            raise node.error("raylab does not support crop windows; it renders the whole picture", name)
    node.choice("file_format", "openexr", ("openexr", "exr", "rgbe", "pfm"))
    node.choice("pixel_format", "rgb", ("luminance", "luminance_alpha", "rgb", "rgba", "xyz", "xyza"))
    node.choice("component_format", "float16", ("float16", "float32", "uint32"))
    for name in (
        "sample_border",
        "banner",
        "compensate",
    ):  # the first is how raylab works, the others do nothing
        node.boolean(name, False)
    rfilter = node.child("rfilter")
    return Film(
        node.integer("width", 768, least=1, most=_LARGEST),
        node.integer("height", 576, least=1, most=_LARGEST),
        context.read(rfilter, FILTERS) if rfilter else _GAUSSIAN,
    )


_GAUSSIAN = Filter("gaussian", radius=2.0, stddev=0.5)


def _box(node: Node, context: Context) -> Filter:
    return Filter("box", radius=0.5)


def _tent(node: Node, context: Context) -> Filter:
    return Filter("tent", radius=node.number("radius", 1.0, above=0))


def _gaussian(node: Node, context: Context) -> Filter:
    """Cut off at four standard deviations, as in Mitsuba 3."""
    stddev = node.number("stddev", 0.5, above=0)
    return Filter("gaussian", radius=4 * stddev, stddev=stddev)


def _sampler(name: SamplerName) -> Callable[[Node, Context], Sampling]:
    def read(node: Node, context: Context) -> Sampling:
        jitter, spp = node.boolean("jitter", True), node.integer("sample_count", 4, least=1)
        if not jitter and (node.type != "stratified" or spp != 1):
            raise node.error("without jitter raylab supports one sample, the pixel's centre, stratified", "jitter")
        if node.type == "orthogonal":
            node.integer("strength", 2, least=1)
        seed = node.integer("seed", 0, least=0, most=2**32 - 1)
        return Sampling(name if jitter else "centre", spp, seed)

    return read


SENSORS: dict[str, Callable[[Node, Context], tuple[Camera, Sampling | None]]] = {
    "perspective": _perspective,
    "thinlens": _thinlens,
}
FILMS: dict[str, Callable[[Node, Context], Film]] = {"hdrfilm": _hdrfilm}
FILTERS: dict[str, Callable[[Node, Context], Filter]] = {"box": _box, "tent": _tent, "gaussian": _gaussian}
SAMPLERS: dict[str, Callable[[Node, Context], Sampling]] = {
    "independent": _sampler("independent"),
    "stratified": _sampler("stratified"),
    "multijitter": _sampler("stratified"),
    "orthogonal": _sampler("sobol"),
    "ldsampler": _sampler("sobol"),
}
