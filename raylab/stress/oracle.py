"""Oracle: truths with sixty digits, by mpmath, from formulas that need no care then."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

DIGITS = 60


def exact() -> Any:
    """mpmath with sixty digits; a UserError where it is not installed."""
    try:
        import mpmath  # type: ignore[import-untyped]
    except ImportError:
        from raylab.errors import UserError

        raise UserError("raylab stress needs mpmath; install raylab[stress]") from None
    mpmath.mp.dps = DIGITS
    return mpmath


def relative(value: Any, truth: Any) -> float:
    """|value - truth| / |truth|, taken with all digits; NaN for what is no number."""
    m = exact()
    if not math.isfinite(value):
        return math.nan
    return float(abs(m.mpf(float(value)) - truth) / abs(m.mpf(truth)))


def worst(values: Iterable[Any], truths: Iterable[Any]) -> float:
    """The largest relative error; NaN if one is."""
    errors = [relative(v, t) for v, t in zip(values, truths, strict=True)]
    return math.nan if any(map(math.isnan, errors)) else max(errors)


def triangle_solid_angle(a: Any, e1: Any, e2: Any) -> Any:
    """Van Oosterom and Strackee, of a corner and two edges as seen from the origin."""
    m = exact()
    a, e1, e2 = (m.matrix([m.mpf(x) for x in v]) for v in (a, e1, e2))
    b, c = a + e1, a + e2
    dot = lambda p, q: sum(p[i] * q[i] for i in range(3))  # noqa: E731
    la, lb, lc = (m.sqrt(dot(v, v)) for v in (a, b, c))
    n = m.matrix([e1[1] * e2[2] - e1[2] * e2[1], e1[2] * e2[0] - e1[0] * e2[2], e1[0] * e2[1] - e1[1] * e2[0]])
    return 2 * m.atan2(abs(dot(a, n)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)


def rectangle_solid_angle(a: Any, e1: Any, e2: Any) -> Any:
    """Of its two triangles; a, e1 and e2 as floats."""
    m = exact()
    far = [m.mpf(float(p)) + m.mpf(float(q)) + m.mpf(float(r)) for p, q, r in zip(a, e1, e2, strict=True)]
    return triangle_solid_angle(a, e1, e2) + triangle_solid_angle(far, [-x for x in e1], [-x for x in e2])


def gauss(n: int, low: float = 0.0, high: float = 1.0) -> tuple[Any, Any]:
    """Nodes and weights of Gauss and Legendre between two ends."""
    x, weights = np.polynomial.legendre.leggauss(n)
    return low + 0.5 * (high - low) * (x + 1.0), 0.5 * (high - low) * weights
