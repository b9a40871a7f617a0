"""`fogproof golden`."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from fogproof.cli.terminal import requests_on_stdin
from fogproof.errors import FogproofError, InvalidInputError
from fogproof.golden import golden_entries, to_c, to_csv, to_json_document, to_npz
from fogproof.input_files import read_requests
from fogproof.oracle.requests import read_request

FORMATS: dict[str, Callable[..., str | bytes]] = {"json": to_json_document, "csv": to_csv, "c": to_c, "npz": to_npz}


@click.command("golden")
@click.argument("quantities", nargs=-1, metavar="[QUANTITY]...")
@click.option("--format", "kind", type=click.Choice(list(FORMATS)), default="json", show_default=True)
@click.option(
    "--requests", metavar="FILE|-", help="Lines of JSON as for `fogproof oracle`: the questions to be answered."
)
@click.option("-o", "--output", metavar="FILE", help="Where to write, stdout unless given.")
def command(quantities: tuple[str, ...], kind: str, requests: str | None, output: str | None) -> int:
    """Write reference values with error bounds and conventions, for test suites that run without fogproof.

    Without --requests these are the proven values of each QUANTITY, if there are any, and its example
    (`fogproof oracle --list` shows them).

    \b
    Example:  fogproof golden phase_pdf airlight_integral --format c -o golden.h
    """
    if not quantities and requests is None:
        raise click.UsageError("name a QUANTITY (`fogproof oracle --list` has them), or give --requests FILE")
    content = FORMATS[kind](golden_entries(quantities, None if requests is None else _read(requests)))
    raw = content.encode("utf-8") if isinstance(content, str) else content
    if output is None:
        sys.stdout.buffer.write(raw)
        sys.stdout.buffer.flush()
        return 0
    try:
        Path(output).write_bytes(raw)
    except OSError as error:
        raise InvalidInputError(f"cannot write {output}: {error.strerror}", output) from None
    return 0


def _read(path: str) -> list[dict[str, Any]]:
    """Return the requests of a file of JSON lines; a bad one is named with its line."""
    try:
        content = requests_on_stdin().read() if path == "-" else read_requests(path)
        lines = content.decode("utf-8-sig").split("\n")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise InvalidInputError(f"cannot read the request file {path}: {reason}", path) from None
    found = []
    for number, line in enumerate(lines, start=1):
        if not line.strip():
            continue
        try:
            request = read_request(line)
        except FogproofError as error:
            raise InvalidInputError(f"{path}, line {number}: {error}", path) from None
        if not isinstance(request, dict):
            raise InvalidInputError(f"{path}, line {number}: must be a JSON object", path)
        found.append(request)
    return found
