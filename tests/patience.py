"""A limit on the computing time of a block, which a busy machine does not use up."""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Iterator
from typing import Any


@contextlib.contextmanager
def within(seconds: float) -> Iterator[None]:
    """Raise TimeoutError as soon as the block, all of its threads together, has computed for so long."""

    def stop(*_: Any) -> None:
        raise TimeoutError(f"not done after {seconds:g} seconds of computing")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)
