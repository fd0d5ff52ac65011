"""A mutant: edits of the package's source, made while a process of its own imports it. No file is touched."""

from __future__ import annotations

import ast
import importlib.abc
import importlib.util
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2] / "raylab"
NAMES = {  # what a mistake may need that its module has not
    "brdf": "from raylab.sampling import sample_hemisphere\n",
    "shade": "import random\nfrom raylab.sampling import sample_sphere\nfrom raylab.vec3 import Vec3\nCALLS = []\n",
    "camera": "from raylab.vec3 import length\n",
}
SHARED = ("vec3", "view", "record", "jit", "quadrics", "callbacks")  # behind a cache on disk, or the language itself


@dataclass(frozen=True)
class Edit:
    """In the function `where` ("module:function" or "module:Class.method"), `old`, which occurs once, becomes `new`."""

    where: str
    old: str
    new: str


@dataclass(frozen=True)
class Mutant:
    """A mistake; `test` names the kind of test that should find it, `bias` (%) is what the mean is off by, if known.

    Tests: M mean, R range, V variance, P counts of a sampler, J its Jacobian, C stratification or independence, D a
    deterministic relation, = nothing (an equivalent mutant).
    """

    name: str
    what: str
    trial: str
    test: str
    edits: tuple[Edit, ...]
    bias: float | None = None
    source: str = ""


def span(source: str, name: str) -> tuple[int, int]:
    """First and last line (from 0, exclusive) of a function or "Class.method"; LookupError when there is none."""
    body: list[ast.stmt] = ast.parse(source).body
    for part in name.split("."):
        found = [n for n in body if isinstance(n, ast.FunctionDef | ast.ClassDef) and n.name == part]
        if len(found) != 1:
            raise LookupError(f"expected one {name!r}, found {len(found)}")
        body, node = found[0].body, found[0]
    assert node.end_lineno is not None
    return node.lineno - 1, node.end_lineno


def edited(source: str, edit: Edit) -> str:
    """The source with the edit made; LookupError when `old` is not there exactly once."""
    lines = source.splitlines(keepends=True)
    first, last = span(source, edit.where.partition(":")[2])
    text = "".join(lines[first:last])
    if text.count(edit.old) != 1:
        raise LookupError(f"{edit.where}: expected {edit.old!r} once, found it {text.count(edit.old)} times")
    return "".join(lines[:first]) + text.replace(edit.old, edit.new) + "".join(lines[last:])


def path_of(edit: Edit) -> Path:
    module = edit.where.partition(":")[0]
    if module in SHARED:
        raise LookupError(f"{module} is not for mutants")
    return ROOT / f"{module}.py"


def sources(edits: tuple[Edit, ...]) -> dict[str, str]:
    """The new text of each module (raylab.X) that the edits change."""
    texts: dict[str, str] = {}
    for edit in edits:
        path = path_of(edit)
        module = f"raylab.{edit.where.partition(':')[0]}"
        texts[module] = edited(texts.get(module) or path.read_text() + NAMES.get(path.stem, ""), edit)
    return texts


class _Loader(importlib.abc.SourceLoader):
    """numba asks for the source of a function by its file name, so the text stands there for linecache too."""

    def __init__(self, path: str, text: str) -> None:
        self.path, self.text = path, text

    def get_filename(self, fullname: str) -> str:
        return self.path

    def get_data(self, path: str) -> bytes:
        return self.text.encode()

    def path_stats(self, path: str):
        raise OSError  # no bytecode cache


class _Finder(importlib.abc.MetaPathFinder):
    def __init__(self, texts: dict[str, str]) -> None:
        self.texts = texts

    def find_spec(self, fullname, path=None, target=None):
        if fullname not in self.texts:
            return None
        where = str(ROOT / f"{fullname.rpartition('.')[2]}.py")
        return importlib.util.spec_from_loader(fullname, _Loader(where, self.texts[fullname]))


def bring_to_life(edits: tuple[Edit, ...]) -> None:
    """From now on `import raylab` imports the mutant; raylab must not have been imported before."""
    assert not any(name == "raylab" or name.startswith("raylab.") for name in sys.modules)
    sys.meta_path.insert(0, _Finder(sources(edits) | {"raylab.jit": _without_cache()}))


def _without_cache() -> str:
    """A mutant must neither read machine code of the right kernels from the disk nor leave its own there."""
    source, cached = (ROOT / "jit.py").read_text(), "numba.njit(cache=CACHE, **OPTIONS)"
    if source.count(cached) != 1:
        raise LookupError(f"jit: expected {cached!r} once: mutants must not share a cache with the right code")
    return source.replace(cached, "numba.njit(**OPTIONS)")
