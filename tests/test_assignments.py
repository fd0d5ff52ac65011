"""Assignments: what students get, what stays with the staff, and what is said of right and wrong submissions."""

from __future__ import annotations

import ast
import itertools

import pytest

from raylab.errors import UserError
from raylab.grading import report
from raylab.grading.assignment import NAMES, load, root
from raylab.grading.begin import begin, stub_of
from raylab.grading.causes import CAUSES
from raylab.grading.paired import agree
from raylab.grading.source import Interpreted
from raylab.grading.stub import function_stub, leaks, solutions, telling
from raylab.grading.table import Table, path_of
from raylab.grading.variant import alive, edited
from raylab.grading.variants import VARIANTS, fingerprint
from raylab.submission.ladder import climb

PRESENT = [name for name in NAMES if (root() / name / "assignment.toml").is_file()]
TASKS = [(name, task) for name in PRESENT for task in load(name).tasks]
SOLVED = solutions()


@pytest.mark.parametrize("name", PRESENT)
def test_nothing_of_a_solution_is_in_what_students_get(name, tmp_path):
    assignment = load(name)
    secrets = [SOLVED[task.id] for task in assignment.tasks]
    for path in begin(assignment, tmp_path / name):
        if path.suffix in (".py", ".md", ".xml"):
            assert leaks(path.read_text(), SOLVED.values()) == [], path.name
    assert all(len(telling(s.node)) >= 1 for s in secrets)


@pytest.mark.parametrize(("name", "task"), TASKS, ids=lambda v: getattr(v, "id", v))
def test_the_leak_check_sees_a_leak(name, task):
    solution = SOLVED[task.id]
    assert leaks(solution.text, [solution])
    secret = sorted(telling(solution.node), key=len)[-1].splitlines()[0]
    assert leaks(f"# notes\n\n> {secret}\n{secret} (no program)\n{secret}\n", [solution])


@pytest.mark.parametrize("name", PRESENT)
def test_a_stub_is_not_attempted(name):
    assignment = load(name)
    found = climb(stub_of(assignment).encode(), assignment.tasks)
    assert found.functions == {}
    assert {f.task for f in found.findings if f.kind == "unfinished"} == {t.id for t in assignment.tasks}


@pytest.mark.parametrize("name", PRESENT)
def test_task_ids_are_the_same_everywhere(name):
    assignment = load(name)
    ids = {task.id for task in assignment.tasks}
    assert {p.task for p in assignment.properties} == ids == set(assignment.solutions)
    handout, stub = (assignment.folder / "handout.md").read_text(), stub_of(assignment)
    for task in assignment.tasks:
        solution = SOLVED[task.id]
        assert assignment.solutions[task.id] == f"{solution.module}:{solution.name}"
        assert f"task {task.id}" in stub
        assert f"`{task.id}`" in handout
        assert tuple(a.arg for a in solution.node.args.args)[: len(task.arguments)] == task.arguments
        assert ast.parse(function_stub(task, solution.doc))


@pytest.mark.parametrize("name", PRESENT)
def test_the_handout_shows_the_rubric(name):
    assignment = load(name)
    text = (assignment.folder / "handout.md").read_text()
    assert report.rubric(assignment) in text
    assert f"{assignment.points:g} points" in text
    assert (assignment.folder / "goal.png").is_file()
    for scene in assignment.scenes.values():
        assert (assignment.folder / scene).is_file()


@pytest.mark.parametrize("task", sorted(VARIANTS))
def test_variants_fit_the_solution_and_have_causes(task):
    for variant in VARIANTS[task]:
        assert edited(SOLVED[task].text, variant) != SOLVED[task].text
        assert variant.cause in CAUSES
        assert all(CAUSES[variant.cause].hints)


@pytest.mark.parametrize("task", sorted(VARIANTS))
def test_the_table_of_variants_is_up_to_date(task):
    """Made by `python -m raylab.grading.table TASK`; its first row is the reference, and no other row is."""
    assignment = load(task.partition(".")[0])
    table = Table.read(path_of(assignment.folder, task))
    assert table.fingerprint == fingerprint(SOLVED[task])
    assert table.causes[0] == "none"
    again = Interpreted({task: alive(SOLVED[task], SOLVED[task].text)}, {task: assignment.task(task)})
    assert agree(table.paired(again, task, 3), table.samples[0, :, :3])
    for cause, samples in zip(table.causes[1:], table.samples[1:], strict=True):
        assert not agree(samples, table.samples[0]), cause


@pytest.mark.parametrize("task", sorted(VARIANTS))
def test_no_two_causes_have_the_same_numbers(task):
    """Else neither could be named."""
    table = Table.read(path_of(load(task.partition(".")[0]).folder, task))
    rows = list(zip(table.causes, table.samples, strict=True))
    alike = {(a, b) for (a, x), (b, y) in itertools.combinations(rows, 2) if a != b and agree(x, y)}
    assert not alike


def test_bad_names_and_folders_are_refused(tmp_path):
    with pytest.raises(UserError, match="unknown assignment 'a9'"):
        load("a9")
    (tmp_path / "file").write_text("my work")
    with pytest.raises(UserError, match="is not empty"):
        begin(load("a1"), tmp_path)
