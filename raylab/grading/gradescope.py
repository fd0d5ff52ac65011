"""Gradescope: the zip file of an assignment, a trial run of it, and what runs there.

    setup.sh, run_autograder   executable, with the ends of lines that a shell wants
    package/                   the course wheel's raylab: the solutions are stubs, here too
    assignment, secret         which one, and what the seeds are made from
    provisional.json           the results of a grading that never began

The same raylab, assignment and secret give the same zip, byte for byte.
"""

from __future__ import annotations

import faulthandler
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from raylab.errors import UserError
from raylab.grading import assignment as assignments
from raylab.grading.assignment import Assignment
from raylab.grading.grading import grade
from raylab.grading.results import problems, provisional
from raylab.grading.session import Limits

EPOCH = (1980, 1, 1, 0, 0, 0)  # the first moment that a zip file knows
PLATFORM_LIMIT = 600.0  # s, of Gradescope by default
SHARE = 0.8  # of it for the submission
MARK = b" ".join((b"BEGIN", b"SOLUTION"))  # of a staff's own files; not in one piece here, for this file is inside
PROGRAMS = ("setup.sh", "run_autograder")
SETUP = """#!/usr/bin/env bash
# Run once, as root, when the image is built: an interpreter of its own, which every user may read.
set -euo pipefail
umask 022
cd /autograder/source
command -v uv > /dev/null || python3 -m pip install --quiet uv
export UV_PYTHON_INSTALL_DIR=/opt/python
mkdir -p "$UV_PYTHON_INSTALL_DIR"  # uv may find a Python of the system instead
uv venv --python 3.11 /opt/raylab
uv pip install --python /opt/raylab/bin/python --constraint constraints.txt ./package pytest
chmod -R a+rX /opt/python /opt/raylab
chmod -R go-rwx /autograder/source
"""
RUN = """#!/usr/bin/env bash
# Grades one submission. The variables are for a trial run elsewhere.
umask 077
ROOT="${RAYLAB_AUTOGRADER:-/autograder}"
mkdir -p "$ROOT/results"
cp "$ROOT/source/provisional.json" "$ROOT/results/results.json"
chmod 700 "$ROOT/source" "$ROOT/submission" "$ROOT/results"
chmod 600 "$ROOT/submission_metadata.json" 2> /dev/null
cd "$ROOT/results" || exit 1
exec "${RAYLAB_PYTHON:-/opt/raylab/bin/python}" -I -c '
import sys
sys.path[:0] = sys.argv[2:]
from raylab.grading.gradescope import run
run(sys.argv[1])' "$ROOT" ${RAYLAB_PACKAGE:+"$RAYLAB_PACKAGE"}
"""


def build(assignment: Assignment, out: Path, secret: bytes) -> str:
    """Write the zip file; its SHA-256. UserError if a solution would be inside."""
    from raylab.grading.course_wheel import SOURCE, leaking, stage
    from raylab.grading.stub import solutions

    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        stage([assignment], folder / "package")
        files = {path.relative_to(folder).as_posix(): path.read_bytes() for path in _files(folder)}
        known = solutions()
        left = leaking(_files(folder), [known[task.id] for task in assignment.tasks])
    files |= {
        "setup.sh": SETUP.encode(), "run_autograder": RUN.encode(), "secret": secret,
        "assignment": assignment.id.encode(), "constraints.txt": (SOURCE / "constraints.txt").read_bytes(),
        "provisional.json": json.dumps(provisional({}).as_json(), indent=1).encode(),
    }  # fmt: skip
    left += [f"{name}: {MARK.decode()}" for name, text in files.items() if MARK in text]
    if left:
        raise UserError(f"a solution would be in the zip file: {left[0]}")
    _write(files, out)
    return hashlib.sha256(out.read_bytes()).hexdigest()


def _files(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts)


def _write(files: Mapping[str, bytes], out: Path) -> None:
    """Not compressed, since compressors differ; nothing in it depends on the machine."""
    part = out.with_name(f".{out.name}.part")
    with zipfile.ZipFile(part, "w", zipfile.ZIP_STORED) as archive:
        for name in sorted(files):
            info = zipfile.ZipInfo(name, EPOCH)
            info.create_system = 3  # so that the mode is read
            info.external_attr = (0o100755 if name in PROGRAMS else 0o100600 if name == "secret" else 0o100644) << 16
            archive.writestr(info, files[name])
    os.replace(part, out)


def run(root: str) -> None:
    """What runs on Gradescope, as root, in /autograder: grade, and end in time whatever happens."""
    start, folder = time.monotonic(), Path(root)
    faulthandler.dump_traceback_later(0.95 * PLATFORM_LIMIT, exit=True)
    name = (folder / "source" / "assignment").read_text()
    graded = grade(
        assignments.load(name), folder / "submission", folder / "results" / "results.json",
        secret=(folder / "source" / "secret").read_bytes(), metadata=folder / "submission_metadata.json",
        limits=Limits(total=SHARE * PLATFORM_LIMIT, must_be_shut=True),
    )  # fmt: skip
    print(f"graded in {time.monotonic() - start:.0f} s; isolation {json.dumps(graded.isolation)}")
    print(*graded.staff, sep="\n")


@dataclass(frozen=True)
class Trial:
    """A trial run: what Gradescope would be given, what is wrong with that, what was printed, and the seconds."""

    results: dict[str, Any]
    problems: list[str]
    printed: str
    seconds: float


def try_out(package: Path, submission: Path, metadata: Mapping[str, Any] | None = None) -> Trial:
    """Run the zip file on a submission as Gradescope does, with this Python, below a temporary folder."""
    with tempfile.TemporaryDirectory(prefix="autograder-") as temporary:
        root = Path(temporary)
        unpack(package, root / "source")
        shutil.move(str(root / "source" / "package"), root / "installed")  # instead of setup.sh
        (root / "results").mkdir()
        if submission.is_dir():
            shutil.copytree(submission, root / "submission", symlinks=True)
        else:
            (root / "submission").mkdir()
            shutil.copy(submission, root / "submission")
        (root / "submission_metadata.json").write_text(json.dumps(dict(metadata or {"previous_submissions": []})))
        start = time.monotonic()
        more = {"RAYLAB_AUTOGRADER": str(root), "RAYLAB_PYTHON": sys.executable, "RAYLAB_PACKAGE": f"{root}/installed"}
        ran = subprocess.run(
            [str(root / "source" / "run_autograder")], env={**os.environ, **more}, text=True, errors="replace",
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, timeout=PLATFORM_LIMIT,
        )  # fmt: skip
        seconds = time.monotonic() - start
        try:
            words = json.loads((root / "results" / "results.json").read_bytes())
        except (OSError, ValueError) as error:
            return Trial({}, [f"results.json: {error}"], ran.stdout, seconds)
        return Trial(words, problems(words), ran.stdout, seconds)


def unpack(package: Path, folder: Path) -> None:
    """The files of our own zip, with their modes; UserError if it is another one."""
    try:
        with zipfile.ZipFile(package) as archive:
            if not set(PROGRAMS) <= set(archive.namelist()):
                raise UserError(f"{package} is no autograder; expected {' and '.join(PROGRAMS)} in it")
            for info in archive.infolist():
                path = Path(archive.extract(info, folder))
                path.chmod((info.external_attr >> 16) & 0o777 or 0o644)
    except (OSError, zipfile.BadZipFile) as error:
        raise UserError(f"{package}: {error}") from None
