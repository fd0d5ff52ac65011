"""Histogram: all that a bet needs to know of the observations, in a few hundred numbers.

A bet of size l against the mean m multiplies its capital by 1 + l (y - m) at each observation y. The logarithm of
that factor is concave in y, so over a bin it lies above its chord. With the count and the sum of the observations of
each bin, the chord gives a lower bound of the log capital: whoever demands a capital of 1 / alpha before speaking
errs on the safe side. In bins of width w the bound falls short by at most (w / sd)^2 / 4 of what the bet has won.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def edges_for(low: float, high: float, centre: float, spread: float) -> Array:
    """Bin edges over [low, high]: steps of spread / 16 about the centre, of 3 % of the distance to it further out."""
    spread = min(max(spread, (high - low) * 2.0**-40), high - low)
    near = spread / 16.0 * np.arange(0, 97)
    steps = int(np.ceil(np.log(max((high - low) / near[-1], 1.0)) / np.log(1.03))) + 1
    far = near[-1] * 1.03 ** np.arange(1, steps + 1)
    offsets = np.concatenate([near, far])
    edges = np.concatenate([[low, high], centre - offsets, centre + offsets])
    return np.unique(np.clip(edges, low, high))


def log_growth(edges: Array, mean: float, bets: Array) -> Array:
    """log(1 + l (y - mean)) for each bet l (k,) and each edge y."""
    with np.errstate(divide="ignore"):
        return np.asarray(np.log1p(np.maximum(np.outer(bets, edges - mean), -1.0)))


class Histogram:
    """Counts and sums of observations in [edges[0], edges[-1]]; the last bin is closed."""

    def __init__(self, edges: Array) -> None:
        self.edges = edges
        self.counts = np.zeros(len(edges) - 1)
        self.sums = np.zeros(len(edges) - 1)

    def add(self, values: Array) -> None:
        """Put `values` (n,) into their bins; all must lie within the edges."""
        bins = np.minimum(np.searchsorted(self.edges, values, side="right") - 1, len(self.counts) - 1)
        self.counts += np.bincount(bins, minlength=len(self.counts))
        self.sums += np.bincount(bins, weights=values, minlength=len(self.counts))

    def log_capital(self, mean: float, bets: Array) -> Array:
        """A lower bound, for each bet l in `bets` (k,), of the sum of log(1 + l (y - mean)) over all observations."""
        return self.log_capital_of(log_growth(self.edges, mean, bets))

    def log_capital_of(self, at_edges: Array) -> Array:
        """The same from what `log_growth` gives at the edges, (k, edges)."""
        share = (self.sums - self.counts * self.edges[:-1]) / np.diff(self.edges)
        share = np.clip(share, 0.0, self.counts)  # rounding of the sums
        used = np.flatnonzero(self.counts)
        left, right = (self.counts - share)[used], share[used]
        return np.asarray(at_edges[:, used] @ left + at_edges[:, used + 1] @ right)
