"""An object of a scene file: a reader asks for its parameters by name, what nobody asks for is refused."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np

from raylab.description import Animation, Array
from raylab.errors import SceneError
from raylab.io.xml_tag import Tag, choices

T = TypeVar("T")
_REQUIRED: Any = object()


@dataclass(frozen=True, eq=False)
class Parameter:
    """A value and the tag it came from; nested objects have the kind "object"."""

    kind: str
    value: Any
    tag: Tag


@dataclass(eq=False)
class Node:
    """`<shape type="sphere" id="ball">` and the like: kind "shape", type "sphere", id "ball"."""

    tag: Tag
    parameters: dict[str, Parameter] = field(default_factory=dict)
    asked: dict[str, None] = field(default_factory=dict)

    @property
    def kind(self) -> str:
        return self.tag.name

    @property
    def type(self) -> str:
        return self.tag.attributes.get("type", self.kind)

    @property
    def id(self) -> str:
        return self.tag.attributes.get("id", "")

    def error(self, message: str, parameter: str = "") -> SceneError:
        """An error about this object, or about its `parameter` where the file gives it."""
        given = self.parameters.get(parameter)
        return (given.tag if given else self.tag).error(message)

    def add(self, name: str, parameter: Parameter) -> None:
        """File `parameter` under `name`, or under a name of its own when it has none."""
        name = name or f"({len(self.parameters)})"
        if name in self.parameters:
            first = self.parameters[name].tag.line
            raise parameter.tag.error(f'"{name}" is given twice; the first time in line {first}')
        self.parameters[name] = parameter

    def has(self, name: str) -> bool:
        return name in self.parameters

    def ask(self, name: str, kinds: tuple[str, ...], default: Any = _REQUIRED) -> Any:
        """The value of parameter `name`, which must be of one of `kinds`."""
        self.asked[name] = None
        parameter = self.parameters.get(name)
        if parameter is None:
            if default is _REQUIRED:
                raise self.error(f'<{kinds[0]} name="{name}"> is missing')
            return default
        if parameter.kind not in kinds:
            if parameter.kind == "animation" and "transform" in kinds:
                raise parameter.tag.error(f"{self.tag.label} cannot move; shapes, area lights and the sensor can")
            wanted = " or ".join(f"<{kind}>" for kind in kinds if kind != "animation")
            raise parameter.tag.error(f'"{name}" must be given as {wanted}, not as <{parameter.tag.name}>')
        return parameter.value

    def number(
        self,
        name: str,
        default: float = _REQUIRED,
        *,
        above: float = -float("inf"),
        below: float = float("inf"),
    ) -> float:
        """A float strictly between `above` and `below`."""
        value = float(self.ask(name, ("float", "integer"), default))
        if not above < value < below:
            limits = f"greater than {above:g}" + (f" and less than {below:g}" if below < float("inf") else "")
            raise self.error(f'"{name}" must be {limits}, got {value:g}', name)
        return value

    def integer(self, name: str, default: int = _REQUIRED, *, least: int, most: int = 2**31 - 1) -> int:
        """A whole number from `least` to `most`."""
        value = self.ask(name, ("integer",), default)
        if not least <= value <= most:
            raise self.error(f'"{name}" must be from {least} to {most}, got {value}', name)
        return int(value)

    def boolean(self, name: str, default: bool) -> bool:
        return bool(self.ask(name, ("boolean",), default))

    def string(self, name: str, default: str = _REQUIRED) -> str:
        return str(self.ask(name, ("string",), default))

    def choice(self, name: str, default: str, allowed: tuple[str, ...]) -> str:
        """A word out of `allowed`."""
        value = self.string(name, default)
        if value not in allowed:
            raise self.error(f'unknown {name} "{value}"; ' + choices(value, allowed), name)
        return value

    def point(self, name: str, default: Array = _REQUIRED) -> Array:
        value: Array = self.ask(name, ("point", "vector"), default)
        return value

    def transform(self, name: str, default: Array) -> Array:
        """A (4, 4) matrix, local to world."""
        value: Array = self.ask(name, ("transform",), default)
        return value

    def placing(self, name: str) -> tuple[Array, Animation | None]:
        """Where something stands, and how it moves if it does; the matrix is that of the first keyframe."""
        given = self.ask(name, ("transform", "animation"), np.eye(4))
        return (given.matrices[0], given) if isinstance(given, Animation) else (given, None)

    def children(self, kind: str, most: int) -> list[Node]:
        """The nested objects of `kind`, at most `most` of them."""
        found = []
        for name, parameter in self.parameters.items():
            if parameter.kind == "object" and parameter.value.kind == kind:
                self.asked[name] = None
                found.append(parameter.value)
                if len(found) > most:
                    raise parameter.tag.error(f"{self.tag.label} takes {most} <{kind}> at most")
        return found

    def child(self, kind: str) -> Node | None:
        """The nested object of `kind`, if any; more than one is an error."""
        found = self.children(kind, 1)
        return found[0] if found else None

    def finish(self) -> None:
        """Refuse the first parameter that no reader asked for."""
        known = [name for name in self.asked if not name.startswith("(")]
        for name, parameter in self.parameters.items():
            if name not in self.asked and parameter.kind == "object":
                raise parameter.tag.error(f"<{parameter.value.kind}> has no place in {self.tag.label}")
            if name not in self.asked:
                raise parameter.tag.error(f'{self.tag.label} has no parameter "{name}"; {choices(name, known)}')


def read_node(node: Node, readers: Mapping[str, Callable[..., T]], *arguments: Any) -> T:
    """What the reader of the node's type makes of it; unknown types and left-over parameters are refused."""
    if node.type not in readers:
        raise node.error(f"unknown {node.kind}; " + choices(node.type, readers, "raylab supports"))
    value = readers[node.type](node, *arguments)
    node.finish()
    return value
