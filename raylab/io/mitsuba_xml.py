"""Scene files: a strict subset of Mitsuba 3's XML, read into a `SceneDescription`.

Every plug-in is an entry in a table (`SHAPES`, `BSDFS`, `EMITTERS`, ...) of its module: name -> reader. A
reader asks its node for parameters by name; `Node.finish` refuses the ones that nobody asked for. To support
one more plug-in, write its reader and enter it into the table.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from raylab.description import DEEPEST, Camera, Environment, Light, SceneDescription
from raylab.io.xml_bsdfs import BSDFS
from raylab.io.xml_colours import TEXTURES
from raylab.io.xml_context import Context
from raylab.io.xml_document import parse
from raylab.io.xml_emitters import EMITTERS, SHAPE_EMITTERS
from raylab.io.xml_node import Node
from raylab.io.xml_sensor import SENSORS
from raylab.io.xml_shapes import SHAPES
from raylab.io.xml_tag import choices

INTEGRATORS = (
    "aov", "depth", "direct", "direct_projective", "moment", "path", "prb", "prb_basic", "prb_projective",
    "prbvolpath", "prbvolpath_basic", "ptracer", "stokes", "volpath", "volpathmis", "volprim_rf_basic",
)  # fmt: skip
ELSEWHERE = {"film": "sensor", "sampler": "sensor", "rfilter": "film"}


def read(path: str | os.PathLike[str], parameters: Mapping[str, str] | None = None) -> SceneDescription:
    """The scene in the file `path`, with `parameters` for its `$name`.

    Raises SceneError, with file, line and element, for everything outside the subset.
    """
    file = Path(path)
    root = parse(file, parameters or {})
    context = Context(file.parent)
    sensors, integrators = root.children("sensor", 1000), root.children("integrator", 1)
    shapes = tuple(context.read(node, SHAPES) for node in root.children("shape", 10**9))
    lights, environment = _emitters(root, context)
    for kind, readers in (("bsdf", BSDFS), ("texture", TEXTURES)):  # also those that nothing refers to
        for node in root.children(kind, 10**9):
            context.read(node, readers)
    for parameter in root.parameters.values():
        if parameter.kind == "object" and parameter.value.kind in ELSEWHERE:
            kind = parameter.value.kind
            raise parameter.tag.error(f"<{kind}> belongs inside <{ELSEWHERE[kind]}>")
    root.finish()
    camera, sampling = _sensor(root, sensors, context)
    return SceneDescription(
        camera=camera,
        shapes=shapes,
        lights=lights,
        environment=environment,
        **_integrator(root, integrators, context),
        name=file.stem,
        path=file,
        warnings=tuple(context.warnings),
        **sampling,
    )


def _emitters(root: Node, context: Context) -> tuple[tuple[Light, ...], Environment | None]:
    """The lights outside shapes, and the environment."""
    lights: list[Light] = []
    environment: Environment | None = None
    for node in root.children("emitter", 10**9):
        emitter = context.read(node, {**EMITTERS, **SHAPE_EMITTERS})
        if isinstance(emitter, Light):
            lights.append(emitter)
        elif isinstance(emitter, Environment):
            if environment is not None:
                raise node.error("a scene can have only one environment, this is one more")
            environment = emitter
        elif not node.id:
            raise node.error("an area light belongs inside a <shape>")
    return tuple(lights), environment


def _sensor(root: Node, sensors: list[Node], context: Context) -> tuple[Camera, dict[str, Any]]:
    """The first camera, and what it says about sampling."""
    if not sensors:
        raise root.error('a <sensor type="perspective"> is missing')
    for node in sensors[1:]:
        context.read(node, SENSORS)
        context.warn(node, "raylab renders the first sensor of a file only, this is one more")
    camera, sampling = context.read(sensors[0], SENSORS)
    return camera, {} if sampling is None else vars(sampling)


def _integrator(root: Node, integrators: list[Node], context: Context) -> dict[str, Any]:
    """Whether to hide the emitters and how deep to follow mirrors; warns if the file asks for more than raylab does."""
    if not integrators:
        context.warn(root, "the file names no integrator; raylab renders direct light")
        return {}
    node = integrators[0]
    if node.type not in INTEGRATORS:
        raise node.error("unknown integrator; " + choices(node.type, INTEGRATORS, "known are"))
    hide_emitters = node.boolean("hide_emitters", False)
    if node.type != "direct":
        context.warn(node, "raylab renders direct light, whatever the integrator")
        return {"hide_emitters": hide_emitters, **_depth(node, context)}
    for name in ("shading_samples", "emitter_samples", "bsdf_samples", "samples_per_pass", "block_size"):
        node.integer(name, 1, least=0)
    node.number("timeout", -1.0)
    node.finish()
    return {"hide_emitters": hide_emitters}


def _depth(node: Node, context: Context) -> dict[str, int]:
    """`max_depth` as in Mitsuba 3, rays in a row; -1, without end, is raylab's own default."""
    rays = node.integer("max_depth", -1, least=-1)
    if rays == 0:
        raise node.error('"max_depth" must be at least 1, or -1 for the default, got 0', "max_depth")
    if rays > DEEPEST:
        context.warn(node, f"raylab follows {DEEPEST} rays in a row at most", "max_depth")
    return {} if rays == -1 else {"max_depth": min(rays, DEEPEST)}
