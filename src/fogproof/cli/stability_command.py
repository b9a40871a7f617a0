"""`fogproof stability`."""

from __future__ import annotations

import datetime
import json
import shlex
import sys
import time
from pathlib import Path

import click

from fogproof.cli.force import FORCE, take
from fogproof.cli.signals import interruptible
from fogproof.cli.terminal import say
from fogproof.cli.values import FOLDER


@click.command("stability")
@click.argument("names", nargs=-1, metavar="[FORMULA]...")
@click.option(
    "-o",
    "--output",
    "folder",
    metavar="DIR",
    type=FOLDER,
    help="Write stability.html, stability.json and stability.csv here; a page of `verify` beside them gets a section.",
)
@click.option(
    "--short", "brief", is_flag=True, help="Fewer points, and no truth that takes long: seconds, not a minute."
)
@FORCE
@click.option("--json", "as_json", is_flag=True, help="Print the record as JSON instead of rows.")
def command(names: tuple[str, ...], folder: Path | None, brief: bool, force: bool, as_json: bool) -> int:
    """Measure formulas and samplers against 50-digit truth in regions where floating point fails.

    FORMULA is a name, a theme such as free_path, or a glob; without any, all are measured. Errors are in units in the last
    place beyond the condition number: 1 is what rounding every argument once may do to the value. Beside each formula of
    ours stand the forms that lectures and renderers print. Exit code 1: a bound is broken; 3: a naive form fails nowhere.

    \b
    Example:  fogproof stability phase 'free_path/*' -o build/stability
    """
    from fogproof.stability.exact import flint
    from fogproof.stability.measuring import POINTS, POINTS_SHORT, FormError, measure
    from fogproof.stability.record import exit_code, hidden, run_record, select, short

    chosen = short(select(names)) if brief else select(names)
    flint()  # says how to install it before anything else is done
    if folder is not None:
        take(folder, ("stability.html", "stability.json", "stability.csv"), force)
    started, clock = datetime.datetime.now(datetime.UTC), time.perf_counter()
    points = POINTS_SHORT if brief else POINTS
    measured: list[FormError] = []
    width = max(len(formula.name) for formula in chosen)
    if not as_json:
        say(f"{'formula':{width}}  {'form':28}  {'type':7}  {'region':26}  {'worst':>8}  {'bound':>6}  outcome")
    with interruptible() as stop:
        for formula in chosen:
            rows = measure(formula, points)
            measured += rows
            if not as_json:
                for row in rows:
                    say(_row(width, row))
    if stop.code:
        reached = len({row.formula for row in measured})
        say(f"stopped after {reached} of {len(chosen)} formulas; these are kept", err=True)
    seconds = time.perf_counter() - clock
    told = run_record(
        measured,
        command=shlex.join(["fogproof", *sys.argv[1:]]),
        started=started.isoformat(timespec="seconds"),
        seconds=seconds,
        points=points,
        asked=len(chosen),
        stopped=stop.code,
    )
    if as_json:
        say(json.dumps(told))
    if folder is not None:
        from fogproof.reports import write_stability

        say(f"report: {write_stability(told, folder)}", err=True)
    broken = [row for row in measured if row.form == "ours" and row.violations]
    for row in broken:
        what = row.reason or f"{row.value!r} instead of {row.truth} at {row.at}"
        say(
            f"{row.formula} in {row.region}, {row.precision}: {row.violations} of {row.points} points break the bound; {what}",
            err=True,
        )
    for name, form in hidden(measured):
        say(f"{name}: the naive form {form!r} fails in none of the regions", err=True)
    compared = sum(row.points for row in measured)
    done = f"{len({row.formula for row in measured})} of {len(chosen)} formulas"
    say(f"{done}, {compared} comparisons, {len(broken)} bounds broken, {seconds:.1f} s", err=True)
    return stop.code or exit_code(measured)


def _row(width: int, row: object) -> str:
    from fogproof.stability.measuring import OURS, FormError

    assert isinstance(row, FormError)
    bound = "stated" if row.bound is None and row.form == OURS else "" if row.bound is None else f"{row.bound:g}"
    if row.form == OURS:
        outcome = f"broken {row.violations} times" if row.violations else "kept"
        outcome += "" if row.share is None else f", {row.share:.2g} of the stated error"
    else:
        outcome = "fails" if row.visible else "holds here"
    numbers = f"{row.worst:>8.2g}  {bound:>6}"
    return f"{row.formula:{width}}  {row.form:28}  {row.precision:7}  {row.region:26}  {numbers}  {outcome}"
