"""The page of one image's comparison, and of many."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fogproof.reports.files import write_file
from fogproof.reports.pages.templates import fill

_HEADLINES = {
    "rejected": "The image is not the oracle's",
    "not rejected": "Nothing tells the image from the oracle's",
    "inconclusive": "The image cannot be judged",
}
_CAPTIONS = {
    "image": "the image",
    "reference": "what it should show",
    "z-map": "where it is off: red too bright, blue too dark, full colour at 5 standard deviations",
    "p-values": "p-values of tiles; uniform where all is right",
}


def write_image_page(record: Mapping[str, Any], pictures: Mapping[str, bytes], folder: Path) -> Path:
    """Write the page of a comparison from its record and pictures; return its path."""
    verdict = record["verdict"]
    page = fill(
        "image.html",
        kind="image",
        headline=(_HEADLINES[verdict["outcome"]], ", ".join(record["images"])),
        tone=verdict["outcome"].replace(" ", "-"),
        record=record,
        pictures=[(name, _CAPTIONS[name], base64.b64encode(data).decode()) for name, data in pictures.items()],
    )
    return write_file(folder / "index.html", page)


def write_renders_page(rows: Sequence[Mapping[str, Any]], renderer: str, folder: Path, title: str = "") -> Path:
    """Write the page of many scenes rendered by one renderer; return its path. `title` says how much of it there is yet, or ""."""
    counts: dict[str, int] = {}
    for row in rows:
        counts[row["outcome"]] = counts.get(row["outcome"], 0) + 1
    told = ", ".join(f"{count} {outcome}" for outcome, count in counts.items()) or "nothing yet"
    tone = "rejected" if counts.get("rejected") or counts.get("error") else "care" if title else "not-rejected"
    first = f"{title or len(rows)} scenes by {renderer}"
    page = fill("renders.html", kind="renders", headline=(first, told), tone=tone, rows=rows)
    return write_file(folder / "index.html", page)


def write_relations_page(rows: Sequence[Mapping[str, Any]], renderer: str, folder: Path, title: str = "") -> Path:
    """Write the page of the relations that a renderer keeps and breaks, scene by scene; return its path.

    title  how much of it there is yet, "" if all
    """
    broken = [row for row in rows if row["outcome"] == "rejected"]
    errors = [row for row in rows if row["outcome"] == "error"]
    kept = sum(row["outcome"] == "not rejected" for row in rows)
    told = f"{len(broken)} broken, {kept} kept, {len(rows) - len(broken) - kept} that nothing is known of"
    page = fill(
        "relations.html",
        kind="relations",
        headline=(f"{title} relations of {renderer}" if title else f"Relations of {renderer}", told),
        tone="rejected" if broken or errors else "care" if title else "not-rejected",
        rows=rows,
        broken=broken,
        scenes=list(dict.fromkeys(row["scene"] for row in rows)),
    )
    return write_file(folder / "index.html", page)
