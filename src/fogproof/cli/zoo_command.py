"""`fogproof zoo`."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Any

import click

from fogproof.checks import fresh_seed
from fogproof.cli.force import FORCE, take
from fogproof.cli.signals import interruptible
from fogproof.cli.terminal import say
from fogproof.cli.values import FOLDER, PROBABILITY


@click.command("zoo")
@click.argument("bugs", nargs=-1, metavar="[BUG]...")
@click.option(
    "-o",
    "--output",
    "folder",
    metavar="DIR",
    type=FOLDER,
    help="Keep the rows in DIR/zoo.jsonl, where a stopped run goes on, and write DIR/zoo.md.",
)
@click.option(
    "--samples", type=click.IntRange(min=1000), default=1_000_000, show_default=True, help="Most of one check."
)
@click.option(
    "--alpha", type=PROBABILITY, default=1e-6, show_default=True, help="False-alarm probability of one check."
)
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    help="Seed of the run; by default that of the rows in DIR, or a fresh one, which is printed.",
)
@click.option("--workers", type=click.IntRange(min=1), default=2, show_default=True, help="Threads.")
@click.option("--others", is_flag=True, help="Put other tests of the field to the same subjects.")
@click.option(
    "--one-in",
    type=click.IntRange(min=1),
    default=10,
    show_default=True,
    help="Of outsiders, mutants and right ones: how many are run.",
)
@FORCE
@click.option("--json", "as_json", is_flag=True, help="Print rows as lines of JSON.")
def command(
    bugs: tuple[str, ...],
    folder: Path | None,
    samples: int,
    alpha: float,
    seed: int | None,
    workers: int,
    others: bool,
    one_in: int,
    force: bool,
    as_json: bool,
) -> int:
    """Run known bugs against the checks: which are killed, by what, with how many samples, and is the cause named rightly?

    BUG is a name, a folder of names, or a glob: field (bugs that shipped), errata (misprints of the literature), families (errors
    in a corner of the parameters), outsiders (three errors in samplers as others have them), mutants (errors planted in every case
    of the catalogue), right (subjects without any error). All by default; of the last three folders, which are thousands of
    checks, one in ten. Ends with 1 if a folder's goal is not met.

    \b
    Example:  fogproof zoo field errata -o build/zoo
    """
    from fogproof.zoo import bugs_of, select
    from fogproof.zoo.matrix import counts, line, summary
    from fogproof.zoo.running import ZooLog, run_zoo

    if folder is not None:  # before thousands of mutants are made
        take(folder, ("zoo.md",), force)
    chosen = select(bugs, one_in)
    log, rows = None, []
    if folder is not None:
        settings: dict[str, Any] = {"samples": samples, "alpha": alpha, "others": others}
        path = folder / "zoo.jsonl"
        if seed is None:
            seed = ZooLog(path, settings).seed()
        seed = fresh_seed() if seed is None else seed
        log = ZooLog(path, settings | {"seed": seed})
        names = {bug.name for bug in chosen}
        found, damaged = log.read()
        rows = [row for row in found if row.name in names]
        if damaged:
            say(f"{damaged} damaged lines of {log.path} are left out; what stood there is run again", err=True)
    seed = fresh_seed() if seed is None else seed
    width = max(len(bug.name) for bug in chosen)
    judge = None
    if others:
        from fogproof.zoo.others import p_values

        judge = p_values
    with interruptible() as stop:
        for row in run_zoo(chosen, samples=samples, alpha=alpha, seed=seed, workers=workers, others=judge, known=rows):
            rows.append(row)
            if log is not None:
                log.add(row)
            say(json.dumps(asdict(row)) if as_json else line(row, width))
    if stop.code:
        say(f"stopped after {len(rows)} of {len(chosen)} bugs; these are kept", err=True)
    order = {bug.name: i for i, bug in enumerate(chosen)}
    rows.sort(key=lambda row: order[row.name])
    if folder is not None:
        from fogproof.whole_files import write_file
        from fogproof.zoo.comparison import page

        sizes = {name: len(bugs_of(name)) for name in {bug.folder for bug in chosen}}
        write_file(folder / "zoo.md", page(rows, samples, alpha, sizes, len(chosen)))
    asked = Counter(bug.folder for bug in chosen)
    say(summary(rows, asked), err=True)
    say(f"{len(rows)} of {len(chosen)} run; seed {seed}", err=True)
    return stop.code or int(not all(count.good for count in counts(rows)))
