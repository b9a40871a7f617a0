"""Names of findings that differ by the number of a channel, an order, a strategy alone."""

from __future__ import annotations

import re
from collections.abc import Iterable

_NUMBERED = re.compile(r"(.*\b(?:channel|order|strategy) )(\d+)")
_MANY = 3  # numbers in succession that are told as a range


def channels_aside(name: str) -> str:
    """Return the name without the number of its channel."""
    found = _NUMBERED.fullmatch(name)
    return found[1] if found else name


def in_ranges(names: Iterable[str]) -> list[str]:
    """Return the names, those that differ by successive numbers of a channel as one: "mean of channel 0 to 99"."""
    runs: list[tuple[str, list[int]]] = []
    for name in names:
        found = _NUMBERED.fullmatch(name)
        stem, numbers = (found[1], [int(found[2])]) if found else (name, [])
        if numbers and runs and runs[-1][0] == stem and runs[-1][1] and runs[-1][1][-1] + 1 == numbers[0]:
            runs[-1][1].append(numbers[0])
        else:
            runs.append((stem, numbers))
    told: list[str] = []
    for stem, numbers in runs:
        if len(numbers) >= _MANY:
            told.append(f"{stem}{numbers[0]} to {numbers[-1]}")
        else:
            told += [f"{stem}{number}" for number in numbers] or [stem]
    return told
