"""Budget: the false-alarm probability of a whole suite, shared out among its tests, and one number that replays it.

By the union bound a suite of correct estimators raises any false alarm with probability at most the sum of its
tests' alphas, however its tests depend on one another. Random numbers come from the operating system, so that the
bound is about this very run; the entropy is part of the replay token, and a test's seed depends on it and on the name
of the test alone, not on which other tests were run, or in which order.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, field

import numpy as np

TOTAL, TESTS = 1e-6, 300


@dataclass(frozen=True)
class Share:
    """What one test gets: its alpha, and the seed of its random numbers (63 bits)."""

    name: str
    alpha: float
    seed: int

    def child(self, number: int) -> int:
        """Seeds 0, 1, ... for tests that need several independent sequences."""
        return _seed(self.seed, str(number))


@dataclass
class Budget:
    """`total` is shared out in `tests` equal parts; a test of weight w takes w of them.

    Without `entropy` it is asked of the operating system.
    """

    total: float = TOTAL
    entropy: int | None = None
    tests: float = TESTS
    spent: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not 0.0 < self.total < 1.0:
            raise ValueError(f"expected a total false-alarm probability between 0 and 1, got {self.total}")
        if not self.tests >= 1.0:
            raise ValueError(f"expected room for at least one test, got {self.tests}")
        if self.entropy is None:
            self.entropy = int(np.random.SeedSequence().entropy)  # type: ignore[arg-type]
        if self.entropy < 0:
            raise ValueError(f"expected an entropy of at least 0, got {self.entropy}")

    def test(self, name: str, weight: float = 1.0) -> Share:
        """The share of the test called `name`; each name may ask once in a run.

        Raises ValueError when the budget is used up: a suite that grows needs a larger `tests`, not a larger total.
        """
        assert self.entropy is not None
        if name in self.spent:
            raise ValueError(f"test {name!r} has had its share of the budget already: a repeated look is another test")
        if not (0.0 < weight < math.inf):
            raise ValueError(f"test {name!r}: expected a positive weight, got {weight}")
        if sum(self.spent.values()) + weight > self.tests * (1.0 + 2.0**-40):
            raise ValueError(f"test {name!r}: the budget of {self.tests:g} tests is used up; make it with more tests")
        self.spent[name] = weight
        return Share(name, self.total * weight / self.tests, _seed(self.entropy, name))

    @property
    def false_alarm(self) -> float:
        """The probability, at most, that what has been tested so far raised a false alarm."""
        return self.total * sum(self.spent.values()) / self.tests

    @property
    def token(self) -> str:
        """What replays this run: the entropy in hexadecimal, and total and tests where they are not the usual ones."""
        usual = (self.total, float(self.tests)) == (TOTAL, float(TESTS))
        return f"{self.entropy:x}" + ("" if usual else f"/{float(self.total)!r}/{float(self.tests)!r}")

    @classmethod
    def replay(cls, token: str) -> Budget:
        """The budget of a token; raises ValueError if it is none."""
        entropy, *rest = token.strip().split("/")
        try:
            total, tests = (float(rest[0]), float(rest[1])) if rest else (TOTAL, TESTS)
            if len(rest) not in (0, 2):
                raise ValueError
            return cls(total, int(entropy, 16), tests)
        except (ValueError, IndexError):
            raise ValueError(f"expected a replay token such as 1f03a9 or 1f03a9/1e-06/300, got {token!r}") from None


def _seed(entropy: int, name: str) -> int:
    """63 bits that belong to a name, unrelated for different names and entropies."""
    key = np.frombuffer(hashlib.sha256(name.encode()).digest(), np.uint32)
    state = np.random.SeedSequence(entropy, spawn_key=tuple(int(word) for word in key)).generate_state(1, np.uint64)
    return int(state[0]) >> 1
