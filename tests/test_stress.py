"""The extreme cases of docs/stability.md, each with its time limit; what the runner does with one that misbehaves."""

from __future__ import annotations

import math
import os
import time

import pytest

from raylab.errors import UserError
from raylab.stress import report, runner
from raylab.stress.case import SECTIONS, Case, Found, Row, cases, chosen

pytestmark = pytest.mark.compiled(reason="the cases measure compiled code")
KNOWN_TO_BREAK: dict[str, str] = {  # id -> why; such a row stays in the table
    "H07": "colours out of gamut are cut off, with a warning, because Mitsuba 3 does so and pictures are to agree",
}


@pytest.fixture(scope="module")
def measuring():
    with runner.Runner() as running:
        yield running


@pytest.mark.extreme
@pytest.mark.parametrize(
    "id", [pytest.param(id, marks=[pytest.mark.certify] if one.slow else []) for id, one in cases().items()]
)
def test_holds(id, measuring):
    row = measuring.run(cases()[id])
    assert row.held == (id not in KNOWN_TO_BREAK), f"{row.case.setup}: {row.found or row.failed}"


def made(measure, limit=5.0, allowed=0.0):
    return Case("A00", "set-up | <b>", "usual", "rule", "truth", "hits", allowed, limit, False, measure)


class Serving(runner.Runner):
    """A runner whose process knows one case, which is given as a function of this module."""

    def __init__(self, name):
        super().__init__()
        self.name = name

    def _start(self):
        context = runner.multiprocessing.get_context("fork")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=serve, args=(theirs, self.name), daemon=True)
        self._process.start()
        theirs.close()


def serve(pipe, name):
    runner.cases = lambda: {"A00": made(globals()[name])}
    runner._serve(_Announced(pipe))


class _Announced:
    """The pipe, without the first word, which `Serving` does not wait for."""

    def __init__(self, pipe):
        self.pipe, self.first = pipe, True

    def send(self, what):
        if not self.first:
            self.pipe.send(what)
        self.first = False

    def recv(self):
        return self.pipe.recv()


def sleeps():
    time.sleep(60.0)


def dies():
    os._exit(7)


def raises():
    raise ZeroDivisionError("of all things")


def finds_nan():
    return Found(math.nan)


@pytest.mark.parametrize(
    ("name", "words"),
    [("sleeps", "did not end within 0.3 s"), ("dies", "ended with code 7"), ("raises", "of all things")],
)
def test_a_case_that_misbehaves_is_a_row_that_does_not_hold(name, words):
    with Serving(name) as running:
        row = running.run(made(None, limit=0.3 if name == "sleeps" else 5.0))
        assert words in row.failed
        assert not row.held
        assert running._process is None or name == "raises"  # what is left of it


def test_a_nan_never_holds():
    with Serving("finds_nan") as running:
        assert not running.run(made(None, allowed=math.inf)).held


def test_the_report_shows_what_fails():
    rows = [
        Row(made(None), 0.1, Found(1.0, 2.0, 3.0)),
        Row(made(None), 0.1, Found(0.0)),
        Row(made(None), 1.0, failed="x\ny"),
    ]
    text, page = report.markdown(rows), report.page(rows)
    assert "1 of 3 cases held (not: A00, A00)" in text
    assert "**1**" in text
    assert "set-up \\| &lt;b>" in text
    assert "<b>" not in page
    assert "<pre>x\ny</pre>" in page


def test_cases_are_chosen_by_id_and_by_section():
    assert [c.id for c in chosen(["B05"])] == ["B05"]
    assert {c.id[0] for c in chosen([])} <= set(SECTIONS)
    with pytest.raises(UserError, match="no case is called 'Z9'; expected an id such as B05"):
        chosen(["Z9"])


def test_the_truths_are_the_published_digits():
    """Solid angle and irradiance of dyadic rectangles, to twenty digits, by another program."""
    from raylab.stress.oracle import exact, rectangle_solid_angle, relative
    from raylab.stress.rectangles import lambert

    m = exact()
    for size, angle, irradiance in (
        (2.0**-7, "5.4298170187923281146e-5", "5.2222045497173589774e-5"),
        (2.0**-14, "3.3276881113355829863e-9", "3.2048185549430369061e-9"),
        (2.0**-27, "4.9587995980210155219e-17", "4.7757545529248356864e-17"),
    ):
        corner, e1, e2 = (0.25, 0.125, 1.0), (size, 0.0, 0.0), (0.0, size, 0.0)
        assert abs(rectangle_solid_angle(corner, e1, e2) / m.mpf(angle) - 1) < 1e-19
        corners = [(0.25 + s * size, 0.125 + t * size, 1.0) for s, t in ((0, 0), (1, 0), (1, 1), (0, 1))]
        assert abs(lambert(corners, m.mpf, m) / m.mpf(irradiance) - 1) < 1e-19
    near = 2 * m.pi - rectangle_solid_angle((-1.0, -1.0, 2.0**-30), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    assert relative(float(near), m.mpf("5.2683560638617540e-9")) < 1e-16
    edge_on = rectangle_solid_angle((-1.0, 1.0, 2.0**-20), (2.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    assert abs(edge_on / m.mpf("5.6491770481679206e-7") - 1) < 1e-15
