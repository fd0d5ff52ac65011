"""Multiple importance sampling: weights for samples of several techniques that could each have found a point.

A technique's sample f / p is multiplied by its weight; at each point the weights of all techniques add up to 1, so
the sum of one sample of each is unbiased. Densities are all in the same measure. Source: Veach 1997, "Robust Monte
Carlo methods for light transport simulation", section 9.2.
"""

from __future__ import annotations

from raylab.jit import njit


@njit
def ratio(q, p):
    """q / p, also where both are infinite or zero (1)."""
    return 1.0 if q == p else q / p


@njit  # exercise a7.balance
def balance(p, q):
    """The balance heuristic, p / (p + q): the weight of a technique of density p against one of density q."""
    return 1.0 / (1.0 + ratio(q, p)) if p > 0.0 else 0.0


@njit  # exercise a7.power
def power(p, q):
    """The power heuristic with beta = 2, p^2 / (p^2 + q^2)."""
    r = ratio(q, p)
    return 1.0 / (1.0 + r * r) if p > 0.0 else 0.0


@njit
def balance_of(i, p):
    """p_i / sum_j p_j: the weight of technique i of those with the densities p = (p_0, p_1, ...)."""
    if not p[i] > 0.0:
        return 0.0
    total = 0.0
    for other in p:
        total += ratio(other, p[i])
    return 1.0 / total


@njit
def power_of(i, p):
    """p_i^2 / sum_j p_j^2."""
    if not p[i] > 0.0:
        return 0.0
    total = 0.0
    for other in p:
        r = ratio(other, p[i])
        total += r * r
    return 1.0 / total
