"""Hidden: the lines of a rubric as tests of pytest, in the judging process, away from all settings and plugins.

pytest runs and reports; the scores are what each line writes down itself, and no exit code is believed.
"""

from __future__ import annotations

import contextlib
import io
import os
import tempfile
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from raylab.grading.faults import GraderFault

Line = Callable[[], str]  # judges, and returns what is wrong, if anything
OPTIONS = ("-q", "-s", "--noconftest", "--import-mode=importlib", "-p", "no:cacheprovider", "-p", "no:xdist")


def test_property(line: Line) -> None:
    import pytest

    wrong = line()
    if wrong:
        pytest.fail(wrong, pytrace=False)


class Lines:
    """Gives pytest the lines; a plugin."""

    def __init__(self, lines: Mapping[str, Line]) -> None:
        self.lines = lines

    def pytest_generate_tests(self, metafunc: Any) -> None:
        metafunc.parametrize("line", self.lines.values(), ids=self.lines.keys())


def run(lines: Mapping[str, Line]) -> str:
    """Judge all lines, and return the report of pytest, which is for the staff."""
    try:
        import pytest
    except ImportError:
        raise GraderFault("grading needs pytest; install raylab[test]") from None
    report = io.StringIO()
    with tempfile.TemporaryDirectory() as empty, clean_environment(), contextlib.redirect_stdout(report):
        pytest.main([*OPTIONS, "-c", os.devnull, "--rootdir", empty, __file__], plugins=[Lines(lines)])
    return report.getvalue()


@contextlib.contextmanager
def clean_environment() -> Iterator[None]:
    """Without what others may have set for pytest."""
    kept = {name: value for name, value in os.environ.items() if name.startswith("PYTEST_")}
    for name in kept:
        del os.environ[name]
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    try:
        yield
    finally:
        del os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"]
        os.environ.update(kept)
