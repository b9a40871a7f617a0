"""The record of a run over the hard regions: JSON, one row a form and region as CSV, and whether all is as it should be."""

from __future__ import annotations

import csv
import dataclasses
import fnmatch
import importlib.metadata
import io
from collections.abc import Iterable
from typing import Any

from fogproof.checks.json_values import jsonable
from fogproof.errors import InvalidValueError
from fogproof.stability.formula import Formula
from fogproof.stability.measuring import OURS, FormError
from fogproof.stability.table import formulas
from fogproof.text import spreadsheet_cell, state, unfinished
from fogproof.verify import environment

SCHEMA = "fogproof/stability/1"
COLUMNS = (
    *("formula", "form", "source", "region", "precision", "points", "bound", "worst", "ulps", "condition"),
    *("share", "stated", "violations", "at", "value", "truth", "reason"),
)


LONG = 0.3
"""Formulas that have a smaller share of the usual points have a truth that takes long; the short form leaves them out."""


def short(chosen: Iterable[Formula]) -> list[Formula]:
    """Return the formulas of the short form."""
    return [formula for formula in chosen if formula.size >= LONG]


def select(names: Iterable[str]) -> list[Formula]:
    """Return the formulas whose name, or the folder it stands in, is one of these, or matches one as a glob; all by default."""
    names = list(names)
    chosen: list[Formula] = []
    for name in names:
        found = [one for one in formulas() if one.name.startswith(f"{name}/") or fnmatch.fnmatchcase(one.name, name)]
        if not found:
            themes = ", ".join(sorted({one.name.partition("/")[0] for one in formulas()}))
            raise InvalidValueError("FORMULA", f"must be a formula, a theme or a glob; themes are {themes}", name)
        chosen += [one for one in found if one not in chosen]
    return chosen if names else list(formulas())


def run_record(
    measured: Iterable[FormError],
    *,
    command: str,
    started: str,
    seconds: float,
    points: int,
    asked: int = 0,
    stopped: int = 0,
) -> dict[str, Any]:
    """Return the JSON-ready record of a run.

    points   so many stood along the axes of most regions
    asked    formulas that were to be measured; as many as have rows by default
    stopped  the exit code of a run that was interrupted, 0 of one that came to its end
    """
    rows = [dataclasses.asdict(row) for row in measured]
    done = {row["formula"] for row in rows}
    told = {one.name: {"title": one.title, "of": one.of, "bound": one.bound} for one in formulas() if one.name in done}
    table: dict[str, Any] = jsonable(
        {
            "schema": SCHEMA,
            "fogproof": importlib.metadata.version("fogproof"),
            "environment": environment(),
            "command": command,
            "started": started,
            "seconds": seconds,
            "points": points,
            "state": state(stopped),
            "title": unfinished(len(done), max(asked, len(done)), bool(stopped)),
            "formulas": told,
            "measured": rows,
        }
    )
    return table


def to_csv(measured: Iterable[FormError]) -> str:
    """Return one row a form, region and precision; no text in it can be taken for a formula of a spreadsheet."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\r\n")
    writer.writerow(COLUMNS)
    for row in measured:
        at = "; ".join(f"{name} = {value!r}" for name, value in row.at.items())
        values = [at if name == "at" else getattr(row, name) for name in COLUMNS]
        cells = zip(COLUMNS, values, strict=True)  # a truth is digits, more than a number in JSON holds
        writer.writerow(value if name == "truth" else spreadsheet_cell(value) for name, value in cells)
    return out.getvalue()


def hidden(measured: Iterable[FormError]) -> list[tuple[str, str]]:
    """Return (formula, form) of naive forms that fail visibly in none of their regions."""
    worst: dict[tuple[str, str], bool] = {}
    for row in measured:
        if row.form != OURS:
            key = row.formula, row.form
            worst[key] = worst.get(key, False) or row.visible
    return [key for key, seen in worst.items() if not seen]


def exit_code(measured: Iterable[FormError]) -> int:
    """Return 1 if a bound of ours is broken, 3 if none is but a naive form fails nowhere, 0 otherwise."""
    measured = list(measured)
    if any(row.violations for row in measured if row.form == OURS):
        return 1
    return 3 if hidden(measured) else 0
