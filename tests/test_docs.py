"""The Python examples of README and docs run as they stand."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize("page", ["README.md", "docs/scenes.md"])
def test_examples_run(page, tmp_path, monkeypatch):
    """One page's blocks, in order, in one namespace and in a folder of their own beside the reference scenes."""
    blocks = [b for b in re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.DOTALL) if "raylab" in b]
    assert blocks
    (tmp_path / "reference_scenes").symlink_to(ROOT / "reference_scenes")
    monkeypatch.chdir(tmp_path)
    namespace: dict = {}
    for block in blocks:
        exec(compile(block, page, "exec"), namespace)
    assert namespace["image"].mean.max() > 0.0


def test_examples_of_the_statistics_run():
    """Fresh random numbers: a verdict other than the page's has the probability that the page states."""
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "docs/statistics.md").read_text(), re.DOTALL)
    namespace: dict = {}
    for block in blocks:
        exec(compile(block, "docs/statistics.md", "exec"), namespace)
    assert len(blocks) == 7


@pytest.mark.parametrize("page", ["README.md", *sorted(f"docs/{p.name}" for p in ROOT.glob("docs/*.md"))])
def test_links_lead_somewhere(page):
    text = (ROOT / page).read_text()
    for target in re.findall(r"\]\(([^)#:]+)\)", text):
        assert ((ROOT / page).parent / target).exists(), target
    if page == "docs/index.md":
        for name in re.findall(r"^(\w+)$", text, re.MULTILINE):
            assert (ROOT / "docs" / f"{name}.md").exists(), name
