"""The tables of a study: one row for each render, and one for each estimator and number of samples."""

from __future__ import annotations

import csv
from dataclasses import asdict
from pathlib import Path
from typing import Any

from raylab.atomic import replacing
from raylab.study.results import COLUMNS, Study


def write(study: Study, folder: Path) -> None:
    """measurements.csv (tidy: a row is a render), summary.csv and columns.txt."""
    _csv(folder / "measurements.csv", list(COLUMNS), [asdict(row) for row in study.rows])
    rows = summary_rows(study)
    _csv(folder / "summary.csv", list(rows[0]) if rows else ["estimator"], rows)
    with replacing(folder / "columns.txt") as beside:
        lines = ["measurements.csv: one row for each render", "", *(f"{n}: {text}" for n, text in COLUMNS.items())]
        beside.write_text("\n".join(lines) + "\n", encoding="utf-8")


def summary_rows(study: Study) -> list[dict[str, Any]]:
    """Variance, RMSE and seconds with 95 % intervals for each estimator and number of samples."""
    rows = []
    for e, levels in study.measured.items():
        for level in levels:
            row: dict[str, Any] = {"estimator": e.label, "spp": level.spp, "repeats": level.repeats}
            for name in ("variance", "rmse", "seconds"):
                estimate = getattr(level, name)
                row |= {name: estimate.value, f"{name}_low": estimate.low, f"{name}_high": estimate.high}
            row["doubts"] = "; ".join(dict.fromkeys((*level.variance.doubts, *level.rmse.doubts)))
            rows.append(row)
    return rows


def _csv(path: Path, columns: list[str], rows: list[dict[str, Any]]) -> None:
    with replacing(path) as beside, open(beside, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)
