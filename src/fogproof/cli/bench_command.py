"""`fogproof bench`."""

from __future__ import annotations

import datetime
import json
import time
from pathlib import Path
from typing import Any

import click

from fogproof.cli.force import FORCE, take
from fogproof.cli.signals import interruptible
from fogproof.cli.terminal import say
from fogproof.cli.values import FOLDER, SECONDS_OR_NONE


@click.command("bench")
@click.argument("names", nargs=-1, metavar="[BENCHMARK]...")
@click.option(
    "-o",
    "--output",
    "folder",
    metavar="DIR",
    type=FOLDER,
    help="Write bench.json, bench.md and figures here, and add to bench.jsonl, the history.",
)
@click.option(
    "--seconds",
    type=SECONDS_OR_NONE,
    default=8.0,
    show_default=True,
    help="For each benchmark, by the clock.",
)
@FORCE
@click.option("--json", "as_json", is_flag=True, help="Print the record as JSON instead of the table.")
def command(names: tuple[str, ...], folder: Path | None, seconds: float, force: bool, as_json: bool) -> int:
    """Measure speed against error: every way to a number in turn, as ratios of the processor's time.

    BENCHMARK is a name or a glob; without any, all are measured. A ratio is that of a way to the
    first of its benchmark. Goals that are not met end nothing: times depend on the machine.

    \b
    Example:  fogproof bench 'airlight*' -o build/bench
    """
    from fogproof.bench import select
    from fogproof.bench.measuring import WayTime, measure, missing, table
    from fogproof.bench.record import changes, history, run_record, write_record

    chosen = select(names)
    earlier: list[dict[str, Any]] = []
    if folder is not None:
        take(folder, ("bench.json", "bench.md"), force)
        earlier, damaged = history(folder)
        if damaged:
            say(f"{damaged} damaged lines of {folder / 'bench.jsonl'} are left out", err=True)
    started, clock = datetime.datetime.now(datetime.UTC), time.perf_counter()
    rows: list[WayTime] = []
    asked = [benchmark.name for benchmark in chosen if not missing(benchmark)]
    with interruptible() as stop:
        for benchmark in chosen:
            if missing(benchmark):
                say(f"{benchmark.name}: skipped, {benchmark.needs} is not installed", err=True)
                continue
            found = measure(benchmark, seconds)
            rows += found
            if not as_json:
                say(table(found) if benchmark is chosen[0] else table(found).split("\n", 2)[2])
    if stop.code:
        reached = len({row.benchmark for row in rows})
        say(f"stopped after {reached} of {len(asked)} benchmarks; these are kept", err=True)
    spent = time.perf_counter() - clock
    record = run_record(rows, started.isoformat(timespec="seconds"), spent, asked, stop.code)
    if as_json:
        say(json.dumps(record))
    if folder is not None:
        for change in changes(rows, earlier[-1]) if earlier else ():
            say(f"changed since {earlier[-1]['started']}: {change}", err=True)
        say(f"table: {write_record(record, rows, chosen, folder)}", err=True)
    judged = [row for row in rows if row.met is not None]
    say(f"{len(rows)} ways; {sum(bool(r.met) for r in judged)} of {len(judged)} goals met; {spent:.0f} s", err=True)
    return stop.code
