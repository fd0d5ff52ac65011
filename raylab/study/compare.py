"""Compare: a picture beside its reference, and the difference in standard errors: is it noise, or is it wrong?

A pixel alone says little: with 64 samples, noise hides an error of a tenth. So the difference is looked at in tiles,
over which an error adds up and noise averages out: z = (luminance - reference) / standard error. Where fewer than
ALPHA of all right pictures would have a tile as far off, it is not noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab.atomic import replacing
from raylab.errors import UserError
from raylab.image import Image
from raylab.study.look import png

Array = npt.NDArray[np.float64]
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of linear sRGB
ACROSS = 40  # tiles beside each other
LEAST = 2.0**-10  # relative difference that counts as none: nobody sees it, and a stored reference is rounded
ALPHA = 1e-6  # of right pictures that are called wrong


def side_of(width: int) -> int:
    """Pixels along the side of a tile."""
    return max(1, round(width / ACROSS))


def in_tiles(values: Array, side: int) -> Array:
    """Sums over squares of side x side pixels of (h, w); those at the right and lower edge may be smaller."""
    h, w = values.shape
    return np.add.reduceat(np.add.reduceat(values, np.arange(0, h, side), 0), np.arange(0, w, side), 1)


def tile_means(mean: Array, side: int) -> Array:
    """Luminance of the tiles of (h, w, 3)."""
    return in_tiles(mean @ LUMINANCE, side) / in_tiles(np.ones(mean.shape[:2]), side)


def tile_errors(standard_error: Array, side: int) -> Array:
    """Its standard error, from that of pixels (h, w, 3): channels share their random numbers, pixels do not."""
    variance = (np.nan_to_num(standard_error) @ LUMINANCE) ** 2
    return np.sqrt(in_tiles(variance, side)) / in_tiles(np.ones(variance.shape), side)


@dataclass(frozen=True, eq=False)
class Reference:
    """What should have come out.

    `mean` (h, w, 3); for the luminance of each tile its standard `error`, and `deviation`, the one that the slide's
    technique has with one sample in each pixel; `noise`, root mean square of the standard errors of the pixels.
    """

    mean: Array
    error: Array
    deviation: Array
    noise: float
    source: str

    @classmethod
    def of(cls, image: Image, source: str) -> Reference:
        """A picture made by the technique itself, of independent samples."""
        error = tile_errors(image.standard_error, side_of(image.mean.shape[1]))
        mean, noise = np.nan_to_num(image.mean), float(np.sqrt(np.nanmean(image.standard_error**2)))
        return cls(mean, error, error * np.sqrt(np.mean(image.samples)), noise, source)


@dataclass(frozen=True, eq=False)
class Comparison:
    """A picture and its reference, of the same size."""

    image: Image
    reference: Reference

    def __post_init__(self) -> None:
        if self.image.mean.shape != self.reference.mean.shape:
            raise UserError("a picture and its reference must have the same size")
        if not np.isfinite(self.image.standard_error).any():
            raise UserError("the noise of a picture with one sample in each pixel is not known; expected two or more")

    @property
    def side(self) -> int:
        return side_of(self.image.mean.shape[1])

    @cached_property
    def _tiles(self) -> tuple[Array, Array, Array]:
        """Luminance of the picture's tiles, of the reference's, and the standard error of the difference.

        Where light comes by rare samples, those of a tile know little of their own variance: there may be none. If the
        technique of the slide has more of it, in this tile or beside it, that is taken.
        """
        from scipy.ndimage import maximum_filter

        side, spp = self.side, float(np.mean(self.image.samples))
        ours, theirs = (tile_means(m, side) for m in (np.nan_to_num(self.image.mean), self.reference.mean))
        known = maximum_filter(self.reference.deviation, 3) / np.sqrt(spp)
        own = np.maximum(tile_errors(self.image.standard_error, side), known)
        return ours, theirs, np.hypot(own, self.reference.error)

    @cached_property
    def z(self) -> Array:
        """The difference of each tile in standard errors; LEAST of the light is always allowed."""
        ours, theirs, error = self._tiles
        allowed = np.hypot(error, LEAST * theirs)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(ours == theirs, 0.0, (ours - theirs) / allowed)

    @property
    def limit(self) -> float:
        """How far off a tile can be by noise, in standard errors: two-sided, ALPHA over all tiles."""
        return NormalDist().inv_cdf(1.0 - 0.5 * ALPHA / (self.z.size + 1))

    @cached_property
    def ratio(self) -> tuple[float, float]:
        """Mean luminance of the picture over that of the reference, and the standard error of this ratio."""
        ours, theirs, error = self._tiles
        sizes = in_tiles(np.ones(self.image.mean.shape[:2]), self.side)
        light = float((theirs * sizes).sum())
        if light == 0.0:
            return float("nan"), float("nan")
        return float((ours * sizes).sum()) / light, float(np.sqrt(((error * sizes) ** 2).sum())) / light

    @property
    def rmse(self) -> tuple[float, float]:
        """Root mean square error of the pixels over the mean of the reference, and what noise makes of it."""
        difference = np.nan_to_num(self.image.mean) - self.reference.mean
        noise = np.nanmean(self.image.standard_error**2) + self.reference.noise**2
        light = float(self.reference.mean.mean())
        with np.errstate(divide="ignore", invalid="ignore"):
            return float(np.sqrt(np.mean(difference**2)) / light), float(np.sqrt(noise) / light)

    @property
    def wrong_tiles(self) -> int:
        return int((np.abs(self.z) > self.limit).sum())

    @property
    def only_noise(self) -> bool:
        ratio, error = self.ratio
        off = bool(abs(ratio - 1.0) > self.limit * np.hypot(error, LEAST))
        return not (self.wrong_tiles or off or self.image.invalid_samples)

    @property
    def worst(self) -> tuple[int, int]:
        """(column, row) of the pixel in the middle of the tile that is furthest off."""
        row, column = np.unravel_index(int(np.argmax(np.abs(self.z))), self.z.shape)
        h, w, _ = self.image.mean.shape
        return min(w - 1, int((column + 0.5) * self.side)), min(h - 1, int((row + 0.5) * self.side))

    @property
    def numbers(self) -> str:
        """Mean, ratio to the reference with its 95 % interval, relative RMSE."""
        (ratio, error), (rmse, noise) = self.ratio, self.rmse
        mean = float(np.nanmean(self.image.mean @ LUMINANCE))
        return (
            f"Mean luminance {mean:.4g}, {ratio:.4f} times the reference (95 %: {ratio - 1.96 * error:.4f} to "
            f"{ratio + 1.96 * error:.4f}); RMSE of a pixel {100 * rmse:.3g} % of the mean, and noise makes "
            f"{100 * noise:.3g} %."
        )

    @property
    def verdict(self) -> str:
        """Noise or not, and where."""
        if self.only_noise:
            return "The difference is noise: no part of the picture is off by more than that explains."
        if self.image.invalid_samples:
            return f"{self.image.invalid_samples} samples are not numbers."
        if not self.wrong_tiles:
            return "More than noise: no part is far off, but the whole picture is."
        column, row = self.worst
        sign = "bright" if self.z.flat[np.argmax(np.abs(self.z))] > 0.0 else "dark"
        return (
            f"More than noise: {100 * self.wrong_tiles / self.z.size:.2g} % of the picture is off by more than "
            f"{self.limit:.2g} standard errors; it is most clearly too {sign} around column {column}, row {row}."
        )

    def to_dict(self) -> dict[str, Any]:
        """For --json."""
        from raylab.io.picture import plain

        ratio, rmse = self.ratio, self.rmse
        return {
            "reference": self.reference.source, "ratio": plain(ratio[0]), "ratio_standard_error": plain(ratio[1]),
            "relative_rmse": plain(rmse[0]), "relative_noise": plain(rmse[1]), "only_noise": self.only_noise,
            "wrong_tiles": self.wrong_tiles, "tiles": self.z.size,
        }  # fmt: skip

    def write(self, path: Path, title: str) -> None:
        """The picture, the reference and the difference in standard errors, as one PNG."""
        from raylab.study.beside import drawn

        with replacing(path) as beside:
            beside.write_bytes(png(drawn(self, title)))
