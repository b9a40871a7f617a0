"""The page of hard regions: every formula's worst error, and maps of where others' forms lose their digits."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fogproof.reports.charts.error_map import ErrorMap
from fogproof.reports.charts.pictures import Picture, render
from fogproof.reports.pages.templates import fill
from fogproof.reports.records.runs import write_record
from fogproof.reports.records.stability import STABILITY, StabilityRecord, parse_stability
from fogproof.reports.text import file_stem
from fogproof.stability.record import to_csv
from fogproof.whole_files import write_file

MOST_PANELS = 4
"""Beside each other in one picture; further forms are in the table alone."""


def write_stability(record: dict[str, Any], folder: str | Path) -> Path:
    """Write `stability.html`, `stability.json`, `stability.csv` and the maps into a folder; return the page's path."""
    folder = Path(folder)
    write_record(record, folder, STABILITY)
    run = parse_stability(record)
    write_file(folder / "stability.csv", to_csv(run.measured))
    maps: dict[str, list[Picture]] = {}
    for name, picture in pictures(run):
        picture.save(folder / "figures")
        maps.setdefault(name, []).append(picture)
    page = fill(
        "stability.html",
        kind="stability",
        run=run,
        maps=maps,
        headline=headline(run),
        tone="bad" if run.broken else "care" if run.title else "good",
    )
    return write_file(folder / "stability.html", page)


def headline(run: StabilityRecord) -> tuple[str, str]:
    """Return what came out in a sentence, and the counts behind it."""
    broken = sum(row.violations for row in run.broken)
    seen = len(run.naive) - len(run.hidden)
    first = (
        f"Our bounds are broken in {broken} places"
        if broken
        else f"No bound of {len(run.formulas)} formulas is broken; {seen} of {len(run.naive)} naive forms fail"
    )
    if run.title:
        first = f"{run.title} formulas were measured; {first[0].lower()}{first[1:]}"
    points = sum(row.points for row in run.ours)
    return first, f"{points} values of ours beside 50-digit truth, {run.seconds:.0f} s, {run.started}"


def pictures(run: StabilityRecord) -> list[tuple[str, Picture]]:
    """Return (formula, map) of every region with two arguments."""
    grids: dict[tuple[str, str, str], list[Any]] = {}
    for row in run.measured:
        if len(row.axes) == 2 and row.map:
            grids.setdefault((row.formula, row.region, row.precision), []).append(row)
    found = []
    for (formula, region, precision), rows in grids.items():
        (x, xs), (y, ys) = rows[0].axes
        panels = tuple((row.form, row.map) for row in rows[:MOST_PANELS])
        chart = ErrorMap((x, y), (xs, ys), panels, precision)
        found.append((formula, render(chart, file_stem("stability", formula, region, precision), chart.size)))
    return found
