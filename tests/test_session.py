"""A submission in its jail: numbers come back, everything else is a sentence, and nothing is left over."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from raylab.grading.faults import Fault
from raylab.grading.process import relatives
from raylab.grading.session import Limits, Session, probe

NAKED = Path(__file__).parent / "hostile" / "naked.py"
SUM = {"id": "sum", "function": "f", "kind": "map", "gives": ["vector"]}
GOOD = b"def f(a, b):\n    return a + b, a - b, a * b\n"


@pytest.fixture(scope="module")
def session():
    with Session(Limits(cpu=3.0, wall=6.0), ladder=NAKED) as session:
        yield session


def test_numbers_go_in_and_numbers_come_out(session):
    assert session.load(GOOD, [SUM]) == []
    rows = np.random.default_rng(1).normal(size=(100, 2))
    a, b = rows.T
    np.testing.assert_array_equal(session.map("sum", rows), np.stack([a + b, a - b, a * b], 1))


def test_the_jail_is_recorded(session):
    session.load(GOOD, [SUM])
    assert session.isolation["limits"]
    assert session.isolation["open"] == []


def test_what_is_printed_is_kept_in_part(session):
    session.load(b"print('x' * 10_000_000)\nprint('last')\n" + GOOD, [SUM])
    assert len(session.output) < 200_000
    assert session.output.endswith("last\n")


def test_a_worker_that_dies_is_replaced(session):
    session.load(b"import os\ndef f(a, b):\n    return [a, b, 0] if a else os._exit(0)\n", [SUM])
    workers = session.workers
    with pytest.raises(Fault, match="ended its process") as caught:
        session.map("sum", [[0.0, 1.0]])
    assert (caught.value.cause, caught.value.task) == ("crash", "sum")
    np.testing.assert_array_equal(session.map("sum", [[2.0, 1.0]]), [[2.0, 1.0, 0.0]])
    assert session.workers == workers + 1


def test_after_two_deaths_a_task_is_not_asked_again():
    with Session(Limits(cpu=3.0, wall=6.0), ladder=NAKED) as session:
        session.load(b"import os\ndef f(a, b):\n    os._exit(0)\n", [SUM])
        for expected in ("crash", "crash", "given up"):
            with pytest.raises(Fault) as caught:
                session.map("sum", [[0.0, 1.0]])
            assert caught.value.cause == expected


def test_one_task_that_kills_leaves_the_others():
    hang = {"id": "hang", "function": "g", "kind": "map"}
    with Session(Limits(cpu=3.0, wall=6.0), ladder=NAKED.with_name("picky.py"), read=[NAKED]) as session:
        findings = session.load(GOOD, [SUM, hang])
        assert [(finding["stage"], finding["task"]) for finding in findings] == [("run", "hang")]
        np.testing.assert_array_equal(session.map("sum", [[2.0, 1.0]]), [[3.0, 1.0, 2.0]])


def test_what_the_machine_allows_can_be_asked():
    found = probe()
    assert found["limits"]
    assert found["shut"] == (found["seccomp"] and bool(found["landlock"] or found["user"] == "own"))


def test_nothing_is_left_of_a_session():
    with Session(ladder=NAKED) as session:
        session.load(GOOD, [SUM])
        process, user, folder = session._process.popen.pid, session.user, Path(session._folder.name)
        assert relatives(process, user) == [process]
    assert relatives(process, user) == []
    assert not folder.exists()


FORGE = """
import os, struct, sys
frame = sys._getframe()
while "replies" not in frame.f_locals:
    frame = frame.f_back
replies, number = frame.f_locals["replies"], frame.f_locals["number"]
def send(payload, number=number, kind=1, length=None, magic=b"rayl", times=1):
    length = len(payload) if length is None else length
    os.write(replies, (struct.pack("<4sQQB", magic, number, length, kind) + payload) * times)
"""


@pytest.mark.parametrize(
    "said",
    [
        "send(b'7')", "send(b'[1, 2]')", "send(b'{}')", "send(b'[')", "send(b'[' * 100_000)", "send(b'[]', kind=9)",
        "send(b'x' * 8, kind=2)", "send(b'[]', number=number + 1)", "send(b'[]', length=1 << 63)",
        "send(b'[]', magic=b'rayk')", "send(b'[]', times=2)", "os.write(replies, b'x' * 1000)",
    ],
)  # fmt: skip
def test_forged_words_are_refused(session, said):
    with pytest.raises(Fault) as caught:
        session.load(f"{FORGE}{said}\nos.kill(os.getpid(), 19)\n".encode() + GOOD, [SUM])
    assert caught.value.cause == "protocol"


def test_numbers_of_another_size_are_refused(session):
    session.load(b"def f(a, b):\n    return a, b\n", [SUM])
    with pytest.raises(Fault, match="returned"):
        session.map("sum", [[0.0, 1.0]])
