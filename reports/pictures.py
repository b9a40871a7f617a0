"""A drawing becomes a PNG and an SVG file, and an SVG to stand inside a page that may be light or dark.

Colours are Okabe and Ito's (distinguishable in every common colour blindness, and by lightness in print). matplotlib is
loaded on first use and driven through `Figure` objects alone: no pyplot, no window system, no state left behind.
"""

from __future__ import annotations

import hashlib
import io
import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from fogproof.reports.files import write_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INK, GRID, PAPER = "#1b1f24", "#cfd6dd", "#fffffe"
EXPECTED, OBSERVED, THIRD = "#d55e00", "#0072b2", "#009e73"
_ON_PAGE = {
    INK: "var(--ink)",
    GRID: "var(--rule)",
    PAPER: "var(--paper)",
    EXPECTED: "var(--warm)",
    OBSERVED: "var(--cool)",
    THIRD: "var(--third)",
}

_STYLE: dict[str, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 11,
    "axes.titlesize": 11,
    "axes.labelcolor": INK,
    "axes.edgecolor": INK,
    "axes.facecolor": "none",
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "lines.linewidth": 1.8,
    "figure.facecolor": PAPER,
    "legend.frameon": False,
    "legend.fontsize": 10,
    "savefig.dpi": 144,
    "svg.fonttype": "none",
    "svg.image_inline": True,
    "text.parse_math": False,  # a dollar in a name is a dollar
}


class Drawing(Protocol):
    """Data of one figure that draws itself."""

    def draw(self, figure: Figure) -> str:
        """Draw on an empty figure and return what it shows in one sentence."""
        ...


@dataclass(frozen=True)
class Picture:
    """A finished figure: `stem` is its file name without suffix, `words` say what it shows; `png` may be empty."""

    stem: str
    words: str
    svg: str
    png: bytes

    def save(self, folder: Path) -> None:
        """Write `folder/STEM.svg` and, if there is one, `folder/STEM.png`."""
        if self.png:
            write_file(folder / f"{self.stem}.png", self.png)
        write_file(folder / f"{self.stem}.svg", self.svg)

    @property
    def on_page(self) -> str:
        """The SVG to stand inside HTML: colours from the page's variables, ids its own, as wide as its column."""
        svg = self.svg[self.svg.index("<svg") :]
        svg = re.sub(r"<(metadata|style)\b.*?</\1>|<!--.*?-->", "", svg, flags=re.S)
        linked = set(re.findall(r'(?:url\(#|href="#)([^)"]+)', svg))

        def on_page(tag: re.Match[str]) -> str:
            text = re.sub(r' id="([^"]+)"', lambda found: found[0] if found[1] in linked else "", tag[0])
            text = re.sub(r'(url\(#|href="#|id=")', rf"\g<1>{self.stem}-", text)
            return re.sub("#[0-9a-f]{6}", lambda found: _ON_PAGE.get(found[0], found[0]), text)

        svg = re.sub(r"<[^>]*>", on_page, svg)
        size = re.search(r'viewBox="[^"]*"', svg)
        assert size
        return re.sub(r"<svg[^>]*>", f'<svg {size[0]} aria-hidden="true">', svg, count=1)


def render(drawing: Drawing, stem: str, size: tuple[float, float] = (5.6, 3.4), png: bool = True) -> Picture:
    """Draw on a new figure of `size` [inch] and return it as SVG and, if wanted, PNG; equal data give equal bytes."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator

    salt = hashlib.blake2b(stem.encode(), digest_size=6).hexdigest()
    style: Any = {**_STYLE, "svg.hashsalt": salt}
    with matplotlib.rc_context(style), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # emoji in a name: the SVG has them, the PNG a box
        figure = Figure(figsize=size)
        FigureCanvasAgg(figure)
        words = drawing.draw(figure)
        for axes in figure.axes:  # minor ticks cost as much time as all the rest, and show nothing at half size
            axes.minorticks_off()
            for axis in (axes.xaxis, axes.yaxis):
                if axis.get_scale() == "log":
                    low, high = axis.get_view_interval()
                    if high < 100 * low:
                        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
                    axis.set_major_formatter("{x:g}")
        pixels, svg = io.BytesIO(), io.StringIO()
        if png:
            figure.savefig(pixels, format="png", metadata={"Software": None}, pil_kwargs={"compress_level": 4})
        figure.savefig(svg, format="svg", metadata={"Date": None, "Creator": None})
    return Picture(stem, words, svg.getvalue(), pixels.getvalue())
