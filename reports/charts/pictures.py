"""A figure becomes a PNG and an SVG file, and an SVG to stand inside a page that may be light or dark."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Protocol

import numpy as np

from fogproof.reports.charts.colours import ON_PAGE, PAPER
from fogproof.reports.charts.sheet import Sheet
from fogproof.reports.charts.sheet_png import png
from fogproof.reports.files import write_picture


class PictureChart(Protocol):
    """Data of one figure that draws itself; HOW tells how to read figures of its kind, "" where they speak for themselves."""

    HOW: ClassVar[str]

    def draw(self, sheet: Sheet) -> str:
        """Draw on an empty sheet and return what it shows in one sentence."""
        ...


@dataclass(frozen=True)
class Picture:
    """A finished figure: `stem` is its file name without suffix, `words` say what it shows, `how` how to read it."""

    stem: str
    words: str
    svg: str
    png: bytes
    how: str = ""

    def save(self, folder: Path) -> None:
        """Write `folder/STEM.svg` and `folder/STEM.png`."""
        write_picture(folder / f"{self.stem}.png", self.png)
        write_picture(folder / f"{self.stem}.svg", self.svg)

    @property
    def on_page(self) -> str:
        """The SVG to stand inside HTML: colours from the page's variables, ids its own, as wide as its column."""
        svg = self.svg[self.svg.index("<svg") :]
        svg = re.sub(r"<(metadata|style)\b.*?</\1>|<!--.*?-->", "", svg, flags=re.S)
        linked = set(re.findall(r'(?:url\(#|href="#)([^")]+)', svg))

        def on_page(tag: re.Match[str]) -> str:
            text = re.sub(r' id="([^"]+)"', lambda found: found[0] if found[1] in linked else "", tag[0])
            text = re.sub(r'(url\(#|href="#|id=")', rf"\g<1>{self.stem}-", text) if linked else text
            return re.sub("#[0-9a-f]{6}", lambda found: ON_PAGE.get(found[0], found[0]), text)

        svg = re.sub(r"<[^>]*>", on_page, svg)
        start, _, rest = svg.partition(">")
        kept = re.findall(r' (?:viewBox|font-family|font-size|fill)="[^"]*"', start)
        return f'<svg{"".join(kept)} aria-hidden="true">{rest}'


def render(chart: PictureChart, stem: str, size: tuple[float, float] = (560, 340)) -> Picture:
    """Draw on a new sheet of `size` [px] and return it as SVG and PNG; equal data give equal bytes."""
    sheet = Sheet(*size, PAPER)
    with np.errstate(all="ignore"):  # a record changed by hand may hold anything; what is not finite is not drawn
        words = chart.draw(sheet)
    return Picture(stem, words, sheet.svg(), png(sheet), chart.HOW)
