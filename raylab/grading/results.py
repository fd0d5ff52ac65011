"""Results: the results.json of Gradescope, whole and valid at every moment of a grading. Standard library only.

Source: gradescope-autograders.readthedocs.io/en/latest/specs. A first version says that the grading did not end; each
later one replaces it in one step. What cannot be graded keeps the score of the submission before.
"""

from __future__ import annotations

import json
import math
import os
import re
import tempfile
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

Status = Literal["passed", "failed", "not graded"]
Visibility = Literal["visible", "hidden", "after_due_date", "after_published"]
VISIBILITIES = ("visible", "hidden", "after_due_date", "after_published")
FORMATS = ("text", "html", "simple_format", "md", "ansi")
OUTPUT_LIMIT, TOTAL_LIMIT = 2048, 65536  # characters of a test's output, and of all of them
UNFINISHED = "The grader did not finish. This is not your fault: the staff can see it, and no points are lost by it."
ESCAPES = re.compile(r"\x1b(\[[0-?]*[ -/]*[@-~]|\][^\x07\x1b]*(\x07|\x1b\\)?|.)?", re.DOTALL)


@dataclass
class Test:
    """One line of the rubric. A score of None, or one that is no number, means that it could not be graded."""

    __test__ = False  # pytest looks at names

    number: str
    name: str
    score: float | None
    max_score: float
    output: str = ""
    visibility: Visibility = "visible"
    tags: list[str] = field(default_factory=list)
    extra_data: dict[str, Any] = field(default_factory=dict)

    @property
    def status(self) -> Status:
        if self.score is None or not math.isfinite(self.score):
            return "not graded"
        return "passed" if self.score >= self.max_score else "failed"


@dataclass
class Results:
    """A grading. `leaderboard` rows are (name, value, order "asc" or "desc")."""

    tests: list[Test] = field(default_factory=list)
    output: str = ""
    execution_time: float = 0.0
    extra_data: dict[str, Any] = field(default_factory=dict)
    leaderboard: list[tuple[str, float, str]] = field(default_factory=list)
    not_graded: str = ""  # why nothing could be graded
    previous: Mapping[str, Any] = field(default_factory=dict)  # the results of the submission before

    def as_json(self) -> dict[str, Any]:
        """As Gradescope wants it: every number finite, no score above its maximum, every text clean and short."""
        rest = TOTAL_LIMIT
        rows = []
        for test in self.tests:
            row = self._row(test, min(OUTPUT_LIMIT, rest))
            rest -= len(row["output"])
            rows.append(row)
        ungraded = bool(self.not_graded) or any(test.status == "not graded" for test in self.tests)
        result: dict[str, Any] = {
            "output": self._words(), "output_format": "text", "test_output_format": "text", "test_name_format": "text",
            "visibility": "visible", "stdout_visibility": "hidden", "execution_time": _number(self.execution_time),
            "tests": rows,
            "extra_data": finite(self.extra_data) | {"status": "not graded" if ungraded else "graded"},
        }  # fmt: skip
        if self.not_graded or not rows:
            result["score"] = _number(self.previous.get("score"))
        if self.leaderboard:
            result["leaderboard"] = [
                {"name": clean(name, 80), "value": value, "order": order}
                for name, value, order in self.leaderboard
                if math.isfinite(value)
            ]
        return result

    def _row(self, test: Test, room: int) -> dict[str, Any]:
        most = _number(test.max_score)
        score, output = min(max(_number(test.score), 0.0), most), test.output
        if test.status == "not graded":
            before = next((row for row in _rows(self.previous) if row.get("number") == test.number), {})
            score = min(max(_number(before.get("score")), 0.0), most)
            output = f"This test could not be graded; that is not your fault, and the staff can see it.\n{output}"
        return {
            "number": test.number, "name": clean(test.name, 200), "score": score, "max_score": most,
            "status": "passed" if test.status == "passed" else "failed", "output": clean(output, room),
            "output_format": "text", "visibility": test.visibility,
            "tags": [*test.tags, *(["not graded"] if test.status == "not graded" else [])],
            "extra_data": finite(test.extra_data),
        }  # fmt: skip

    def _words(self) -> str:
        lines = [self.not_graded, self.output]
        if self.not_graded:
            lines.insert(1, "This is not zero points: the score of the submission before, if there is one, is kept.")
        hidden = sum(test.visibility != "visible" for test in self.tests)
        if hidden:
            lines.append(f"{hidden} {'check is' if hidden == 1 else 'checks are'} hidden until later.")
        return clean("\n".join(line for line in lines if line), 2 * OUTPUT_LIMIT)


def provisional(previous: Mapping[str, Any]) -> Results:
    """What stands there until something better does."""
    return Results(not_graded=UNFINISHED, previous=previous)


def write(results: Results, path: Path) -> None:
    """Replace results.json in one step; a reader sees the old file or the new one."""
    text = json.dumps(results.as_json(), allow_nan=False, indent=1)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=".results-")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def previous_results(metadata: Path) -> dict[str, Any]:
    """The results of the submission before, out of submission_metadata.json; empty if there are none."""
    try:
        submissions = json.loads(metadata.read_bytes())["previous_submissions"]
        latest = max(submissions, key=lambda submission: str(submission.get("submission_time")))
        return dict(latest["results"], score=latest.get("score", latest["results"].get("score")))
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return {}


def clean(text: str, limit: int) -> str:
    """Without escape sequences, control and direction characters, and at most `limit` characters."""
    text = ESCAPES.sub("", text.encode("utf-8", "replace").decode().replace("\r\n", "\n"))
    text = "".join(c for c in text if c in "\n\t" or unicodedata.category(c) not in ("Cc", "Cf", "Cs"))
    mark = " [...]"
    return text if len(text) <= limit else text[: limit - len(mark)] + mark if limit > len(mark) else ""


def finite(value: Any) -> Any:
    """The same with a text for each number that JSON does not know."""
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, Mapping):
        return {str(key): finite(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [finite(each) for each in value]
    return value if isinstance(value, str | int | float | bool | None) else str(value)


def problems(words: Any) -> list[str]:
    """What is wrong with the contents of a results.json, in the eyes of Gradescope."""
    if not isinstance(words, dict):
        return ["no object"]
    found = [] if "score" in words or words.get("tests") else ["neither a score nor tests"]
    rows = _rows(words)
    found += [f"{key}: no number" for key in ("score", "execution_time") if key in words and not _is_number(words[key])]
    found += ["visibility"] if words.get("visibility", "visible") not in VISIBILITIES else []
    for number, row in enumerate(rows):
        found += [
            f"test {number}: {key} is no number" for key in ("score", "max_score") if not _is_number(row.get(key))
        ]
        found += [f"test {number}: status"] if row.get("status") not in ("passed", "failed") else []
        found += [f"test {number}: visibility"] if row.get("visibility", "visible") not in VISIBILITIES else []
        found += [f"test {number}: output_format"] if row.get("output_format", "text") not in FORMATS else []
        if not found and not 0.0 <= row["score"] <= row["max_score"]:
            found.append(f"test {number}: a score of {row['score']} out of {row['max_score']}")
    return found


def points(words: Mapping[str, Any]) -> float:
    """The score that Gradescope shows."""
    return words["score"] if "score" in words else sum(row["score"] for row in _rows(words))


def _rows(words: Mapping[str, Any]) -> list[dict[str, Any]]:
    rows = words.get("tests")
    return [row for row in rows if isinstance(row, dict)] if isinstance(rows, list) else []


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _number(value: Any) -> float:
    """A finite number; 0 for anything else."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return 0.0
    return number if math.isfinite(number) else 0.0
