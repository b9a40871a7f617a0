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
    """Show the cases of the catalogue, of a file or of a package: what is checked, against what, and the planted error of its twin.

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
                "twin": case.twin.error if case.twin else "",
                "expected": case.expected,
                "needs": case.needs,
            }
            say(json.dumps(row))
        else:
            said = (
                case.title,
                f"reference {case.oracle}" * bool(case.oracle),
                f"twin: {case.twin.error}" if case.twin else "",
            )
            say(f"{case.name:{width}}  {'; '.join(filter(None, said))}".rstrip())
    return 0
