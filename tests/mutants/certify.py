"""`make certify`: false alarms, power, every mutant, and docs/certificate.md.

`python -m mutants.certify` goes on where an earlier run was stopped (Ctrl-C keeps what is finished); `--fresh` begins
anew, `--report` only writes the report. Results are kept in build/certify.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from typing import Any

from mutants import run as runner  # before raylab: its children must import the mutants' raylab, not this one
from mutants.corpus import BY_NAME

HERE = Path(__file__).resolve().parents[2]
STATE, DOCS = HERE / "build" / "certify", HERE / "docs"
GRADINGS = {"gradings": 3000, "assignments": 3000}  # of toy estimators, and of assignment a1
REPEATS, MEASURES = 1000, 200


def results() -> list[dict[str, Any]]:
    return [json.loads(line) for path in sorted(STATE.glob("*.jsonl")) for line in path.read_text().splitlines()]


def mutants(jobs: int) -> None:
    """All trials of the right code first, whose variances the z-test wants, then every mutant."""
    trials = sorted({t for m in BY_NAME.values() for t in m.trial.split("; ")})
    for names in ([f"correct:{trial}" for trial in trials], list(BY_NAME)):
        done = {r["name"] for r in results() if "error" not in r and (not r.get("plain") or "plain only" in r)}
        for r in results():
            for t in r["tests"]:
                if r["name"].startswith("correct:") and "variance" in t:
                    runner.VARIANCES[t["trial"]] = t["variance"]
        _run([n for n in names if n not in done], jobs)


def _run(names: list[str], jobs: int) -> None:
    start = time.monotonic()
    with (STATE / "compiled.jsonl").open("a") as file:
        for k, result in enumerate(runner.run(names, plain=False, jobs=jobs), 1):
            result["plain only"] = True  # whatever it was run in, it need not be run again
            file.write(json.dumps(result) + "\n")
            file.flush()
            print(f"\r{k}/{len(names)} {result['name']:<24} {time.monotonic() - start:.0f} s ", end="", flush=True)
    print()


def keep(name: str, compute: Callable[[], Any]) -> None:
    """Compute once; the file says that it has been done."""
    path = STATE / f"{name}.json"
    if not path.exists():
        print(f"{name} ...", flush=True)
        path.write_text(json.dumps(compute()))


def suite() -> dict[str, Any]:
    """Every claim of an assignment about right functions in a file, in a fresh process."""
    paths = os.pathsep.join([str(HERE), str(HERE / "tests")])
    start, before = time.perf_counter(), getrusage(RUSAGE_CHILDREN)
    command, environment = [sys.executable, "-m", "mutants.grading"], os.environ | {"PYTHONPATH": paths}
    ran = subprocess.run(command, env=environment, capture_output=True, text=True)
    ran.check_returncode()
    after, wall = getrusage(RUSAGE_CHILDREN), time.perf_counter() - start
    busy = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    conditions = {"load": os.getloadavg()[0], "processors": os.cpu_count()}
    return json.loads(ran.stdout) | {"wall": wall, "busy": busy} | conditions


def conditions() -> str:
    import numba
    import numpy

    load = os.getloadavg()[1]
    return (
        f"{os.cpu_count()} processors with {load:.0f} processes at work on average while this was finished; Python "
        f"{platform.python_version()}, numpy {numpy.__version__}, numba {numba.__version__}."
    )


def measured() -> dict[str, Any]:
    found: dict[str, Any] = {"mutants": results(), "repeats": REPEATS, "conditions": conditions()}
    for path in STATE.glob("*.json"):
        found[path.stem] = json.loads(path.read_text())
    return found


def measurements(jobs: int) -> None:
    from mutants import alarms

    keep("measure", lambda: {str(alpha): alarms.by_change_of_measure(alpha, MEASURES) for alpha in (1e-6, 3e-9)})
    for kind in GRADINGS:
        gradings(kind, jobs)
    keep("power", lambda: alarms.power(REPEATS))


def gradings(kind: str, jobs: int) -> None:
    """Goes on from what has been counted before."""
    from mutants import alarms

    path, n = STATE / f"{kind}.json", GRADINGS[kind]
    total = Counter(json.loads(path.read_text()) if path.exists() else {})
    if total["gradings"] >= n:
        return
    for seen in getattr(alarms, kind)(n - total["gradings"], jobs):
        total += seen
        path.write_text(json.dumps(total))
        print(f"\r{kind} {total['gradings']}/{n}", end="", flush=True)
    print()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("--report", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    STATE.mkdir(parents=True, exist_ok=True)
    if options.fresh:
        for path in STATE.iterdir():
            path.unlink()
    try:
        if not options.report:
            keep("suite", suite)
            mutants(options.jobs)  # before this process has a raylab of its own
            measurements(options.jobs)
    except KeyboardInterrupt:
        print("\nstopped; what is finished is kept")
    from mutants import certificate

    print(certificate.write(DOCS, measured()))


if __name__ == "__main__":
    main()
