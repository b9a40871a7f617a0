"""The oracle as a process: lines in, one answer a line out, in order, whatever the lines are."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import BinaryIO

from fogproof.errors import FogproofError, InvalidInputError, TooLargeError
from fogproof.oracle.answers import failure, to_json
from fogproof.oracle.batches import Reply, answer_lines
from fogproof.oracle.limits import Limits

AT_ONCE = 512
"""Lines that are looked at together; more wait, so that the first answers do not."""

CHUNK = 1 << 18
"""Bytes read at a time, at most: a program that writes one line and waits is answered at once."""

BLANKS = b" \t\r\n"
"""What JSON takes for white space: a line of anything else is a request, if a bad one."""
PATIENCE = 0.05
"""Seconds that an answer may wait for others to leave with."""


def serve(read: Callable[[int], bytes], out: BinaryIO, rigorous: bool = False, limits: Limits | None = None) -> bool:
    """Answer every line until the input ends, blank ones apart; return whether all had an answer.

    read  returns up to that many bytes as soon as there are any, and none at the end
    out   takes the answers; flushed whenever no more are at hand
    """
    limits = limits or Limits()
    good, left = True, time.monotonic()
    for lines in _lines(read, limits.bytes):
        for start in range(0, len(lines), AT_ONCE):
            for reply in _replies(lines[start : start + AT_ONCE], rigorous, limits):
                good = good and reply.good
                out.write(reply.text.encode("ascii") + b"\n")
                if time.monotonic() > left + PATIENCE:
                    out.flush()
                    left = time.monotonic()
            out.flush()
    return good


def _replies(lines: list[bytes | None], rigorous: bool, limits: Limits) -> Iterator[Reply]:
    """Answer lines in order; None stands for one that was too long to be kept."""
    texts: list[str | FogproofError] = []
    for line in lines:
        if line is None:
            rule = f"the line is longer than {limits.bytes} bytes; split the request, or allow longer lines"
            texts.append(TooLargeError(rule))
            continue
        try:
            texts.append(line.decode("utf-8-sig"))  # files that were joined bring a mark each
        except UnicodeDecodeError as error:
            texts.append(InvalidInputError(f"request is not UTF-8 text: {error.reason} at byte {error.start}"))
    answers = answer_lines([text for text in texts if isinstance(text, str)], rigorous, limits)
    for text in texts:
        yield next(answers) if isinstance(text, str) else Reply(to_json(failure(text)), False)


def _lines(read: Callable[[int], bytes], longest: int) -> Iterator[list[bytes | None]]:
    """Yield the lines that have arrived, as soon as any has; None for one that is too long, before it has come to its end."""
    kept: list[bytes] = []
    size, first, lost = 0, True, False
    while True:
        chunk = read(CHUNK)
        if first:
            chunk, first = chunk.removeprefix(b"\xef\xbb\xbf"), False
        *complete, rest = chunk.split(b"\n")
        found: list[bytes | None] = []
        for part in complete if chunk else [b""]:
            if lost:
                lost = False
                continue
            kept.append(part)
            size += len(part)
            line = b"".join(kept) if size <= longest else None
            if line is None or line.strip(BLANKS):
                found.append(line)
            kept, size = [], 0
        if not lost:
            size, kept = size + len(rest), [*kept, rest]
            if size > longest:
                found.append(None)
                kept, size, lost = [], 0, True
        if found:
            yield found
        if not chunk:
            return
