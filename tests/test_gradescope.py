"""The zip file for Gradescope: the same every time, without a solution, and valid results whatever happens in it."""

from __future__ import annotations

import subprocess
import zipfile
from dataclasses import replace

import pytest
from click.testing import CliRunner

from raylab.cli import commands
from raylab.errors import UserError
from raylab.grading import assignment as assignments
from raylab.grading import gradescope
from raylab.grading.results import points

SECRET = b"s" * 32


@pytest.fixture(scope="module")
def a1():
    return assignments.load("a1")


@pytest.fixture(scope="module")
def package(a1, tmp_path_factory):
    out = tmp_path_factory.mktemp("zip") / "a1.zip"
    gradescope.build(a1, out, SECRET)
    return out


def test_the_same_zip_twice(a1, package, tmp_path):
    gradescope.build(a1, tmp_path / "other name.zip", SECRET)
    assert (tmp_path / "other name.zip").read_bytes() == package.read_bytes()


def test_programs_are_executable_and_the_secret_is_not_public(package):
    with zipfile.ZipFile(package) as archive:
        modes = {info.filename: info.external_attr >> 16 & 0o777 for info in archive.infolist()}
        for name in gradescope.PROGRAMS:
            assert modes[name] == 0o755
            text = archive.read(name)
            assert text.startswith(b"#!/usr/bin/env bash\n")
            assert b"\r" not in text
            subprocess.run(["bash", "-n"], input=text, check=True)
        assert modes["secret"] == 0o600
        assert all(info.date_time == gradescope.EPOCH for info in archive.infolist())


def test_no_solution_is_inside(a1, package):
    with zipfile.ZipFile(package) as archive:
        shade = archive.read("package/raylab/shade.py").decode()
    body = shade[shade.index("def area_diffuse") :].partition("\n\n\n")[0]
    assert "NotImplementedError" in body
    assert "dot(" not in body


def test_a_solution_inside_is_refused(a1, tmp_path):
    folder = tmp_path / "a1"
    folder.mkdir()
    for path in a1.folder.iterdir():
        if path.is_file():
            (folder / path.name).write_bytes(path.read_bytes())
    (folder / "handout.md").write_text("# BEGIN " + "SOLUTION\n")
    with pytest.raises(UserError, match="a solution would be in the zip file"):
        gradescope.build(replace(a1, folder=folder), tmp_path / "a1.zip", SECRET)
    assert not (tmp_path / "a1.zip").exists()


def test_a_trial_run_on_a_bad_submission(package, tmp_path):
    (tmp_path / "Shade.py").write_text("pass\n")
    trial = gradescope.try_out(package, tmp_path)
    assert trial.problems == []
    assert points(trial.results) == 0.0
    assert "found Shade.py: rename it" in trial.results["output"]
    assert trial.results["extra_data"]["status"] == "graded"


def test_a_grader_that_never_starts_leaves_valid_results(package, tmp_path, monkeypatch):
    monkeypatch.setattr(gradescope.sys, "executable", "/bin/false")
    trial = gradescope.try_out(package, tmp_path)
    assert trial.problems == []
    assert trial.results["extra_data"]["status"] == "not graded"
    assert "did not finish" in trial.results["output"]


def test_another_zip_is_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("x", "y")
    with pytest.raises(UserError, match="is no autograder"):
        gradescope.try_out(tmp_path / "a.zip", tmp_path)
    with pytest.raises(UserError, match=r"a\.txt"):
        gradescope.try_out(tmp_path / "a.txt", tmp_path)


def test_the_commands(package, tmp_path):
    folder, out = tmp_path / "course", tmp_path / "a1.zip"
    folder.mkdir()
    (folder / "secret").write_bytes(SECRET)
    run = CliRunner().invoke(commands, ["autograder", "build", "a1", "-o", str(out), "--secret", str(folder)])
    assert out.read_bytes() == package.read_bytes(), run.output
    (tmp_path / "submission").mkdir()
    run = CliRunner().invoke(commands, ["autograder", "test", str(out), str(tmp_path / "submission")])
    assert "expected a file shade.py, found nothing" in run.output
    assert "0 points, graded" in run.output


@pytest.mark.certify
def test_a_trial_run_of_the_solution_gets_full_points(a1, package, tmp_path):
    from raylab import lecture
    from raylab.grading.stub import solutions

    text = f"from raylab.lecture import {', '.join(name for name in lecture.__all__ if name != 'math')}\n"
    solution = solutions()["a1.diffuse"]
    (tmp_path / "shade.py").write_text(text + solution.text.replace(f"def {solution.name}(", "def shade("))
    trial = gradescope.try_out(package, tmp_path)
    assert trial.problems == []
    assert points(trial.results) == a1.points, trial.printed
    (row,) = trial.results["leaderboard"]
    assert row["name"] == "a1.diffuse: variance x rays"
    assert 0.7 < row["value"] < 1.3  # of a right submission with the slide's technique; see tests/test_ranking.py
