"""Reports render the record of a run, and nothing else: no statistics, no second run.

A report is a folder: `results.json` (the record), `results.csv`, `junit.xml`, `figures/*.png` and `*.svg`, and the page
`index.html`, which needs none of the others.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fogproof.errors import InvalidInputError
from fogproof.reports.files import COMPARISON, REPORT, prepare_folder
from fogproof.reports.gallery.pictures import write_gallery
from fogproof.reports.pages.comparison import exit_code, write_comparison_page
from fogproof.reports.pages.junit import write_junit
from fogproof.reports.pages.page import write_page
from fogproof.reports.pages.stability import write_stability
from fogproof.reports.pages.study import write_study_page
from fogproof.reports.records.runs import (
    RESULTS,
    SCHEMA,
    RunRecord,
    check_schema,
    load_record,
    parse_record,
    write_csv,
    write_record,
)
from fogproof.reports.records.studies import as_run, parse_study
from fogproof.reports.records.study_record import History

__all__ = [
    "COMPARISON",
    "REPORT",
    "SCHEMA",
    "compare_exit_code",
    "prepare_folder",
    "read_record",
    "write_comparison",
    "write_gallery",
    "write_report",
    "write_stability",
]


def write_report(record: dict[str, Any], folder: str | Path, *, keep: bool = False) -> Path:
    """Write the report of `record`, of whatever kind, into `folder`, made if need be, and return the path of its page.

    The record itself is written first: whatever goes wrong afterwards, the results are kept.

    keep  the record is in the folder already, and stays as it is
    """
    if not keep:
        write_record(record, folder)
    check_schema(record, "record")
    if _is_study(record):
        study = parse_study(record)
        write_junit(as_run(study), folder)
        return write_study_page(study, Path(folder))
    run = parse_record(record)
    write_csv(run, folder)
    write_junit(run, folder)
    return write_page(run, folder)


def read_record(folder: str | Path) -> dict[str, Any]:
    """Return the record in `folder`, or say in an `InvalidInputError` why there is none that can be shown."""
    record, origin = load_record(folder), str(Path(folder) / RESULTS)
    run = _run(record, origin)
    if (run.kind, run.state) == ("verify", "finished") and not run.cases:
        raise InvalidInputError(f"{origin}: cases must not be empty: no run of cases finishes without one", "cases")
    return record


def write_comparison(before: dict[str, Any], after: dict[str, Any], folder: str | Path) -> Path:
    """Write what changed between two records into `folder` and return the path of the page, `comparison.html`.

    The two records stand beside it as `before.json` and `after.json`.
    """
    older, newer = _run(before, "before"), _run(after, "after")
    write_record(before, folder, "before.json")
    write_record(after, folder, "after.json")
    return write_comparison_page(older, newer, Path(folder), _history(before, after))


def compare_exit_code(before: dict[str, Any], after: dict[str, Any]) -> int:
    """Return what became of the older record's cases in the newer one: 0 nothing bad, 1 one came out worse, 3 one is gone.

    Two records of different kinds, a run of the catalogue and a study, cannot be compared: `InvalidInputError`.
    """
    older, newer = _run(before, "before"), _run(after, "after")
    if older.kind != newer.kind:
        what = f"a record of kind {older.kind!r} cannot be compared with one of kind {newer.kind!r}"
        raise InvalidInputError(f"{what}; compare two runs of the same command", "kind")
    return exit_code(older, newer, _history(before, after))


def _run(record: Any, origin: str) -> RunRecord:
    check_schema(record, origin)
    return as_run(parse_study(record, origin)) if _is_study(record) else parse_record(record, origin)


def _history(before: dict[str, Any], after: dict[str, Any]) -> History | None:
    """Return what the newer study says of the older one, if it is this one that it was held against."""
    history = parse_study(after).history if _is_study(after) else None
    return history if history is not None and history.before.get("started") == before.get("started") else None


def _is_study(record: Any) -> bool:
    return isinstance(record, dict) and record.get("kind") == "study"
