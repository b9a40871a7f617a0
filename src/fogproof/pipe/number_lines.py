"""Rows of numbers in lines of text: read strictly, and where another language's habit is plain the fix is told."""

from __future__ import annotations

import re

_HABITS = (
    (rb"\d[dDqQ][-+]?\d", "an exponent is written with e: 1.5e-3"),
    (rb"#(INF|IND|QNAN|SNAN)|nan\(", "numbers that are none are written inf, -inf and nan"),
    (rb"\d_", "digits are not grouped"),
    (rb"0[xX][0-9a-fA-F]", "numbers are decimal"),
    (rb"\d\s*[;\t]\s*[-+\d.]", "numbers are separated by commas"),
    (rb"\d +[-+\d.]", "numbers are separated by commas"),
    (rb"[\[\]()\"']", "numbers stand without brackets or quotes"),
)
_DECIMAL_COMMA = rb"\s*[-+]?\d+,\d+([eE][-+]?\d+)?\s*"


def numbers_of(cells: list[bytes], count: int) -> list[float]:
    """Return the numbers of one row, or raise `ValueError`; digits in groups, 1_000, are none, though Python reads them."""
    if len(cells) != count:
        raise ValueError
    row = [float(cell) for cell in cells]
    if any(b"_" in cell for cell in cells):
        raise ValueError
    return row


def habit(line: bytes, count: int, separator: bytes | None = b",", points: bool = False) -> str:
    """Return in words what another way of printing numbers is to be changed into, "" if the line shows none.

    points  whether there are decimal points around: then a comma is none, and a row such as 1,2 has a number too many
    """
    whole = line.split(separator)
    halves = len(whole) == 2 * count and all(cell.strip().lstrip(b"-+").isdigit() for cell in whole[::2])
    commas = (halves and separator == b",") or any(re.fullmatch(_DECIMAL_COMMA, cell) for cell in whole)
    if commas and not points:
        return "; the decimal mark is a point: set the locale to C"
    return next((f"; {fix}" for pattern, fix in _HABITS if re.search(pattern, line)), "")
