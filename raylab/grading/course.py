"""Course: all submissions of an assignment, each graded by a process of its own, resumable, and what comes of it.

    OUT/NAME/results.json    as Gradescope wants it        OUT/gradebook.csv    a line for each submission
    OUT/NAME/staff.json      for the staff alone           OUT/dashboard.html   all of them at a glance
    OUT/secret               what the seeds are made from  OUT/changes.csv      whose score is another one than before

A submission whose results are there, for the same bytes, the same secret and the same raylab, is not graded again.
"""

from __future__ import annotations

import csv
import hashlib
import json
import os
import secrets
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from raylab import __version__
from raylab.atomic import replacing
from raylab.errors import UserError
from raylab.grading.assignment import Assignment
from raylab.grading.ranking import column, ranked

Say = Callable[[str], None]
LONGEST = 900.0  # seconds for one submission, whatever it does


@dataclass(frozen=True)
class Entry:
    """A submission and where its results go."""

    name: str
    path: Path
    folder: Path

    @property
    def results(self) -> dict[str, Any]:
        return _json(self.folder / "results.json")

    @property
    def staff(self) -> dict[str, Any]:
        return _json(self.folder / "staff.json")


def _json(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def entries(paths: Sequence[Path], out: Path, file: str = "shade.py") -> list[Entry]:
    """One for each path; a folder without the `file` that is handed in stands for the folders and files in it."""
    found: list[Path] = []
    for path in paths:
        if not path.exists():
            raise UserError(f"there is no submission {path}")
        inside = sorted(path.iterdir()) if path.is_dir() else []
        several = [p for p in inside if p.is_dir() and not p.name.startswith((".", "_"))]
        several += [p for p in inside if p.suffix in (".zip", ".py")]
        whole = path.is_file() or any(p.name.lower() == file.lower() for p in inside)
        found += [path] if whole or not several else several
    names = [p.stem if p.is_file() else p.name for p in found]
    twice = {name for name in names if names.count(name) > 1}
    unique = [f"{path.parent.name}-{n}" if n in twice else n for n, path in zip(names, found, strict=True)]
    if len(set(unique)) < len(unique):
        raise UserError(f"two submissions are called {sorted(twice)[0]!r}; expected a name for each")
    return [Entry(name, path, out / name) for name, path in zip(unique, found, strict=True)]


def secret_of(out: Path) -> bytes:
    """The secret of this course: made once, kept in the folder; its SHA-256 is in each result."""
    path = out / "secret"
    if not path.is_file():
        out.mkdir(parents=True, exist_ok=True)
        handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with os.fdopen(handle, "wb") as file:
            file.write(secrets.token_hex(32).encode())
    return path.read_bytes().strip()


def stamp(entry: Entry, secret: bytes, assignment: Assignment) -> str:
    """Changes with the submission, the secret, the rubric and the version."""
    content = hashlib.sha256(secret + __version__.encode() + (assignment.folder / "assignment.toml").read_bytes())
    files = [entry.path] if entry.path.is_file() else sorted(p for p in entry.path.rglob("*") if p.is_file())
    for path in files:
        content.update(path.name.encode() + b"\0")
        if path.is_symlink() or path.stat().st_size > 1 << 20:
            content.update(repr(path.lstat().st_size).encode())
        else:
            content.update(path.read_bytes())
    return content.hexdigest()[:24]


def grade_all(
    assignment: Assignment, paths: Sequence[Path], out: Path, jobs: int, say: Say, again: bool = False,
    trust: bool = False,
) -> list[Entry]:  # fmt: skip
    """Grade what is not graded yet; write the gradebook, the dashboard and what has changed.

    `trust`: grade although this machine cannot shut the jail, if it cannot.
    """
    from raylab.grading.dashboard import write_dashboard

    secret, every = secret_of(out), entries(paths, out, assignment.file)
    before = {e.name: e.results for e in every}
    todo = [e for e in every if again or e.staff.get("stamp") != stamp(e, secret, assignment)]
    if len(todo) < len(every):
        say(f"{len(every) - len(todo)} of {len(every)} submissions are graded already.")

    def one(entry: Entry) -> None:
        start = time.monotonic()
        grade_one(assignment, entry, secret, library, trust)
        score = sum(t["score"] for t in entry.results.get("tests", []))
        say(f"{entry.name}: {score:g} of {assignment.points:g}, {time.monotonic() - start:.0f} s")

    if todo and not trust:
        refuse_an_open_jail()
    with tempfile.TemporaryDirectory(prefix="raylab-") as folder, ThreadPoolExecutor(max(1, jobs)) as pool:
        library = without_solutions(assignment, Path(folder))
        list(pool.map(one, todo))
    write_gradebook(assignment, every, out / "gradebook.csv")
    write_changes(before, every, out / "changes.csv", say)
    write_dashboard(assignment, every, out / "dashboard.html")
    return every


def refuse_an_open_jail() -> None:
    """UserError where this machine cannot keep hostile code in."""
    from raylab.grading.session import probe

    jail = probe()
    if not jail["shut"]:
        raise UserError(
            f"this machine cannot shut a jail around the submissions: {json.dumps(jail)}; expected Linux with seccomp, "
            "and Landlock or root. --trust grades all the same, submissions that you trust"
        )


def without_solutions(assignment: Assignment, folder: Path) -> Path:
    """A raylab for the jail, in a folder that every user may read: there are stubs in the place of the solutions."""
    from raylab.grading.course_wheel import stripped

    stripped([assignment], folder)
    for path in (folder, *folder.rglob("*")):
        path.chmod(0o755 if path.is_dir() else 0o644)
    return folder


def grade_one(assignment: Assignment, entry: Entry, secret: bytes, library: Path, trust: bool = False) -> None:
    """In a process of its own, which is killed if it does not end; what it leaves is valid whatever happens."""
    entry.folder.mkdir(parents=True, exist_ok=True)
    (entry.folder / "staff.json").unlink(missing_ok=True)
    folders = [str(path) for path in (assignment.folder, entry.path, entry.folder, library)]
    process = subprocess.Popen(
        [sys.executable, "-m", "raylab.grading.one", *folders, stamp(entry, secret, assignment), str(int(trust))],
        stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
    )  # fmt: skip
    try:
        _, errors = process.communicate(secret, LONGEST)
    except subprocess.TimeoutExpired:
        process.kill()
        _, errors = process.communicate()
    if process.returncode:
        note = {"error": errors.decode("utf-8", "replace")[-4000:], "code": process.returncode}
        (entry.folder / "staff.json").write_text(json.dumps(note))


# --- what comes of it ---


def outcome(entry: Entry) -> str:
    """graded, not graded, or failed to run."""
    return str(entry.results.get("extra_data", {}).get("status", "not graded"))


def write_gradebook(assignment: Assignment, every: Iterable[Entry], path: Path) -> None:
    """A line for each submission: its score, each property, the likeliest cause of each task."""
    with replacing(path) as temporary, open(temporary, "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        ranks = [column(task) for task in ranked(assignment)]
        rows.writerow(["name", "status", "score", "of", *(p.id for p in assignment.properties), *ranks, "causes"])
        for entry in every:
            tests = {t["name"]: t["score"] for t in entry.results.get("tests", [])}
            total = sum(tests.values())
            causes = entry.results.get("extra_data", {}).get("causes", {})
            named = "; ".join(f"{task}: {found[0]['cause']}" for task, found in causes.items() if found)
            scores = [tests.get(p.id, "") for p in assignment.properties]
            values = leaderboard(entry.results)
            efficient = [values.get(name, "") for name in ranks]
            rows.writerow([entry.name, outcome(entry), total, assignment.points, *scores, *efficient, named])


def leaderboard(results: dict[str, Any]) -> dict[str, float]:
    """The values of the leaderboard by name."""
    return {row["name"]: row["value"] for row in results.get("leaderboard", [])}


def write_changes(before: dict[str, dict[str, Any]], every: Iterable[Entry], path: Path, say: Say) -> None:
    """Whose score has changed since the last grading, and in which properties: nobody's is lowered unseen."""
    rows = []
    for entry in every:
        old = {t["name"]: t["score"] for t in before[entry.name].get("tests", [])}
        new = {t["name"]: t["score"] for t in entry.results.get("tests", [])}
        if not old or before[entry.name].get("extra_data", {}).get("status") != "graded":
            continue
        changed = [f"{name}: {old.get(name, 0):g} -> {new[name]:g}" for name in new if new[name] != old.get(name)]
        if changed:
            rows.append([entry.name, sum(old.values()), sum(new.values()), "; ".join(changed)])
    if not rows:
        path.unlink(missing_ok=True)
        return
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([["name", "before", "now", "why"], *rows])
    lowered = sum(row[2] < row[1] for row in rows)
    say(f"{len(rows)} scores have changed, {lowered} of them to less: see {path}")
