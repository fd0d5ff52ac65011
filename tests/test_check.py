"""raylab check: an error is an error and no missing attempt; what compiled code raises has its line."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

from raylab.grading import public
from raylab.grading.assignment import load
from raylab.grading.begin import stub_of
from raylab.grading.raised import first_that_raises

RARELY = """
from raylab.lecture import Vec3, black


def share(a, b):
    return a / b


def shade(x, k_d, N, scene, rng):
    if rng.number() < 0.004:
        return Vec3(1.0, 1.0, 1.0) * share(1.0, 0.0)
    return black
"""
CAMERA = """
def shutter_time(open, close, u):
    large = int((close - open) * (1e300 if u < 0.002 else 1e3))
    return (open + (close - open) * u, open)[0 if large > 0 else 2]


def position(p0, p1, t0, t1, t):
    parts = (p0, p1)
    if t > t1 + 0.5 * (t1 - t0):
        return parts[int(t1 - t1) + 2]
    return p0
"""


def outcomes(text: str) -> list[str]:
    return re.findall(r"^(PASS|FAIL|INCONCLUSIVE|ERROR|NOT ATTEMPTED) +[\d.]+ of", text, re.M)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (RARELY.replace("    return black", "    return 0.0 + black"), 12),
        (RARELY.replace("(x, k_d, N, scene, rng):", "(x, k_d, N, scene, rng)"), 9),
    ],
)
def test_an_error_is_not_called_a_missing_attempt(text, line, tmp_path, run):
    (tmp_path / "shade.py").write_text(text)
    done = run("check", "a1", tmp_path / "shade.py")
    assert outcomes(done.stdout) == ["ERROR"] * len(load("a1").properties)
    assert f"    line {line}: " in done.stdout
    assert done.code == 1


def test_a_stub_is_a_missing_attempt(tmp_path, run):
    (tmp_path / "shade.py").write_text(stub_of(load("a1")))
    done = run("check", "a1", tmp_path / "shade.py")
    assert outcomes(done.stdout) == ["NOT ATTEMPTED"] * len(load("a1").properties)
    assert "`shade` is not written yet." in done.stdout


def test_what_a_shade_raises_in_one_of_250_samples_has_its_line(tmp_path, run):
    """Slide "Area source by Monte Carlo (diffuse)": plain Python did not meet it in its few samples."""
    path = tmp_path / "shade.py"
    path.write_text(RARELY)
    done = run("check", "a1", path, "--seed", "5")
    assert "line 6: This line divides by zero.\n    return a / b\n" in done.stdout
    assert outcomes(done.stdout) == ["ERROR"] * len(load("a1").properties)
    assert done.stdout.count("line 6: ") == 1 + len(load("a1").properties)
    token = re.findall(r"raylab replay (\S+) ", done.stdout)[-1]
    replayed = run("replay", token, path)
    assert replayed.stdout.endswith("raises ZeroDivisionError: float division by zero\n")


def test_what_plain_functions_raise_has_its_line_if_plain_python_raises_it_too(tmp_path, run):
    """Slide "Motion blur". A number of 10^300 has no place in compiled integers."""
    path = tmp_path / "shade.py"
    path.write_text(CAMERA)
    done = run("check", "a6", path, "--seed", "5")
    assert "line 10: The index is past the end of the tuple." in done.stdout
    assert "Compiled, `shutter_time` raises IndexError" in done.stdout
    assert "in plain Python the same sample runs, so the line is not known" in done.stdout
    assert outcomes(done.stdout).count("ERROR") == len(load("a6").properties) - 1  # one sees no such input


def test_pytest_in_the_folder_fails_with_the_line(tmp_path):
    path = tmp_path / "shade.py"
    path.write_text(CAMERA)
    own = next(p for p in load("a6").properties if p.options.get("expected") == "position_outside")
    verdict = public.judged("a6", path, own.id)
    assert verdict.outcome == "FAIL"
    assert "line 10: The index is past the end of the tuple." in verdict.seen


@pytest.mark.parametrize("bad", [0, 1, 6, 9])
def test_the_first_sample_that_raises_is_found(bad):
    def ask(low, high):
        if low <= 100 + bad < high:
            raise ValueError

    assert first_that_raises(ask, 100, 10) == 100 + bad


def test_what_takes_long_to_import_is_not_there_before_the_first_words():
    heavy = "scipy.special", "scipy.stats", "matplotlib", "colour", "OpenImageIO", "trimesh", "skimage", "pytest"
    text = f"import sys, raylab.cli, raylab.grading.check; print([n for n in {heavy} if n in sys.modules])"
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
