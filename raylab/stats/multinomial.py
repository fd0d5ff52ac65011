"""Multinomial: do counts in cells follow given probabilities? A mixture of bets, exact at every sample size.

    E = mean over A of  Gamma(A) / Gamma(A + N)  prod_k  Gamma(A p_k + n_k) / (Gamma(A p_k) p_k^n_k)

is the likelihood ratio of Dirichlet mixtures around p against p itself, a martingale of mean 1 if p is true. No pooling
of small cells, no table: a count where p_k = 0 refutes at once. Sources: Good 1967, JRSS-B 29 (the Bayes factor);
Ville 1939 (the bound).
"""

from __future__ import annotations

import numpy as np

from raylab.stats.histogram import Array

STRENGTHS = 4.0 ** np.arange(3.0, 12.0)  # A: how near to p the alternatives lie


class Counts:
    """Counts of independent draws over cells of probabilities `p` (k,); what they lack to 1 is a cell "elsewhere"."""

    def __init__(self, p: Array) -> None:
        p = np.asarray(p, np.float64)
        if p.ndim != 1 or not (p >= 0.0).all() or p.sum() > 1.0 + 1e-9:
            raise ValueError(f"expected probabilities (k,) with a sum of at most 1, got {p.shape} with sum {p.sum()}")
        self.p = np.append(p, max(0.0, 1.0 - p.sum()))
        if self.p[-1] < 1e-12:  # rounding of the sum is not a cell
            self.p[-1] = 0.0
        self.n = np.zeros(len(self.p))

    def add(self, cells: Array) -> None:
        """Count draws by the numbers of their cells (n,); -1 is elsewhere."""
        self.n += np.bincount(np.where(cells < 0, len(self.p) - 1, cells), minlength=len(self.p))

    def log_evidence(self) -> float:
        """log E: `exp` of it exceeds 1 / alpha ever with probability at most alpha if p is true."""
        from scipy.special import gammaln, logsumexp

        if (self.n[self.p == 0.0] > 0).any():
            return np.inf
        used = self.n > 0
        p, n, total = self.p[used], self.n[used], self.n.sum()
        terms = [
            gammaln(a) - gammaln(a + total) + (gammaln(a * p + n) - gammaln(a * p) - n * np.log(p)).sum()
            for a in STRENGTHS
        ]
        return float(logsumexp(terms) - np.log(len(terms)))
