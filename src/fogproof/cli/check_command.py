"""`fogproof check`."""

from __future__ import annotations

import json

import click

from fogproof.checks.json_values import jsonable
from fogproof.cli.terminal import say, what_is_done
from fogproof.cli.values import NAMED, POSITIVE, PROBABILITY, SECONDS
from fogproof.pipe.check import Checked, Settings, check_file, check_program
from fogproof.pipe.process import Timeouts

_CODES = {"not rejected": 0, "rejected": 1, "inconclusive": 3}


@click.command("check")
@click.argument("file", required=False, metavar="[FILE]", type=NAMED)
@click.option("--exec", "program", metavar="COMMAND", help="The program and its arguments; no shell reads it.")
@click.option(
    "--spec", required=True, metavar="SPEC.toml", type=NAMED, help="What it is, and how to judge it; see docs/pipe.md."
)
@click.option("--samples", type=click.IntRange(min=100), help="Most samples; 1000000 by default, of a file all.")
@click.option(
    "--alpha", type=PROBABILITY, default=1e-6, show_default=True, help="False-alarm probability of this check."
)
@click.option("--seed", type=click.IntRange(min=0), help="A fresh one is drawn and printed by default.")
@click.option("--resolution", type=POSITIVE, help="The smallest error of interest: stop as soon as it would be seen.")
@click.option(
    "--start-timeout", type=SECONDS, default=Timeouts.start, show_default=True, help="Seconds to its greeting."
)
@click.option("--timeout", type=SECONDS, default=Timeouts.answer, show_default=True, help="Seconds to each answer.")
@click.option(
    "--end-timeout",
    type=SECONDS,
    default=Timeouts.end,
    show_default=True,
    help="Seconds from the end of its input to its own.",
)
@click.option("--json", "as_json", is_flag=True, help="Print the verdict as JSON.")
def command(
    file: str | None,
    program: str | None,
    spec: str,
    samples: int | None,
    alpha: float,
    seed: int | None,
    resolution: float | None,
    start_timeout: float,
    timeout: float,
    end_timeout: float,
    as_json: bool,
) -> int:
    """Judge somebody else's sampler or estimator: a program in any language, or a FILE of its samples.

    The program reads requests and answers on its standard input and output; docs/pipe.md is the protocol, on one page. FILE is
    .npy, .csv or .bin.

    \b
    Example:  fogproof check --exec "./my_sampler --g 0.8" --spec sampler.toml
    """
    if (file is None) == (program is None):
        raise click.UsageError("give either a FILE of samples or --exec COMMAND")
    settings = Settings(samples, resolution, alpha, seed)
    timeouts = Timeouts(start_timeout, timeout, end_timeout)
    with what_is_done():
        outcome = check_file(file, spec, settings) if file else check_program(str(program), spec, settings, timeouts)
    _tell(outcome, as_json)
    return _CODES[outcome.verdict.outcome]


def _tell(outcome: Checked, as_json: bool) -> None:
    verdict = outcome.verdict
    if as_json:
        say(json.dumps(jsonable({**verdict.to_dict(), "notes": outcome.notes, "stderr": outcome.said})))
    else:
        say(verdict)
    for note in outcome.notes:
        say(f"note: {note}", err=True)
    if outcome.said:
        say(f"it wrote to stderr: {outcome.said[:1000]}", err=True)
