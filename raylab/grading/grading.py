"""Grading: one submission, from its files to its results.json.

    grade(assignment, Path("submission"), Path("results/results.json"), secret=b"...")

The file is there, and valid, from the first moment on; every property that is judged replaces it. What the submission
does costs points, what the grader does costs none. Nothing that a student's process says while it knows hidden data
is shown: neither what it prints nor the text of its exceptions.
"""

from __future__ import annotations

import hashlib
import hmac
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from raylab import __version__
from raylab.grading import hidden, results
from raylab.grading.diagnosis import diagnose
from raylab.grading.faults import Fault, GraderFault
from raylab.grading.intake import collect
from raylab.grading.judge import Judge
from raylab.grading.report import as_dict
from raylab.grading.results import Results, Test
from raylab.grading.session import Limits, Session
from raylab.grading.table import Table, path_of

MakeJudge = Callable[[Any, Session, int], Any]
NO_FUNCTION = ("error", "unfinished")  # kinds of findings after which a task has no function
WAITING = "The grader did not get to this test."


@dataclass
class Grading:
    """What was found out about one submission."""

    results: Results
    source: bytes = b""
    findings: list[dict[str, Any]] = field(default_factory=list)
    judged: list[Any] = field(default_factory=list)
    isolation: dict[str, Any] = field(default_factory=dict)
    entropy: int = 0
    staff: list[str] = field(default_factory=list)  # for the staff: the report of pytest, tracebacks
    printed: list[str] = field(default_factory=list)  # by the submission, which may have printed what is hidden


def grade(
    assignment: Any,
    submission: Path,
    where: Path,
    *,
    secret: bytes,
    metadata: Path | None = None,
    limits: Limits | None = None,
    library: Path | None = None,
    make_judge: MakeJudge | None = None,
    ladder: Path | None = None,
) -> Grading:
    """Grade, and leave the results in `where`; raises nothing but what the machine does to the file itself."""
    start = time.monotonic()
    previous = results.previous_results(metadata) if metadata else {}
    results.write(results.provisional(previous), where)
    tests = [
        Test(str(i + 1), own.id, None, own.points, WAITING, getattr(own, "visibility", "visible"))
        for i, own in enumerate(assignment.properties)
    ]
    grading = Grading(Results(tests, previous=previous))

    def save() -> None:
        grading.results.execution_time = time.monotonic() - start
        grading.results.extra_data |= _record(grading, assignment, secret)
        results.write(grading.results, where)

    try:
        _grade(grading, assignment, submission, secret, limits, library, make_judge or Judge, ladder, save)
    except Exception as error:
        grading.results.not_graded = (
            "Your submission could not be graded. This is not your fault; the staff can see it."
        )
        grading.staff.append(str(error) if isinstance(error, GraderFault) else traceback.format_exc())
    save()
    return grading


def _grade(
    grading: Grading, assignment: Any, submission: Path, secret: bytes, limits: Limits | None, library: Path | None,
    make_judge: MakeJudge, ladder: Path | None, save: Callable[[], None],
) -> None:  # fmt: skip
    taken = collect(submission, (assignment.file,))
    if taken.problems:
        _refuse(grading, "\n".join(taken.problems))
        return
    grading.source = taken.files[assignment.file]
    grading.entropy = entropy(secret, assignment.id, grading.source)
    with Session(limits, library, ladder=ladder) as session:
        try:
            grading.findings = session.load(grading.source, assignment.tasks)
        except Fault as fault:
            _refuse(grading, fault.sentence)
            return
        finally:
            grading.isolation = session.isolation
        grading.results.output = told(grading.findings)
        fatal = {finding["task"] or "" for finding in grading.findings if finding["kind"] in NO_FUNCTION}
        without = set(session.tasks) if "" in fatal else fatal
        judge = make_judge(assignment, session, grading.entropy)

        def judged(test: Test, own: Any) -> str:
            try:
                return _judge_one(grading, test, own, judge, own.task in without)
            finally:
                save()

        pairs = zip(grading.results.tests, assignment.properties, strict=True)
        grading.staff.append(hidden.run({own.id: partial(judged, test, own) for test, own in pairs}))
        grading.results.extra_data["token"] = getattr(judge, "token", "")
        grading.results.leaderboard = getattr(judge, "leaderboard", list)()
        _name_causes(grading, assignment, session)
        grading.printed.append(session.output)


def _judge_one(grading: Grading, test: Test, own: Any, judge: Any, without: bool) -> str:
    """Fill in one line of the rubric; what is wrong, if anything. Raises what the grader itself gets wrong."""
    if without:
        test.score, test.output = 0.0, "There is no function to test yet; see above."
        test.extra_data = {"outcome": "NOT ATTEMPTED"}
        return test.output
    test.output = ""
    try:
        judged = judge.judge(own)
    except Fault as fault:
        test.score, test.output = 0.0, f"{own.says}\nWhen it was called, {fault.sentence}."
        test.extra_data = {"outcome": "FAIL", "cause": fault.cause}
        grading.printed.append(f"{own.id}: {fault.cause}: {fault.detail}")
        return test.output
    grading.judged.append(judged)
    test.score = judged.score
    test.output = "\n".join(text for text in (own.says, judged.seen) if text)
    test.extra_data = {key: value for key, value in vars(judged).items() if key not in ("says", "score", "points")}
    return test.output if test.status == "failed" else ""


def _name_causes(grading: Grading, assignment: Any, session: Session) -> None:
    """For each task with something wrong, what the mistake may be: a hint for the student, all of it for the staff."""
    wrong = [judged.task for judged in grading.judged if judged.outcome == "FAIL"]
    named: dict[str, Any] = {}
    for task in dict.fromkeys(wrong):
        path = path_of(assignment.folder, task)
        if not path.is_file():
            continue
        try:
            found = diagnose(Table.read(path), session, task)
        except Fault:
            continue
        named[task] = as_dict(found)
        if found:
            grading.results.output = f"{grading.results.output}\n\n{task}: {found[0].hint(1)}".strip()
    grading.results.extra_data["causes"] = named


def _refuse(grading: Grading, why: str) -> None:
    """No points, and why."""
    grading.results.output = why
    for test in grading.results.tests:
        test.score, test.output = 0.0, "There is no function to test; see above."


def entropy(secret: bytes, assignment: str, source: bytes) -> int:
    """The seed of all random numbers of a grading, 128 bits: the same submission always gets the same ones, and no one
    who has not the secret can tell which. HMAC-SHA256."""
    return int.from_bytes(hmac.digest(secret, assignment.encode() + b"\0" + source, "sha256")[:16], "little")


def commitment(secret: bytes) -> str:
    """What is published before the deadline, so that the secret can be checked when it is published afterwards."""
    return hashlib.sha256(secret).hexdigest()


def told(findings: Sequence[Mapping[str, Any]]) -> str:
    """Findings as text: each with its line of the submission."""
    parts = []
    for finding in findings:
        line = f"Line {finding['line']}: " if finding.get("line") else ""
        code = f"\n    {finding['text']}" if finding.get("text") else ""
        advice = f"\n  {finding['advice']}" if finding.get("advice") else ""
        parts.append(f"{finding['task'] or ''}\n  {line}{finding['sentence'] or ''}{code}{advice}".strip())
    return "\n\n".join(parts)


def _record(grading: Grading, assignment: Any, secret: bytes) -> dict[str, Any]:
    """For `extra_data`: what a regrading and a reader of the grade need to know."""
    return {
        "raylab": __version__, "assignment": assignment.id, "source": hashlib.sha256(grading.source).hexdigest(),
        "commitment": commitment(secret), "isolation": grading.isolation,
    }  # fmt: skip
