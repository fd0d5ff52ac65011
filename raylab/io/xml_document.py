"""A scene file as a tree of nodes: includes, defaults, `$name` and references resolved, not interpreted."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from raylab.description import Animation, Array
from raylab.errors import SceneError
from raylab.io.xml_node import Node, Parameter
from raylab.io.xml_tag import Tag, choices
from raylab.io.xml_transform import compose
from raylab.io.xml_values import VALUES, find_file, number

OBJECTS = (
    "scene",
    "integrator",
    "sensor",
    "film",
    "rfilter",
    "sampler",
    "shape",
    "bsdf",
    "texture",
    "emitter",
)
STATEMENTS = ("transform", "animation", "ref", "default", "include", "alias")
UNSUPPORTED = ("medium", "phase", "volume", "path")  # elements that Mitsuba 3 knows and raylab does not read
MAX_INCLUDE_DEPTH = 15  # as in Mitsuba 3


def parse(path: Path, parameters: Mapping[str, str]) -> Node:
    """The root node of the scene file `path`, with `parameters` filled in for `$name`."""
    parser = _Parser(parameters)
    root = parser.read_file(path, None)
    if root.kind != "scene":
        raise root.error("the outermost element of a scene file must be <scene>")
    parser.resolve()
    for name in parameters:
        if name not in parser.used:
            known = sorted(parser.used | (parser.defaults.keys() - parameters.keys()))
            raise SceneError(f'{path}: parameter "{name}" is not used in the file; {choices(name, known)}')
    return root


class _Parser:
    """What one scene file and all it includes share: parameters, identifiers and references."""

    def __init__(self, parameters: Mapping[str, str]) -> None:
        self.defaults: dict[str, str] = dict(parameters)
        self.used: set[str] = set()
        self.ids: dict[str, Node] = {}
        self.references: list[tuple[Node, str, Tag]] = []
        self.files: list[Path] = []

    def read_file(self, path: Path, included_by: Tag | None) -> Node:
        """Parse one file; `included_by` is the `<include>` that asked for it."""
        if included_by and (path.resolve() in self.files or len(self.files) > MAX_INCLUDE_DEPTH):
            raise included_by.error("the files include each other in a circle, or too deeply")
        self.files.append(path.resolve())
        element = _load(path)
        version = element.attrib.pop("version", None)
        tag = self.tag(element, path)
        _check_version(tag, version)
        node = self.node(element, tag)
        self.files.pop()
        return node

    def tag(self, element: Any, path: Path) -> Tag:
        """`element` with `$name` replaced in its attributes."""
        raw = Tag(str(element.tag), {str(k): str(v) for k, v in element.attrib.items()}, path, element.sourceline)
        values = {key: self.substitute(raw, text) for key, text in raw.attributes.items()}
        return Tag(raw.name, values, path, raw.line)

    def substitute(self, tag: Tag, text: str) -> str:
        r"""Replace `$name` by the longest parameter name that fits; `\$` is a plain dollar sign."""
        names = sorted(self.defaults, key=len, reverse=True)

        def replace(match: re.Match[str]) -> str:
            if match[0].startswith("\\"):
                return "$"
            for name in names:
                if match[1].startswith(name):
                    self.used.add(name)
                    return self.defaults[name] + match[1][len(name) :]
            raise tag.error(f'undefined parameter "${match[1]}"; {choices(match[1], names, "known parameters:")}')

        return re.sub(r"\\\$|\$([\w-]*)", replace, text)

    def node(self, element: Any, tag: Tag) -> Node:
        """An object with all that is nested in it."""
        tag.check_attributes(() if tag.name == "scene" else ("type",), ("id", "name"))
        node = Node(tag)
        self.name_node(node.id, node, tag)
        for child in _elements(element):
            self.add(node, child, self.tag(child, tag.file))
        return node

    def name_node(self, name: str, node: Node, tag: Tag) -> None:
        if name and name in self.ids:
            first = self.ids[name].tag
            raise tag.error(f'the id "{name}" is already taken by {first.label} in {first.file}:{first.line}')
        if name:
            self.ids[name] = node

    def add(self, parent: Node, element: Any, tag: Tag) -> None:
        """File the nested `element` as a parameter of `parent`, or do what it says."""
        name = tag.attributes.get("name", "")
        if tag.name in OBJECTS or (tag.name == "spectrum" and "type" in tag.attributes):
            parent.add(name, Parameter("object", self.node(element, tag), tag))
        elif tag.name == "transform":
            tag.check_attributes(("name",))
            operations = [self.tag(child, tag.file) for child in _elements(element)]
            parent.add(name, Parameter("transform", compose(operations), tag))
        elif tag.name == "animation":
            tag.check_attributes(("name",))
            parent.add(name, Parameter("animation", self.animation(element, tag), tag))
        elif tag.name in VALUES or tag.name in STATEMENTS:
            for child in _elements(element):
                raise self.tag(child, tag.file).error(f"<{tag.name}> takes no nested elements")
            if tag.name in VALUES and not name:
                raise tag.error("the name must not be empty")
            if tag.name in VALUES:
                parent.add(name, Parameter(_kind(tag), VALUES[tag.name](tag), tag))
            else:
                getattr(self, f"do_{tag.name}")(parent, tag)
        else:
            known = (*OBJECTS, *VALUES, *STATEMENTS)
            missing = "raylab does not support this element" if tag.name in UNSUPPORTED else "unknown element"
            raise tag.error(f"{missing}; {choices(tag.name, known)}")

    def animation(self, element: Any, tag: Tag) -> Animation:
        """Keyframes: `<transform time="...">` at increasing times."""
        times: list[float] = []
        matrices: list[Array] = []
        for child in _elements(element):
            key = self.tag(child, tag.file)
            if key.name != "transform":
                raise key.error('an <animation> is made of <transform time="..."> alone')
            key.check_attributes(("time",))
            time = number(key, key.attributes["time"])
            if times and time <= times[-1]:
                raise key.error(f"the times of keyframes must increase, got {time:g} after {times[-1]:g}")
            matrix = compose(self.tag(operation, tag.file) for operation in _elements(child))
            if matrices and np.linalg.det(matrix[:3, :3]) * np.linalg.det(matrices[-1][:3, :3]) < 0:
                raise key.error("this keyframe mirrors and the one before does not: a shape would turn inside out")
            times.append(time)
            matrices.append(matrix)
        if len(times) < 2:
            raise tag.error(f'an <animation> needs two <transform time="..."> or more, got {len(times)}')
        return Animation(np.array(times), np.array(matrices))

    def do_ref(self, parent: Node, tag: Tag) -> None:
        tag.check_attributes(("id",), ("name",))
        slot = tag.attributes.get("name") or f"({len(parent.parameters)})"
        parent.add(slot, Parameter("object", parent, tag))  # a place holder until `resolve`
        self.references.append((parent, slot, tag))

    def do_default(self, parent: Node, tag: Tag) -> None:
        tag.check_attributes(("name", "value"))
        if not tag.attributes["name"]:
            raise tag.error("the name must not be empty")
        self.defaults.setdefault(tag.attributes["name"], tag.attributes["value"])

    def do_alias(self, parent: Node, tag: Tag) -> None:
        tag.check_attributes(("id", "as"))
        self.name_node(tag.attributes["as"], self.target(tag), tag)

    def do_include(self, parent: Node, tag: Tag) -> None:
        tag.check_attributes(("filename",), ("name",))
        node = self.read_file(find_file(tag, tag.attributes["filename"]), tag)
        if node.kind != "scene":
            parent.add(tag.attributes.get("name", ""), Parameter("object", node, tag))
            return
        for name, parameter in node.parameters.items():
            slot = "" if name.startswith("(") else name
            parent.add(slot, parameter)
        moved = {id(parameter): name for name, parameter in parent.parameters.items()}
        self.references = [
            (parent, moved[id(node.parameters[slot])], at) if owner is node else (owner, slot, at)
            for owner, slot, at in self.references
        ]

    def target(self, tag: Tag) -> Node:
        name = tag.attributes["id"]
        if name not in self.ids:
            raise tag.error(f'nothing has the id "{name}"; ' + choices(name, self.ids, "known are"))
        return self.ids[name]

    def resolve(self) -> None:
        """Put every reference's target in its place, then refuse objects that contain themselves."""
        for owner, slot, tag in self.references:
            owner.parameters[slot] = Parameter("object", self.target(tag), tag)
        for owner, _, tag in self.references:
            _check_circle(owner, tag, self.target(tag), set())


def _check_circle(owner: Node, tag: Tag, node: Node, seen: set[int]) -> None:
    if node is owner:
        raise tag.error(f"circular reference: {owner.tag.label} would contain itself")
    for parameter in node.parameters.values():
        if parameter.kind == "object" and id(parameter.value) not in seen:
            seen.add(id(parameter.value))
            _check_circle(owner, tag, parameter.value, seen)


def _kind(tag: Tag) -> str:
    return "rgb" if tag.name == "srgb" else tag.name


def _elements(element: Any) -> Iterator[Any]:
    """The child elements, without comments and processing instructions."""
    return (child for child in element if isinstance(child.tag, str))


def _check_version(tag: Tag, version: str | None) -> None:
    if version is None:
        raise tag.error('attribute "version" is missing; expected version="3.0.0"')
    if not re.fullmatch(r"\d+\.\d+\.\d+", version):
        raise tag.error(f'version must be three numbers such as "3.0.0", got "{version}"')
    if version.split(".")[0] not in ("2", "3"):
        raise tag.error(f'raylab reads the format of Mitsuba 3 (version="3.0.0"), not version "{version}"')


def _load(path: Path) -> Any:
    """The root element of an XML file; document types and entities are refused."""
    from lxml import etree

    try:
        data = path.read_bytes()
    except OSError as error:
        raise SceneError(f"{path}: cannot read the scene file: {error.strerror}") from None
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
    try:
        root = etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        reason = re.sub(r", line \d+, column \d+$", "", str(error.msg))
        raise SceneError(f"{path}:{error.lineno or 1}: not well-formed XML: {reason}") from None
    if root.getroottree().docinfo.internalDTD is not None:
        raise SceneError(f"{path}:1: <!DOCTYPE>: document types and entities are not allowed in scene files")
    return root
