"""What the readers of one scene file share: its folder, what was read already, and warnings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from raylab.description import Array
from raylab.errors import UserError
from raylab.io.image_file import faulty_texel, read_image
from raylab.io.xml_node import Node, read_node
from raylab.io.xml_values import find_file

T = TypeVar("T")


@dataclass
class Context:
    """`folder` holds the scene file; objects that are referred to twice are read once and shared."""

    folder: Path
    warnings: list[str] = field(default_factory=list)
    _read: dict[int, Any] = field(default_factory=dict)
    _images: dict[tuple[Path, bool], Array] = field(default_factory=dict)

    def warn(self, node: Node, message: str, parameter: str = "") -> None:
        given = node.parameters.get(parameter)
        self.warnings.append(f"{(given.tag if given else node.tag).place}: {message}")

    def read(self, node: Node, readers: Mapping[str, Callable[[Node, Context], T]]) -> T:
        """What the reader of the node's type makes of it, the same object each time."""
        if id(node) not in self._read:
            self._read[id(node)] = read_node(node, readers, self)
        value: T = self._read[id(node)]
        return value

    def file(self, node: Node) -> Path:
        """The file that the parameter `filename` names."""
        name = node.string("filename")
        return find_file(node.parameters["filename"].tag, name, self.folder)

    def image(self, node: Node, raw: bool, upper: float) -> Array:
        """The pixels of the file that `filename` names, (h, w, 3) from 0 to `upper`."""
        path = self.file(node)
        try:
            if (path, raw) not in self._images:
                self._images[path, raw] = read_image(path, raw)
        except UserError as error:
            raise node.error(str(error), "filename") from None
        fault = faulty_texel(self._images[path, raw], upper)
        if fault:
            raise node.error(f'in "{path}" {fault}', "filename")
        return self._images[path, raw]
