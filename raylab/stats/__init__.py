"""Statistics of estimators, with error rates that are theorems; nothing here knows of rendering.

In reading order: `histogram` and `verdict`, `betting` (is a mean what it is said to be?), `multinomial` (do counts
follow given probabilities?), `claims` (what can be said of an estimator), `tails` (when nothing can be said).
"""

from raylab.stats.betting import Claim, Test
from raylab.stats.claims import decide, mean_is, same_mean, shrinks_as, uncorrelated, variance_is, variance_ratio_is
from raylab.stats.multinomial import Counts
from raylab.stats.verdict import Verdict

__all__ = [
    "Claim", "Counts", "Test", "Verdict", "decide", "mean_is", "same_mean", "shrinks_as", "uncorrelated",
    "variance_is", "variance_ratio_is",
]  # fmt: skip
