"""The page of one image's comparison, and of many."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fogproof.reports.charts.colours import diverging
from fogproof.reports.charts.pictures import Picture
from fogproof.reports.pages.templates import fill
from fogproof.whole_files import write_file

_HEADLINES = {
    "rejected": "The image is not the oracle's",
    "not rejected": "Nothing tells the image from the oracle's",
    "inconclusive": "The image cannot be judged",
}
_CAPTIONS = {
    "image": "the image",
    "reference": "what it should show",
    "z-map": "where it is off: red too bright, blue too dark, pale as chance has it",
}
_TONES = {"rejected": "bad", "not rejected": "good", "inconclusive": "care"}


def write_image_page(
    record: Mapping[str, Any],
    pictures: Mapping[str, bytes],
    folder: Path,
    *,
    reach: float,
    resolution: str = "",
    p_values: Picture | None = None,
) -> Path:
    """Write the page of a comparison from its record and pictures; return its path.

    reach       standard deviations at which the colours of the z-map end
    resolution  the smallest error that would have been caught, in words
    p_values    of tiles
    """
    verdict = record["verdict"]
    means = [f"{row['channel']} {row['ratio']:.5g} [{row['low']:.5g}, {row['high']:.5g}]" for row in record["ratios"]]
    about = [", ".join(record["images"]), *([f"mean / reference {', '.join(means)}"] if means else [])]
    page = fill(
        "image.html",
        kind="image",
        headline=(_HEADLINES[verdict["outcome"]], ": ".join(about)),
        tone=_TONES[verdict["outcome"]],
        record=record,
        pictures=[(name, _CAPTIONS[name], base64.b64encode(data).decode()) for name, data in pictures.items()],
        p_values=p_values,
        resolution=resolution,
        reach=f"{reach:g}",
        colours=[diverging(k / 10) for k in range(-10, 11)],
    )
    return write_file(folder / "index.html", page)


def write_renders_page(rows: Sequence[Mapping[str, Any]], renderer: str, folder: Path, title: str = "") -> Path:
    """Write the page of many scenes rendered by one renderer; return its path. `title` says how much of it there is yet, or ""."""
    counts: dict[str, int] = {}
    for row in rows:
        counts[row["outcome"]] = counts.get(row["outcome"], 0) + 1
    told = ", ".join(f"{count} {outcome}" for outcome, count in counts.items()) or "nothing yet"
    tone = "bad" if counts.get("rejected") or counts.get("error") else "care" if title else "good"
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
        tone="bad" if broken or errors else "care" if title else "good",
        rows=rows,
        broken=broken,
        scenes=list(dict.fromkeys(row["scene"] for row in rows)),
    )
    return write_file(folder / "index.html", page)
