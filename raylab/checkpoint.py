"""Checkpoint: a render under way in a file, so that one that was killed goes on and gives the same picture, bit by bit.

What a pixel gets depends on seed, pixel, stream and sample number alone, so a picture whose first n samples were kept
ends as if it had never been stopped. The file says of which render it is; another one's is refused.
"""

from __future__ import annotations

import dataclasses
import hashlib
import os
import time
from collections.abc import Mapping
from pathlib import Path
from types import CodeType
from typing import Any
from zipfile import BadZipFile

import numpy as np
import numpy.typing as npt

from raylab._version import __version__
from raylab.atomic import replacing
from raylab.errors import UserError

Array = npt.NDArray[Any]


class Checkpoint:
    """The file of one render, known by what determines its picture."""

    interval = 10.0  # s between two writings, and at least ten times what one takes

    def __init__(self, path: Path, *what: Any) -> None:
        self.path, self.identity = path, hashlib.sha256(repr((__version__, fingerprint(what))).encode()).hexdigest()
        self._written, self._took = time.monotonic(), 0.0

    def load(self) -> dict[str, Array]:
        """What was kept; nothing if there is no file. UserError if it is of another render, or no checkpoint."""
        if not self.path.exists():
            return {}
        try:
            with open(self.path, "rb") as opened, np.load(opened, allow_pickle=False) as file:
                kept = {name: file[name] for name in file.files}
            identity = str(kept.pop("identity"))
        except (OSError, ValueError, KeyError, EOFError, BadZipFile) as error:
            raise UserError(f"{self.path} cannot be read as a checkpoint ({error}); expected one, or no file") from None
        if identity != self.identity:
            raise UserError(
                f"{self.path} is the checkpoint of another render (scene, shade, sampler, seed, samples or version "
                "differ); expected its own, or no file"
            )
        return kept

    def due(self, left: float) -> bool:
        """Is it time to write again, where `left` seconds are left in all?"""
        return left > 2.0 * self._took and time.monotonic() - self._written > max(self.interval, 10.0 * self._took)

    def save(self, **kept: Any) -> None:
        """Replace the file in one step; UserError if it cannot be written, and then the last one stays."""
        start = time.monotonic()
        with replacing(self.path) as beside, open(beside, "wb") as file:
            np.savez(file, identity=np.array(self.identity), **kept)
            file.flush()
            os.fsync(file.fileno())
        self._written = time.monotonic()
        self._took = self._written - start


def fingerprint(value: Any) -> Any:
    """A value whose `repr` is the same for the same content, in every process."""
    if isinstance(value, np.ndarray):
        return value.shape, str(value.dtype), hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = {f.name: getattr(value, f.name) for f in dataclasses.fields(value) if f.name != "path"}
        return type(value).__name__, fingerprint(fields)
    if isinstance(value, Mapping):
        return sorted((str(key), repr(fingerprint(own))) for key, own in value.items())
    if isinstance(value, list | tuple):
        return [fingerprint(own) for own in value]
    if isinstance(value, CodeType):
        return value.co_code, fingerprint(value.co_consts), value.co_names
    if callable(value):
        code = getattr(getattr(value, "py_func", value), "__code__", None)
        return getattr(value, "__name__", ""), fingerprint(code)
    return repr(value)
