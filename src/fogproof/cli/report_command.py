"""`fogproof report`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from fogproof.cli.force import FORCE, take
from fogproof.cli.terminal import say
from fogproof.cli.values import PLACE
from fogproof.errors import FogproofError, InvalidInputError
from fogproof.text import one_line

_TOLD = 8


@click.command("report")
@click.argument("folder", metavar="DIR", type=PLACE)
@click.option(
    "--against",
    "older",
    metavar="OLD",
    type=PLACE,
    help="Compare with an older run's folder as well: what came out worse, what was mended.",
)
@FORCE
def command(folder: Path, older: Path | None, force: bool) -> int:
    """Make the page of a run again from the results.json in DIR, and print its path.

    With --against, print the path of DIR/comparison.html instead; its exit code is 1 if something came out worse, 3 if
    nothing did but cases are gone. Without, it is 1 if the run was interrupted and had rejected something: no other command
    may have told so.

    \b
    Examples:  fogproof report build/report
               fogproof report build/report --against last-week
    """
    from fogproof.reports import (
        COMPARISON,
        REPORT,
        compare_exit_code,
        read_record,
        write_comparison,
        write_report,
    )

    record = read_record(folder)
    before = read_record(older) if older else None
    try:
        if before is not None and before.get("kind") == record.get("kind") == "study":
            from fogproof.study.history import compare

            record["history"] = compare(before, record)
        rejected = _rejected(record)
        code = int(bool(rejected)) if before is None else compare_exit_code(before, record)
        take(folder, REPORT if before is None else (*REPORT, *COMPARISON), force)
        page = write_report(record, folder, keep=True)
        if before is not None:
            page = write_comparison(before, record, folder)
    except (FogproofError, OSError):
        raise
    except Exception as error:  # whatever somebody made of a record that has passed its schema
        what = f"{type(error).__name__}: {error}"
        where = " and ".join(str(path / "results.json") for path in filter(None, (folder, older)))
        raise InvalidInputError(f"no page can be made of {where}, as if changed by hand: {what}", str(folder)) from None
    say(str(page))
    if rejected and before is None:
        more = f" and {len(rejected) - _TOLD} others" if len(rejected) > _TOLD else ""
        say(f"the run was interrupted, and had rejected {', '.join(map(one_line, rejected[:_TOLD]))}{more}", err=True)
    return code


def _rejected(record: dict[str, Any]) -> list[str]:
    """Return what a run that was interrupted had rejected; of one that came to its end its own exit code has told."""
    cases = record.get("cases", ()) if record.get("state") == "interrupted" else ()
    return [case["name"] for case in cases if case.get("status") == "rejected"]
