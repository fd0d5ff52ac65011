"""Choosing one of many lights: choose(u) -> i, q; then one sample of light i, divided by q, stands for the sum.

Its variance is sum_i x_i^2 / q_i - (sum_i x_i)^2 and that of the lights' own samples: none if q_i is in proportion to
what light i contributes. `power` comes near that in the open: q_i proportional to radiance times area. An alias table
answers in the same short time for any number of lights, which take 24 bytes each.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from raylab.errors import SceneError
from raylab.jit import njit
from raylab.record import record
from raylab.view import View

Array = npt.NDArray[np.float64]
MANY = 64  # lights above which `direct` takes one sample of one light, chosen by power, instead of one of each


@njit
def choose_uniform(n, u):
    """One of n lights, each with q = 1 / n."""
    return min(int(u[0] * n), n - 1), 1.0 / n


@njit
def choose_by_alias(table, u):
    """Bin i of n holds light i up to its threshold and light alias[i] above it: Walker 1977, Vose 1991."""
    i = min(int(u[0] * len(table.shares)), len(table.shares) - 1)
    if u[1] >= table.thresholds[i]:
        i = table.aliases[i]
    return i, table.shares[i]


@record
class FewLights(NamedTuple):
    """At most MANY lights: `direct` samples each."""

    thresholds: View
    aliases: View
    shares: View

    def many(self):
        return False

    def choose(self, u):
        return choose_by_alias(self, u)


@record
class ManyLights(NamedTuple):
    """More than MANY lights: `direct` samples one."""

    thresholds: View
    aliases: View
    shares: View

    def many(self):
        return True

    def choose(self, u):
        return choose_by_alias(self, u)


def alias_table(weights: npt.ArrayLike) -> tuple[Array, npt.NDArray[np.int64], Array]:
    """Thresholds, aliases and shares of non-negative weights (n,), not all zero; Vose 1991, O(n).

    The share of light i is (threshold_i + sum of 1 - threshold_j over the bins j whose alias is i) / n.
    """
    w = np.asarray(weights, np.float64)
    if w.ndim != 1 or not (np.all(np.isfinite(w)) and np.all(w >= 0.0) and w.sum() > 0.0):
        raise SceneError("the powers of lights must be finite, not negative and not all zero")
    shares = w / w.max()
    shares /= shares.sum()
    filling = shares * len(w)
    thresholds, aliases = np.ones(len(w)), np.arange(len(w))
    small, large = np.flatnonzero(filling < 1.0).tolist(), np.flatnonzero(filling >= 1.0).tolist()
    left = filling.tolist()
    while small and large:
        low, high = small.pop(), large.pop()
        thresholds[low], aliases[low] = left[low], high
        left[high] -= 1.0 - left[low]
        (small if left[high] < 1.0 else large).append(high)
    return thresholds, aliases, shares


def make_choice(power: Array) -> FewLights | ManyLights:
    """The choice among lights of these powers, in any unit; lights that are all dark are chosen uniformly."""
    power = power if len(power) and power.max() > 0.0 else np.ones(max(len(power), 1))
    kind = ManyLights if len(power) > MANY else FewLights
    thresholds, aliases, shares = alias_table(power)
    return kind(View(thresholds), View(aliases), View(shares))
