"""Check: the same properties on the student's own machine, in this process, with what there is to say said at once."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from raylab.errors import UserError
from raylab.grading import report
from raylab.grading.assignment import Assignment, Property
from raylab.grading.diagnosis import diagnose
from raylab.grading.evidence import Diagnosis, ranked
from raylab.grading.intake import collect
from raylab.grading.judge import Judge
from raylab.grading.judged import Judged, refused
from raylab.grading.paired import by_samples
from raylab.grading.raised import Raised, Watched
from raylab.grading.source import Interpreted, Source
from raylab.grading.table import Table, path_of
from raylab.submission.finding import Finding
from raylab.submission.ladder import Climb, climb
from raylab.submission.shape import ENTRY, check_shape
from raylab.submission.source import read
from raylab.submission.task import Task

Say = Callable[[str], None]


def source_of(path: Path, assignment: Assignment) -> bytes:
    """The bytes of the student's file, or of the one in a folder; UserError with a sentence."""
    taken = collect(path, (path.name if path.is_file() else assignment.file,))
    if taken.problems:
        raise UserError("; ".join(taken.problems))
    return next(iter(taken.files.values()))


def in_python(source: bytes, task: Task, silent: bool = False) -> Any:
    """The student's function, to be called in plain Python; a `silent` one does not print."""
    parsed = read(source)
    return parsed.namespace(check_shape(parsed, task)[0], silent)[ENTRY]


def table_of(assignment: Assignment, task: str) -> Table | None:
    path = path_of(assignment.folder, task)
    return Table.read(path) if path.is_file() else None


def at_once(assignment: Assignment, source: bytes, task: Task) -> tuple[list[Diagnosis], str]:
    """What the first samples say in plain Python, and a token for the first one that is not the reference's."""
    table = table_of(assignment, task.id)
    if table is None:
        return [], ""
    values = table.paired(Interpreted({task.id: in_python(source, task, silent=True)}, {task.id: task}), task.id)
    found = ranked(by_samples(table, values))
    return found, first_different(table, values, task.id) if found and task.kind == "shade" else ""


def by_distribution(assignment: Assignment, source: Source, task: str) -> list[Diagnosis]:
    """What may be wrong with a task that has failed, however it uses its random numbers."""
    table = table_of(assignment, task)
    with suppress(Raised):
        return diagnose(table, source, task) if table else []
    return []


def first_different(table: Table, values: Any, task: str) -> str:
    """The token of the first sample that differs from the reference's, for `raylab replay`."""
    import numpy as np

    with np.errstate(all="ignore"):
        off = ~(np.abs(values - table.samples[0]) <= 1e-3 * np.abs(table.samples[0]) + 1e-12).all(axis=2)
    if not off.any():
        return ""
    trial, number = np.argwhere(off)[0]
    return f"{task}:{trial}:{number}"


def verdict(judge: Judge, own: Property, climbed: Climb) -> Judged:
    """One property; an ERROR is no FAIL, and neither is what nobody has written. May raise Raised."""
    if own.task in climbed.functions:
        return judge.judge(own)
    errors = [f for f in climbed.of(own.task) if f.kind == "error"]
    return refused(own, "ERROR", where(errors[0])) if errors else refused(own)


def where(finding: Finding) -> str:
    """In one line; all of it has been said."""
    return f"line {finding.line}: {finding.sentence}" if finding.line else finding.sentence


def sample_of(error: Raised, assignment: Assignment, path: Path) -> str:
    """How to look at the sample that raises."""
    trials = assignment.diagnosis[error.finding.task]
    if error.trial not in trials:
        return "It does so for some inputs only."
    token = ":".join(map(str, (error.finding.task, trials.index(error.trial), *error.numbers)))
    return f"Not in every sample; this is one: raylab replay {token} {path}"


def check(assignment: Assignment, path: Path, say: Say, hint: int = 1, entropy: int | None = None) -> list[Judged]:
    """Say what there is to say; the verdicts."""
    source, tasks = source_of(path, assignment), assignment.tasks
    early = climb(source, tasks, until="interpret")
    for finding in early.findings:
        say(str(finding))
    stopped = {f.task for f in early.findings if f.fatal}
    running = [task for task in tasks if task.id not in stopped and "" not in stopped]
    named: dict[str, list[str]] = {}
    for task in running:
        found, token = at_once(assignment, source, task)
        named[task.id] = report.causes(found, hint)
        for sentence in named[task.id]:
            say(f"{task.id}: {sentence}")
        if token:
            say(f"    A sample to look at: raylab replay {token} {path}")
    if running:
        say(f"{', '.join(t.id for t in running)}: runs in plain Python; now it is compiled and judged ...")
    climbed = climb(source, running, tell=lambda f: say(str(f)) if f.stage in ("compile", "cross-check") else None)
    climbed.findings[:0] = early.findings
    watched = Watched(climbed.functions, source, tasks)
    judge = Judge(assignment, watched, entropy)
    judged, raised = [], set[str]()
    for own in assignment.properties:
        try:
            judged.append(verdict(judge, own, climbed))
        except Raised as error:
            judged.append(refused(own, "ERROR", where(error.finding)))
            if (text := str(error.finding)) not in raised:
                raised.add(text)
                say(f"{text}\n    {sample_of(error, assignment, path)}")
    for name in dict.fromkeys(j.task for j in judged if j.outcome == "FAIL" and not named[j.task]):
        for sentence in report.causes(by_distribution(assignment, watched, name), hint):
            say(f"{name}: {sentence}")
    say("")
    say(report.verdicts(judged))
    score, points = report.total(judged)
    say(f"\n{score:g} of {points:g} points, by the properties that are graded; the grader draws other random numbers.")
    for name, value, _ in judge.leaderboard():
        say(f"{name} = {value:g}: that of one sample, relative to the slide's technique; less is better.")
    if hint < 3 and any(j.outcome == "FAIL" for j in judged):
        say(f"More is said by: raylab check {assignment.id} {path} --hint {hint + 1}")
    return judged
