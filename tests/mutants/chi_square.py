"""The published tests of samplers of other projects, re-implemented: True where a mistake is noticed.

Pearson's chi-square in cells of (cos theta, phi): Nori's `warptest` (51 x 102 cells, 1000 samples each, alpha 1 %) and
`chi2test` for BRDFs (10 x 20 cells, 1e6 samples, five runs with Sidak's correction), Mitsuba 3's `chi2.py` (50 x 101
cells, 1e6 samples, alpha 1 %), pbrt-v4's (80 x 160 cells, 1e6 samples, five runs with Sidak's correction). All pool
cells with less than 5 expected, and let a cell where nothing is expected have a share of 1e-5 of the samples. Their
integrals are ours here, which err less. darts: the pdf integrates to 0.90 .. 1.01, 90 % of the samples are valid; pdf
and samples are compared by eye.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mutants.charts import Chart

SETTINGS = {  # rows, columns, samples, runs
    "Nori": {"warp": (51, 102, 51 * 102 * 1000, 1), "BRDF": (10, 20, 1_000_000, 5)},
    "Mitsuba": {"warp": (50, 101, 1_000_000, 1), "BRDF": (50, 101, 1_000_000, 1)},
    "pbrt": {"warp": (80, 160, 1_000_000, 5), "BRDF": (80, 160, 1_000_000, 5)},
}
ALPHA, POOL, STRAY = 0.01, 5.0, 1e-5


def rejects(observed: Any, expected: Any, runs: int) -> bool:
    """Pearson's test with the smallest cells pooled, as in Nori's hypothesis.h, Mitsuba's chi2.py and pbrt's."""
    from scipy.stats import chi2

    n = observed.sum()
    order = np.argsort(expected, axis=None)
    observed, expected = observed.ravel()[order].astype(float), expected.ravel()[order]
    if not np.isfinite(expected).all() or (observed[expected <= 0.0] > STRAY * n).any():
        return True
    observed, expected = observed[expected > 0.0], expected[expected > 0.0]
    pooled = int(np.searchsorted(expected, POOL))
    while pooled < len(expected) and 0.0 < expected[:pooled].sum() < POOL:
        pooled += 1
    if pooled:
        observed = np.append(observed[pooled:], observed[:pooled].sum())
        expected = np.append(expected[pooled:], expected[:pooled].sum())
    statistic = float(((observed - expected) ** 2 / expected).sum())
    return bool(chi2.sf(statistic, len(expected) - 1) < 1.0 - (1.0 - ALPHA) ** (1.0 / runs))


def judge(draw: Any, density: Any, chart: Chart, kind: str) -> dict[str, bool]:
    """What each would say; `draw(n)` gives points (n, 3), `density(points)` the pdf. `kind`: "warp" or "BRDF"."""
    found = {}
    for name, settings in SETTINGS.items():
        rows, columns, n, runs = settings[kind]
        share = chart.expected(density, rows, columns)
        found[name] = share.sum() > 1.1 and name == "Mitsuba"
        for _ in range(runs):
            counted, lost = chart.counts(draw(n), rows, columns)
            found[name] = found[name] or lost > STRAY * n or rejects(counted, share * n, runs)
    counted, lost = chart.counts(draw(100_000), 128, 256)
    total = float(chart.expected(density, 128, 256).sum())
    found["darts"] = not (0.90 <= total <= 1.01 and lost <= 10_000)
    return found
