"""`fogproof verify`."""

from __future__ import annotations

import datetime
import json
import shlex
import sys
import time
from pathlib import Path
from typing import Any

import click

from fogproof.checks import fresh_seed
from fogproof.checks.limits import UnstartedError
from fogproof.cli.force import FORCE, take
from fogproof.cli.signals import interruptible
from fogproof.cli.terminal import BAD_INPUT, say
from fogproof.cli.unwritten import Unwritten
from fogproof.cli.values import FOLDER, PROBABILITY, SECONDS
from fogproof.text import one_line, p_value
from fogproof.verify import ALPHA, Result, exit_code, record, reproduce, run, select, shares
from fogproof.verify.elsewhere import SEED, Elsewhere
from fogproof.verify.selection import require_listed
from fogproof.workers.executors import require_executor


@click.command("verify")
@click.argument("cases", nargs=-1, metavar="[CASE]...")
@click.option(
    "--report",
    "folder",
    type=FOLDER,
    help="Write the page, figures and results here.",
)
@click.option(
    "--seed", type=click.IntRange(min=0), help="Seed of the run; a fresh one is drawn and printed by default."
)
@click.option(
    "--alpha",
    type=PROBABILITY,
    default=ALPHA,
    show_default=True,
    help="False-alarm probability of the whole catalogue.",
)
@click.option(
    "--workers",
    type=click.IntRange(min=1),
    default=2,
    show_default=True,
    help="Threads, and processes of --executor processes; results do not depend on it.",
)
@click.option(
    "--executor",
    default="threads",
    show_default=True,
    metavar="WHERE",
    help="Who draws for samplers of more than four million samples: threads, processes, or dask://host:port of a Dask scheduler; "
    "results do not depend on it.",
)
@click.option("--keep", type=FOLDER, help="Keep the samples of those here: the same command goes on where it was.")
@click.option("--twins", is_flag=True, help="Run every broken twin as well: the same checks must reject it.")
@click.option(
    "--time-limit",
    type=SECONDS,
    metavar="SECONDS",
    help="Longest a case may take, and listing those of a file; one that takes longer is an error.",
)
@FORCE
@click.option("--json", "as_json", is_flag=True, help="Print the record of the run as JSON instead of rows.")
def command(
    cases: tuple[str, ...],
    folder: Path | None,
    seed: int | None,
    alpha: float,
    workers: int,
    executor: str,
    keep: Path | None,
    twins: bool,
    time_limit: float | None,
    force: bool,
    as_json: bool,
) -> int:
    """Check every sampler and estimator against its reference.

    CASE is a name, a folder of names, or a glob; without any, the whole catalogue runs. A path such as my_cases.py stands for a
    file of your own, whose function cases() returns SamplerCase and EstimatorCase of fogproof.catalogue; my_cases.py::name for
    some of it. Each case of it runs in a process of its own.

    \b
    Example:  fogproof verify directions 'mitsuba/hg*' --report build/report
    """
    if time_limit is not None:
        require_listed(cases, time_limit)
    chosen = select(cases)
    if folder is not None:
        from fogproof.reports import REPORT

        take(folder, REPORT, force)
    elsewhere = _elsewhere(executor, workers, keep)
    if elsewhere is not None:
        elsewhere.require(chosen)
        seed = elsewhere.seed(seed)
    seed = fresh_seed() if seed is None else seed
    started, clock = datetime.datetime.now(datetime.UTC), time.perf_counter()
    results: list[Result] = []
    unfinished, unwritten = 0, Unwritten()
    width = max(len(case.name) for case in chosen)
    if not as_json:
        say(_row(width, "case", "outcome", "smallest p", "resolution", "samples", "seconds"))
    with interruptible() as stop, _progress(len(chosen)) as advance:
        try:
            options: dict[str, Any] = {"twins": twins, "time_limit": time_limit, "elsewhere": elsewhere}
            for result in run(chosen, seed=seed, alpha=alpha, workers=workers, **options):
                results.append(result)
                if not as_json:
                    advance.print(_describe(width, result))
                advance(result.case.name)
        except UnstartedError as error:
            say(f"fogproof: {error.strerror}", err=True)
            unfinished = BAD_INPUT
    if stop.code or unfinished:
        say(f"stopped after {len(results)} of {len(chosen)} cases; these are kept", err=True)
    if unfinished and exit_code(results) == 1:  # no lack of processes hides it
        unfinished = 1
    _explain(results, seed, shares(chosen, alpha))
    if as_json or folder is not None:
        run_record = record(
            results,
            seed=seed,
            alpha=alpha,
            command=shlex.join(["fogproof", *sys.argv[1:]]),
            started=started.isoformat(timespec="seconds"),
            seconds=time.perf_counter() - clock,
            asked=chosen,
            stopped=stop.code or unfinished,
        )
        if as_json:
            say(json.dumps(run_record))
        if folder is not None:
            from fogproof.reports import write_report

            with unwritten.noted():
                say(f"report: {write_report(run_record, folder)}", err=True)
    return stop.code or unfinished or unwritten.code(exit_code(results))


def _elsewhere(executor: str, workers: int, keep: Path | None) -> Elsewhere | None:
    """Return who draws for samplers of many samples, None if each case does it alone."""
    require_executor(executor)
    if keep is None and executor == "threads":
        return None
    if keep is not None:
        take(keep, (SEED,))
    return Elsewhere(executor, workers, None if keep is None else str(keep.resolve()))


def _row(width: int, *cells: str) -> str:
    name, outcome, p, resolution, samples, seconds = cells
    return f"{name:{width}}  {outcome:12}  {p:>10}  {resolution:34}  {samples:>8}  {seconds:>7}".rstrip()


def _describe(width: int, result: Result) -> str:
    verdict = result.verdict
    if verdict is None:
        return _row(width, result.case.name, result.status, "", one_line(result.reason), "", f"{result.seconds:.2f}")
    rejecting = [finding for finding in verdict.findings if finding.outcome == "rejected"]
    smallest = (
        min((f.p_value for f in rejecting if f.p_value is not None), default=None) if rejecting else verdict.p_value
    )
    p = p_value(smallest, 2) if smallest is not None else "certain" if rejecting else ""
    resolution = "" if verdict.resolution is None else f"{verdict.resolution.value:.2g} {verdict.resolution.kind}"
    if rejecting:  # what did it, not what would have been seen besides
        more = f" and {len(rejecting) - 1} more" if len(rejecting) > 1 else ""
        resolution = f"by {rejecting[0].check}{more}" + (f"; likely {verdict.cause}" if verdict.cause else "")
    outcome = verdict.outcome if result.status in ("passed", "rejected", "inconclusive") else f"{result.status}"
    return _row(width, result.case.name, outcome, p, resolution, str(verdict.samples), f"{result.seconds:.2f}")


def _explain(results: list[Result], seed: int, parts: dict[str, float]) -> None:
    told: dict[str, list[Result]] = {}
    for result in results:
        if not result.good:
            told.setdefault(_sort(result), []).append(result)
    for sort, alike in told.items():
        for result in alike[:_TOLD]:
            again = reproduce(result.case, seed, parts[result.case.origin]) + (" --twins" if result.twin else "")
            for what in _faults(result):
                say(f"\n{result.case.name}: {what}\n  reproduce: {again}", err=True)
        if more := [one_line(result.case.name) for result in alike[_TOLD:]]:
            shown = ", ".join(more[:8]) + (f" and {len(more) - 8} others" if len(more) > 8 else "")
            say(f"\n{len(more)} more of the same sort ({sort}): {shown}", err=True)
    counts: dict[str, int] = {}
    for result in results:
        counts[result.status] = counts.get(result.status, 0) + 1
    summary = ", ".join(f"{count} {status}" for status, count in counts.items())
    twins = [result.twin for result in results if result.twin]
    rejected = sum(twin.outcome == "rejected" for twin in twins)
    caught = f"; {rejected} of {len(twins)} broken twins rejected" if twins else ""
    say(f"{len(results)} cases: {summary}{caught}; seed {seed}", err=True)


_TOLD = 2
"""Cases of one sort that are told in full: where one cause rejects many, the first are explanation enough."""


def _sort(result: Result) -> str:
    """Return what cases that came out wrong in the same way share: outcome and likely cause."""
    if result.verdict is None:
        return f"{result.status}: {one_line(result.reason)[:60]}"
    if result.good or result.status in ("passed", "known"):
        return "broken twin not rejected"
    return f"{result.status}, likely {result.verdict.cause}" if result.verdict.cause else result.status


def _faults(result: Result) -> list[str]:
    faults = []
    if result.status not in ("passed", "known", "skipped"):
        faults.append(result.reason if result.verdict is None else str(result.verdict))
    if result.twin and result.case.twin and result.twin.outcome != "rejected":
        what = f"its broken twin ({result.case.twin.error}) was not rejected: {result.twin.outcome}"
        faults.append(f"{what}; {result.twin.reason}" if result.twin.reason else what)
    return faults


class _Advance:
    """Moves the progress bar, and prints rows above it."""

    def __init__(self, bar: object | None, task: object) -> None:
        self._bar, self._task = bar, task

    def __call__(self, name: str) -> None:
        if self._bar is not None:
            self._bar.update(self._task, advance=1, description=name)  # type: ignore[attr-defined]

    def print(self, row: str) -> None:
        say(row)


class _progress:  # noqa: N801 - reads as a with-statement
    """A rich progress bar on stderr; nothing at all where stderr is not a terminal."""

    def __init__(self, total: int) -> None:
        self._total = total
        self._bar: object | None = None

    def __enter__(self) -> _Advance:
        if not sys.stderr.isatty():
            return _Advance(None, None)
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
        bar = Progress(*columns, console=Console(stderr=True), transient=True, redirect_stdout=True)
        bar.start()
        self._bar = bar
        return _Advance(bar, bar.add_task("starting", total=self._total))

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()  # type: ignore[attr-defined]
