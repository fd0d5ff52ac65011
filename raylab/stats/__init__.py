"""Statistics of estimators, with error rates that are theorems; nothing here knows of rendering.

In reading order: `histogram` and `verdict`, `betting` (is a mean what it is said to be?), `multinomial` (do counts
follow given probabilities?), `claims` (what can be said of an estimator), `tails` (when nothing can be
said), `budget` (a suite of tests, and how to replay it); `domains`, `cells`, `sampler_map` and `sampler_check` (has a
sampler the density that it claims?); for display `intervals`, `convergence` and `efficiency`.
"""

from raylab.stats.betting import Claim, Test
from raylab.stats.budget import Budget, Share
from raylab.stats.claims import decide, mean_is, same_mean, shrinks_as, uncorrelated, variance_is, variance_ratio_is
from raylab.stats.multinomial import Counts
from raylab.stats.verdict import Verdict

__all__ = [
    "Budget", "Claim", "Counts", "Share", "Test", "Verdict", "decide", "mean_is", "same_mean", "shrinks_as",
    "uncorrelated", "variance_is", "variance_ratio_is",
]  # fmt: skip
