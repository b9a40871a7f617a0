"""Names beside the lines of a chart: cut where they are too wide, and told once where all share a folder."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile

from fogproof.reports.charts.sheet_png import text_width
from fogproof.reports.text import label

SIZE = 12.0
"""Of a name [px]."""


def shared_folder(names: Sequence[str]) -> str:
    """Return the folder that all names lie in, with its slash; "" if there is none, or one name alone."""
    folders = zip(*(name.split("/")[:-1] for name in names), strict=False)
    shared = takewhile(lambda parts: len(set(parts)) == 1, folders)
    return "".join(f"{parts[0]}/" for parts in shared) if len(names) > 1 else ""


def cut(text: str, width: float) -> str:
    """Return a text on one line, its middle left out if it is wider than `width` px."""
    text = label(text, max(int(width), 4))  # no letter is narrower than a pixel
    limit = max(len(text), 4)
    while limit > 4 and text_width(label(text, limit), SIZE) > width:
        limit -= 1
    return label(text, limit)
