"""The elements that hold plain values: numbers, words, points, colours and spectra."""

from __future__ import annotations

import re
from collections.abc import Callable
from os.path import isfile
from pathlib import Path
from typing import Any

import numpy as np

from raylab.description import Array
from raylab.errors import UserError
from raylab.io.xml_tag import Tag

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)", re.IGNORECASE)


def number(tag: Tag, text: str) -> float:
    """`text` as a finite float."""
    word = text.strip()
    if _NOT_FINITE.fullmatch(word):
        raise tag.error(f'expected a finite number, got "{text}"')
    if not _NUMBER.fullmatch(word):
        raise tag.error(f'expected a number, got "{text}"')
    value = float(word)
    if not np.isfinite(value):
        raise tag.error(f'expected a finite number, got "{text}", which is too large')
    return value


def numbers(tag: Tag, text: str, *counts: int) -> Array:
    """`text` as finite floats separated by blanks or commas; there must be one of `counts` of them."""
    words = [word for word in re.split(r"[\s,]+", text) if word]
    if len(words) not in counts:
        expected = " or ".join(str(count) for count in counts)
        raise tag.error(f'expected {expected} numbers, got {len(words)} in "{text}"')
    return np.array([number(tag, word) for word in words])


def coordinates(tag: Tag, default: float | None = None) -> Array:
    """(3,) from `x`, `y`, `z`, each `default` when left out, or from `value` with one or three numbers."""
    given = [key for key in "xyz" if key in tag.attributes]
    if "value" in tag.attributes:
        if given:
            raise tag.error("give either value or x, y and z, not both")
        return np.broadcast_to(numbers(tag, tag.attributes["value"], 1, 3), 3).copy()
    if default is None and len(given) < 3:
        missing = ", ".join(key for key in "xyz" if key not in given)
        raise tag.error(f"expected x, y and z (or value); {missing} missing")
    return np.array([number(tag, tag.attributes.get(key, str(default))) for key in "xyz"])


MAY_BE_INFINITE = ("focus_distance",)


def _float(tag: Tag) -> float:
    tag.check_attributes(("name", "value"))
    if tag.attributes["name"] in MAY_BE_INFINITE and tag.attributes["value"].strip().lower() in ("inf", "infinity"):
        return float("inf")
    return number(tag, tag.attributes["value"])


def _integer(tag: Tag) -> int:
    tag.check_attributes(("name", "value"))
    text = tag.attributes["value"]
    if not re.fullmatch(r"\s*[+-]?[0-9]{1,18}\s*", text):
        raise tag.error(f'expected a whole number, got "{text}"')
    return int(text)


def _boolean(tag: Tag) -> bool:
    tag.check_attributes(("name", "value"))
    word = tag.attributes["value"].lower()
    if word not in ("true", "false"):
        raise tag.error(f'expected "true" or "false", got "{tag.attributes["value"]}"')
    return word == "true"


def _string(tag: Tag) -> str:
    tag.check_attributes(("name", "value"))
    return tag.attributes["value"]


def _point(tag: Tag) -> Array:
    tag.check_attributes(("name",), ("x", "y", "z", "value"))
    return coordinates(tag)


def _rgb(tag: Tag) -> Array:
    tag.check_attributes(("name", "value"))
    return np.broadcast_to(numbers(tag, tag.attributes["value"], 1, 3), 3).copy()


def _srgb(tag: Tag) -> Array:
    """Display values in [0, 1] or "#rrggbb", decoded to linear RGB (an addition to Mitsuba 3's elements)."""
    from raylab.io.image_file import decode_srgb

    tag.check_attributes(("name", "value"))
    text = tag.attributes["value"].strip()
    if text.startswith("#"):
        if not re.fullmatch(r"#[0-9a-fA-F]{6}", text):
            raise tag.error(f'expected "#rrggbb", got "{text}"')
        return decode_srgb(np.frombuffer(bytes.fromhex(text[1:]), np.uint8) / 255)
    encoded = np.broadcast_to(numbers(tag, text, 1, 3), 3)
    if encoded.min() < 0 or encoded.max() > 1:
        raise tag.error(f'sRGB values must lie in [0, 1], got "{text}"; <rgb> takes linear values')
    return decode_srgb(encoded)


def _spectrum(tag: Tag) -> float | tuple[Array, Array]:
    """A uniform value, or wavelengths in nm and values."""
    from raylab.io import spectrum

    tag.check_attributes(("name",), ("value", "filename"))
    if ("value" in tag.attributes) == ("filename" in tag.attributes):
        raise tag.error("give either value or filename")
    text = tag.attributes.get("value")
    if text is not None and ":" not in text:
        return float(numbers(tag, text, 1)[0])
    try:
        if text is not None:
            return spectrum.parse_pairs(text)
        return spectrum.read_spd(find_file(tag, tag.attributes["filename"]))
    except UserError as error:
        raise tag.error(str(error)) from None


def find_file(tag: Tag, name: str, beside: Path | None = None) -> Path:
    """The file called `name`, looked for in the folder `beside` and in the folder of the tag's own file."""
    folders = [tag.file.parent] if beside is None else [beside, tag.file.parent]
    for folder in folders:
        if isfile(folder / name):  # False as well for a name that is none, or too long for a file
            return folder / name
    where = " or ".join(f'"{folder}"' for folder in dict.fromkeys(folders))
    raise tag.error(f'no file "{name}" in {where}')


VALUES: dict[str, Callable[[Tag], Any]] = {
    "float": _float,
    "integer": _integer,
    "boolean": _boolean,
    "string": _string,
    "point": _point,
    "vector": _point,
    "rgb": _rgb,
    "srgb": _srgb,
    "spectrum": _spectrum,
}
