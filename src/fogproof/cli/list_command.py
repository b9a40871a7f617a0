"""`fogproof list`."""

from __future__ import annotations

import json

import click

from fogproof.cli.terminal import say
from fogproof.verify import select


@click.command("list")
@click.argument("cases", nargs=-1, metavar="[CASE]...")
@click.option("--json", "as_json", is_flag=True, help="Print JSON lines instead of a table.")
def command(cases: tuple[str, ...], as_json: bool) -> int:
    """Show the cases of the catalogue: what is checked, against what, and the planted error of its broken twin.

    \b
    Example:  fogproof list directions
    """
    chosen = select(cases)
    width = max(len(case.name) for case in chosen)
    for case in chosen:
        if as_json:
            row = {
                "name": case.name,
                "title": case.title,
                "kind": case.kind,
                "reference": case.oracle,
                "source": case.source,
                "twin": case.twin.error,
                "expected": case.expected,
                "needs": case.needs,
            }
            say(json.dumps(row))
        else:
            say(f"{case.name:{width}}  {case.title}; reference {case.oracle}; twin: {case.twin.error}")
    return 0
