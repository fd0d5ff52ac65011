"""Hostile and broken submissions: whatever is handed in, the results are valid, no score is above the honest one,
nothing hidden gets out, nothing is left running, and there is an end.

Each is graded twice: once with nothing but the jail in its way, once behind the ladder of `raylab.submission`.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import pytest
from hostile import files, numba, python
from hostile.case import ONLY_SQUARE
from hostile.toy import ASSIGNMENT, FULL, HONEST, WRONG, Judge

from raylab.grading import process, session
from raylab.grading.grading import grade
from raylab.grading.jail import readable
from raylab.grading.process import relatives
from raylab.grading.results import points, problems
from raylab.grading.session import Limits

NAKED = Path(__file__).parent / "hostile" / "naked.py"
MARKER = "HIDDEN-MARKER-5ae1"
LIMITS = Limits(cpu=20.0, wall=60.0, total=120.0)
SHORT = {"naked": Limits(cpu=0.5, wall=1.5, total=60.0), "ladder": Limits(cpu=3.0, wall=30.0, total=60.0)}
LONGEST = 60.0  # s
COMPILED = {45, 50, 51, 53, 60}  # also behind the ladder; the others there are for `make certify`
CASES = [
    pytest.param(
        case,
        wall,
        id=f"{case.id}, {wall}",
        marks=[] if wall == "naked" or case.number in COMPILED else [pytest.mark.certify],
    )
    for case in (*files.CASES, *python.CASES, *numba.CASES)
    for wall in case.walls
]


@pytest.fixture
def place(tmp_path):
    """Folders as on Gradescope, with things in them that nobody may see."""
    for folder in ("submission", "source", "results"):
        (tmp_path / folder).mkdir(mode=0o700)
    (tmp_path / "source" / "expected.npz").write_text(MARKER)
    (tmp_path / "submission_metadata.json").write_text(json.dumps({"email": MARKER, "previous_submissions": []}))
    return tmp_path


@pytest.fixture
def workers(monkeypatch):
    """The processes that are started, with their users."""
    started = []

    class Watched(process.Process):
        def __init__(self, *arguments):
            super().__init__(*arguments)
            started.append((self.popen.pid, self.user))

    monkeypatch.setattr(session, "Process", Watched)
    yield started
    left = [pid for worker, user in started for pid in relatives(worker, user)]
    assert left == []


class Seconds:
    """Seconds that have passed for a program that was running: a machine that stops everything stops this too."""

    def __enter__(self):
        self.clock, self.done = process.Clock(), threading.Event()
        self.thread = threading.Thread(target=self._run)
        self.thread.start()
        return self

    def _run(self):
        while not self.done.wait(0.1):
            self.clock.tick()

    def __exit__(self, *_):
        self.done.set()
        self.thread.join()
        self.passed = self.clock.tick()


def graded(place, wall="naked", limits=LIMITS, **more):
    where = place / "results" / "results.json"
    with Seconds() as seconds:
        grading = grade(
            ASSIGNMENT, place / "submission", where, secret=MARKER.encode(), limits=limits,
            metadata=place / "submission_metadata.json", ladder=NAKED if wall == "naked" else None,
            **{"make_judge": Judge, **more},
        )  # fmt: skip
    assert seconds.passed < LONGEST
    return grading, json.loads(where.read_text(), parse_constant=lambda name: pytest.fail(f"{name} in the results"))


def secrets(grading):
    """Everything that must not be told."""
    asked = Judge(ASSIGNMENT, None, grading.entropy)
    return [MARKER, MARKER.encode().hex(), *(f"{number:.6f}" for number in asked.u.ravel())]


@pytest.mark.parametrize(("case", "wall"), CASES)
@pytest.mark.usefixtures("workers")
def test_hostile(case, wall, place, monkeypatch):
    monkeypatch.setenv("RAYLAB_SECRET", MARKER)
    case.make(place / "submission")
    grading, words = graded(place, wall, SHORT[wall] if case.slow else LIMITS)
    text = json.dumps(words)
    assert problems(words) == []
    assert words["extra_data"]["status"] == "graded", grading.staff
    assert not [secret for secret in secrets(grading) if secret in text]
    assert not any(MARKER in said for said in (*grading.staff, *grading.printed))
    assert [path.name for path in (place / "results").iterdir()] == ["results.json"]
    if wall == "naked":
        assert points(words) == case.score or (case.racing and points(words) < case.score), grading.staff
        assert case.says in text
    else:
        assert points(words) <= case.behind_the_ladder, text


@pytest.mark.parametrize("wall", ["naked", "ladder"])
@pytest.mark.parametrize(("text", "score"), [(HONEST, FULL), (WRONG, ONLY_SQUARE)], ids=["honest", "wrong"])
def test_what_the_corpus_is_measured_by(place, workers, wall, text, score):
    (place / "submission" / "shade.py").write_text(text)
    grading, words = graded(place, wall)
    assert points(words) == score, grading.staff
    assert len(workers) == 1
    assert words["extra_data"]["isolation"]["open"] == []


# --- 61 to 64: faults that are not the student's ---


class Broken(Judge):
    """The grader's own mistake in one property."""

    def judge(self, own):
        if own.name == "right" and own.task == "toy.warp":
            raise RuntimeError(f"the reference fails its own test: {MARKER}")
        return super().judge(own)


def test_61_a_test_that_raises_is_not_graded(place, workers):
    before = {"score": 7.0, "submission_time": "2026", "results": {"tests": [{"number": "1", "score": 4.0}]}}
    (place / "submission_metadata.json").write_text(json.dumps({"previous_submissions": [before]}))
    (place / "submission" / "shade.py").write_text(HONEST)
    _, words = graded(place, make_judge=Broken)
    assert [row["score"] for row in words["tests"]] == [4.0, 3.0, 2.0]
    assert [row["tags"] for row in words["tests"]] == [["not graded"], [], []]
    assert words["extra_data"]["status"] == "not graded"
    assert MARKER not in json.dumps(words)


def test_62_without_a_judge_every_test_is_listed_as_not_graded(place, workers):
    def missing(*_):
        raise FileNotFoundError("expected.npz")

    (place / "submission" / "shade.py").write_text(HONEST)
    grading, words = graded(place, make_judge=missing)
    assert problems(words) == []
    assert [row["tags"] for row in words["tests"]] == [["not graded"]] * 3
    assert "not your fault" in words["output"]
    assert "expected.npz" not in json.dumps(words)
    assert "FileNotFoundError" in grading.staff[-1]


def test_63_killed_in_the_middle_what_was_found_is_on_disk(place):
    (place / "submission" / "shade.py").write_text(HONEST)
    grader = os.fork()
    if grader == 0:

        class Slow(Judge):
            def judge(self, own):
                if own.task == "toy.square":
                    os.kill(os.getpid(), 9)
                return super().judge(own)

        graded(place, make_judge=Slow)
        os._exit(0)
    _, status = os.waitpid(grader, 0)
    assert os.WTERMSIG(status) == 9
    words = json.loads((place / "results" / "results.json").read_text())
    assert problems(words) == []
    assert [row["score"] for row in words["tests"]] == [5.0, 3.0, 0.0]
    assert words["extra_data"]["status"] == "not graded"


def test_64_a_machine_that_pauses_costs_no_points(place, workers):
    (place / "submission" / "shade.py").write_text(HONEST)
    stop = threading.Event()

    def hold():
        while not stop.is_set():
            for pid, _ in workers:
                for signal in (19, 18):
                    try:
                        os.kill(pid, signal)
                    except ProcessLookupError:
                        continue
                    time.sleep(0.08 if signal == 19 else 0.02)
            time.sleep(0.01)

    holder = threading.Thread(target=hold)
    holder.start()
    try:
        _, words = graded(place, limits=Limits(cpu=2.0, wall=60.0))
    finally:
        stop.set()
        holder.join()
    assert points(words) == FULL


# --- as an ordinary user ---

BY_MACHINE = "23 or 27 or 31 or 33 or 34 or 35"  # the attacks that the system must ward off
ORDINARY = 54321


@pytest.mark.parametrize(
    "which", [BY_MACHINE, pytest.param("naked or measured or session", marks=pytest.mark.certify)], ids=["some", "all"]
)
def test_as_an_ordinary_user(which):
    """The grader itself has no rights here: root becomes an ordinary user, and an ordinary user remains who he is.

    Where Python is in a folder of root's alone, that user may read it.
    """
    here, command, user = Path(__file__).parent, [], os.geteuid()
    if user == 0:
        user = ORDINARY
        command = ["setpriv", f"--reuid={user}", f"--regid={user}", "--clear-groups"]
        if not all(map(readable, (sys.executable, sys.base_prefix, str(here)))):
            command += ["--inh-caps=+dac_read_search", "--ambient-caps=+dac_read_search"]
    folder = Path(tempfile.mkdtemp(prefix="ordinary-"))
    os.chown(folder, user, -1)
    files = ["test_hostile.py", "test_session.py"]
    command += [
        sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "--basetemp", f"{folder}/t",
        "-k", f"({which}) and not ladder and not ordinary", *(str(here / name) for name in files),
    ]  # fmt: skip
    environment = {"PATH": os.environ["PATH"], "HOME": str(folder), "TMPDIR": str(folder)}
    environment |= {"PYTHONPATH": str(here.parent), "PYTHONDONTWRITEBYTECODE": "1"}
    ran = subprocess.run(command, env=environment, cwd=folder, capture_output=True, text=True)
    shutil.rmtree(folder)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert " passed" in ran.stdout
    assert os.geteuid() or relatives(-1, user) == []
