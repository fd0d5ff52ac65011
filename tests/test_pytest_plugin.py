"""The pytest plugin: the page docs/testing_estimators.md as a test file, and what is said of bad estimators."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from raylab import trials

pytest_plugins = ["pytester"]
pytestmark = pytest.mark.compiled(reason="a hundred thousand samples each")
PAGE = Path(__file__).parents[1] / "docs" / "testing_estimators.md"
HEAD = "from raylab.vec3 import Vec3\n"


@pytest.fixture
def session(pytester):
    """Runs a test file with the plugin, in a process of its own."""

    def run(source, *options):
        pytester.makepyfile(source)
        return pytester.runpytest_subprocess("-p", "raylab.pytest_plugin", "-p", "no:cacheprovider", "-ra", *options)

    return run


def test_the_examples_of_the_page_pass(session):
    source = "\n\n".join(re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.S))
    result = session(source)
    result.assert_outcomes(passed=10)
    output = result.stdout.str()
    assert "10 claims; false alarms: probability at most 3.3e-08 (budget 1e-06)" in output
    assert re.search(r"PASS  test_the_examples\S+::test_the_mean_is_right unbiased area_diffuse my_area_light", output)
    assert re.search(r"estimate \S+ in \[\S+, \S+\], expected \S+; \d+ samples; a bias of \S+ \(\S+ % of it\)", output)


def test_the_page_lists_the_trials():
    rows = dict(re.findall(r"^\| `(\w+)` \| (.*) \|$", PAGE.read_text(), re.M))
    assert rows == {name: ", ".join(f"`{t}`" for t in trials.make(name, 0).answers) for name in trials.NAMES}


def test_a_wrong_estimator_fails_with_a_command_that_repeats_it(session):
    source = HEAD + "\n".join(
        [
            "def grey(x, k_d, N, scene, rng):",
            "    return Vec3(0.01, 0.01, 0.01) * rng.number()",
            "def nothing(x, k_d, N, scene, rng):",
            "    return k_d * (0.0 / (rng.number() * 0.0))",
            "def test_grey(raylab_claims):",
            "    raylab_claims.unbiased('area_diffuse', grey, trial='polygons')",
            "def test_nothing(raylab_claims):",
            "    raylab_claims.unbiased('area_diffuse', nothing, trial='polygons')",
        ]
    )
    result = session(source)
    result.assert_outcomes(failed=2)
    output = result.stdout.str()
    assert "returns NaN or infinity: nan" in output
    token = re.search(r"pytest --raylab-entropy=([0-9a-f]+)", output)[1]
    lines = [line for line in output.splitlines() if "estimate" in line]
    again = session(source, f"--raylab-entropy={token}", "-k", "test_grey").stdout.str()
    repeated = [line for line in again.splitlines() if "estimate" in line]
    assert repeated
    assert set(repeated) <= set(lines)


def test_inconclusive_is_said_and_is_no_failure(session, monkeypatch):
    source = "\n".join(
        [
            "import pytest",
            "from raylab.testing import deciding",
            "@pytest.fixture(autouse=True)",
            "def little_patience(monkeypatch):",
            "    monkeypatch.setattr(deciding, 'CAP', 1e-9)",
            "def test_too_short(raylab_claims):",
            "    raylab_claims.unbiased('area_diffuse', trial='polygons')",
        ]
    )
    result = session(source)
    result.assert_outcomes(skipped=1)
    result.stdout.fnmatch_lines(["*INCONCLUSIVE*samples did not decide*"])


def test_a_session_without_claims_is_left_alone(session):
    result = session("def test_one():\n    assert True\n")
    result.assert_outcomes(passed=1)
    assert "raylab claims" not in result.stdout.str()


def test_mistakes_in_the_options_and_claims_are_named(session):
    result = session("def test_one():\n    assert True\n", "--raylab-entropy=hello")
    assert "expected a replay token such as 1f03a9" in result.stderr.str()
    result = session("def test_one(raylab_claims):\n    raylab_claims.unbaised('area')\n")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*unknown claim 'unbaised'; expected one of unbiased*"])
