"""Text from outside made safe to show: names, messages and the output of programs may hold anything."""

from __future__ import annotations

import textwrap
from typing import Any

_CONTROL_PICTURES = {code: 0x2400 + code for code in range(0x20) if chr(code) not in "\t\n"} | {0x7F: 0x2421}


def visible(text: str) -> str:
    """Return `text` with what no document may hold made visible: the result is valid in HTML 5, XML 1.0 and UTF-8.

    Control characters become their pictures (U+2400...), bidirectional overrides (which reorder the text around them),
    lone surrogates and non-characters become U+FFFD. Everything else, right-to-left scripts and emoji included, stays.
    """
    return "".join(_visible(c) for c in text) if not text.isascii() else text.translate(_CONTROL_PICTURES)


def one_line(text: str) -> str:
    """Return `text` on one line, safe as `visible` makes it."""
    return " ".join(visible(text).split())


def beginning(text: str, most: int = 200) -> str:
    """Return the first line of `text`, or as many whole words of it as have room.

    >>> beginning("could only read 3"), beginning("could only read 3", 15)
    ('could only read 3', 'could only ...')
    """
    return textwrap.shorten(visible(text).partition("\n")[0], most, placeholder=" ...")


def unfinished(done: int, asked: int, stopped: bool = False) -> str:
    """Return how much of what was asked for is there, "" if all of it is and nothing was stopped.

    >>> unfinished(2, 62), unfinished(62, 62)
    ('Unfinished: 2 of 62', '')
    """
    return f"Unfinished: {done} of {asked}" if done < asked or stopped else ""


def state(stopped: object) -> str:
    """Return what a record says of its run: "interrupted" if it was stopped, else "finished"."""
    return "interrupted" if stopped else "finished"


def p_value(p: float, digits: int = 3) -> str:
    """Return a p-value to so many digits; one that is too small for a float is none the less not 0.

    >>> p_value(0.0123456), p_value(0.0)
    ('0.0123', '< 1e-300')
    """
    return f"{p:.{digits}g}" if p > 0 else "< 1e-300"


_UNITS = (("d", 86_400.0), ("h", 3600.0), ("min", 60.0), ("s", 1.0), ("ms", 1e-3), ("µs", 1e-6))


def duration(seconds: float, space: str = " ") -> str:
    """Return a time with a unit that suits it.

    >>> duration(1490), duration(0.000082), duration(0.9999)
    ('24.8 min', '82 µs', '1 s')
    """
    rounded = float(f"{seconds:.3g}")
    unit, size = next((pair for pair in _UNITS if rounded >= pair[1]), ("ns", 1e-9))
    number = float(f"{seconds / size:.3g}")
    return f"{number:,.0f}{space}{unit}" if number >= 1000 else f"{number:g}{space}{unit}"


def share(part: float) -> str:
    """Return a share in per cent, with two digits.

    >>> share(0.0834), share(0.00034), share(1.234)
    ('8.3 %', '0.034 %', '120 %')
    """
    return f"{float(f'{100 * part:.2g}'):g} %"


def unbiased(status: str, exact: bool, seen: float | None, wrong: str) -> str:
    """Return whether an estimator of a study is unbiased.

    exact  whether nothing is random
    seen   the least bias that would have been seen, relative to the reference; None where nobody needs to know
    wrong  for what it was rejected, "" for a bias
    """
    words = {
        "passed": "exact" if exact else f"yes, to {share(seen)}" if seen else "yes",
        "known": "no, as declared",
        "rejected": f"rejected: {wrong}" if wrong else "no: rejected",
        "inconclusive": "not sure yet",
    }
    return words[status]


def marked(time: str, how: str, unless: str) -> str:
    """Return the time to an error with the marks of what it is.

    how     "<" less than that, "~" beyond the last count
    unless  "*" if unbiased, "?" if values too rare to be met hold no more of the error
    """
    return {"less-than": "< ", "extrapolated": "~ "}.get(how, "") + time + {"bias": " *", "rare": " ?"}.get(unless, "")


def spreadsheet_cell(value: Any) -> Any:
    """Return what stands in a cell of CSV: None is empty, and a text that a spreadsheet would take for a formula is none any more.

    Such a text begins with = + - @, a tabulator or the end of a line; it gets an apostrophe in front.
    """
    if not isinstance(value, str):
        return "" if value is None else value
    return (
        f"'{visible(value)}" if value.lstrip(" ").startswith(("=", "+", "-", "@", "\t", "\r", "\n")) else visible(value)
    )


def _visible(character: str) -> str:
    code = ord(character)
    if code in _CONTROL_PICTURES:
        return chr(_CONTROL_PICTURES[code])
    hidden = 0x80 <= code <= 0x9F or 0x202A <= code <= 0x202E or 0x2066 <= code <= 0x2069
    impossible = 0xD800 <= code <= 0xDFFF or 0xFDD0 <= code <= 0xFDEF or code & 0xFFFE == 0xFFFE
    return "\N{REPLACEMENT CHARACTER}" if hidden or impossible else character
