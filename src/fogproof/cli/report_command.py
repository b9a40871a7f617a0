"""`fogproof report`."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("report")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
def command(folder: Path) -> int:
    """Make the page of a run again from the results.json in DIR.

    \b
    Example:  fogproof report build/report
    """
    from fogproof.reports import read_record, write_report

    click.echo(str(write_report(read_record(folder), folder)))
    return 0
