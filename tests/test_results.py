"""results.json: valid at every moment, no number that JSON does not know, no text that does something."""

from __future__ import annotations

import json
import math
import os

import pytest

from raylab.grading.results import (
    OUTPUT_LIMIT,
    TOTAL_LIMIT,
    Results,
    Test,
    clean,
    points,
    previous_results,
    problems,
    provisional,
    write,
)  # fmt: skip

NASTY = "\x1b[2J\x1b]0;title\x07a\x00b\u202ec\r\nd\ud800" + "e" * 10_000


def read(path):
    return json.loads(path.read_text(), parse_constant=lambda name: pytest.fail(f"{name} in the file"))


def test_the_first_version_is_valid_and_says_what_happened(tmp_path):
    write(provisional({}), tmp_path / "results.json")
    words = read(tmp_path / "results.json")
    assert problems(words) == []
    assert (points(words), words["extra_data"]["status"]) == (0.0, "not graded")
    assert "did not finish" in words["output"]


def test_whatever_comes_in_valid_results_come_out(tmp_path):
    numbers = [math.nan, math.inf, -math.inf, None, -1.0, 99.0, 2.0]
    tests = [Test(str(i), NASTY, number, 2.0, NASTY, extra_data={"z": number}) for i, number in enumerate(numbers)]
    write(Results(tests, NASTY, math.nan, {"a": [math.inf, object()]}, [("v", math.nan, "asc")]), tmp_path / "r.json")
    words = read(tmp_path / "r.json")
    assert problems(words) == []
    assert [row["score"] for row in words["tests"]] == [0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 2.0]
    assert [row["tags"] for row in words["tests"]] == [["not graded"]] * 4 + [[]] * 3
    assert words["leaderboard"] == []
    assert all(len(row["output"]) <= OUTPUT_LIMIT for row in words["tests"])


def test_output_is_bounded_in_all():
    tests = [Test(str(i), "t", 1.0, 1.0, "x" * 10_000) for i in range(100)]
    words = Results(tests).as_json()
    assert sum(len(row["output"]) for row in words["tests"]) <= TOTAL_LIMIT
    assert problems(words) == []


def test_text_is_only_text():
    assert clean(NASTY, 9) == "abc\n [...]"[:3] + " [...]"
    assert clean("a\x1b[31mred\x1b[0m\tb", 100) == "ared\tb"
    assert clean("</pre><script>", 100) == "</pre><script>"  # shown as text, which the format says


def test_not_graded_is_not_zero(tmp_path):
    before = {"previous_submissions": [
        {"submission_time": "2026-01-01", "score": 1.0, "results": {"tests": []}},
        {"submission_time": "2026-02-01", "score": 7.0, "results": {"tests": [{"number": "1", "score": 3.0}]}},
    ]}  # fmt: skip
    (tmp_path / "metadata.json").write_text(json.dumps(before))
    previous = previous_results(tmp_path / "metadata.json")
    assert points(provisional(previous).as_json()) == 7.0
    words = Results([Test("1", "a", None, 5.0), Test("2", "b", 2.0, 2.0)], previous=previous).as_json()
    assert (points(words), words["extra_data"]["status"]) == (5.0, "not graded")
    assert words["tests"][0]["tags"] == ["not graded"]


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"previous_submissions": []}', '{"previous_submissions": [1]}'])
def test_no_submission_before(tmp_path, content):
    (tmp_path / "metadata.json").write_text(content)
    assert previous_results(tmp_path / "metadata.json") == {}


def test_a_full_disk_leaves_the_version_before(tmp_path, monkeypatch):
    write(provisional({}), tmp_path / "results.json")
    before = (tmp_path / "results.json").read_bytes()

    def full(*_):
        raise OSError("No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        write(Results([Test("1", "a", 1.0, 1.0)]), tmp_path / "results.json")
    assert [path.name for path in tmp_path.iterdir()] == ["results.json"]
    assert (tmp_path / "results.json").read_bytes() == before


def test_hidden_checks_are_announced():
    words = Results([Test("1", "a", 1.0, 1.0, visibility="after_due_date")]).as_json()
    assert "1 check is hidden until later." in words["output"]


@pytest.mark.parametrize(
    "words",
    [
        [], {}, {"score": "1"}, {"score": math.nan}, {"score": 1, "execution_time": "0.1"},
        {"tests": [{"score": 1.0, "max_score": 2.0}]}, {"tests": [{"score": 3, "max_score": 2, "status": "passed"}]},
    ],
)  # fmt: skip
def test_the_contract_is_checked(words):
    assert problems(words)
