"""The lines of the protocol, version 1: the program's greeting, a request, an answer. Each is one JSON object on one line."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, get_args

from fogproof.errors import shorten
from fogproof.input_files import RepeatedKeyError, parse_json
from fogproof.pipe.blocks import Type
from fogproof.pipe.faults import BROKEN, REFUSES
from fogproof.text import one_line

VERSION = 1
SAMPLER_COLUMNS = ("x", "pdf", "weight", "event", "valid")
ESTIMATOR_COLUMNS = ("value", "cost", "order", "stderr")
_ANSWERS = ("pdf", "eval")
EXAMPLE = '{"fogproof": 1, "type": "float64", "columns": ["x", "x", "x", "pdf"], "answers": ["pdf"]}'


class BrokenLineError(ValueError):
    """A line is not what was due; the message completes "the program ...\", `cause` is the class of the fault."""

    def __init__(self, message: str, cause: str = BROKEN) -> None:
        super().__init__(message)
        self.cause = cause


class AheadError(BrokenLineError):
    """A line announces the answer to the question before, which has one already."""


@dataclass(frozen=True)
class Greeting:
    """The program's first line: how it writes numbers, what stands in its columns, and which other questions it answers.

    type     "float64", "float32" (little-endian) or "text" (CSV)
    columns  of a sample: "x" for each coordinate, "pdf", "weight" for each channel, "event", "valid"; of an estimator:
             "value" for each channel, "cost", "order", "stderr"
    answers  "pdf", "eval" if it can be asked for them at any point
    """

    type: Type
    columns: tuple[str, ...]
    answers: tuple[str, ...] = ()

    @property
    def samples(self) -> bool:
        """Whether it is a sampler, not an estimator."""
        return "x" in self.columns

    def places(self, name: str) -> list[int]:
        """Return which columns have a name."""
        return [i for i, column in enumerate(self.columns) if column == name]


def read_greeting(line: bytes) -> Greeting:
    """Return the greeting, or raise `BrokenLineError`."""
    table = _object(line, "its greeting", EXAMPLE)
    version = table.get("fogproof")
    if version != VERSION or isinstance(version, bool):
        raise BrokenLineError(f"speaks version {shorten(version)} of the protocol; this is version {VERSION}")
    extra = sorted(set(table) - {"fogproof", "type", "columns", "answers"})
    if extra:
        raise BrokenLineError(f"greets with an unknown key {extra[0]!r}; known are fogproof, type, columns, answers")
    kind = table.get("type", "float64")
    if kind not in get_args(Type):
        raise BrokenLineError(f"greets with type {shorten(kind)}; known are {', '.join(get_args(Type))}")
    columns, answers = (_words(table, name) for name in ("columns", "answers"))
    known = SAMPLER_COLUMNS if "x" in columns else ESTIMATOR_COLUMNS
    if not columns or ("x" not in columns and "value" not in columns):
        got = f"its columns are {', '.join(columns)}" if columns else "it names no columns"
        raise BrokenLineError(f'greets without a column "x" (a sampler) or "value" (an estimator): {got}')
    for name in columns:
        if name not in known:
            raise BrokenLineError(
                f"greets with a column {name!r}; beside {known[0]!r} known are {', '.join(known[1:])}"
            )
        if name not in ("x", "weight", "value") and columns.count(name) > 1:
            raise BrokenLineError(f"greets with {columns.count(name)} columns {name!r}; there is one at most")
    for name in answers:
        if name not in _ANSWERS:
            raise BrokenLineError(f"greets with an answer {name!r}; known are {', '.join(_ANSWERS)}")
    return Greeting(kind, columns, answers)


def request_line(request: str, n: int, columns: int, seed: int, parameters: Mapping[str, float]) -> bytes:
    """Return the line before a block of n rows. Keys come in this order, with one space after each colon and comma."""
    table = {"fogproof": VERSION, "request": request, "n": n, "columns": columns, "seed": seed}
    return json.dumps({**table, "parameters": dict(parameters)}).encode() + b"\n"


def require_answer(line: bytes, n: int, before: int = 0) -> None:
    """Raise `BrokenLineError` unless a line announces n rows; the question before was for `before` rows."""
    table = _object(line, "the line before its rows", f'{{"n": {n}}}')
    if "error" in table:
        raise BrokenLineError(f"says: {one_line(str(table['error']))[:500]}", REFUSES)
    got = table.get("n")
    if "fogproof" in table and got is None:
        raise BrokenLineError("greets again where an answer was due, as after a new start: it greets once")
    if isinstance(got, bool) or got != n:
        told = f"announces {shorten(got)} rows where {n} were asked for"
        if got == before:
            raise AheadError(f"{told}, as many as before: it answers once too often, or always with so many")
        raise BrokenLineError(told)


def _object(line: bytes, what: str, example: str) -> dict[str, Any]:
    try:
        table = parse_json(line)
    except RepeatedKeyError as error:
        raise BrokenLineError(f"wrote {what}, in which {error}") from None
    except (ValueError, RecursionError):
        table = None
    if not isinstance(table, dict):
        shown = one_line(line[:80].decode("utf-8", "replace"))
        raise BrokenLineError(f"wrote {shown!r} where {what} was due, such as {example}")
    return table


def _words(table: dict[str, Any], name: str) -> tuple[str, ...]:
    value = table.get(name, [])
    if not isinstance(value, list) or len(value) > 64 or not all(isinstance(word, str) for word in value):
        raise BrokenLineError(f"greets with {name} {shorten(value)}; it is a list of at most 64 words")
    return tuple(value)
