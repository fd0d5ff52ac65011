"""docs/writing_shade.md says what raylab says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from test_submission_messages import HEAD

from raylab import lecture
from raylab.submission import STAGES, Task, climb

PAGE = (Path(__file__).parents[1] / "docs" / "writing_shade.md").read_text()
TASK = Task("a1.diffuse", "shade", like="area_diffuse")
ROWS = re.findall(r"^\| `(.*)` \| (.*) \| (.*) \|$", PAGE.split("## What the messages mean")[1], re.MULTILINE)


@pytest.mark.parametrize(("code", "sentence", "advice"), ROWS, ids=[row[0] for row in ROWS])
def test_a_message_of_the_page_is_the_one_that_comes(code, sentence, advice):
    rest = "\n    except Exception: pass" if code.startswith("try") else ""
    (finding,) = climb(f"{HEAD}    {code}{rest}\n".encode(), [TASK], until="interpret").findings
    assert finding.sentence == sentence
    assert finding.advice == advice.strip()


def test_the_page_shows_a_file_that_is_accepted():
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    assert climb(code.encode(), [TASK], until="interpret").findings == []


def test_the_page_names_all_stages_and_only_words_that_are_there():
    assert re.findall(r"^\| ([a-z-]+) \|", PAGE.split("## The ladder")[1].split("## What")[0], re.MULTILINE)[
        1:
    ] == list(STAGES)
    words = PAGE.split("## The words")[1].split("## What may")[0]
    named = set(re.findall(r"`([A-Za-z_]+)\b[^`.]*`", words)) - {
        "lecture",
        "math",
        "numpy",
        "raylab",
        "x",
        "y",
        "N",
        "V",
    }
    assert {w for w in named if not hasattr(lecture, w)} <= {
        "k_d",
        "brdf",
        "scene",
        "light",
        "rng",
        "v",
        "sample_",
        "pdf_",
    }
