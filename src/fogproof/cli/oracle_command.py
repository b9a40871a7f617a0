"""`fogproof oracle`."""

from __future__ import annotations

import contextlib
import io
import json
import math
import os
import stat
import sys
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import click

from fogproof.cli.answer_timeout import answer_timeout
from fogproof.cli.terminal import requests_on_stdin, say
from fogproof.cli.values import FILE, NAMED
from fogproof.errors import InvalidInputError
from fogproof.input_files import read_requests
from fogproof.oracle import Limits, schema, serve
from fogproof.oracle.service import BLANKS
from fogproof.quantities import quantities


@click.command("oracle")
@click.argument("request", metavar="REQUEST.json|-|SCENE.toml", required=False, type=NAMED)
@click.option(
    "-o",
    "--output",
    type=FILE,
    help="Write the image of SCENE.toml here: .exr, .npy or .pfm.",
)
@click.option("--list", "as_list", is_flag=True, help="List the quantities with units, conventions and arguments.")
@click.option("--schema", "as_schema", is_flag=True, help="Print the JSON Schema of requests and answers instead.")
@click.option(
    "--rigorous", is_flag=True, help="Prove every answer by ball arithmetic (slow; needs the extra 'rigorous')."
)
@click.option("--max-values", default=Limits.values, show_default=True, help="Numbers in one answer, at most.")
@answer_timeout
@click.option("--max-bytes", default=Limits.bytes, show_default=True, help="Length of a request, at most.")
def command(
    request: str | None,
    output: Path | None,
    as_list: bool,
    as_schema: bool,
    rigorous: bool,
    max_values: int,
    timeout: float,
    max_bytes: int,
) -> int:
    """Answer JSON requests with reference values and error bounds, one answer a line.

    REQUEST.json holds one JSON object, or one a line; '-' reads lines from stdin and answers each at once. A line
    that cannot be answered gets an error with a code, and costs no other line its answer.

    SCENE.toml is a scene with a camera; -o writes its image, the mean radiance of each pixel, with its error as a layer.

    \b
    Example:  echo '{"quantity": "phase_pdf", "phase": {"kind": "rayleigh"}, "mu": [-1, 0, 1]}' | fogproof oracle -
    """
    if as_schema:
        click.echo(json.dumps(schema(), indent=1))
        return 0
    if as_list:
        for quantity in quantities().values():
            click.echo(json.dumps(quantity.to_dict(), ensure_ascii=False))
        return 0
    if request is None:
        raise click.UsageError("give a REQUEST.json, '-' for lines on stdin, --list or --schema")
    if output is not None:
        return _image(request, output)
    limits = Limits(values=max_values, seconds=timeout or math.inf, bytes=max_bytes)
    read = _stdin() if request == "-" else _file(request)
    return 0 if serve(read, sys.stdout.buffer, rigorous, limits) else 2


def _image(scene_file: str, output: Path) -> int:
    """Write the image of a scene."""
    from fogproof.analytic import image
    from fogproof.images.formats import format_of, layers
    from fogproof.reports.files import require_other
    from fogproof.scene.files import read_image_scene

    format_ = format_of(output)
    require_other(output, scene_file)
    found = image(read_image_scene(scene_file))
    channels = layers(found.value)
    if output.suffix.lower() == ".exr":
        channels |= {f"error.{name}": off for name, off in layers(found.error).items()}
    format_.write(output, channels)
    rows, columns = found.value.shape[:2]
    say(
        f"{output}: {columns} x {rows} pixels, mean {found.value.mean():.9g}, largest error {found.error.max():.2g}",
        err=True,
    )
    return 0


def _stdin() -> Callable[[int], bytes]:
    stdin = requests_on_stdin()
    if _answers_itself(stdin):
        raise InvalidInputError(
            "stdout is the file that stdin reads: answers would be questions; write to another", "-"
        )
    return stdin.read1 if isinstance(stdin, io.BufferedReader) else stdin.read


def _answers_itself(stdin: BinaryIO) -> bool:
    with contextlib.suppress(OSError, ValueError):  # one of them is no file
        read, written = os.fstat(stdin.fileno()), os.fstat(sys.stdout.fileno())
        return stat.S_ISREG(read.st_mode) and os.path.samestat(read, written)
    return False


def _file(path: str) -> Callable[[int], bytes]:
    """Return how to read a file: as it is if it holds lines of JSON, as one line if it holds one object on several."""
    content = read_requests(path)
    if not content.strip(BLANKS):
        raise InvalidInputError(f"{path} holds no request: write a JSON object, or one a line", path)
    if _is_json(content) or not any(map(_is_json, content.split(b"\n"))):
        content = content.replace(b"\n", b" ")
    return io.BytesIO(content).read1


def _is_json(line: bytes) -> bool:
    try:
        json.loads(line)
    except (ValueError, RecursionError):
        return False
    return True
