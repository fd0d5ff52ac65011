"""docs/certificate.md from what has been measured, whole or in part; it says which."""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import Any

from mutants.corpus import ALL, BY_NAME, EQUIVALENT
from mutants.patch import Mutant

BLOCK = 256  # observations in the first block of a test: no decision is sooner
RIVALS = ("Nori", "Mitsuba", "pbrt", "darts")


def best(results: list[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """For each name the compiled result if it is there (it goes on longer), else the one in plain Python."""
    chosen: dict[str, dict[str, Any]] = {}
    for result in sorted(results, key=lambda r: not r.get("plain", False)):
        chosen[result["name"]] = result
    return chosen


def tests_of(result: dict[str, Any]) -> list[dict[str, Any]]:
    return [t for t in result["tests"] if t["test"] != "rivals"]


def killers(result: dict[str, Any]) -> list[dict[str, Any]]:
    return [t for t in tests_of(result) if t["outcome"] == "FAIL"]


def seconds_to_kill(result: dict[str, Any]) -> float:
    """Drawing and deciding of all tests up to the first that says FAIL; not compiling."""
    total = 0.0
    for test in tests_of(result):
        total += test["seconds"]
        if test["outcome"] == "FAIL":
            break
    return total


def ratio(test: dict[str, Any]) -> float | None:
    """Samples over what theory says, which is never less than the first block."""
    theory = test.get("theory", math.nan)
    return test["samples"] / max(theory, BLOCK) if math.isfinite(theory) else None


def state(mutant: Mutant, result: dict[str, Any] | None) -> str:
    if result is None:
        return "not run"
    if "error" in result:
        return "error"
    if killers(result):
        return "killed"
    open_ = any(t["outcome"] == "INCONCLUSIVE" for t in tests_of(result))
    return "undecided in plain Python" if open_ and result.get("plain") else "survives"


def write(folder: Path, measured: dict[str, Any]) -> Path:
    """The report, its table as CSV and its figures; returns the report's path."""
    pictures = folder / "certificate"
    pictures.mkdir(parents=True, exist_ok=True)
    results = best(measured.get("mutants", []))
    _csv(pictures / "mutants.csv", results)
    parts = [_head(measured), _alarms(measured), _power(measured, pictures), _suite(measured)]
    parts += [_mutants(results, pictures), _matrix(results), _table(results)]
    path = folder / "certificate.md"
    path.write_text("\n\n".join(part for part in parts if part) + "\n")
    return path


def _head(measured: dict[str, Any]) -> str:
    return (
        "# Certificate\n\n"
        "What the statistical harness has been seen to do, by `make certify`. A run that was stopped goes on where\n"
        "it stood, so parts may come from different times; what was not run is called so. A FAIL of right code has\n"
        "probability at most 3.3e-9 for each test, by theorem; a\n"
        "PASS of code that is off by 1 % or more at most 1e-3.\n\n" + measured.get("conditions", "")
    ).rstrip()


def _alarms(measured: dict[str, Any]) -> str:
    lines = ["## False alarms"]
    if "measure" in measured:
        lines += ["", "By change of measure (bets 1 to 5 of 14, whose share of alpha is 0.357 at most):", ""]
        lines += ["| alpha | measured / alpha | standard error |", "| --- | --- | --- |"]
        lines += [f"| {alpha} | {rate:.3f} | {error:.3f} |" for alpha, (rate, error) in measured["measure"].items()]
    lines += _brute(measured.get("gradings"), "34 claims about toy estimators that are right", "1.2e-7")
    lines += _brute(
        measured.get("assignments"), "assignment a1, its six properties judged as `raylab grade` does, of the right "
        "answer, compiled, in this process and on new scenes each time", "1e-6"
    )  # fmt: skip
    return "\n".join(lines) if len(lines) > 1 else "## False alarms\n\nnot run"


def _brute(counts: dict[str, int] | None, of: str, theorem: str) -> list[str]:
    """How many gradings, verdicts and false alarms, and what follows at 95 % confidence."""
    if not counts:
        return []
    from raylab.stats.tails import rule_of_three

    verdicts = sum(counts.get(o, 0) for o in ("PASS", "FAIL", "INCONCLUSIVE"))
    fails = counts.get("FAIL", 0)
    bounds = (
        f"At 95 % confidence fewer than {rule_of_three(verdicts):.3g} of the verdicts, and "
        f"{rule_of_three(counts['gradings']):.2g} of the gradings, are false alarms (the theorem says {theorem} for a "
        "grading)."
    )
    return [
        "",
        f"By brute force: {counts['gradings']} whole gradings of {of}; fresh entropy: {verdicts} verdicts, of them "
        f"{counts.get('PASS', 0)} PASS, {counts.get('INCONCLUSIVE', 0)} INCONCLUSIVE, {fails} FAIL; gradings with a "
        f"FAIL: {counts.get('gradings with a FAIL', 0)}. " + (bounds if fails == 0 else "That must not be."),
    ]


def _power(measured: dict[str, Any], pictures: Path) -> str:
    rows = measured.get("power")
    if not rows:
        return "## Power\n\nnot run"
    _power_figure(rows, pictures / "power.png")
    worst = max(abs(r[2] - r[3]) for r in rows)
    table = ["| samples | bias % | predicted | measured |", "| --- | --- | --- | --- |"]
    table += [f"| {n} | {100 * bias:.2f} | {p:.3f} | {m:.3f} |" for n, bias, p, m in rows]
    return (
        "## Power\n\nProbability of FAIL within n samples (uniform distribution, alpha 3.3e-9): predicted from one bet "
        f"and a normal mean, and measured in {measured.get('repeats', 1000)} repeats each. Largest difference "
        f"{worst:.3f}.\n\n"
        "![power](certificate/power.png)\n\n" + "\n".join(table)
    )


def _power_figure(rows: list[Any], path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    import numpy as np
    from matplotlib import pyplot as plt

    from mutants.alarms import predicted

    figure, axes = plt.subplots(figsize=(5.2, 3.2), dpi=110, layout="constrained")
    for colour, n in zip(("C0", "C3"), sorted({r[0] for r in rows}), strict=False):
        own = [r for r in rows if r[0] == n]
        bias = np.linspace(0.0, 1.1 * own[-1][1], 200)
        axes.plot(100 * bias, [predicted(b, n) for b in bias], colour, label=f"predicted, {n} samples")
        axes.plot([100 * r[1] for r in own], [r[3] for r in own], colour, marker="o", ls="none", label=f"measured, {n}")
    axes.set(xlabel="bias, %", ylabel="probability of FAIL")
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(path)
    plt.close(figure)


def _mutants(results: dict[str, Any], pictures: Path) -> str:
    states = {m.name: state(m, results.get(m.name)) for m in ALL if m not in EQUIVALENT}
    count = {s: sum(v == s for v in states.values()) for s in set(states.values())}
    dead_ones = [results[n] for n, s in states.items() if s == "killed"]
    first = [t for r in dead_ones for t in killers(r)[:1]]
    by_mean = [t for r in dead_ones for t in [t for t in killers(r) if t["test"] in "MR"][:1]]
    ratios = [r for t in by_mean if (r := ratio(t)) is not None]
    seconds = [seconds_to_kill(r) for r in dead_ones]
    large = [n for n, s in states.items() if s not in ("not run", "error") and _bias(BY_NAME[n], results[n]) >= 1.0]
    dead = sum(states[n] == "killed" for n in large)
    tried = sum(s not in ("not run", "error") for s in states.values())
    plain = sum(results[n].get("plain", False) for n, s in states.items() if s != "not run")
    fast = sum(s <= 2.0 for s in seconds)
    lines = [
        "## Mutants", "",
        f"{len(states)} mistakes and {len(EQUIVALENT)} equivalent mutants, each a patch of the package "
        "(`tests/mutants`). "
        + "; ".join(f"{s}: {n}" for s, n in sorted(count.items())) + ".", "",
        f"- killed {len(first)} of {tried} that were run; {dead} of {len(large)} with a bias of 1 % or more",
        f"- {tried - plain} of them compiled, {plain} in plain Python",
    ]  # fmt: skip
    if ratios:
        lines += [
            f"- samples against theory, where the mean or the range decides ({len(ratios)}): median "
            f"{sorted(ratios)[len(ratios) // 2]:.2f}, worst {max(ratios):.2f} times, {sum(r > 3 for r in ratios)} "
            "above 3 (theory: the best fixed bet, or the first value out of range, on samples of their own; at least "
            "one block)",
            f"- {fast} of {len(first)} ({100 * fast / len(first):.1f} %) within 2 s of drawing and deciding in one "
            "thread, all tests before the one that says FAIL included; median "
            f"{sorted(seconds)[len(seconds) // 2]:.3f} s, longest {max(seconds):.2f} s",
            f"- {sum(t['samples'] <= BLOCK for t in first)} within the first block of {BLOCK} samples",
        ]
        _samples_figure(by_mean, pictures / "samples.png")
        lines += ["", "![samples](certificate/samples.png)"]
    alarmed = [m.name for m in EQUIVALENT if m.name in results and killers(results[m.name])]
    ran = [m.name for m in EQUIVALENT if m.name in results]
    lines += ["", f"Equivalent mutants: {len(ran)} run, {len(alarmed)} complained about {alarmed or ''}".rstrip() + "."]
    others = [(n, s) for n, s in states.items() if s not in ("killed", "not run")]
    if others:
        lines += ["", "Not killed:", ""] + [f"- {n}, {BY_NAME[n].what}: {s}; {_why(results[n])}" for n, s in others]
    unexpected = [
        n for n, s in states.items()
        if s == "killed" and not any(t["test"] in BY_NAME[n].test for t in killers(results[n]))
    ]  # fmt: skip
    if unexpected:
        lines += ["", f"Killed by another test than the one for it: {', '.join(unexpected)}."]
    return "\n".join(lines)


def _why(result: dict[str, Any]) -> str:
    if "error" in result:
        return result["error"].strip().splitlines()[-1]
    biased = [t for t in tests_of(result) if "bias" in t]
    small = f"its bias is {biased[0]['bias']:.2f} +- {biased[0].get('bias_error', math.nan):.2f} %; " if biased else ""
    return small + "; ".join(f"{t['test']} {t['outcome']} after {t['samples']}" for t in tests_of(result))


def _bias(mutant: Mutant, result: dict[str, Any] | None) -> float:
    found = [t["bias"] for t in (result or {}).get("tests", []) if "bias" in t]
    return abs(found[0] if found else (mutant.bias or 0.0))


def _samples_figure(first: list[dict[str, Any]], path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(5.2, 3.2), dpi=110, layout="constrained")
    for kind, colour in (("M", "C0"), ("R", "C3")):
        own = [t for t in first if t["test"] == kind and ratio(t) is not None]
        if own:
            name = {"M": "by the mean", "R": "by the range"}[kind]
            axes.loglog(
                [max(t["theory"], 1.0) for t in own], [t["samples"] for t in own], "o", ms=4, color=colour, label=name
            )
    line = [1.0, 1e6]
    axes.loglog(line, line, "k-", lw=0.8, label="theory")
    axes.loglog([1.0, BLOCK, 1e6 / 3], [3.0 * BLOCK, 3.0 * BLOCK, 1e6], "k--", lw=0.8, label="three times theory")
    axes.set(xlabel="samples that theory says", ylabel="samples taken")
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(path)
    plt.close(figure)


def seen_by(result: dict[str, Any] | None, rival: str) -> str:
    """With which of its tests a rival notices: "mean", "chi2", both, none ("-"), or "" if it was not asked."""
    found = {}
    for judged in (result or {}).get("tests", []):
        if judged["test"] == "rivals" and rival in judged:
            kind = "chi2" if judged.get("chi-square") else "mean"
            found[kind] = found.get(kind, False) or judged[rival]
    return ", ".join(kind for kind, seen in sorted(found.items()) if seen) or ("-" if found else "")


def _what(mutant: Mutant) -> str:
    return mutant.what.replace("|", "&#124;")


def _matrix(results: dict[str, Any]) -> str:
    """All mutants under the tests of all projects; before it, how many each of them notices."""
    asked = [m for m in ALL if m.name in results and "error" not in results[m.name]]
    if not any(seen_by(results[m.name], r) for m in asked for r in RIVALS):
        return "## Other projects' settings on the same mutants\n\nnot run"
    wrong, right = [m for m in asked if m.test != "="], [m.name for m in asked if m.test == "="]
    right += [name for name in results if name.startswith("correct:")]
    large = [m for m in wrong if _bias(m, results[m.name]) >= 1.0]
    lines = [
        "## Other projects' settings on the same mutants", "",
        "Re-implemented in numpy from their published parameters (`tests/mutants/rivals.py` for images and means, "
        "`tests/mutants/chi_square.py` for samplers), on our scenes: what their own scenes do not contain is not held "
        "against them. Single runs at their own alpha, so some of what is seen is seen by chance.", "",
        f"| | raylab | {' | '.join(RIVALS)} |", "| --- " * (2 + len(RIVALS)) + "|",
    ]  # fmt: skip
    for what, names in (
        (f"mistakes noticed, of {len(wrong)}", [m.name for m in wrong]),
        (f"of them with a bias of 1 % or more, of {len(large)}", [m.name for m in large]),
        (f"the others, of {len(wrong) - len(large)}", [m.name for m in wrong if m not in large]),
        (f"right code complained about, of {len(right)}", right),
    ):
        ours = sum(bool(killers(results[n])) for n in names)
        said = [[seen_by(results[n], r) for n in names] for r in RIVALS]
        theirs = [f"{sum(s not in ('', '-') for s in column)} of {sum(s != '' for s in column)}" for column in said]
        lines.append(f"| {what} | {ours} | {' | '.join(theirs)} |")
    lines += ["", '"=" marks what is right, written another way; a blank is no test of that kind.', "",
              f"| mutant | what | raylab | {' | '.join(RIVALS)} |", "| --- " * (3 + len(RIVALS)) + "|"]  # fmt: skip
    for m in asked:
        result = results[m.name]
        ours = "".join(dict.fromkeys(t["test"] for t in killers(result))) or "-"
        name = f"{m.name}{' =' if m.test == '=' else ''}"
        lines.append(f"| {name} | {_what(m)} | {ours} | {' | '.join(seen_by(result, r) for r in RIVALS)} |")
    return "\n".join(lines)


def _suite(measured: dict[str, Any]) -> str:
    suite = measured.get("suite")
    if not suite:
        return "## A whole correct suite\n\nnot run"
    lines = [
        "## A whole correct suite", "",
        f"{len(suite['claims'])} claims about functions in a file, as a student hands them in, at 1 %: "
        f"{sum(c[1] == 'PASS' for c in suite['claims'])} PASS, {sum(c[2] for c in suite['claims'])} samples, "
        f"**{suite['wall']:.1f} s** in a fresh pair of processes on {suite['processors']} processors, compiling "
        f"included; {suite['busy']:.1f} s of processor time ({suite['load']:.1f} processes at work on average in the "
        "minute before its end). "
        f"Replay {suite['token']}.", "",
        "| claim | outcome | samples | s | s for scene and kernel |", "| --- " * 5 + "|",
    ]  # fmt: skip
    return "\n".join(lines + [f"| {n} | {o} | {k} | {s:.2f} | {p:.2f} |" for n, o, k, s, p in suite["claims"]])


def _table(results: dict[str, Any]) -> str:
    """Every mutant; the CSV holds the same and more."""
    lines = ["## Every mutant", "", "`certificate/mutants.csv` has every test of each. R range, M mean, V variance, J "
             "Jacobian, Q the p that comes with a sample is not pdf(), I integral of the pdf, T ties, P counts, C "
             "correlation or 1/N, D relation, W watched calls. Samples and theory are those of the first test that "
             "says FAIL, s (drawing and deciding) is of all tests until then.", "",
             "| mutant | what | bias % | killed by | samples | theory | s |", "| --- " * 7 + "|"]  # fmt: skip
    for mutant in ALL:
        result = results.get(mutant.name)
        found = killers(result) if result and "error" not in result else []
        if mutant.test == "=":
            verdict = "equivalent: " + ("FAIL" if found else "no complaint" if result else "not run")
            lines.append(f"| {mutant.name} | {_what(mutant)} | 0 | {verdict} | | | |")
        elif found:
            t = found[0]
            theory = f"{max(t['theory'], BLOCK):.0f}" if "theory" in t else ""
            bias = f"{t['bias']:.1f}" if "bias" in t and abs(t["bias"]) < 1e4 else ""
            kinds, s = "".join(dict.fromkeys(k["test"] for k in found)), seconds_to_kill(result)
            lines.append(
                f"| {mutant.name} | {_what(mutant)} | {bias} | {kinds} | {t['samples']} | {theory} | {s:.2f} |"
            )
        else:
            lines.append(f"| {mutant.name} | {_what(mutant)} | | {state(mutant, result)} | | | |")
    return "\n".join(lines)


def _csv(path: Path, results: dict[str, Any]) -> None:
    with path.open("w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["mutant", "what", "meant for", "source", "compiled", "trial", "test", "outcome", "samples",
                       "theory", "bias %", "seconds"])  # fmt: skip
        for name, result in sorted(results.items()):
            mutant = BY_NAME.get(name)
            about = [mutant.what, mutant.test, mutant.source] if mutant else ["the code as it is", "", ""]
            for t in tests_of(result):
                numbers = [f"{t[k]:.6g}" if k in t else "" for k in ("theory", "bias")]
                place = [not result["plain"], t["trial"], t["test"], t["outcome"], t["samples"]]
                rows.writerow([name, *about, *place, *numbers, f"{t['seconds']:.3f}"])
