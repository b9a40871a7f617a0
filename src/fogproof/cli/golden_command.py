"""`fogproof golden`."""

from __future__ import annotations

import io
import math
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import click

from fogproof.cli.answer_timeout import answer_timeout
from fogproof.cli.terminal import requests_on_stdin
from fogproof.cli.values import FILE_OR_STDOUT, NAMED
from fogproof.errors import FogproofError, InvalidInputError, TooLargeError, shorten
from fogproof.golden import Entry, golden_entries, to_c, to_csv, to_json_document, to_npz
from fogproof.input_files import read_requests
from fogproof.oracle.limits import Limits
from fogproof.oracle.requests import read_request
from fogproof.oracle.service import BLANKS
from fogproof.reports.files import write_output

FORMATS: dict[str, Callable[..., str | bytes]] = {"json": to_json_document, "csv": to_csv, "c": to_c, "npz": to_npz}
_TOLD = 10  # bad lines


@click.command("golden")
@click.argument("quantities", nargs=-1, metavar="[QUANTITY]...")
@click.option("--format", "kind", type=click.Choice(list(FORMATS)), default="json", show_default=True)
@click.option(
    "--requests",
    metavar="FILE|-",
    type=NAMED,
    help="Lines of JSON as for `fogproof oracle`: the questions to be answered.",
)
@answer_timeout
@click.option("-o", "--output", metavar="FILE", type=FILE_OR_STDOUT, help="Where to write, stdout (-) unless given.")
def command(quantities: tuple[str, ...], kind: str, requests: str | None, timeout: float, output: Path | None) -> int:
    """Write reference values with error bounds and conventions, for test suites that run without fogproof.

    Without --requests these are the proven values of each QUANTITY, if there are any, and its example
    (`fogproof oracle --list` shows them).

    \b
    Example:  fogproof golden phase_pdf airlight_integral --format c -o golden.h
    """
    if not quantities and requests is None:
        raise click.UsageError("name a QUANTITY (`fogproof oracle --list` has them), or give --requests FILE")
    limits = Limits(seconds=timeout or math.inf)
    entries = golden_entries(quantities, limits=limits) if requests is None else _answered(requests, quantities, limits)
    content = FORMATS[kind](entries)
    raw = content.encode("utf-8") if isinstance(content, str) else content
    if output is None:
        sys.stdout.buffer.write(raw)
        sys.stdout.buffer.flush()
        return 0
    write_output(output, raw, *([requests] if requests is not None else []))
    return 0


def _answered(path: str, quantities: Sequence[str], limits: Limits) -> list[Entry]:
    """Return the answers to the requests of a file of JSON lines; all bad lines are told at once, of many the first ten."""
    entries = golden_entries(quantities, [], limits)  # none; an unknown quantity is no fault of a line
    bad: list[str] = []
    asked = False
    for number, line in enumerate(_lines(path), start=1):
        try:
            request = _request(line)
            if request is not None:
                asked = True
                entries += golden_entries(quantities, [request], limits)
        except FogproofError as error:
            bad.append(f"{path}, line {number}: {error}")
            if len(bad) == _TOLD or len(line) > Limits.bytes:  # what follows would be the rest of the same line
                break
    if bad:
        raise InvalidInputError("\n".join(bad), path)
    if not asked:
        raise InvalidInputError(f"{path} holds no request: write a JSON object a line", path)
    return entries


def _lines(path: str) -> Iterator[bytes]:
    lines = requests_on_stdin() if path == "-" else io.BytesIO(read_requests(path))
    return iter(partial(lines.readline, Limits.bytes + 1), b"")


def _request(line: bytes) -> dict[str, Any] | None:
    """Return the request of a line, None if it is empty; it may begin with a byte order mark, as those of joined files do."""
    if len(line) > Limits.bytes:
        raise TooLargeError(f"the line is longer than {Limits.bytes} bytes")
    try:
        text = line.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InvalidInputError("it is not UTF-8 text") from None
    if not text.strip(BLANKS.decode()):
        return None
    request = read_request(text)
    if not isinstance(request, dict):
        raise InvalidInputError(f"must be a JSON object, got {shorten(request)}")
    return request
