"""Report: the table of all cases as docs/stability.md and as a page that needs no other file. What fails is shown."""

from __future__ import annotations

import html
import platform
from collections.abc import Sequence
from pathlib import Path

from raylab.atomic import replacing
from raylab.stress.case import SECTIONS, Row

COMMAND = "raylab stress -o stress --markdown docs/stability.md"
HEADS = ("case", "set-up", "usual code", "raylab", "truth", "error of", "allowed", "raylab", "usual", "float32", "s")
STYLE = """body{font:15px/1.5 system-ui,sans-serif;max-width:1400px;margin:2em auto;padding:0 1em;color:#1a1a1a}
table{border-collapse:collapse;font-size:13px}
th,td{border:1px solid #ddd;padding:4px 7px;vertical-align:top;text-align:left}
td.held{background:#e6f4ea}td.broken{background:#fde7e7;font-weight:600}
td.n{white-space:nowrap;font-variant-numeric:tabular-nums}
pre{white-space:pre-wrap;margin:0}"""


def number(value: float | None) -> str:
    return "" if value is None else "0" if value == 0.0 else f"{value:.2g}"


def summary(rows: Sequence[Row]) -> str:
    """How many hold, and how many of the usual code would have."""
    held, tried = sum(row.held for row in rows), [row.usual_held for row in rows if row.usual_held is not None]
    broken = ", ".join(row.case.id for row in rows if not row.held)
    return (
        f"{held} of {len(rows)} cases held{f' (not: {broken})' if broken else ''}. "
        f"The usual code was tried in {len(tried)} of them and held in {sum(tried)}."
    )


def cells(row: Row) -> list[str]:
    """The row as text: set-up, formulas, errors."""
    c, found = row.case, row.found
    seen = number(found.error) if found else row.failed.strip().splitlines()[-1]
    usual, single = (number(found.usual), number(found.single)) if found else ("", "")
    note = f" {found.note}" if found and found.note else ""
    return [
        c.id, c.setup, c.usual, c.rule + note, c.truth, c.unit, number(c.allowed), seen, usual, single,
        f"{row.seconds:.1f}",
    ]  # fmt: skip


def markdown(rows: Sequence[Row]) -> str:
    """The page for docs/."""
    parts = [
        "# Where it holds and where it breaks", "",
        f"Made by `{COMMAND}`; also run by `pytest -m extreme`. {summary(rows)}", "",
        "Each row is an extreme case with a known truth. Errors are those of raylab, of the code that is usually",
        "written, and of raylab's formula in float32 where that says something. **A row that fails stays here.**",
        f"Python {platform.python_version()}, {platform.machine()}.",
    ]  # fmt: skip
    for letter, title in SECTIONS.items():
        own = [row for row in rows if row.case.id[0] == letter]
        if own:
            parts += ["", f"## {letter}. {title}", "", "| " + " | ".join(HEADS) + " |", "|---" * len(HEADS) + "|"]
            parts += ["| " + " | ".join(_cell(text) for text in _marked(row)) + " |" for row in own]
    return "\n".join(parts) + "\n"


def _marked(row: Row) -> list[str]:
    texts = cells(row)
    texts[7] = texts[7] if row.held else f"**{texts[7]}**"
    return texts


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ").replace("<", "&lt;")


def page(rows: Sequence[Row]) -> str:
    """The same as one HTML file."""
    parts = [
        "<!doctype html><meta charset='utf-8'><title>raylab: stiff and extreme cases</title>",
        f"<style>{STYLE}</style><h1>Where it holds and where it breaks</h1><p>{html.escape(summary(rows))}</p>",
    ]
    for letter, title in SECTIONS.items():
        own = [row for row in rows if row.case.id[0] == letter]
        if own:
            heads = "".join(f"<th>{head}</th>" for head in HEADS)
            body = "".join(map(_table_row, own))
            parts.append(f"<h2>{letter}. {html.escape(title)}</h2><table><tr>{heads}</tr>{body}</table>")
    return "".join(parts)


def _table_row(row: Row) -> str:
    texts, kinds = [html.escape(text) for text in cells(row)], [""] * len(HEADS)
    kinds[6:] = ["n"] * 5
    kinds[7] = "held n" if row.held else "broken"
    if row.usual_held is not None:
        kinds[8] = "held n" if row.usual_held else "broken n"
    if row.failed:
        texts[7] = f"<pre>{html.escape(row.failed)}</pre>"
    return "<tr>" + "".join(f"<td class='{k}'>{t}</td>" for k, t in zip(kinds, texts, strict=True)) + "</tr>"


def write(rows: Sequence[Row], folder: Path, markdown_file: Path | None = None) -> Path:
    """The page in a folder, and the Markdown where it is asked for; the page's path."""
    folder.mkdir(parents=True, exist_ok=True)
    target = folder / "stability.html"
    with replacing(target) as beside:
        beside.write_text(page(rows), encoding="utf-8")
    if markdown_file:
        with replacing(markdown_file) as beside:
            beside.write_text(markdown(rows), encoding="utf-8")
    return target
