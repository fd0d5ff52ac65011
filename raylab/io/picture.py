"""A rendered picture as a file: what to look at (.png), what to measure with (.exr), everything (.npz)."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from raylab.atomic import replacing
from raylab.errors import UserError
from raylab.image import Image

SUFFIXES = (".png", ".exr", ".npz")


def check(path: Path) -> None:
    """UserError unless `write` knows the suffix of `path` and its folder is there."""
    if path.suffix.lower() not in SUFFIXES:
        raise UserError(
            f'cannot write "{path}": expected a name that ends in {", ".join(SUFFIXES[:-1])} or {SUFFIXES[-1]}'
        )
    if not path.parent.is_dir():
        raise UserError(f'cannot write "{path}": there is no folder "{path.parent}"')


def write(image: Image, path: Path) -> str:
    """Write a picture in the format that its suffix names; returns a sentence on what the file cannot show, or "".

    .png : the mean, 8-bit sRGB, values above 1 cut.
    .exr : float32 channels R, G, B (mean), standard_error.R, .G, .B and samples; the report as attribute "raylab".
    .npz : float64 mean, standard_error (h, w, 3) and samples (h, w); report, JSON text.

    Raises UserError for another suffix or a file that cannot be written.
    """
    check(path)
    suffix = path.suffix.lower()
    if suffix == ".png":
        return _write_png(image, path)
    if suffix == ".exr":
        from raylab.io.image_file import write_exr

        channels = {"": image.mean, "standard_error": image.standard_error, "samples": image.samples}
        write_exr(path, channels, {"raylab": report_json(image)})
        return ""
    with replacing(path) as beside:
        np.savez(
            beside,
            mean=image.mean,
            standard_error=image.standard_error,
            samples=image.samples,
            report=np.array(report_json(image)),
        )
    return ""


def report_json(image: Image) -> str:
    """How the picture was made, as one JSON object; what is not a number is null."""
    names = ("invalid_samples", "invalid_rays", "degenerate_samples", "bias_bounds", "complete")
    counts = {name: getattr(image, name) for name in names}
    return json.dumps(plain({**image.report, **counts}), allow_nan=False)


def plain(value: Any) -> Any:
    """`value` as JSON knows it: arrays become lists, numpy numbers Python's, NaN and infinity None."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _write_png(image: Image, path: Path) -> str:
    from raylab.io.image_file import write_png

    lost, pixels = write_png(path, image.mean), image.mean[..., 0].size
    sentences = []
    if lost.invalid:
        sentences.append(f"{lost.invalid} of {pixels} pixels have no finite value and are magenta in {path.name}.")
    if lost.clipped:
        sentences.append(
            f"{lost.clipped} of {pixels} pixels are darker than 0 or brighter than 1 and are cut in {path.name}; "
            "an .exr file keeps them."
        )
    return " ".join(sentences)
