"""Pictures and error maps as PNG files that are also on the page."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from raylab.figures import panels
from raylab.image import Image
from raylab.io.image_file import write_png
from raylab.study.look import data_uri

Array = npt.NDArray[np.float64]


def picture(image: Image, path: Path) -> str:
    """Write the mean of `image` and return it as a data URI."""
    return _kept(image.mean, path)


def error_map(image: Image, reference: Array, path: Path) -> str:
    """Write `panels.error_map` of `image`."""
    return _kept(panels.error_map(image.mean, reference), path)


def scale(path: Path) -> str:
    """The colour scale of error maps, as a strip."""
    return _kept(panels.colours(np.tile(np.linspace(0.0, 1.0, 256), (12, 1))), path)


def _kept(pixels: Array, path: Path) -> str:
    write_png(path, pixels)
    return data_uri(path.read_bytes(), "png")


def rmse(image: Image, reference: Image) -> float:
    """Root mean square difference over pixels and channels, the reference's own variance taken out."""
    squares = float(np.nanmean((image.mean - reference.mean) ** 2)) - float(np.nanmean(reference.standard_error**2))
    return max(squares, 0.0) ** 0.5
