"""A class: several submissions graded, again, after a change; a wheel without solutions."""

from __future__ import annotations

import csv
import json
import re
import zipfile

import manners
import pytest

from raylab.errors import UserError
from raylab.grading import course
from raylab.grading.assignment import NAMES, load
from raylab.grading.copies import likeness
from raylab.grading.course_wheel import leaking, stage, without
from raylab.grading.stub import solutions, student_file

SOLVED = solutions()
CERTIFY = pytest.mark.certify
WHEELS = [["a1", "a3"], ["a7"], *(pytest.param(names, marks=CERTIFY) for names in (["a2"], ["a5"], ["a4", "a6"]))]


def fake(assignment, entry, secret, library=None, trust=False):
    """Instead of a grading: results as they would be, from the length of the file."""
    entry.folder.mkdir(parents=True, exist_ok=True)
    good = len(entry.path.read_bytes()) % 2 == 0
    tests = [
        {"name": p.id, "score": p.points if good else 0.0, "max_score": p.points, "output": "<b>", "extra_data": {}}
        for p in assignment.properties
    ]
    causes = {} if good else {assignment.tasks[0].id: [{"cause": "black", "hints": ["a", "b", "c < d"]}]}
    result = {"tests": tests, "extra_data": {"status": "graded", "causes": causes}}
    (entry.folder / "results.json").write_text(json.dumps(result))
    staff = {
        "stamp": course.stamp(entry, secret, assignment),
        "seconds": 1.5,
        "likeness": {assignment.tasks[0].id: 0.95},
    }
    (entry.folder / "staff.json").write_text(json.dumps(staff))


def test_a_class_is_graded_once_and_changes_are_shown(tmp_path, monkeypatch):
    graded = []
    monkeypatch.setattr(course, "grade_one", lambda a, e, *more: (graded.append(e.name), fake(a, e, *more)))
    handed_in, out, said = tmp_path / "in", tmp_path / "out", []
    handed_in.mkdir()
    (handed_in / "ann.py").write_text("xx")
    (handed_in / "bob.py").write_text("xxx")
    course.grade_all(load("a1"), [handed_in], out, 2, said.append)
    assert sorted(graded) == ["ann", "bob"]
    rows = list(csv.DictReader((out / "gradebook.csv").read_text().splitlines()))
    assert [(r["name"], r["score"], r["causes"]) for r in rows] == [
        ("ann", "20", ""),
        ("bob", "0.0", "a1.diffuse: black"),
    ]
    page = (out / "dashboard.html").read_text()
    assert "c &lt; d" in page
    assert "<b>" not in page.split("<h2>Submissions")[1].replace("<b>20</b>", "").replace("<b>0</b>", "")
    assert (out / "secret").stat().st_mode & 0o077 == 0
    course.grade_all(load("a1"), [handed_in], out, 1, said.append)
    assert len(graded) == 2  # nothing is graded again
    (handed_in / "ann.py").write_text("xxxxx")
    course.grade_all(load("a1"), [handed_in], out, 1, said.append)
    assert graded[2:] == ["ann"]
    changes = list(csv.DictReader((out / "changes.csv").read_text().splitlines()))
    assert [(r["name"], r["before"], r["now"]) for r in changes] == [("ann", "20", "0.0")]
    assert "1 scores have changed, 1 of them to less" in said[-1]


def test_nobody_is_graded_where_the_jail_stays_open(tmp_path, monkeypatch):
    graded = []
    monkeypatch.setattr(course, "grade_one", lambda a, e, *more: (graded.append(e.name), fake(a, e, *more)))
    monkeypatch.setattr("raylab.grading.session.probe", lambda: {"shut": False, "seccomp": False})
    (tmp_path / "ann.py").write_text("xx")
    with pytest.raises(UserError, match=r'cannot shut a jail .*"seccomp": false'):
        course.grade_all(load("a1"), [tmp_path / "ann.py"], tmp_path / "out", 1, print)
    assert graded == []
    course.grade_all(load("a1"), [tmp_path / "ann.py"], tmp_path / "out", 1, print, trust=True)
    assert graded == ["ann"]


def test_submissions_are_found_and_named(tmp_path):
    for name in ("x/ann/shade.py", "x/bob/shade.py", "y/ann/shade.py"):
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_text("1")
    names = [e.name for e in course.entries([tmp_path / "x", tmp_path / "y" / "ann"], tmp_path)]
    assert names == ["x-ann", "bob", "y-ann"]
    with pytest.raises(UserError, match="there is no submission"):
        course.entries([tmp_path / "z"], tmp_path)


def test_a_copy_is_seen_and_a_stub_is_not():
    own = load("a1")
    solution = SOLVED["a1.diffuse"].text
    assert likeness(solution.encode(), own) == {"a1.diffuse": 1.0}
    assert (
        likeness(solution.replace("  ", "   ").replace("L =", "L   =  # direction\n").encode(), own)["a1.diffuse"] > 0.7
    )
    assert likeness(student_file(own).encode(), own)["a1.diffuse"] < 0.2


@pytest.mark.parametrize("names", WHEELS, ids=lambda names: "-".join(names))
def test_no_solution_is_in_what_a_course_wheel_is_made_of(tmp_path, names):
    own = [load(name) for name in names]
    changed = stage(own, tmp_path)
    solved = [SOLVED[task.id] for a in own for task in a.tasks]
    assert leaking(tmp_path.rglob("*"), solved) == []
    for solution in solved:
        assert solution.name in changed[f"{solution.module}.py"]
    for name in names:
        folder = tmp_path / "raylab" / "assignments" / name
        assert {"handout.md", "stub.py", "assignment.toml"} <= {p.name for p in folder.iterdir()}
    for path in tmp_path.rglob("*.py"):
        compile(path.read_text(), path.name, "exec")


def test_a_wheel_without_what_another_assignment_needs_is_refused(tmp_path):
    with pytest.raises(UserError, match=r"a4 needs sampling:sample_phong_lobe, which a5.lobe asks for"):
        stage([load("a4"), load("a5")], tmp_path)


def test_functions_that_hold_the_same_lines_become_stubs_as_well():
    text = (course.Path(course.__file__).parents[1] / "shade.py").read_text()
    changed, names = without(text, [SOLVED["a1.diffuse"]], "shade", "why")
    assert {"area_diffuse", "area", "area_solid_angle"} <= set(names)
    assert "env_cosine" not in names
    assert '"""Slide "Area source by Monte Carlo (diffuse)".' in changed


@pytest.mark.certify
@pytest.mark.parametrize("name", NAMES)
def test_a_right_answer_gets_all_points_and_a_stub_none(name, tmp_path):
    """Through `raylab grade`: files in, jail, judge, gradebook."""
    own = load(name)
    (tmp_path / "stub.py").write_text(student_file(own))
    (tmp_path / "right.py").write_text(handed_in(own))
    course.grade_all(own, [tmp_path / "right.py", tmp_path / "stub.py"], tmp_path / "out", 2, print)
    rows = list(csv.DictReader((tmp_path / "out" / "gradebook.csv").read_text().splitlines()))
    assert [(r["name"], r["status"], float(r["score"])) for r in rows] == [
        ("right", "graded", own.points),
        ("stub", "graded", 0.0),
    ]


def handed_in(assignment):
    """A right answer to all tasks, out of one file of tests/submissions, under the names that are asked for."""
    rights = next(rights for rights in manners.of_assignment(assignment.id) if len({r.file for r in rights}) == 1)
    text = rights[0].text
    for right in rights:
        asked = assignment.task(right.task).function
        text = re.sub(rf"\b{right.name}\b", asked, re.sub(rf"\b{asked}\b", f"{asked}_of_the_lecture", text))
        text = text.replace(f"{asked}_of_the_lecture,", f"{asked} as {asked}_of_the_lecture,")
    return text


@pytest.mark.certify
def test_a_course_wheel_is_built(tmp_path):
    """Needs setuptools 77 or later."""
    from raylab.grading.course_wheel import build

    with zipfile.ZipFile(build([load("a1"), load("a3")], tmp_path)) as wheel:
        names = wheel.namelist()
        assert "raylab/assignments/a1/stub.py" in names
        assert "raylab/assignments/a3/variants/a3.cosine.npz" in names
        assert not any("variants.py" in name or "commands_staff" in name for name in names)
        for name in names:
            if name.endswith(".py"):
                wheel.extract(name, tmp_path / "x")
    assert leaking((tmp_path / "x").rglob("*.py"), [SOLVED["a1.diffuse"], SOLVED["a3.cosine"]]) == []
