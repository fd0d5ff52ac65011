"""Right answers, however they are written: the ladder is silent, they get full points, and nobody accuses them.

A right answer is failed with probability at most 1e-6 (`raylab.grading.judge`); there are fewer than a hundred.
"""

from __future__ import annotations

from collections import defaultdict

import manners
import pytest

from raylab.grading.assignment import NAMES, load
from raylab.grading.diagnosis import diagnose
from raylab.grading.judge import Judge
from raylab.grading.source import InProcess
from raylab.grading.table import Table, path_of
from raylab.submission.ladder import climb

MANNERS = [(name, rights) for name in NAMES for rights in manners.of_assignment(name)]
ONE = [next((n, rights) for n, rights in MANNERS[5:] if n == name) for name in NAMES]


def climbed(rights, until):
    """The functions of a submission, whose answers may stand in several files, and what is said of them but notes."""
    files = defaultdict(list)
    for right in rights:
        files[right.file].append(right)
    functions, said = {}, []
    for own in files.values():
        found = climb(own[0].text.encode(), [right.asked for right in own], until=until)
        said += [str(f) for f in found.findings if f.kind != "note"]
        functions |= found.functions
    return functions, said


def named(case):
    return "-".join([case[0], *dict.fromkeys(right.name for right in case[1])])


@pytest.mark.parametrize("case", ONE, ids=named)
def test_a_right_answer_climbs_in_plain_python(case):
    _, said = climbed(case[1], "interpret")
    assert said == []


@pytest.mark.certify
@pytest.mark.parametrize("case", MANNERS, ids=named)
def test_a_right_answer_gets_full_points(case):
    assignment = load(case[0])
    functions, said = climbed(case[1], "cross-check")
    assert said == []
    source = InProcess(functions)
    judge = Judge(assignment, source)
    judged = [judge.judge(own) for own in assignment.properties]
    score, decided = sum(j.score for j in judged), sum(j.outcome == "PASS" for j in judged)
    print(f"{named(case)}: {score:g} of {assignment.points:g} points, {decided} of {len(judged)} properties decided")
    assert score == assignment.points, [(j.task, j.name, j.seen) for j in judged if j.score < j.points]
    for task in assignment.tasks:
        table = Table.read(path_of(assignment.folder, task.id))
        assert [d.cause for d in diagnose(table, source, task.id)] == [], task.id
