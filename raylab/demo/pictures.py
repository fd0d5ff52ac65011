"""Pictures and error maps as PNG files that are also on the page."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from raylab.image import Image
from raylab.io.image_file import decode_srgb, write_png
from raylab.study.look import data_uri

Array = npt.NDArray[np.float64]
LEAST, MOST = 1e-3, 1.0  # ends of the colour scale of an error map, relative to the mean of the reference


def picture(image: Image, path: Path) -> str:
    """Write the mean of `image` and return it as a data URI."""
    write_png(path, image.mean)
    return data_uri(path.read_bytes(), "png")


def error_map(image: Image, reference: Array, path: Path) -> str:
    """Write |picture - reference| of each pixel, mean over channels, in a logarithmic colour scale."""
    relative = np.nanmean(np.abs(image.mean - reference), axis=-1) / np.mean(reference)
    with np.errstate(divide="ignore"):
        place = np.log(relative / LEAST) / np.log(MOST / LEAST)
    write_png(path, decode_srgb(_colours(np.clip(place, 0.0, 1.0))))
    return data_uri(path.read_bytes(), "png")


def scale(path: Path) -> str:
    """The colour scale of error maps, as a strip."""
    write_png(path, decode_srgb(_colours(np.tile(np.linspace(0.0, 1.0, 256), (12, 1)))))
    return data_uri(path.read_bytes(), "png")


def rmse(image: Image, reference: Image) -> float:
    """Root mean square difference over pixels and channels, the reference's own variance taken out."""
    squares = float(np.nanmean((image.mean - reference.mean) ** 2)) - float(np.nanmean(reference.standard_error**2))
    return max(squares, 0.0) ** 0.5


def _colours(place: Array) -> Array:
    """sRGB display values (..., 3) for places 0 .. 1 on the scale, from dark to light for colour-blind eyes too."""
    import matplotlib

    return np.asarray(matplotlib.colormaps["inferno"](place)[..., :3], np.float64)
