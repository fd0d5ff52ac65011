"""One: the process that grades one submission.

python -m raylab.grading.one ASSIGNMENT SUBMISSION OUT LIBRARY STAMP TRUST < secret
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

from raylab.grading.assignment import load
from raylab.grading.copies import likeness
from raylab.grading.grading import grade
from raylab.grading.session import Limits


def main(folder: str, submission: str, out: str, library: str, stamp: str, trust: str) -> None:
    """Write results.json and staff.json."""
    start, assignment = time.monotonic(), load(Path(folder))
    grading = grade(
        assignment, Path(submission), Path(out, "results.json"), secret=sys.stdin.buffer.read().strip(),
        limits=Limits(must_be_shut=trust != "1"), library=Path(library),
    )  # fmt: skip
    staff = {
        "stamp": stamp, "seconds": time.monotonic() - start, "notes": grading.staff, "findings": grading.findings,
        "entropy": f"{grading.entropy:x}", "likeness": likeness(grading.source, assignment),
    }  # fmt: skip
    Path(out, "staff.json").write_text(json.dumps(staff, default=str))


if __name__ == "__main__":
    main(*sys.argv[1:])
