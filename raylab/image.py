"""Image: what a render returns: mean radiance and its standard error, pixel by pixel, and how it was made."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab.pixels import COUNT, INVALID, MEAN, SQUARES

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Image:
    """A rendered picture.

    Attributes
    ----------
    mean, standard_error : (h, w, 3) float64, linear sRGB radiance; the error is NaN where it is unknown.
    samples : (h, w) samples in each pixel, invalid ones not counted.
    invalid_samples : how many samples were not finite and left out; each may hide a bias.
    invalid_rays : how many rays were not traced because they were not finite; they let no light through.
    degenerate_samples : how many points of lights were seen edge-on, up to rounding, and taken to be in shadow.
    """

    mean: Array
    standard_error: Array
    samples: Array
    invalid_samples: int = 0
    invalid_rays: int = 0
    degenerate_samples: int = 0
    complete: bool = True
    report: dict[str, Any] = field(default_factory=dict)

    @property
    def image_mean(self) -> Array:
        """(3,): the mean over all pixels."""
        return np.asarray(np.nanmean(self.mean, axis=(0, 1)))

    @property
    def image_standard_error(self) -> Array:
        """(3,): of `image_mean`; pixels are independent, so their variances add."""
        variance = self.standard_error**2
        return np.asarray(np.sqrt(variance.sum(axis=(0, 1))) / variance[..., 0].size)

    @property
    def bias_bounds(self) -> dict[str, float]:
        """Of each kind of loss, the share of the samples that it can have touched: the picture is off by at most that
        share of the brightest sample there can be."""
        taken = float(np.sum(self.samples)) + self.invalid_samples
        lost = {
            "invalid_samples": self.invalid_samples, "invalid_rays": self.invalid_rays,
            "degenerate_samples": self.degenerate_samples,
        }  # fmt: skip
        return {name: min(1.0, count / taken) if taken else 0.0 for name, count in lost.items()}

    @property
    def relative_error(self) -> float:
        """Root mean square of the standard errors of all pixels over the mean radiance; NaN while unknown."""
        mean = float(np.nanmean(self.mean))
        noise = float(np.sqrt(np.mean(self.standard_error**2)))
        return noise / mean if mean > 0.0 else (0.0 if noise == 0.0 else float("nan"))


def estimate(accumulator: Array, independent: bool) -> tuple[Array, Array, Array]:
    """Mean (h, w, 3), standard error (h, w, 3) and samples (h, w) from (streams, h, w, COLUMNS).

    Each of the R streams with samples counts the same, m = sum m_r / R. Independent samples: SE^2 = sum_r s_r^2 / n_r
    / R^2 with s_r^2 = sum (v - m_r)^2 / (n_r - 1). Otherwise samples of one stream depend on each other, and the
    streams are compared: SE^2 = sum (m_r - m)^2 / (R (R - 1)).
    """
    counts = accumulator[..., COUNT]
    some = (counts > 0)[..., None]
    streams = some.sum(axis=0)
    means = accumulator[..., MEAN : MEAN + 3]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # an error beyond 1e308 is inf
        mean = np.where(some, means, 0.0).sum(axis=0) / streams
        if independent:
            n = counts[..., None]
            spread = np.where(some, accumulator[..., SQUARES : SQUARES + 3] / (n * (n - 1.0)), 0.0).sum(axis=0)
            variance = spread / streams**2
        else:
            spread = np.where(some, (means - mean) ** 2, 0.0).sum(axis=0)
            variance = spread / (streams * (streams - 1.0))
    known = (counts[..., None] > 1).all(axis=0) if independent else streams > 1
    return mean, np.where(known, np.sqrt(variance), np.nan), counts.sum(axis=0)


def invalid(accumulator: Array) -> int:
    return int(accumulator[..., INVALID].sum())
