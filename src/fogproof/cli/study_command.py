"""`fogproof study`."""

from __future__ import annotations

import json
import shlex
import sys
from pathlib import Path
from typing import Any

import click

from fogproof.cli.signals import code_of, stoppable
from fogproof.cli.terminal import say
from fogproof.text import one_line


@click.command("study")
@click.argument("study", metavar="STUDY.toml", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    "folder",
    required=True,
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Run folder; the same one goes on where it stopped.",
)
@click.option(
    "--executor",
    default="threads",
    show_default=True,
    metavar="WHERE",
    help="threads, processes, or dask://host:port of a Dask scheduler; results do not depend on it.",
)
@click.option("--workers", type=click.IntRange(min=1), help="Threads or processes; one a core by default.")
@click.option(
    "--against",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Earlier run to compare with: what became slower, noisier or biased, beyond noise.",
)
@click.option("--salvage", is_flag=True, help="Put a damaged store aside and go on with what can be read of it.")
@click.option("--json", "as_json", is_flag=True, help="Print the record of the run as JSON instead of rows.")
def command(
    study: Path, folder: Path, executor: str, workers: int | None, against: Path | None, salvage: bool, as_json: bool
) -> int:
    """Measure speed against error, and judge bias and variance by the oracle.

    Results go into DIR batch by batch; started again, the study goes on where it was.

    \b
    Example:  fogproof study studies/lecture.toml -o runs/lecture
    """
    from fogproof.study import read_study, run_study

    called = shlex.join(["fogproof", *sys.argv[1:]])
    plan = read_study(study)
    try:
        with stoppable():
            record = run_study(
                plan, folder, executor=executor, workers=workers, against=against, salvage=salvage, command=called
            )
    except KeyboardInterrupt as stop:
        say(f"fogproof: stopped; what was drawn is kept, go on with: {called}", err=True)
        return code_of(stop)
    if as_json:
        say(json.dumps(record))
    else:
        _print_rows(record)
    _explain(record, folder)
    history = record["history"]
    return 1 if history and history["worse"] else record["exit_code"]


def _print_rows(record: dict[str, Any]) -> None:
    for scene in record["scenes"]:
        reference = scene["reference"]
        unit = "" if scene["unit"] == "1" else f" {scene['unit']}"
        say(f"{one_line(scene['name'])}: {scene['quantity']}, reference {reference['value']:.9g}{unit}")
        width = max(len(e["name"]) for e in scene["estimators"])
        head = ("outcome", "bias", "slope", "time each", "relative", "to 1 %", "0.1 %", "0.01 %")
        say(f"  {'estimator':{width}}  " + "  ".join(f"{word:>12}" for word in head))
        for estimator in scene["estimators"]:
            cells = "  ".join(f"{word:>12}" for word in _cells(estimator))
            say(f"  {estimator['name']:{width}}  {cells}")


def _cells(estimator: dict[str, Any]) -> list[str]:
    speed = estimator["speed"]
    status = estimator["status"] if estimator["status"] != "known" else "biased"
    if speed is None:
        return [status] + [""] * 7
    slope = estimator["slope"]["value"] if estimator["slope"] else None
    march = estimator["march"]
    if march and march["order"]:
        slope = -march["order"]["value"]
    targets = ["never" if t["seconds"] is None else f"{t['seconds']:.2g} s" for t in speed["targets"]]
    relative = speed["relative"]
    ratio = "" if relative is None else "exact" if relative["value"] == "inf" else f"{relative['value']:.3g}"
    bias = f"{estimator['bias']['value']:+.1e}"
    return [status, bias, "" if slope is None else f"{slope:.2f}", f"{speed['cpu']['value']:.2e} s", ratio, *targets]


def _explain(record: dict[str, Any], folder: Path) -> None:
    for answer in record["answers"]:
        say(f"\n{answer['question']}\n  {answer['scene']}: {answer['text']}", err=True)
    for scene in record["scenes"]:
        for estimator in scene["estimators"]:
            bad = [f for f in estimator["findings"] if f["outcome"] != "not rejected"]
            for finding in bad if estimator["status"] != "known" else ():
                place = one_line(f"{scene['name']} / {estimator['name']}")
                say(f"\n{place}: {finding['outcome']}, {finding['check']}: {finding['message']}", err=True)
            if estimator["warning"]:
                say(f"\n{scene['name']} / {estimator['name']}: {estimator['warning']}", err=True)
    for failure in record["failures"]:
        place = f"batch {failure['batch']} of {failure['scene']} / {failure['estimator']}"
        say(f"\n{place} failed {failure['attempts']} times: {failure['error']}", err=True)
    if record["mixed"]:
        say("\nbatches of different versions or machines are mixed in this run, see 'sessions'", err=True)
    if record["history"]:
        say(f"\nagainst the earlier run: {record['history']['text']}", err=True)
    say(f"\nresults: {folder / 'results.json'}; seed {record['seed']}", err=True)
