"""What all tests have in common: their order, what needs the compiler, the command line to run, and Mitsuba."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest
from helpers import COMPILED

from raylab import cli

# Files that take longest, longest first, so that in the end no worker is left with one of them.
SLOW = (
    "test_hostile", "test_left_out", "test_reference_scenes", "test_closed_form_skies", "test_trials",
    "test_closed_form_renders", "test_mutants", "test_motion_blur", "test_metamorphic", "test_session",
    "test_submission_accepted", "test_lessons", "test_gradescope", "test_estimators", "test_stats_sampler",
    "test_study", "test_demo", "test_cli", "test_estimator_check", "test_figures", "test_study_tails",
)  # fmt: skip


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Slow files first; without the compiler, tests marked `compiled` are left out."""
    order = {name: place for place, name in enumerate(SLOW)}
    items.sort(key=lambda item: order.get(item.path.stem, len(SLOW)))
    if not COMPILED:
        config.hook.pytest_deselected(items=[item for item in items if item.get_closest_marker("compiled")])
        items[:] = [item for item in items if not item.get_closest_marker("compiled")]


@dataclass
class Done:
    """What a command left behind."""

    code: int
    stdout: str
    stderr: str


@pytest.fixture
def run(monkeypatch, capsys) -> Callable[..., Done]:
    """Run the command line in this process, which is fast."""

    def call(*arguments: object) -> Done:
        monkeypatch.setattr(sys, "argv", ["raylab", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            cli.main()
        return Done(left.value.code, *capsys.readouterr())

    return call


@pytest.fixture(scope="session")
def mitsuba() -> Any:
    """Mitsuba 3, which only tests marked `crosscheck` ask for; its variant `scalar_rgb` needs no LLVM."""
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    return mitsuba
