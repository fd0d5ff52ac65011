"""Dashboard: one HTML page about all submissions of an assignment, without anything from outside."""

from __future__ import annotations

import html
import json
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from raylab.grading.assignment import Assignment
from raylab.grading.copies import SUSPICIOUS
from raylab.grading.ranking import DOUBTFUL

if TYPE_CHECKING:
    from raylab.grading.course import Entry

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; color: #222; margin: 2em auto; max-width: 70em; padding: 0 1em }
table { border-collapse: collapse; font-size: 13px } td, th { padding: .25em .6em; text-align: left; vertical-align: top }
tr + tr { border-top: 1px solid #ddd } .full { background: #dcefe0 } .none { background: #f6dad5 } .open { background: #eee }
svg { background: #fafafa; margin: .3em 1.5em .3em 0 } h2 { font-size: 1.1em; margin: 1.6em 0 .4em } .small { color: #666 }
"""
BLUE, GREY = "#2f6f9f", "#888"
BEST = 20  # of a leaderboard


def write_dashboard(assignment: Assignment, every: Sequence[Entry], path: Path) -> None:
    """Scores, causes, p-values, variance and run time, and a row for each submission."""
    results = [(entry, entry.results, entry.staff) for entry in every]
    totals = [sum(t["score"] for t in r.get("tests", [])) for _, r, _ in results]
    ungraded = [e.name for e, r, _ in results if r.get("extra_data", {}).get("status") != "graded"]
    causes = Counter(
        f"{task}: {found[0]['cause']}"
        for _, r, _ in results
        for task, found in r.get("extra_data", {}).get("causes", {}).items()
        if found
    )
    p_values = [
        t["extra_data"]["p_value"]
        for _, r, _ in results
        for t in r.get("tests", [])
        if t.get("extra_data", {}).get("p_value") is not None and t["score"] == t["max_score"]
    ]
    seconds = [float(s["seconds"]) for _, _, s in results if "seconds" in s]
    parts = [
        f"<!doctype html><meta charset='utf-8'><title>{assignment.id}</title><style>{STYLE}</style>",
        f"<h1>{assignment.id}: {html.escape(assignment.title)}</h1>",
        f"<p>{len(every)} submissions, {assignment.points:g} points. Median score {_median(totals):g}."
        f"{' Could not be graded: ' + html.escape(', '.join(ungraded)) + '.' if ungraded else ''}</p>",
        "<h2>Scores</h2>",
        histogram(totals, 0.0, assignment.points, "points"),
        "<h2>What is wrong</h2>",
        bars(causes.most_common(20)) if causes else "<p>Nothing that has a name.</p>",
        "<h2>p-values of right means, run time</h2>"
        "<p class='small'>Of submissions that are right p is spread evenly: another shape means that truth and grader "
        "disagree. Run time is that of a whole grading.</p>",
        histogram(p_values, 0.0, 1.0, "p, first look at the mean"),
        histogram(seconds, 0.0, max(seconds, default=1.0) * 1.01, "seconds"),
        "<h2>Variance</h2><p class='small'>Of one sample, times the variance of the technique; log scale.</p>",
        dots([(e.name, v) for e, r, _ in results for v in _variances(r)]),
        *leaderboard([(e.name, row) for e, r, _ in results for row in r.get("leaderboard", [])]),
        "<h2>Submissions</h2>",
        table(assignment, results),
    ]
    path.write_text("\n".join(parts), "utf-8")


def _median(values: Sequence[float]) -> float:
    ordered = sorted(values)
    return ordered[len(ordered) // 2] if ordered else 0.0


def _variances(results: dict[str, Any]) -> list[float]:
    found = (t.get("extra_data", {}).get("variance") for t in results.get("tests", []))
    return [float(v) for v in found if v]


def histogram(values: Sequence[float], low: float, high: float, label: str, bins: int = 20) -> str:
    """Counts in equal bins."""
    counts = [0] * bins
    for value in values:
        counts[min(max(int((value - low) / (high - low or 1.0) * bins), 0), bins - 1)] += 1
    top = max(counts) or 1
    parts = [f"<svg width='380' height='130'><title>{html.escape(label)}</title>"]
    for i, count in enumerate(counts):
        height = 90 * count / top
        parts.append(
            f"<rect x='{10 + 18 * i}' y='{100 - height:.1f}' width='16' height='{height:.1f}' fill='{BLUE}'>"
            f"<title>{count}</title></rect>"
        )
    ends = f"<text x='10' y='118' font-size='11'>{low:g}</text><text x='340' y='118' font-size='11'>{high:.4g}</text>"
    return "".join(
        [*parts, ends, f"<text x='120' y='118' font-size='11'>{html.escape(label)} (n = {len(values)})</text></svg>"]
    )


def bars(counts: Iterable[tuple[str, int]]) -> str:
    """How often each cause was named first."""
    rows, pairs = [], list(counts)
    top = max(n for _, n in pairs)
    for i, (name, n) in enumerate(pairs):
        y = 18 * i
        rows.append(
            f"<rect x='330' y='{y + 4}' width='{240 * n / top:.0f}' height='12' fill='{BLUE}'/><text x='320' y='{y + 14}' "
            f"font-size='12' text-anchor='end'>{html.escape(name)}</text><text x='{336 + 240 * n / top:.0f}' y='{y + 14}' "
            f"font-size='12'>{n}</text>"
        )
    return f"<svg width='640' height='{18 * len(pairs) + 8}'>{''.join(rows)}</svg>"


def dots(values: Sequence[tuple[str, float]]) -> str:
    """Each submission at its variance, from 1/10 to 10 times that of the technique."""
    import math

    rows = [f"<line x1='{x}' x2='{x}' y1='5' y2='60' stroke='#ccc'/>" for x in (20, 320, 620)]
    for i, (name, value) in enumerate(values):
        x = 320 + 300 * max(-1.0, min(1.0, math.log10(value)))
        rows.append(
            f"<circle cx='{x:.1f}' cy='{15 + 7 * (i % 6)}' r='3' fill='{BLUE}' fill-opacity='.5'>"
            f"<title>{html.escape(name)}: {value:.3g}</title></circle>"
        )
    labels = "".join(
        f"<text x='{x}' y='74' font-size='11' fill='{GREY}'>{t}</text>"
        for x, t in ((12, "1/10"), (316, "1"), (612, "10"))
    )
    return f"<svg width='660' height='80'>{''.join(rows)}{labels}</svg>"


def leaderboard(rows: Sequence[tuple[str, dict[str, Any]]]) -> list[str]:
    """For each task, who needs least: name and value, those that are hard to believe marked."""
    parts = []
    for title in dict.fromkeys(row["name"] for _, row in rows):
        values = sorted((row["value"], name) for name, row in rows if row["name"] == title)
        cells = [
            f"<tr{' class=none' if value < DOUBTFUL else ''}><td>{i + 1}</td><td>{html.escape(name)}</td>"
            f"<td>{value:.3g}</td></tr>"
            for i, (value, name) in enumerate(values[:BEST])
        ]
        parts.append(f"<h3>{html.escape(title)}</h3><table>{''.join(cells)}</table>")
    note = (
        "<h2>Leaderboard</h2><p class='small'>Variance of one sample, times the rays that it traces; the variance is that "
        f"of the slide's technique where it is 1. The rays are what the submission's process says: values below {DOUBTFUL:g} "
        "are marked. No points follow from it.</p>"
    )
    return [note, *parts] if parts else []


def table(assignment: Assignment, results: Sequence[tuple[Entry, dict[str, Any], dict[str, Any]]]) -> str:
    """A row for each submission, a cell for each property."""
    heads = "".join(f"<th>{html.escape(p.id)}</th>" for p in assignment.properties)
    rows = []
    for entry, result, staff in sorted(results, key=lambda row: row[0].name):
        tests = {t["name"]: t for t in result.get("tests", [])}
        cells = []
        for own in assignment.properties:
            test = tests.get(own.id, {})
            score = test.get("score")
            kind = "open" if score is None else "full" if score >= own.points else "none"
            seen = html.escape(str(test.get("output", "")), quote=True)
            cells.append(f"<td class='{kind}' title='{seen}'>{'' if score is None else f'{score:g}'}</td>")
        named = {t: f[0]["hints"][2] for t, f in result.get("extra_data", {}).get("causes", {}).items() if f}
        alike = [f"{t} {100 * v:.0f} %" for t, v in staff.get("likeness", {}).items() if v >= SUSPICIOUS]
        note = "; ".join([*(f"{t}: {h}" for t, h in named.items()), *(f"like raylab's own: {a}" for a in alike)])
        total = sum(t["score"] for t in tests.values())
        rows.append(
            f"<tr><td>{html.escape(entry.name)}</td><td><b>{total:g}</b></td>{''.join(cells)}"
            f"<td class='small'>{html.escape(note)}</td></tr>"
        )
    return f"<table><tr><th>name</th><th>score</th>{heads}<th>remarks, for the staff</th></tr>{''.join(rows)}</table>"


def summary(every: Sequence[Entry]) -> str:
    """The same numbers as JSON, for other programs."""
    return json.dumps([{"name": e.name, "tests": e.results.get("tests", [])} for e in every])
