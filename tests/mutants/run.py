"""Runs mutants, each in a process of its own: the mistake is made while that process imports raylab.

`python -m mutants.run [--compiled] [--jobs 2] NAME ...` prints one JSON line for each; `correct:TRIAL` runs the code as
it is. A parent that has imported numpy and numba, but not raylab, forks.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import signal
import sys
import time
import traceback
from collections.abc import Iterable, Iterator
from typing import Any

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ[_name] = "1"

import numba  # noqa: E402
import numpy as np  # noqa: E402
import scipy.special  # noqa: E402, F401

from mutants.corpus import BY_NAME  # noqa: E402
from mutants.patch import Mutant, bring_to_life  # noqa: E402

ALPHA = 3.3e-9
PLAIN_CAP = {"trial": 8192, "loop": 16384, "map": 32768}  # without the compiler: about a second each
CAP = 1 << 23
VARIANCES: dict[str, float] = {}  # of the right code by trial, which the parent fills in before it forks
MAP_CAP = 500_000  # 250 / phi^2 for phi^2 = 5e-4: silence is a PASS there
THEORY = {True: 4096, False: 200_000}  # independent samples from which the theory's prediction is made
PATIENCE = 1200  # seconds until a mutant "never returns"
GREY = 0.5  # radiance of what is measured in units of its truth
KINDS = {
    "R": "range", "M": "mean", "V": "variance", "J": "Jacobian", "Q": "p of a sample is not pdf()",
    "I": "integral of the pdf", "T": "ties", "P": "counts", "C": "correlation, 1/N", "D": "relation of scenes",
    "W": "watched calls",
}  # fmt: skip


def run_one(name: str, plain: bool) -> dict[str, Any]:
    """In the child: every test of every trial of this mutant."""
    correct = name.startswith("correct:")
    mutant = Mutant(name, "the code as it is", name[8:], "=", ()) if correct else BY_NAME[name]
    plain = plain or mutant.trial.startswith("watch ")
    numba.core.config.DISABLE_JIT = int(plain)
    bring_to_life(mutant.edits)
    tests = []
    for trial in sorted(mutant.trial.split("; "), key=lambda t: not t.startswith(("map ", "picks "))):  # cheapest first
        tests += list(_tests(trial, plain, "V" in mutant.test or correct))
    return {"name": name, "plain": plain, "tests": tests}


def _tests(name: str, plain: bool, variances: bool) -> Iterator[dict[str, Any]]:
    kind, _, rest = name.partition(" ")
    if kind == "map":
        yield from _map(name, plain)
    elif kind in ("relation", "watch", "picks", "shrinks", "unbiased", "brdf"):
        from mutants import relations

        yield from getattr(relations, kind)(name, rest.split(" "))
    else:
        from mutants.loops import LOOPS

        if name in LOOPS:
            yield from _loop(name, plain, variances, LOOPS[name]())
        else:
            yield from _trial(name, plain, variances)


def _map(name: str, plain: bool) -> Iterator[dict[str, Any]]:
    from mutants.maps import examine, maps

    made = maps()[name]()
    for test, outcome, taken, seconds, seen in examine(made, PLAIN_CAP["map"] if plain else MAP_CAP, ALPHA):
        outcome = "INCONCLUSIVE" if outcome == "PASS" and test == "P" and plain else outcome
        yield {"trial": name, "test": test, "outcome": outcome, "samples": taken, "seconds": seconds, "reason": seen}
    if not plain:
        from mutants.chi_square import judge

        yield _rivals(name) | judge(made.draws, made.pdf, made.chart, made.kind) | {"chi-square": True}


def _rivals(name: str) -> dict[str, Any]:
    return {"trial": name, "test": "rivals", "outcome": "", "samples": 0, "seconds": 0.0}


def _alike(name: str, draws: Any) -> dict[str, Any]:
    """T: no right estimator without atoms gives the same number five times in 4096."""
    from mutants.maps import LOOK, SAME, most_alike

    start = time.perf_counter()
    most = most_alike(draws(LOOK))
    return {"trial": name, "test": "T", "outcome": "FAIL" if most >= SAME else "PASS", "samples": LOOK,
            "seconds": time.perf_counter() - start, "reason": f"{most} of {LOOK} samples agree"}  # fmt: skip


def _loop(name: str, plain: bool, variances: bool, loop: Any) -> Iterator[dict[str, Any]]:
    from raylab.stats import mean_is, variance_is

    cap = PLAIN_CAP["loop"] if plain else None
    loop.draws(1)  # compiles
    kind = "C" if name.startswith("unrelated") else "M"
    bounds = {"low": loop.low, "high": loop.high, "alpha": ALPHA, "cap": cap}
    verdict = mean_is(name, loop.draws, loop.mean, delta=loop.delta, **bounds)
    yield _report(name, kind, verdict, loop.draws, loop.mean, loop.high, plain)
    if not loop.atoms:
        yield _alike(name, loop.draws)
    if variances and loop.variance is not None:
        yield _report(name, "V", variance_is(name, loop.draws, loop.variance, **bounds))
    if not plain:
        yield from _judged(name, loop.values or loop.draws, GREY, loop.spp)


def _trial(name: str, plain: bool, variances: bool) -> Iterator[dict[str, Any]]:
    from mutants.kills import Draws, check_mean, check_variance
    from mutants.trials import TRIALS

    trial = TRIALS[name]()
    draws = Draws(trial)
    start = time.perf_counter()
    draws(1)
    compiling = time.perf_counter() - start
    cap = PLAIN_CAP["trial"] if plain else CAP
    yield _report(name, "M", check_mean(trial, draws, cap), draws, 1.0, trial.high, plain) | {"compiling": compiling}
    if not trial.atoms:
        yield _alike(name, lambda n: draws.raw(n)[:, 1])
    if variances and trial.variance is not None:
        yield _report(name, "V", check_variance(trial, draws, cap))
    if not plain:
        yield from _judged(name, draws, float(np.mean(trial.truth)), 1)


def _judged(name: str, draws: Any, radiance: float, spp: int) -> Iterator[dict[str, Any]]:
    from mutants.rivals import judge

    found = judge(draws, VARIANCES.get(name), radiance, spp)
    yield _rivals(name) | {"variance": float(np.var(draws(THEORY[False] // spp)))} | found


def _report(
    name: str, kind: str, verdict: Any, draws: Any = None, mean: float = 1.0, high: float = math.inf, plain: bool = True
) -> dict[str, Any]:
    found = {"trial": name, "test": "R" if "outside" in verdict.reason else kind, "outcome": verdict.outcome,
             "samples": verdict.samples, "seconds": verdict.seconds, "estimate": verdict.estimate,
             "reason": verdict.reason}  # fmt: skip
    if draws is not None and (verdict.outcome == "FAIL" or not plain) and mean > 0.0:
        found |= _theory(draws(THEORY[plain]), high)
    return found


def _theory(values: Any, high: float) -> dict[str, Any]:
    """From samples of their own: bias, and the number that the best bet, or the first value out of range, needs."""
    from mutants.kills import growth

    outside = ~((values >= 0.0) & (values <= high))
    inside = values[~outside]
    needs = math.inf
    if outside.any():
        needs = len(values) / outside.sum()
    if len(inside):
        rate = growth(inside, high)
        needs = min(needs, math.log(2.0 / ALPHA) / rate) if rate > 0.0 else needs
    finite = values[np.isfinite(values)]
    bias = 100.0 * float(finite.mean() - 1.0) if len(finite) else math.nan
    cv = float(finite.std()) if len(finite) else math.nan
    return {
        "bias": bias,
        "bias_error": 100.0 * cv / math.sqrt(len(values)),
        "theory": needs,
        "out_of_range": float(outside.mean()),
    }


# --- processes ---


def run(names: Iterable[str], plain: bool, jobs: int = 2) -> Iterator[dict[str, Any]]:
    """Results as they come; each mutant is forked off a parent without raylab."""
    waiting, running = list(names), {}
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                name = waiting.pop(0)
                pid, pipe = _fork(name, plain)
                running[pid] = (name, pipe, time.monotonic())
            yield from _collect(running)
    finally:
        for pid, (_, pipe, _) in running.items():
            os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)
            os.close(pipe)


def _fork(name: str, plain: bool) -> tuple[int, int]:
    reader, writer = os.pipe()
    sys.stdout.flush()
    pid = os.fork()
    if pid:
        os.close(writer)
        return pid, reader
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends its children
    os.close(reader)
    start = time.perf_counter()
    try:
        result = run_one(name, plain)
    except BaseException:
        result = {"name": name, "plain": plain, "tests": [], "error": traceback.format_exc(limit=-3)}
    result["seconds"] = time.perf_counter() - start
    try:
        os.write(writer, json.dumps(result).encode())
    finally:
        os._exit(0)  # never back into the parent's code


def _collect(running: dict[int, Any]) -> Iterator[dict[str, Any]]:
    """Those that have ended, or had to be ended."""
    pid, _, usage = os.wait4(-1, os.WNOHANG)
    if not pid:
        time.sleep(0.02)
        late = [p for p, (_, _, start) in running.items() if time.monotonic() - start > PATIENCE]
        for p in late:
            os.kill(p, signal.SIGKILL)
        return
    name, pipe, start = running.pop(pid)
    with os.fdopen(pipe, "rb") as file:
        text = file.read()
    seconds = time.monotonic() - start
    said = json.loads(text) if text else {"tests": [], "error": f"ended after {seconds:.0f} s without a word"}
    yield {"name": name} | said | {"processor": usage.ru_utime + usage.ru_stime}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--compiled", action="store_true")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    for result in run(options.names or list(BY_NAME), not options.compiled, options.jobs):
        print(json.dumps(result), flush=True)


if __name__ == "__main__":
    main()
