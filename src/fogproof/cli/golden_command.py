"""`fogproof golden`."""

from __future__ import annotations

import io
import math
import sys
from collections.abc import Callable
from functools import partial
from typing import Any

import click

from fogproof.cli.terminal import requests_on_stdin
from fogproof.cli.values import SECONDS_OR_NONE
from fogproof.errors import FogproofError, InvalidInputError, TooLargeError
from fogproof.golden import golden_entries, to_c, to_csv, to_json_document, to_npz
from fogproof.input_files import read_requests
from fogproof.oracle.limits import Limits
from fogproof.oracle.requests import read_request
from fogproof.reports.files import write_output

FORMATS: dict[str, Callable[..., str | bytes]] = {"json": to_json_document, "csv": to_csv, "c": to_c, "npz": to_npz}


@click.command("golden")
@click.argument("quantities", nargs=-1, metavar="[QUANTITY]...")
@click.option("--format", "kind", type=click.Choice(list(FORMATS)), default="json", show_default=True)
@click.option(
    "--requests", metavar="FILE|-", help="Lines of JSON as for `fogproof oracle`: the questions to be answered."
)
@click.option(
    "--timeout",
    type=SECONDS_OR_NONE,
    default=Limits.seconds,
    show_default=True,
    help="Seconds for one answer, 0 for no limit.",
)
@click.option("-o", "--output", metavar="FILE", help="Where to write, stdout unless given.")
def command(quantities: tuple[str, ...], kind: str, requests: str | None, timeout: float, output: str | None) -> int:
    """Write reference values with error bounds and conventions, for test suites that run without fogproof.

    Without --requests these are the proven values of each QUANTITY, if there are any, and its example
    (`fogproof oracle --list` shows them).

    \b
    Example:  fogproof golden phase_pdf airlight_integral --format c -o golden.h
    """
    if not quantities and requests is None:
        raise click.UsageError("name a QUANTITY (`fogproof oracle --list` has them), or give --requests FILE")
    limits = Limits(seconds=timeout or math.inf)
    content = FORMATS[kind](golden_entries(quantities, None if requests is None else _read(requests), limits))
    raw = content.encode("utf-8") if isinstance(content, str) else content
    if output is None:
        sys.stdout.buffer.write(raw)
        sys.stdout.buffer.flush()
        return 0
    write_output(output, raw, *([requests] if requests is not None else []))
    return 0


def _read(path: str) -> list[dict[str, Any]]:
    """Return the requests of a file of JSON lines; the first bad one is named, and nothing after it is waited for."""
    lines = requests_on_stdin() if path == "-" else io.BytesIO(read_requests(path))
    found = []
    for number, line in enumerate(iter(partial(lines.readline, Limits.bytes + 1), b""), start=1):
        try:
            if len(line) > Limits.bytes:
                raise TooLargeError(f"the line is longer than {Limits.bytes} bytes")
            text = line.decode("utf-8-sig" if number == 1 else "utf-8")
            if not text.strip():
                continue
            request = read_request(text)
        except UnicodeDecodeError:
            raise InvalidInputError(f"{path}, line {number}: it is not UTF-8 text", path) from None
        except FogproofError as error:
            raise InvalidInputError(f"{path}, line {number}: {error}", path) from None
        if not isinstance(request, dict):
            raise InvalidInputError(f"{path}, line {number}: must be a JSON object", path)
        found.append(request)
    return found
