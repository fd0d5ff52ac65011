"""Moments: what is known of a distribution of samples, whatever random numbers they were made of.

Each moment grows with a power of a sample, its degree: a submission that is a variant times c has its moments times
c^degree.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
OF_COLOURS = np.array([1, 1, 1, 0, 0, 0.5, 0.25])  # degrees
OF_MAPS = np.array([1, 2, 4, 0, 2, 1, 2])
BATCHES = 16


def of_colours(values: Array) -> Array:
    """(trials, n, 3) -> (trials, n, K): each channel, whether black, whether negative, and roots of the green one."""
    lit = (np.abs(values) > 0.0).any(axis=-1)
    green = np.abs(values[..., 1])
    rest = np.stack([~lit, (values < 0.0).any(axis=-1), np.sqrt(green), np.sqrt(np.sqrt(green))], axis=-1)
    return np.concatenate([values, rest], axis=-1)


def of_maps(values: Array, parameters: Array) -> Array:
    """(trials, n, m) -> (trials, BATCHES, K), where all directions across the axis count alike, as frames differ.

    The axis of a direction is the vector in the first three `parameters` (trials, k), and its height that over the
    axis; of a point of the lens it is the distance from the middle. K: powers of the height, how often it is negative,
    the squared length; how far the mean is from the axis, and how much wider the points lie one way than the other.
    """
    trials, n, m = values.shape
    values = values[:, : n - n % BATCHES].reshape(trials, BATCHES, -1, m)
    across = values
    height = np.sqrt(np.sum(values**2, axis=-1))
    if m == 3:
        axis = parameters[:, None, None, :3]
        height = np.sum(values * axis, axis=-1)
        across = values - height[..., None] * axis
    spread = np.linalg.eigvalsh(np.einsum("tbni,tbnj->tbij", across, across) / across.shape[2])
    parts = [height, height**2, height**4, height < 0.0, np.sum(values**2, axis=-1)]
    means = [part.mean(axis=-1) for part in parts]
    return np.stack([*means, np.linalg.norm(across.mean(axis=2), axis=-1), spread[..., -1] - spread[..., -2]], axis=-1)
