"""Begin: the folder in which a student works on an assignment."""

from __future__ import annotations

import shutil
from pathlib import Path

from raylab.errors import UserError
from raylab.grading.assignment import Assignment

TESTS = '''"""The public tests of {id}: the properties that are graded, with other random numbers. Run `pytest` here."""

from pathlib import Path

import pytest

from raylab.grading.public import judged, properties


@pytest.mark.parametrize("name", properties("{id}"))
def test_{id}(name):
    verdict = judged("{id}", Path(__file__).with_name("{file}"), name)
    if verdict.outcome == "FAIL":
        pytest.fail(f"{{verdict.says}} Seen: {{verdict.seen}}.", pytrace=False)
    if verdict.outcome != "PASS":
        pytest.skip(verdict.outcome)
'''
KEPT = {".md", ".xml", ".png", ".ply", ".exr"}  # what students get of an assignment's folder


def begin(assignment: Assignment, folder: Path) -> list[Path]:
    """Write the folder; nothing that is already there is changed (UserError)."""
    if folder.exists() and any(folder.iterdir()):
        raise UserError(f"{folder} is not empty; expected a new folder, so that no work is lost")
    folder.mkdir(parents=True, exist_ok=True)
    written = [folder / assignment.file, folder / f"test_{assignment.id}.py"]
    written[0].write_text(stub_of(assignment), "utf-8")
    written[1].write_text(TESTS.format(id=assignment.id, file=assignment.file), "utf-8")
    for path in sorted(assignment.folder.iterdir()):
        if path.suffix in KEPT:
            shutil.copyfile(path, folder / path.name)
            written.append(folder / path.name)
    return written


def stub_of(assignment: Assignment) -> str:
    """The file to complete: as a course wheel holds it, or made from the marked solutions."""
    ready = assignment.folder / "stub.py"
    if ready.is_file():
        return ready.read_text("utf-8")
    from raylab.grading.stub import student_file

    return student_file(assignment)
