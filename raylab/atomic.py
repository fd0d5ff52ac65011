"""Files that are either there in full or not at all."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from raylab.errors import UserError


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A name beside `path`, with its suffix, to write to: renamed at the end, removed after an error."""
    target = Path(path)
    beside = target.with_name(f".{target.stem}.{secrets.token_hex(4)}{target.suffix}")
    try:
        beside.touch(exist_ok=False)
    except OSError as error:
        raise UserError(f'cannot write "{target}": {error.strerror}') from None
    try:
        yield beside
        os.replace(beside, target)
    except OSError as error:
        raise UserError(f'cannot write "{target}": {error.strerror or error}') from None
    finally:
        beside.unlink(missing_ok=True)
