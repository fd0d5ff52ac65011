"""The truth that a study measures against: a closed form, or a reference with its own error."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
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
ONLY_SIZE = {"width", "height", "spp"}  # parameters of a scene file that do not change what the picture shows


@dataclass(frozen=True, eq=False)
class Truth:
    """`value`, (3,) for the mean of the whole image or (h, w, 3) for its pixels, and how it is known.

    `standard_error` has the same shape. `all_light`: it holds for all the light of the scene, so not for estimators
    that leave out a kind of light.
    """

    value: Array
    standard_error: Array
    source: str
    all_light: bool = False

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


def find(scene: Scene, parameters: Mapping[str, Any] | None = None) -> Truth | None:
    """The truth in `truth.json` beside the scene file, None if there is none or it does not fit.

    It fits a scene that was loaded with no other `parameters` than its size. Pixels are compared if the reference has
    as many; else the mean of the whole image, if it is known in closed form and the aspect ratio is the same.
    Raises UserError for a file that cannot be understood.
    """
    path = scene.description.path
    if path is None or not (path.parent / "truth.json").is_file() or set(parameters or {}) - ONLY_SIZE:
        return None
    return read(path.parent / "truth.json", scene)


def read(path: Path, scene: Scene) -> Truth | None:
    """A truth.json: {"source", "reference": "reference.npz"} and, for a closed form, {"mean", "standard_error"}."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UserError(f'cannot read the truth "{path}": {error}') from None
    if not isinstance(content, dict) or not {"mean", "reference"} & set(content):
        raise UserError(f'"{path}" must be an object with "mean" or "reference"')
    if content.get("shade", "direct") != "direct":
        return None  # the picture of one shade, not of all light
    closed, source = "mean" in content, str(content.get("source", ""))
    aspect = scene.description.camera.width / scene.description.camera.height
    if "reference" in content:
        mean, spread = _reference(path.parent / str(content["reference"]))
        if mean.shape == (scene.description.camera.height, scene.description.camera.width, 3):
            how = "closed form in each pixel" if closed else "reference"
            return Truth(mean, spread, f"{how}, {content['reference']}: {source}", all_light=True)
        closed = closed and abs(aspect * mean.shape[0] / mean.shape[1] - 1.0) < 1e-9
    if not closed:
        return None
    value, spread = (np.asarray(content.get(k, np.zeros(3)), np.float64) for k in ("mean", "standard_error"))
    if value.shape != (3,) or spread.shape != (3,) or not np.isfinite([value, spread]).all():
        raise UserError(f'"mean" and "standard_error" in "{path}" must be three finite numbers each')
    return Truth(value, spread, f"closed form of the mean of the whole image: {source}", all_light=True)


def _reference(path: Path) -> tuple[Array, Array]:
    try:
        with np.load(path, allow_pickle=False) as arrays:
            mean, error = np.asarray(arrays["mean"], float), np.asarray(arrays["standard_error"], float)
    except (OSError, ValueError, KeyError) as problem:
        raise UserError(f'cannot read the reference "{path}": {problem}') from None
    if mean.ndim != 3 or mean.shape[2] != 3 or error.shape != mean.shape or not np.isfinite(mean).all():
        raise UserError(f'the reference "{path}" must hold a finite mean (h, w, 3) and its standard_error')
    return mean, np.nan_to_num(error)


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
