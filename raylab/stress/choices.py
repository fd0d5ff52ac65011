"""Choices: among many lights, between two techniques, and of a point in a triangle, at the ends of their ranges."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import mis
from raylab.light_choice import alias_table, make_choice
from raylab.sampling import sample_triangle
from raylab.stress.case import U53, Found, case
from raylab.stress.lamps import squares
from raylab.stress.single import single

Array = npt.NDArray[np.float64]
LIGHTS = 1_000_000
POWERS = 1e-12 ** np.linspace(0.0, 1.0, LIGHTS)
MEAN = float(POWERS.mean())


@case(
    "B21", "one of 1e6 lights with powers from 1 to 1e-12; none with any power",
    usual="cumulated powers in float32; 0 / 0 without power", rule="an alias table in float64; all alike without power",
    truth="the powers", unit="total variation between the chances and the shares, NaN if one is",
    allowed=2 * U53 * (1.0 / MEAN + 8.0),  # two roundings of what a bin still has to give
)  # fmt: skip
def one_of_a_million() -> Found:
    shares = POWERS / math.fsum(POWERS)
    thresholds, aliases, claimed = alias_table(POWERS)
    chances = (thresholds + np.bincount(aliases, 1.0 - thresholds, LIGHTS)) / LIGHTS
    dark = make_choice(np.zeros(LIGHTS)).shares.array
    error = float(max(np.abs(chances - shares).sum(), np.abs(claimed - shares).sum()) + abs(dark.sum() - 1.0))
    sums = np.cumsum(POWERS.astype(np.float32))
    drawn = np.diff(sums / sums[-1], prepend=np.float32(0.0)).astype(float)
    never = int((drawn == 0.0).sum())
    return Found(error, float(np.abs(drawn - shares).sum()), note=f"usual: {never} lights are never chosen")


DENSITIES = (
    (1e20, 1e20),
    (1e20, 1.0),
    (1e160, 1e160),
    (1e160, 1e159),
    (1e-200, 1e-200),
    (math.inf, 1.0),
    (0.0, 1.0),
    (0.0, 0.0),
)


@case(
    "B22", "weights of two densities: 1e20, 1e160, 1e-200, infinite, one or both 0", usual="p^2 / (p^2 + q^2)",
    rule="1 / (1 + (q / p)^2), 0 where p = 0", truth="w(p, q) + w(q, p) = 1, or 0 where both are",
    unit="error of the sum, NaN if one is", allowed=1e-15,
)  # fmt: skip
def weights_of_two() -> Found:
    def worst(weight: Any, number: Any) -> float:
        with np.errstate(all="ignore"):
            pairs = [(number(p), number(q)) for p, q in DENSITIES]
            errors = [abs(float(weight(p, q)) + float(weight(q, p)) - (p > 0.0 or q > 0.0)) for p, q in pairs]
        return math.nan if any(map(math.isnan, errors)) else max(errors)

    def usual(p: Any, q: Any) -> Any:
        return p * p / (p * p + q * q)

    return Found(
        max(worst(mis.power, float), worst(mis.balance, float)), worst(usual, np.float64),
        worst(single(mis.power), np.float32),
    )  # fmt: skip


@case(
    "B23", "points of a triangle for u in {0, 2^-53, 1 - 2^-53, 1}^2 and 100,000 others",
    usual="(u, v) mirrored into the triangle where u + v > 1", rule="b1 = sqrt(u1) (1 - u2), b2 = sqrt(u1) u2",
    truth="b1, b2 >= 0 and b1 + b2 <= 1", unit="how far outside a point is", allowed=2 * U53,
)  # fmt: skip
def corners_of_a_triangle() -> Found:
    ends = (0.0, 2.0**-53, 1.0 - 2.0**-53, 1.0)
    places = [(u, v) for u in ends for v in ends] + [(float(u), float(v)) for u, v in squares(100_000)]

    def outside(b1: float, b2: float) -> float:
        return max(0.0, -b1, -b2, math.fsum((b1, b2, -1.0)))

    def mirrored(u: float, v: float) -> tuple[float, float]:
        return (1.0 - u, 1.0 - v) if u + v > 1.0 else (u, v)

    ours = max(outside(*sample_triangle(u)) for u in places)
    few = single(sample_triangle)
    in_float32 = max(outside(*map(float, few((np.float32(u), np.float32(v))))) for u, v in places[:2000])
    return Found(ours, max(outside(*mirrored(*u)) for u in places), in_float32)
