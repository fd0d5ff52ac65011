"""pytest plugin: one line of test for each claim about an estimator. A session that makes no claim is left alone.

    def test_my_area_light(raylab_claims):
        raylab_claims.unbiased("area_diffuse", my_shade, trial="polygons")

A claim that is refuted fails the test; one that is not decided within its number of samples is skipped as
INCONCLUSIVE, never failed. All claims of a session share a false-alarm probability of 1e-6; random numbers are fresh in
each session, and `pytest --raylab-entropy=TOKEN` repeats one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import pytest

_EXAMINER = pytest.StashKey[Any]()
PROPERTY = "raylab"


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("raylab", "claims about estimators")
    group.addoption("--raylab-entropy", metavar="TOKEN", help="repeat the random numbers of a session")
    group.addoption(
        "--raylab-tests", metavar="N", type=float, help="share the false alarms among N claims (300 by default)"
    )


def pytest_configure(config: pytest.Config) -> None:
    if config.getoption("--raylab-entropy") or config.getoption("--raylab-tests"):
        _examiner(config)  # a mistake in the options is said at once


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """Every process of pytest-xdist gets the same entropy; a test's random numbers depend on its name alone."""
    node.workerinput["raylab"] = _examiner(node.config).budget.token


def _examiner(config: pytest.Config) -> Any:
    """The session's examiner, made when it is first asked for."""
    if config.stash.get(_EXAMINER, None) is None:
        from raylab.stats.budget import TESTS, Budget
        from raylab.testing import Examiner

        token = getattr(config, "workerinput", {}).get("raylab") or config.getoption("--raylab-entropy")
        tests = config.getoption("--raylab-tests") or TESTS
        try:
            budget = Budget.replay(token) if token else Budget(tests=tests)
        except ValueError as error:
            raise pytest.UsageError(f"--raylab-entropy: {error}") from None
        config.stash[_EXAMINER] = Examiner(budget)
    return config.stash[_EXAMINER]


class Claims:
    """What can be claimed of an estimator: `raylab.testing.Examiner.CLAIMS`, each of which fails, skips or passes."""

    def __init__(self, examiner: Any, request: pytest.FixtureRequest) -> None:
        self._examiner, self._request = examiner, request

    def __getattr__(self, name: str) -> Callable[..., Any]:
        from raylab.testing import Examiner

        if name not in Examiner.CLAIMS:
            raise AttributeError(f"unknown claim {name!r}; expected one of {', '.join(Examiner.CLAIMS)}")
        return lambda *arguments, **more: self._judge(getattr(self._examiner, name)(*arguments, **more))

    def _judge(self, report: Any) -> Any:
        node = self._request.node
        replay = f'replay: pytest --raylab-entropy={report.token} "{node.nodeid}"'
        node.user_properties.append((PROPERTY, str(report)))
        if report.outcome == "FAIL":
            pytest.fail(f"{report}\n{replay}", pytrace=False)
        if report.outcome == "INCONCLUSIVE":
            pytest.skip(f"INCONCLUSIVE {report.name}: {report.samples} samples did not decide; {replay}")
        return report


@pytest.fixture
def raylab_claims(request: pytest.FixtureRequest) -> Iterator[Claims]:
    """Claims about estimators, with the session's budget of false alarms."""
    examiner = _examiner(request.config)
    examiner.prefix = f"{request.node.nodeid} "
    yield Claims(examiner, request)
    examiner.prefix = ""


def estimator_test(
    technique: str, trials: Sequence[str], claims: Sequence[str] = ("unbiased",), **more: Any
) -> Callable[[Callable[[], Any]], Any]:
    """Make tests of a function that returns a shade(): each of `claims` in each of `trials`.

    Other keyword arguments are handed to the claims.
    """

    def decorate(function: Callable[[], Any]) -> Any:
        @pytest.mark.parametrize("trial", trials)
        @pytest.mark.parametrize("claim", claims)
        def test(raylab_claims: Claims, claim: str, trial: str) -> None:
            getattr(raylab_claims, claim)(technique, function(), trial=trial, **more)

        test.__name__, test.__doc__, test.__module__ = function.__name__, function.__doc__, function.__module__
        return test

    return decorate


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    report.raylab = [text for name, text in report.user_properties if name == PROPERTY]  # type: ignore[attr-defined]


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    """What each claim found, and how to repeat the session."""
    reports = [r for kind in ("passed", "failed", "skipped") for r in terminalreporter.stats.get(kind, [])]
    found = [text for r in reports if getattr(r, "when", "") == "call" for text in getattr(r, "raylab", [])]
    if not found:
        return
    budget = _examiner(config).budget
    terminalreporter.section("raylab claims")
    for text in found:
        terminalreporter.write_line(text)
    terminalreporter.write_line(
        f"{len(found)} claims; false alarms: probability at most {budget.total * len(found) / budget.tests:.2g} "
        f"(budget {budget.total:g}); replay: pytest --raylab-entropy={budget.token}"
    )
