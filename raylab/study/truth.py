"""The truth that a study measures against: a closed form, or a reference with its own error."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab.errors import UserError
from raylab.image import Image
from raylab.render import render
from raylab.scene import Scene

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Truth:
    """`value`, (3,) for the mean of the whole image or (h, w, 3) for its pixels, and how it is known.

    `standard_error` has the same shape; it is zero for a closed form.
    """

    value: Array
    standard_error: Array
    source: str

    @property
    def of_pixels(self) -> bool:
        return self.value.ndim == 3

    def quantity(self, image: Image) -> Array:
        """What is compared, as a vector: all pixels, or the three channels of the image mean.

        A pixel without a finite sample counts as black.
        """
        mean = np.nan_to_num(image.mean, nan=0.0, posinf=0.0, neginf=0.0)
        return (mean if self.of_pixels else mean.mean(axis=(0, 1))).ravel()

    @property
    def variance(self) -> float:
        """Mean square of the truth's own error."""
        return float(np.mean(self.standard_error**2))

    @property
    def variance_error(self) -> float:
        """Standard error of the squared error that the truth really adds, for independent normal pixels."""
        by_pixel = (self.standard_error**2).reshape(-1, 3).sum(axis=1)
        return float(np.sqrt(2.0 * np.sum(by_pixel**2)) / self.value.size)


def find(scene: Scene) -> Truth | None:
    """The truth in `truth.json` beside the scene file, None if there is none or it has another size."""
    path = scene.description.path
    if path is None or not (path.parent / "truth.json").is_file():
        return None
    return read(path.parent / "truth.json", scene)


def read(path: Path, scene: Scene) -> Truth | None:
    """{"mean": [r, g, b], "source": ...}, else {"reference": "reference.npz", ...}; UserError if neither."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UserError(f'cannot read the truth "{path}": {error}') from None
    source = str(content.get("source", "")) if isinstance(content, dict) else ""
    if isinstance(content, dict) and content.get("mean") is not None:
        value = np.asarray(content["mean"], np.float64)
        if value.shape != (3,) or not np.isfinite(value).all():
            raise UserError(f'"mean" in "{path}" must be three finite numbers, got {content["mean"]}')
        return Truth(value, np.zeros(3), f"closed form of the mean of the whole image. {source}".strip())
    if isinstance(content, dict) and "reference" in content:
        return _read_reference(path.parent / str(content["reference"]), scene, source)
    raise UserError(f'"{path}" must be an object with "mean" or "reference"')


def _read_reference(path: Path, scene: Scene, source: str) -> Truth | None:
    camera = scene.description.camera
    try:
        with np.load(path, allow_pickle=False) as arrays:
            mean, error = np.asarray(arrays["mean"], float), np.asarray(arrays["standard_error"], float)
    except (OSError, ValueError, KeyError) as problem:
        raise UserError(f'cannot read the reference "{path}": {problem}') from None
    if mean.shape != (camera.height, camera.width, 3):
        return None
    return Truth(mean, np.nan_to_num(error), f"reference {path.name}. {source}".strip())


def compute(
    scene: Scene,
    shade: str | Callable[..., Any],
    spp: int,
    seed: int,
    threads: int | None,
    progress: Callable[[Any], None] | None = None,
) -> Truth:
    """A reference rendered now, with Sobol' points; KeyboardInterrupt if it is stopped."""
    image = render(scene, shade, sampler="sobol", spp=spp, seed=seed, threads=threads, progress=progress)
    if not image.complete:
        raise KeyboardInterrupt
    name = shade if isinstance(shade, str) else getattr(shade, "__name__", "shade")
    source = f"reference rendered for this study: shade {name}, sampler sobol, {spp} samples per pixel, seed {seed}"
    return Truth(np.nan_to_num(image.mean), np.nan_to_num(image.standard_error), source)
