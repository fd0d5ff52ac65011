"""Images in and out through OpenImageIO: linear RGB inside, sRGB only in 8 and 16 bit files."""

from __future__ import annotations

import contextlib
import functools
import importlib.metadata
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from raylab.atomic import replacing
from raylab.errors import UserError
from raylab.jit import cache_folder

Array = npt.NDArray[np.float64]
MAGENTA = np.array([1.0, 0.0, 1.0])


class PngReport(NamedTuple):
    """How many pixels of a picture an 8 bit file could not show."""

    invalid: int  # NaN or infinite in some channel, written as magenta
    clipped: int  # below 0 or above 1 in some channel


def decode_srgb(encoded: npt.ArrayLike) -> Array:
    """Linear values from sRGB display values in [0, 1] (IEC 61966-2-1)."""
    import colour

    values = np.asarray(encoded, dtype=np.float64)
    return np.asarray(colour.cctf_decoding(values, function="sRGB"), dtype=np.float64)


def encode_srgb(rgb: npt.ArrayLike) -> npt.NDArray[np.uint8]:
    """Bytes for linear (..., 3): clamped to [0, 1], encoded as sRGB, rounded; not finite becomes magenta."""
    linear = np.asarray(rgb, dtype=np.float64)
    valid = np.isfinite(linear).all(axis=-1, keepdims=True)
    shown = np.clip(np.where(valid, linear, MAGENTA), 0.0, 1.0)
    return np.searchsorted(_byte_steps(), shown, side="right").astype(np.uint8)


@functools.cache
def _byte_steps() -> Array:
    """(255,) linear values at which the encoded byte goes up, from colour-science's sRGB.

    They are kept in the cache folder: importing colour-science takes longer than rendering a small picture.
    """
    kept = cache_folder() / f"srgb-{importlib.metadata.version('colour-science')}.npy"
    if kept.is_file():
        steps: Array = np.load(kept)
        return steps
    steps = decode_srgb((np.arange(255) + 0.5) / 255.0)
    with contextlib.suppress(OSError, UserError):  # a read-only home folder: compute them again next time
        kept.parent.mkdir(parents=True, exist_ok=True)
        with replacing(kept) as beside, beside.open("wb") as file:
            np.save(file, steps)
    return steps


def read_image(path: str | Path, raw: bool = False) -> Array:
    """(h, w, 3) linear RGB, row 0 at the top; 8 and 16 bit files are decoded from sRGB unless `raw`.

    Grey is repeated, alpha dropped. Raises UserError for files that cannot be read.
    """
    import OpenImageIO

    if not Path(path).is_file():
        raise UserError(f'no image file "{path}"')
    plain = OpenImageIO.ImageSpec()
    plain["oiio:UnassociatedAlpha"] = 1  # colours as they are in the file, not multiplied by alpha
    image = OpenImageIO.ImageInput.open(str(path), plain)
    if image is None:
        raise UserError(f'cannot read the image "{path}": {_first_line(OpenImageIO.geterror())}')
    try:
        spec = image.spec()
        first, last = _colour_channels(path, list(spec.channelnames))
        levels = {"uint8": 255, "uint16": 65535}.get(str(spec.format))
        pixels = image.read_image(0, 0, first, last, spec.format if levels else OpenImageIO.FLOAT)
        if pixels is None:
            raise UserError(f'cannot read the image "{path}": {_first_line(image.geterror())}')
    finally:
        image.close()
    values = np.asarray(pixels).reshape(spec.height, spec.width, last - first)
    if levels:  # by a table of all levels of the format
        table = np.arange(levels + 1) / levels
        values = (table if raw else decode_srgb(table))[values]
    return np.array(np.broadcast_to(values, (spec.height, spec.width, 3)), dtype=np.float64)


def _colour_channels(path: str | Path, names: list[str]) -> tuple[int, int]:
    """The range of channels with the colour: R, G, B in a row, or one that is grey."""
    if names[:3] == ["R", "G", "B"]:
        return 0, 3
    for at in range(len(names) - 2):
        if names[at : at + 3] == ["R", "G", "B"]:
            return at, at + 3
    if names in (["Y"], ["Y", "A"]) or len(names) == 1:
        return 0, 1
    raise UserError(f'"{path}" must have channels R, G, B or Y, got {", ".join(names)}')


def faulty_texel(pixels: Array, upper: float = np.inf) -> str:
    """What is wrong with the first texel that is not finite, negative or above `upper`, else ""."""
    wrong = ~((pixels >= 0) & (pixels <= upper) & np.isfinite(pixels)).all(axis=-1)
    if not wrong.any():
        return ""
    row, column = (int(i) for i in np.unravel_index(np.argmax(wrong), wrong.shape))
    value = ", ".join(f"{v:g}" for v in pixels[row, column])
    limit = "finite and not negative" if upper == np.inf else f"from 0 to {upper:g}"
    return (
        f"the pixel in column {column}, row {row} (counted from 0 at the top left) is ({value}); "
        f"values must be {limit} ({int(wrong.sum())} such pixels)"
    )


def write_exr(path: str | Path, channels: Mapping[str, npt.ArrayLike], metadata: Mapping[str, str]) -> None:
    """A float32 OpenEXR file: channel NAME for each (h, w) array, NAME.R, NAME.G, NAME.B for (h, w, 3).

    The name "" gives the channels R, G, B. Raises UserError if the file cannot be written.
    """
    names, planes = _planes(channels)
    data = np.stack(planes, axis=-1).astype(np.float32)
    _write(path, ".exr", data, names, {"compression": "zip", **metadata})


def write_png(path: str | Path, rgb: npt.ArrayLike) -> PngReport:
    """An 8 bit sRGB picture of linear (h, w, 3) `rgb`; returns how many pixels it could not show."""
    linear = np.asarray(rgb, dtype=np.float64)
    if linear.ndim != 3 or linear.shape[2] != 3:
        raise UserError(f"a picture must have the shape (h, w, 3), got {linear.shape}")
    _write(path, ".png", encode_srgb(linear), ["R", "G", "B"], {"oiio:ColorSpace": "sRGB"})
    valid = np.isfinite(linear).all(axis=-1)
    outside = ((linear < 0) | (linear > 1)).any(axis=-1)
    return PngReport(invalid=int((~valid).sum()), clipped=int((valid & outside).sum()))


def _planes(channels: Mapping[str, npt.ArrayLike]) -> tuple[list[str], list[Array]]:
    """Channel names and their (h, w) arrays, which must all have one size."""
    names: list[str] = []
    planes: list[Array] = []
    for name, value in channels.items():
        array = np.asarray(value, dtype=np.float64)
        if array.ndim == 3 and array.shape[2] == 3:
            names += [f"{name}.{c}" if name else c for c in "RGB"]
            planes += list(np.moveaxis(array, -1, 0))
        elif array.ndim == 2 and name:
            names.append(name)
            planes.append(array)
        else:
            raise UserError(f'channel "{name}" must have the shape (h, w) or (h, w, 3), got {array.shape}')
        if planes[-1].shape != planes[0].shape:
            raise UserError(f'channel "{name}" must have the size {planes[0].shape}, got {planes[-1].shape}')
    if not planes:
        raise UserError("an image needs at least one channel")
    return names, planes


def _write(
    path: str | Path, suffix: str, data: npt.NDArray[Any], names: list[str], attributes: Mapping[str, str]
) -> None:
    import OpenImageIO

    if Path(path).suffix.lower() != suffix:
        raise UserError(f'the name of the file must end in {suffix}, got "{path}"')
    height, width, count = data.shape
    spec = OpenImageIO.ImageSpec(width, height, count, "uint8" if suffix == ".png" else "float")
    spec.channelnames = tuple(names)
    for key, value in attributes.items():
        spec.attribute(key, value)
    with replacing(path) as beside:
        image = OpenImageIO.ImageOutput.create(str(beside))
        if image is None:
            raise UserError(f'cannot write "{path}": {_first_line(OpenImageIO.geterror())}')
        if not (image.open(str(beside), spec) and image.write_image(data) and image.close()):
            raise UserError(f'cannot write "{path}": {_first_line(image.geterror())}')


def _first_line(message: str) -> str:
    return message.strip().splitlines()[0] if message.strip() else "unknown reason"
