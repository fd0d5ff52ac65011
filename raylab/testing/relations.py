"""Relations of samples: those of one scene and of another that must give the same, but for a factor."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from raylab.errors import UserError
from raylab.metamorphic import Relation
from raylab.stats.betting import PILOT, Claim
from raylab.stats.budget import Share
from raylab.stats.tails import rule_of_three
from raylab.stats.verdict import Verdict
from raylab.testing.deciding import Decision, decide, equal_means
from raylab.testing.source import Array, Draw

Samples = Callable[[int], Draw]  # of a seed
ROUNDING = 2.0**-10  # relative: float32 moves points by 2^-24 of the scene, 1/r^2 and cosines by some 100 times that
FLIPS = 1e-3  # samples that rounding may bring to the other side of an edge or texel: far fewer than that
LOOK = 1 << 12  # samples that are compared bit for bit


def related(
    share: Share, before: Samples, after: Samples, relation: Relation, bound: Array | None, delta: float
) -> Decision:
    """A relation of samples before and after the change; one about means alone needs a bound of the samples (3,)."""
    if relation.expected == "bitwise":
        return _bitwise(share, _differs(share, before, after, relation))
    if relation.expected == "rounding":
        differs = _differs(share, before, after, relation)
        claim = Claim(share.name, 0.5 * FLIPS, 0.0, 1.0, 9.5 * FLIPS, 0.5 * FLIPS, share.alpha)
        return decide([claim], lambda n: differs(n)[:, None])
    x, y = before(share.child(1)), after(share.child(2))
    pilot, cut = before(share.child(3))(PILOT), lambda values: values
    if relation.expected == "distribution":  # of samples that are spread alike, all that is cut off alike is as well
        pilot = np.concatenate([pilot, after(share.child(4))(PILOT) / relation.factor])  # one of them may be black
        bound = top = 4.0 * pilot.max(axis=0) + 1e-300
        cut = lambda values: np.minimum(values, top)  # noqa: E731
    if bound is None:
        raise UserError(f"relation {relation.name!r} is about means: expected a bound of the samples")
    claims = equal_means(share, bound, bound, delta * np.maximum(pilot.mean(axis=0), 1e-6 * bound))
    return decide(claims, lambda n: cut(x(n)) - cut(y(n) / relation.factor))


def _differs(share: Share, before: Samples, after: Samples, relation: Relation) -> Draw:
    """n -> (n,), 1 where two samples with the same random numbers are not the same, or not within rounding."""
    x_draw, y_draw = before(share.child(1)), after(share.child(1))

    def differs(n: int) -> Array:
        x, y, allowed = x_draw(n) * relation.factor, y_draw(n), np.zeros(3)
        if relation.expected == "rounding":
            allowed = ROUNDING * np.maximum(np.abs(x), np.nanmean(np.abs(x), axis=0) + 1e-300)
        same = (np.abs(y - x) <= allowed) | (np.isnan(x) & np.isnan(y))
        return np.where(same.all(axis=1), 0.0, 1.0)

    return differs


def _bitwise(share: Share, differs: Draw) -> Decision:
    """No sample may differ: no chance is in that, so one that does is a FAIL."""
    start = time.perf_counter()
    wrong, unseen = float(differs(LOOK).mean()), rule_of_three(LOOK, 1.0 - 1e-3)
    verdict = Verdict(
        share.name, "FAIL" if wrong else "PASS", wrong, (0.0, max(wrong, unseen)), 0.0, LOOK, unseen, 0.0, 1e-3,
        time.perf_counter() - start, f"{100 * wrong:.3g} % of the samples changed, expected none" if wrong else "",
    )  # fmt: skip
    return Decision((verdict,), LOOK, ())
