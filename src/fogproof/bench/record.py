"""The record of a run: ratios and the machine as JSON, earlier runs beside it, the table and the figures."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from fogproof.bench.benchmark import Benchmark
from fogproof.bench.figure import TimeErrorPlane, drawable
from fogproof.bench.measuring import WayTime, machine, table
from fogproof.errors import InvalidInputError
from fogproof.input_files import read_text
from fogproof.journal import add_line, whole_lines
from fogproof.reports.gallery.plots import render_plot
from fogproof.text import state, unfinished
from fogproof.whole_files import write_file

SCHEMA = "fogproof/bench/1"
_PAGE = """\
# {title}

Written by `fogproof bench -o build/bench` (`make bench`) on {processor}, {cores} cores, load {load}, Python {python},
NumPy {numpy} with vectors of {vectors}. Every way of a benchmark runs once in a round, in turn, and times are the processor's; a
ratio is the median, over {rounds} rounds or more, of a way's time to that of the first way of its benchmark, with quartiles. Errors
are medians of relative ones. The front holds the ways that no other beats in both time and error. Estimators are compared by
variance x time.

On x86 NumPy takes logarithms, cosines and cube roots of binary64 several at a time with AVX-512 alone (`X86_V4`, `AVX512_…`).
Elsewhere they take several times as long beside uniforms, as `log1p` of `samplers` shows, and so do the samplers made of them.

{table}

{goals}
"""


def run_record(
    rows: Iterable[WayTime], started: str, seconds: float, asked: Iterable[str] = (), stopped: int = 0
) -> dict[str, Any]:
    """Return the record, ready for JSON.

    asked    names of the benchmarks that were to be measured; all that have a row by default
    stopped  the exit code of a run that was interrupted, 0 of one that came to its end
    """
    ways = [asdict(row) for row in rows]
    done = {way["benchmark"] for way in ways}
    return {
        "schema": SCHEMA,
        "started": started,
        "seconds": round(seconds, 1),
        "state": state(stopped),
        "title": unfinished(len(done), len(set(asked) | done), bool(stopped)),
        "machine": machine(),
        "ways": ways,
    }


def write_record(record: Mapping[str, Any], rows: list[WayTime], benchmarks: Iterable[Benchmark], folder: Path) -> Path:
    """Write bench.json, a line of bench.jsonl (the history), bench.md and figures; return the page's path."""
    write_file(folder / "bench.json", json.dumps(record, indent=1) + "\n")
    add_line(folder / "bench.jsonl", record)
    figures = folder / "figures"
    for benchmark in benchmarks:
        mine = tuple(row for row in rows if row.benchmark == benchmark.name)
        if drawable(mine):
            figures.mkdir(exist_ok=True)
            render_plot(TimeErrorPlane(benchmark.title, mine), f"speed-{benchmark.name}").save(figures)
    return write_file(folder / "bench.md", page(record, rows))


def page(record: Mapping[str, Any], rows: list[WayTime]) -> str:
    """Return the page as Markdown."""
    on = record["machine"]
    return _PAGE.format(
        processor=on["processor"],
        cores=on["cores"],
        load=f"{on['load'][0]:.1f}" if on["load"] else "unknown",
        python=on["python"],
        numpy=on["versions"]["numpy"],
        vectors=on["vectors"],
        rounds=min((row.rounds for row in rows), default=0),
        table=table(rows),
        title=f"{record['title']} benchmarks" if record["title"] else "Speed against error",
        goals=_goals(rows, record["title"]),
    )


def _goals(rows: list[WayTime], unfinished: str) -> str:
    missed = [f"{row.benchmark}, {row.way}" for row in rows if row.met is False]
    if missed:
        return f"Goals not met: {'; '.join(missed)}."
    if not any(row.met for row in rows):
        return "No goal was judged."
    return "Every goal that was judged is met." if unfinished else "Every goal is met."


def history(folder: Path) -> tuple[list[dict[str, Any]], int]:
    """Return the records of earlier runs in a folder, oldest first, and how many lines are damaged.

    A file that holds no record at all is somebody else's, and refused.
    """
    path = folder / "bench.jsonl"
    lines = whole_lines(read_text(path, "the history")) if path.exists() else []
    records = [record for line in lines if (record := _record(line)) is not None]
    if lines and not records:
        what = f"{path} holds no record of {SCHEMA}"
        raise InvalidInputError(f"{what}; choose another folder, or move the file away", str(path))
    return records, len(lines) - len(records)


def _record(line: str) -> dict[str, Any] | None:
    """Return the record that a line holds, None if it is none that could be compared with."""
    try:
        record: dict[str, Any] = json.loads(line)
        numbers = [way[key] for way in record["ways"] for key in ("ratio", "low", "high")]
        told = [record["started"], *(way[key] for way in record["ways"] for key in ("benchmark", "way"))]
    except (ValueError, RecursionError, TypeError, KeyError):
        return None
    whole = all(isinstance(number, int | float) for number in numbers) and all(isinstance(word, str) for word in told)
    return record if whole and record.get("schema") == SCHEMA else None


def changes(rows: Iterable[WayTime], before: Mapping[str, Any]) -> list[str]:
    """Return which ratios lie outside the quartiles of an earlier run, and theirs outside of these: what has changed."""
    old = {(way["benchmark"], way["way"]): way for way in before["ways"]}
    found = []
    for row in rows:
        was = old.get((row.benchmark, row.way))
        if was and (row.low > was["high"] or row.high < was["low"]):
            found.append(f"{row.benchmark}, {row.way}: {was['ratio']:.3g} -> {row.ratio:.3g}")
    return found
