"""`fogproof oracle`."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator

import click

from fogproof.checks import jsonable
from fogproof.errors import InvalidInputError
from fogproof.oracle import answer_text, schema


@click.command("oracle")
@click.argument("request", metavar="REQUEST.json|-", required=False)
@click.option("--schema", "as_schema", is_flag=True, help="Print the JSON Schema of requests and answers instead.")
@click.option(
    "--rigorous", is_flag=True, help="Prove every answer by ball arithmetic (slow; needs the extra 'rigorous')."
)
def command(request: str | None, as_schema: bool, rigorous: bool) -> int:
    """Answer JSON requests with reference values and error bounds, one answer a line.

    REQUEST.json holds one JSON object, or one a line; '-' reads lines from stdin and answers each at once.

    \b
    Example:  echo '{"quantity": "phase_pdf", "phase": {"kind": "rayleigh"}, "mu": [-1, 0, 1]}' | fogproof oracle -
    """
    if as_schema:
        click.echo(json.dumps(schema(), indent=1))
        return 0
    if request is None:
        raise click.UsageError("give a REQUEST.json, '-' for lines on stdin, or --schema")
    bad = False
    for text in _requests(request):
        reply = jsonable(answer_text(text, rigorous))
        bad = bad or ("error" in reply and "value" not in reply)
        click.echo(json.dumps(reply))
        sys.stdout.flush()  # whoever writes one line and waits must get its answer
    return 2 if bad else 0


def _requests(source: str) -> Iterator[str]:
    if source == "-":
        yield from (line for line in sys.stdin if line.strip())
        return
    try:
        with open(source, encoding="utf-8") as file:
            text = file.read()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise InvalidInputError(f"cannot read the request file {source}: {reason}", source) from None
    try:
        json.loads(text)
    except (json.JSONDecodeError, RecursionError):
        lines = [line for line in text.splitlines() if line.strip()]
        # A file of JSON lines, or a single broken object: then its own fault is worth more than that of its first line.
        yield from lines if any(_is_json(line) for line in lines) else [text]
    else:
        yield text


def _is_json(line: str) -> bool:
    try:
        json.loads(line)
    except (json.JSONDecodeError, RecursionError):
        return False
    return True
