"""Planted mistakes: a selection is found, in plain Python; what is written otherwise but right is not complained about.

The whole corpus, compiled, is for `make certify`. Seeds are fresh: a right piece of code FAILs with a probability of
3.3e-9 for each test here, and a mutant that is found in a few hundred samples escapes with 1e-3 at most.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from mutants import alarms, certificate
from mutants.corpus import ALL, BY_NAME, EQUIVALENT
from mutants.patch import Edit, edited, sources, span
from scipy import stats

pytestmark = pytest.mark.xdist_group("mutants")  # the selection is run once, by one worker
HERE = Path(__file__).parent
# By every kind of test but relations of scenes, which take too long here.
KILLED = (
    "a1", "a4", "a8", "a17", "a24", "a26", "a32", "a34", "a42", "a44", "a51", "a60", "a63", "a67", "a86", "a91", "a95",
    "a100", "a110", "b3", "c1", "c13", "V1", "V2", "V5", "C4", "C7", "C10", "a103", "V9", "P8", "P10", "P11", "P12",
    "c31", "D12", "W1", "W3",
)  # fmt: skip
PASSING = ("rectangle", "rectangle, solid angle", "two lights", "ball", "point", "sun", "unrelated pixels")


@pytest.fixture(scope="session")
def results():
    """What `mutants.run` says of the selection."""
    names = [*KILLED, *(m.name for m in EQUIVALENT), *(f"correct:{trial}" for trial in PASSING)]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(HERE.parent), str(HERE)])}
    ran = subprocess.run(
        [sys.executable, "-m", "mutants.run", *names], env=environment, capture_output=True, text=True, timeout=600
    )
    assert ran.returncode == 0, ran.stderr
    return {r["name"]: r for r in map(json.loads, ran.stdout.splitlines())}


def outcomes(result):
    assert "error" not in result, result["error"]
    return {test["test"]: test["outcome"] for test in result["tests"]}


@pytest.mark.parametrize("name", KILLED)
def test_a_mistake_is_found(results, name):
    found = outcomes(results[name])
    assert "FAIL" in found.values()
    assert any(found.get(kind) == "FAIL" for kind in BY_NAME[name].test), f"{name}: found, but not by the test for it"


@pytest.mark.parametrize("name", [m.name for m in EQUIVALENT])
def test_another_way_to_write_it_is_not_a_mistake(results, name):
    assert "FAIL" not in outcomes(results[name]).values()


@pytest.mark.parametrize("trial", PASSING)
def test_the_code_as_it_is_is_not_complained_about(results, trial):
    """PASS, or INCONCLUSIVE where plain Python had not the patience for a PASS; `make certify` asks for PASS."""
    assert "FAIL" not in outcomes(results[f"correct:{trial}"]).values()


@pytest.mark.parametrize("mutant", ALL, ids=lambda m: m.name)
def test_every_mutant_still_fits_the_code(mutant):
    assert sources(mutant.edits)


def test_the_certificate_says_what_was_run(results, tmp_path):
    path = certificate.write(tmp_path, {"mutants": list(results.values())})
    text = path.read_text()
    assert f"Equivalent mutants: {len(EQUIVALENT)} run, 0 complained about" in text
    assert f"killed {len(KILLED)} of {len(KILLED)} that were run" in text
    assert text.count("not run\n") >= 3  # false alarms, power, the suite
    assert "a9 | area 1 % too large | | not run" in text
    assert (tmp_path / "certificate" / "mutants.csv").read_text().count("\n") > len(results)


def test_gradings_of_right_estimators_do_not_fail():
    seen = alarms.verdict(*next(alarms.suite()), np.random.default_rng(), 100_000)
    assert seen.outcome == "PASS"
    assert len(list(alarms.suite())) == 34


def test_the_certificate_predicts_power():
    """At the bias that is seen in half of the runs, 60 runs: within the binomial's bounds of 0.2 more or less."""
    n, bias = 1000, 0.15
    found = round(60 * alarms.measured(bias, n, 60))
    p = alarms.predicted(bias, n)
    assert stats.binom.ppf(5e-7, 60, max(p - 0.25, 0.0)) <= found <= stats.binom.ppf(1 - 5e-7, 60, min(p + 0.25, 1.0))


def test_an_edit_that_does_not_fit_is_refused():
    source = "def f(x):\n    return x + x\n"
    with pytest.raises(LookupError, match="2 times"):
        edited(source, Edit("m:f", " x", " y"))
    with pytest.raises(LookupError, match="0 times"):
        edited(source, Edit("m:f", "z", "y"))
    with pytest.raises(LookupError, match="expected one 'g'"):
        span(source, "g")
    with pytest.raises(LookupError, match="vec3 is not for mutants"):
        sources((Edit("vec3:dot", "a", "b"),))
