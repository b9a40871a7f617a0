"""Work in blocks that stay in the cache: temporaries of a whole large batch cost several times their arithmetic."""

from __future__ import annotations

from collections.abc import Iterator

BLOCK = 1 << 14
"""Samples a block. Twice as many were measured to cost three times as much: arrays above 128 kB are given back to the operating
system, and their pages are faulted in again at the next use."""

IN_PLACE = 1 << 15
"""Samples a block where nothing is allocated: half as many calls for the same work."""


def blocks(n: int, size: int = BLOCK) -> Iterator[slice]:
    """Yield slices that cover 0 … n in blocks."""
    for start in range(0, n, size):
        yield slice(start, min(start + size, n))
