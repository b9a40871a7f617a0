"""`fogproof study`."""

from __future__ import annotations

import json
import math
import shlex
import sys
from pathlib import Path
from typing import Any

import click

from fogproof.cli.force import FORCE, take
from fogproof.cli.signals import interruptible
from fogproof.cli.terminal import say
from fogproof.cli.unwritten import Unwritten
from fogproof.cli.values import FOLDER, PLACE
from fogproof.text import duration, marked, one_line, unbiased


@click.command("study")
@click.argument("study", metavar="STUDY.toml", type=PLACE)
@click.option(
    "-o",
    "--output",
    "folder",
    required=True,
    metavar="DIR",
    type=FOLDER,
    help="Run folder; the same one goes on where it stopped.",
)
@click.option(
    "--executor",
    default="threads",
    show_default=True,
    metavar="WHERE",
    help="threads, processes, or dask://host:port of a Dask scheduler; results do not depend on it. "
    "Estimators of your own are never drawn in threads: they may end the process.",
)
@click.option("--workers", type=click.IntRange(min=1), help="Threads or processes; one a core by default.")
@click.option(
    "--against",
    metavar="DIR",
    type=PLACE,
    help="Earlier run to compare with: what became slower, noisier or biased, beyond noise.",
)
@click.option("--salvage", is_flag=True, help="Put a damaged store aside and go on with what can be read of it.")
@FORCE
@click.option("--json", "as_json", is_flag=True, help="Print the record of the run as JSON instead of rows.")
def command(
    study: Path,
    folder: Path,
    executor: str,
    workers: int | None,
    against: Path | None,
    salvage: bool,
    force: bool,
    as_json: bool,
) -> int:
    """Measure speed against error, and judge bias and variance by the oracle.

    Results go into DIR batch by batch, and their page is DIR/index.html; started again, the study goes on where it was.

    \b
    Example:  fogproof study studies/lecture.toml -o runs/lecture
    """
    from fogproof.reports import REPORT, read_record, write_report
    from fogproof.study import read_study, run_study
    from fogproof.study.conduct import UnwrittenError
    from fogproof.study.trial import has_own

    called = shlex.join(["fogproof", *sys.argv[1:]])
    plan = read_study(study)
    if executor == "threads" and has_own(plan):
        executor = "processes"
    take(folder, REPORT, force)
    unwritten = Unwritten()
    with interruptible() as stop:
        try:
            record = run_study(
                plan,
                folder,
                executor=executor,
                workers=workers,
                against=against,
                salvage=salvage,
                command=called,
                tell=lambda words: say(f"fogproof: {words}", err=True),
            )
        except UnwrittenError as error:
            record = error.record
            unwritten.tell(str(error))
    if stop.code:
        if not (folder / "results.json").exists():
            say(f"fogproof: stopped before anything was drawn in this run; start again with: {called}", err=True)
            return stop.code
        page = write_report(read_record(folder), folder, keep=True)
        say(f"fogproof: stopped; what was drawn is kept, go on with: {called}\npage: {page}", err=True)
        return stop.code
    if as_json:
        say(json.dumps(record))
    else:
        _print_rows(record)
    _explain(record)
    history = record["history"]
    code = 1 if history and history["worse"] else record["exit_code"] or (3 if history and history["gone"] else 0)
    if not unwritten.reasons:
        with unwritten.noted():
            page = write_report(read_record(folder), folder, keep=True)
            say(f"\npage: {page}; seed {record['seed']}", err=True)
    return unwritten.code(code)


def _print_rows(record: dict[str, Any]) -> None:
    counts, became = record["settings"]["samples"], record["settings"]["sobol_samples"]
    if became and list(became) != list(counts):
        asked, made = (", ".join(map(str, numbers)) for numbers in (counts, became))
        say(f"Sobol points are balanced in powers of two alone: for {asked} there are {made} of them.\n")
    for scene in record["scenes"]:
        reference = scene["reference"]
        unit = "" if scene["unit"] == "1" else f" {scene['unit']}"
        say(f"{one_line(scene['name'])}: {scene['quantity']}, reference {reference['value']:.9g}{unit}")
        place = {name: k for k, name in enumerate([*scene["answer"]["ranking"], *scene["answer"]["unranked"]])}
        errors: list[dict[str, Any]] = next(
            (e["speed"]["targets"] for e in scene["estimators"] if e["speed"] and e["speed"]["targets"]), []
        )
        rows = [_cells(e, len(errors)) for e in sorted(scene["estimators"], key=lambda e: place[e["name"]])]
        head = ["estimator", "unbiased", "bias", "order", *(f"to {100 * t['error']:g} %" for t in errors), "speed"]
        widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
        for row in (head, *rows):
            first, *rest = (
                word.ljust(w) if k < 2 else word.rjust(w) for k, (word, w) in enumerate(zip(row, widths, strict=True))
            )
            say("  " + "  ".join([first, *rest]).rstrip())
        say("")
    if record["scenes"]:
        say(_MARKS)


_MARKS = """\
to 1 %: time of an estimate with a relative root mean square error, bias included, of 1 %; < where the first count is better
already, > where the last is not enough, ~ beyond the last count; * if unbiased: a bias of so much would not have been seen;
? if no values too rare to be met hold more of the error. speed: of that time, the soonest being 1."""


def _cells(estimator: dict[str, Any], targets: int) -> list[str]:
    speed, order = estimator["speed"], estimator["order"]
    checks = [finding["check"] for finding in estimator["findings"] if finding["outcome"] == "rejected"]
    wrong = "" if {"mean", "value", "random points"} & set(checks) else ", ".join(checks)
    answer = unbiased(estimator["status"], estimator["axis"] != "samples", estimator["unbiased_to"], wrong)
    bias = f"{estimator['bias']['value']:+.1e}" if estimator["bias"] else ""
    times = [_time(target) for target in speed["targets"]] if speed else []
    relative = _relative(speed["relative"]) if speed and speed["relative"] else ""
    words = [_name(estimator), answer, bias, f"{order['value']:.2f}" if order else ""]
    return [*words, *(times or [""] * targets), relative]


_LONGEST = 40
"""Characters of a title in a row."""


def _name(estimator: dict[str, Any]) -> str:
    """Return the name of a row, with the title that sentences call it by where somebody else wrote that."""
    name, label = one_line(estimator["name"]), one_line(estimator["label"])
    short = label if len(label) <= _LONGEST else f"{label[: _LONGEST - 1]}…"
    return f"{name} “{short}”" if ":" in estimator["kind"] and label != name else name


def _relative(speed: dict[str, Any]) -> str:
    low, high = float(speed["low"]), float(speed["high"])
    if low > 0 and math.isfinite(high):
        return f"{speed['value']:.3g}"
    return f"< {high:.3g}" if math.isfinite(high) else f"> {low:.3g}" if low > 0 else ""


def _time(target: dict[str, Any]) -> str:
    if target["how"] in ("never", "rises"):
        return str(target["how"])
    if target["seconds"] is None:
        return f"> {duration(target['low'])}"
    return marked(duration(target["seconds"]), target["how"], target["unless"])


def _explain(record: dict[str, Any]) -> None:
    """Say on stderr what was found, in the study's order, and nothing twice."""
    asked = ""
    for answer in record["answers"]:
        if answer["question"] != asked:
            say(f"\n{one_line(answer['question'])}", err=True)
        asked = answer["question"]
        say("\n    ".join([f"  {one_line(answer['scene'])}", *answer["text"].split("\n")]), err=True)
    for scene in record["scenes"]:
        for estimator in scene["estimators"]:
            place = one_line(f"{scene['name']} / {estimator['name']}")
            for finding in estimator["findings"] if estimator["status"] == "rejected" else ():
                if finding["outcome"] == "rejected":
                    say(f"\n{place}: rejected, {finding['check']}: {finding['message']}", err=True)
            if estimator["warning"] and estimator["points"] == "random":
                say(f"\n{place}: {estimator['warning']}", err=True)
    lost: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for failure in record["failures"]:
        lost.setdefault((failure["scene"], failure["estimator"]), []).append(failure)
    for (scene_name, name), failures in lost.items():
        first, more = max(failures, key=lambda failure: int(failure["attempts"])), len(failures) - 1
        place = one_line(f"{scene_name} / {name}")
        others = f", and {more} more of {place}" if more else ""
        what = f"batch {first['batch']} of {place} failed {first['attempts']} times: {first['error']}"
        say(f"\n{what}{others}", err=True)
    if record["advice"]:
        say(f"\n{record['advice']}", err=True)
    if record["mixed_environments"]:
        say("\nbatches of different versions or machines are mixed in this run, see 'sessions'", err=True)
    if record["history"]:
        say(f"\nagainst the earlier run: {record['history']['text']}", err=True)
