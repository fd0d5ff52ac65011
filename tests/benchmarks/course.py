"""A whole class: minutes for 300 submissions of a1 on two cores, and the memory of one grading.

    python tests/benchmarks/course.py [HOW MANY OF THEM, 40]

The submissions are the right answers of tests/submissions and their planted mistakes (tests/planted.py), in turns;
each is graded by `raylab grade`: in a jail, compiled, judged, diagnosed. Memory is that of grader and worker together.
"""

from __future__ import annotations

import csv
import itertools
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from manners import of_task
from planted import corpus

RIGHTS = of_task("a1.diffuse")

PROMISED_MINUTES, PROMISED_MB = 90.0, 768.0


def submissions() -> Iterator[str]:
    """Files with a `shade` for a1: right ones first, then one mistake each, and all over again."""
    rows = [(right, ()) for right in RIGHTS] + [(p.right, p.edits) for p in corpus() if p.right.task == "a1.diffuse"]
    for number, (right, edits) in enumerate(itertools.cycle(rows)):
        yield f"{right.edited(edits).replace(f'def {right.name}(', 'def shade(')}\n# {number}\n"


def memory() -> float:
    """The most that one grader and the processes below it hold now, in MB."""
    below: dict[int, list[int]] = {}
    held, graders = {}, []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            held[int(entry.name)] = int((entry / "statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20
            command = (entry / "cmdline").read_bytes()
        except (OSError, ValueError):
            continue
        below.setdefault(parent, []).append(int(entry.name))
        graders += [int(entry.name)] if b"raylab.grading.one" in command else []

    def tree(process: int) -> float:
        return held.get(process, 0.0) + sum(map(tree, below.get(process, [])))

    return max(map(tree, graders), default=0.0)


def main(count: int = 40) -> None:
    with tempfile.TemporaryDirectory() as temporary:
        folder, most = Path(temporary), 0.0
        for number, text in enumerate(itertools.islice(submissions(), count)):
            (folder / "in" / f"{number:03d}").mkdir(parents=True)
            (folder / "in" / f"{number:03d}" / "shade.py").write_text(text)
        command = [sys.executable, "-m", "raylab.cli", "grade", "a1", str(folder / "in"), "-o", str(folder / "out")]
        start = time.monotonic()
        running = subprocess.Popen([*command, "--jobs", "2"], stdout=subprocess.DEVNULL)
        while running.poll() is None:
            most = max(most, memory())
            time.sleep(0.3)
        minutes = (time.monotonic() - start) / 60.0
        rows = list(csv.DictReader((folder / "out" / "gradebook.csv").read_text().splitlines()))
    graded = sum(row["status"] == "graded" for row in rows)
    right = len(RIGHTS)
    print(f"{graded} of {count} graded in {minutes:.1f} minutes ({60 * minutes / count:.1f} s each): "
          f"300 take {300 * minutes / count:.0f}, at most {PROMISED_MINUTES:g} are promised")  # fmt: skip
    print(f"memory of one grading: {most:.0f} MB, at most {PROMISED_MB:g} are promised")
    print(f"scores: right {[row['score'] for row in rows[:right]]}, "
          f"median of the others {statistics.median(float(row['score']) for row in rows[right:]):g}")  # fmt: skip


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
