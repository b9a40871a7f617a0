"""The record of a run: read and written whole, checked, and never half there.

`results.json` is the record itself; `results.csv` has one row a case for spreadsheets. Both are written to a temporary
file beside their place and renamed, so that a reader (or a crash) never meets half a file.
"""

from __future__ import annotations

import csv
import io
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeVar, cast

from fogproof.checks.json_values import jsonable
from fogproof.checks.verdict import Verdict
from fogproof.errors import InvalidInputError, shorten
from fogproof.input_files import parse_json, read_text
from fogproof.oracle_error import OracleError
from fogproof.plan import Plan
from fogproof.reports.charts.findings import parse_figure
from fogproof.reports.records.figures import require_figures
from fogproof.reports.validation import adapter
from fogproof.text import spreadsheet_cell, unfinished
from fogproof.verify import TwinResult, code_of, status_of
from fogproof.whole_files import write_file

SCHEMA = "fogproof/results/1"
RESULTS = "results.json"
COLUMNS = (
    *("name", "title", "kind", "status", "expected", "outcome", "p_value"),
    *("resolution_kind", "resolution", "resolution_miss", "samples", "seconds", "seed"),
    *("cause", "rejected_by", "reason", "source", "reference"),
    *("twin", "twin_outcome", "twin_rejected_by", "twin_p_value", "twin_samples"),
    *("terms", "solver", "estimator", "reproduce"),
)

_OF_CASES_ALONE = ("verify", "run")
"""Kinds of runs whose exit code follows from their cases; that of a test session counts all its tests."""

T = TypeVar("T")
Status = Literal["surprise", "rejected", "error", "inconclusive", "known", "skipped", "passed"]


@dataclass(frozen=True)
class Case:
    """What one case of the catalogue came to; `verdict` is None where nothing was judged."""

    name: str
    title: str
    kind: str
    status: Status
    expected: Literal["not rejected", "rejected", "inconclusive"]
    reason: str
    source: str
    reference: str
    twin: str
    reproduce: str
    seconds: float
    verdict: Verdict | None = None
    twin_result: TwinResult | None = None
    plan: Plan | None = None


@dataclass(frozen=True)
class RunRecord:
    """A whole run, its cases in the order of the catalogue.

    asked  the names of the cases that were to run; () in records of old, where those that ran are all that is known
    """

    schema: str
    kind: str
    fogproof: str
    environment: dict[str, Any]
    command: str
    seed: int
    alpha: float
    started: str
    seconds: float
    exit_code: int
    cases: tuple[Case, ...]
    oracle: tuple[OracleError, ...] = ()
    state: Literal["finished", "interrupted"] = "finished"
    asked: tuple[str, ...] = ()

    @property
    def missing(self) -> tuple[str, ...]:
        """The names of the cases that were asked for and have no result."""
        there = {case.name for case in self.cases}
        return tuple(name for name in self.asked if name not in there)

    @property
    def unfinished(self) -> str:
        """How much of what was asked for is there, in words; "" if all of it is."""
        whole = len(self.cases) + len(self.missing)
        return unfinished(len(self.cases), whole, self.state == "interrupted")


def parse_record(record: Any, origin: str = "record") -> RunRecord:
    """Return the record as dataclasses; `origin` is where it came from, for the message of an `InvalidInputError`."""
    check_schema(record, origin)
    run = validated(RunRecord, record, origin)
    names: set[str] = set()
    for number, case in enumerate(run.cases):
        if case.name in names:
            raise InvalidInputError(f"{origin}: two cases have the name {shorten(case.name)}", f"cases.{number}.name")
        names.add(case.name)
        stated = (record["cases"][number].get("verdict") or {}).get("outcome")
        if case.verdict is not None and stated not in (None, case.verdict.outcome):
            place = f"cases.{number}.verdict.outcome"
            said = f"must be {case.verdict.outcome!r}, as its findings are, got {shorten(stated)}"
            raise InvalidInputError(f"{origin}: {place} {said}", place)
        due = case.status if case.verdict is None else status_of(case.verdict.outcome, case.expected)
        if case.status != due:
            place = f"cases.{number}.status"
            said = f"must be {due!r}, as its verdict is, got {shorten(case.status)}"
            raise InvalidInputError(f"{origin}: {place} {said}", place)
        for index, finding in enumerate(case.verdict.findings if case.verdict is not None else ()):
            if finding.figure is not None:
                parse_figure(finding.figure, f"{origin}: cases.{number}.verdict.findings.{index}.figure")
    if run.state == "finished" and run.missing:
        lacks = f"must have {shorten(run.missing[0])}, which was asked for: the run is finished"
        raise InvalidInputError(f"{origin}: cases {lacks}", "cases")
    due_code = code_of((case.status, case.twin_result) for case in run.cases)
    if run.kind in _OF_CASES_ALONE and run.state == "finished" and run.exit_code != due_code:
        said = f"must be {due_code}, as the outcomes of its cases are, got {run.exit_code}"
        raise InvalidInputError(f"{origin}: exit_code {said}", "exit_code")
    return run


def check_schema(record: Any, origin: str) -> None:
    """Raise `InvalidInputError` if this is not a record that this version reads."""
    another = record.get("format") if isinstance(record, dict) else None
    if isinstance(another, str) and another.startswith("fogproof"):
        what = f"is a record of another kind ({shorten(another)}), whose page stands beside it"
        raise InvalidInputError(f"{origin}: {what}; pages are made again for runs and studies alone", "format")
    if not isinstance(record, dict) or not isinstance(record.get("schema"), str):
        raise InvalidInputError(f"{origin}: is not the record of a run, it has no text key 'schema'", "schema")
    if record["schema"] != SCHEMA:
        ours = record["schema"].startswith("fogproof/results/")
        fix = "read it with the fogproof that wrote it" if ours else "it was not written by fogproof"
        raise InvalidInputError(
            f"{origin}: schema must be {SCHEMA!r}, got {shorten(record['schema'])}; {fix}", "schema"
        )


def validated(kind: type[T], record: Any, origin: str) -> T:
    """Return `record` as the dataclass `kind`; the first fault becomes an `InvalidInputError` that names its place."""
    import pydantic

    try:
        return adapter(kind).validate_python(record)
    except pydantic.ValidationError as error:
        fault = error.errors()[0]
        place = ".".join(str(part) for part in fault["loc"] if part != "dataclass-args")
        said = "is missing" if fault["type"] == "missing" else f"{fault['msg']}, got {shorten(fault['input'])}"
        raise InvalidInputError(f"{origin}: {place} {said[0].lower()}{said[1:]}", place) from None


def load_record(folder: str | Path) -> dict[str, Any]:
    """Return what stands in `folder/results.json`, or say in an `InvalidInputError` why that is nothing."""
    path = Path(folder) / RESULTS
    if Path(folder).is_file():
        raise InvalidInputError(f"{folder} is a file: give the folder that it lies in", str(folder))
    if not path.exists():
        there = "the folder has no" if Path(folder).is_dir() else f"there is no folder {folder} with a"
        make = f"'fogproof verify --report {folder}' or 'fogproof study STUDY.toml -o {folder}'"
        raise InvalidInputError(f"cannot read {path}: {there} {RESULTS}; {make} make one", str(path))
    text = read_text(path, "the record")
    try:
        record = parse_json(text)
    except (ValueError, RecursionError) as error:
        ends = isinstance(error, json.JSONDecodeError) and error.pos >= len(text.rstrip())
        reason = "it ends in the middle of a record" if ends else f"it is not JSON ({error})"
        raise InvalidInputError(f"cannot read {path}: {reason}; run the checks again", str(path)) from None
    check_schema(record, str(path))
    require_figures(record, str(path))
    return cast(dict[str, Any], record)


def write_record(record: dict[str, Any], folder: str | Path, name: str = RESULTS) -> Path:
    """Write `record` as `folder/name` and return that path. Non-finite numbers become "inf", "-inf", "nan"."""
    return write_file(Path(folder) / name, _lines(jsonable(record)))


def _lines(record: dict[str, Any]) -> str:
    """Return the record as JSON: one line a key, one a case; the encoder's own indentation takes ten times as long."""

    def text(value: Any) -> str:
        return json.dumps(value, ensure_ascii=True, allow_nan=False)

    lines = []
    for key, value in record.items():
        rows = ",\n".join(map(text, value)) if isinstance(value, list) and value else ""
        lines.append(f"{text(key)}: " + (f"[\n{rows}\n]" if rows else text(value)))
    return "{\n" + ",\n".join(lines) + "\n}\n"


def write_csv(run: RunRecord, folder: str | Path) -> Path:
    """Write `folder/results.csv`, one row a case, and return its path; of a case that was asked for and is missing the row says so.

    No text in it can be taken for a formula, see `spreadsheet_cell`.
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\r\n")
    rows = [_row(case, run) for case in run.cases]
    rows += [dict.fromkeys(COLUMNS) | {"name": name, "status": "not run"} for name in run.missing]
    writer.writerow(COLUMNS)
    writer.writerows(map(spreadsheet_cell, row.values()) for row in rows)
    return write_file(Path(folder) / "results.csv", out.getvalue())


def _row(case: Case, run: RunRecord) -> dict[str, Any]:
    verdict, resolution = case.verdict, case.verdict.resolution if case.verdict is not None else None
    twin, plan = case.twin_result, case.plan
    rejecting = (
        [finding.check for finding in verdict.findings if finding.outcome == "rejected"] if verdict is not None else []
    )
    values = {
        "outcome": None if verdict is None else verdict.outcome,
        "p_value": None if verdict is None else verdict.p_value,
        "resolution_kind": resolution and resolution.kind,
        "resolution": resolution and resolution.value,
        "resolution_miss": resolution and resolution.miss,
        "samples": None if verdict is None else verdict.samples,
        "seed": run.seed if verdict is None else verdict.seed,
        "cause": None if verdict is None else verdict.cause,
        "rejected_by": "; ".join(rejecting),
        "twin_outcome": twin and twin.outcome,
        "twin_rejected_by": twin and "; ".join(twin.checks),
        "twin_p_value": twin and twin.p_value,
        "twin_samples": twin and twin.samples,
        "terms": plan and "; ".join(term.name for term in plan.terms if term.kept),
        "solver": plan and plan.solver,
        "estimator": plan and plan.estimator,
    }
    return {name: values[name] if name in values else getattr(case, name) for name in COLUMNS}
