"""Files from outside, read whole: whatever cannot be read is said before memory is taken for it, and nothing is waited for."""

from __future__ import annotations

import datetime
import json
import os
import stat
import tomllib
from collections.abc import Iterator
from io import BufferedReader
from pathlib import Path
from typing import Any

from fogproof.errors import InvalidInputError

TEXT = 2**26
"""The largest text that is read [bytes]: a scene, a study, a record, a file of cases."""

REQUESTS = 2**27
"""The most that is read of a file of requests [bytes]; from stdin there may be any number, a line at a time."""


def open_regular(path: str | Path, what: str, pipes: bool = False) -> BufferedReader:
    """Open a regular file to read, or raise an `InvalidInputError`: a device never ends, and a pipe may never begin.

    what   what the file is, for the message: "the grid"
    pipes  whether pipes are waited for and read as well, as a shell's <(command) is one
    """
    wait = 0 if pipes else getattr(os, "O_NONBLOCK", 0)
    try:
        file = open(os.open(path, os.O_RDONLY | wait | getattr(os, "O_BINARY", 0)), "rb")  # noqa: SIM115
    except (OSError, ValueError) as error:  # ValueError: a path with a zero byte
        reason = getattr(error, "strerror", None) or str(error)
        raise InvalidInputError(f"cannot read {what} {path}: {reason}", str(path)) from None
    mode = os.fstat(file.fileno()).st_mode
    if not stat.S_ISREG(mode) and not (pipes and stat.S_ISFIFO(mode)):
        file.close()
        kind = "a pipe" if stat.S_ISFIFO(mode) else "a device"
        raise InvalidInputError(f"cannot read {what} {path}: it must be a regular file, it is {kind}", str(path))
    return file


def read_requests(path: str | Path) -> bytes:
    """Return a file of requests, which may be a pipe, or raise an `InvalidInputError` that names it."""
    with open_regular(path, "the request file", pipes=True) as file:
        try:
            content = file.read(REQUESTS + 1)
        except OSError as error:
            raise InvalidInputError(
                f"cannot read the request file {path}: {error.strerror or error}", str(path)
            ) from None
    if len(content) > REQUESTS:
        what = f"it has more than {REQUESTS} bytes; split it, or let fogproof oracle - read it from stdin"
        raise InvalidInputError(f"cannot read the request file {path}: {what}", str(path))
    return content


def size_of(file: BufferedReader) -> int:
    """Return the size of an open file [bytes]."""
    return os.fstat(file.fileno()).st_size


class RepeatedKeyError(ValueError):
    """A JSON text has a key twice in one table; the message says which."""


def parse_json(text: str | bytes) -> Any:
    """Return the value of a JSON text; a ValueError (or RecursionError) where it is none, or has a key twice in one table."""
    return json.loads(text, object_pairs_hook=_unique)


def read_toml(path: str | Path, what: str) -> dict[str, Any]:
    """Return the table of a TOML file, or raise an `InvalidInputError` that names it: texts, numbers and truth values alone.

    what  what the file is, for the message: "the study file"
    """
    text = read_text(path, what)
    try:
        table = _parsed(text)
        dates = [(key, value) for key, value in _leaves(table) if isinstance(value, datetime.date | datetime.time)]
    except (ValueError, RecursionError) as error:
        raise InvalidInputError(f"{path} is not valid TOML: {error}", str(path)) from None
    for key, value in dates:
        fix = "is a date or a time, and no key takes one: put it in quotes"
        raise InvalidInputError(f"{path}: {key} = {value} {fix}", key)
    return table


def _parsed(text: str) -> dict[str, Any]:
    """Return the table of a TOML text; a ValueError (or RecursionError) where it is none, or has an integer beyond all numbers."""
    digits = ValueError("an integer has too many digits; write it as a float, 1e300")
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except ValueError:  # Python's bound on digits, whose words are for programmers
        raise digits from None
    if any(isinstance(value, int) and value.bit_length() > 1023 for _, value in _leaves(table)):
        raise digits
    return table


def _leaves(value: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Yield what is no table and no list, each under its key as messages have it: "ray.origin.0"."""
    if isinstance(value, dict | list):
        for name, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _leaves(item, f"{key}.{name}" if key else str(name))
    else:
        yield key, value


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table = dict(pairs)
    if len(table) < len(pairs):
        keys = [key for key, _ in pairs]
        raise RepeatedKeyError(
            f"the key {next(key for key in keys if keys.count(key) > 1)!r} stands twice in one table"
        )
    return table


def read_text(path: str | Path, what: str) -> str:
    """Return the UTF-8 text of a regular file of no more than `TEXT` bytes, or raise an `InvalidInputError` that names it.

    The mark that some editors begin UTF-8 with is no part of it.
    """
    with open_regular(path, what) as file:
        if size_of(file) > TEXT:
            size = f"it has {size_of(file)} bytes, more than {TEXT}"
            raise InvalidInputError(f"cannot read {what} {path}: {size}", str(path))
        try:
            return file.read(TEXT).decode("utf-8-sig").replace("\r\n", "\n")
        except OSError as error:
            raise InvalidInputError(f"cannot read {what} {path}: {error.strerror or error}", str(path)) from None
        except UnicodeDecodeError:
            raise InvalidInputError(f"cannot read {what} {path}: it is not UTF-8 text", str(path)) from None
