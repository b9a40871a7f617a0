"""Plots of the gallery, by matplotlib: polar axes, images, colour bars.

It is loaded on first use and driven through `Figure` objects alone: no pyplot, no window system, no state left behind.
"""

from __future__ import annotations

import hashlib
import io
from typing import TYPE_CHECKING, Any, Protocol

from fogproof.reports.charts.colours import GRID, INK, PAPER
from fogproof.reports.charts.pictures import Picture

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
    "text.parse_math": False,  # a dollar is a dollar
}


class Plot(Protocol):
    """A figure that draws itself."""

    def draw(self, figure: Figure) -> str:
        """Draw on an empty figure and return what it shows in one sentence."""
        ...


def render_plot(plot: Plot, stem: str, size: tuple[float, float] = (5.6, 3.4)) -> Picture:
    """Draw on a new figure of `size` [inch] and return it as SVG and PNG; equal data give equal bytes."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator

    salt = hashlib.blake2b(stem.encode(), digest_size=6).hexdigest()
    style: Any = {**_STYLE, "svg.hashsalt": salt}
    with matplotlib.rc_context(style):
        figure = Figure(figsize=size)
        FigureCanvasAgg(figure)
        words = plot.draw(figure)
        for axes in figure.axes:  # minor ticks cost as much time as all the rest, and show nothing at half size
            axes.minorticks_off()
            for axis in (axes.xaxis, axes.yaxis):
                if axis.get_scale() == "log":
                    low, high = axis.get_view_interval()
                    if high < 100 * low:
                        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
                    axis.set_major_formatter("{x:g}")
        pixels, svg = io.BytesIO(), io.StringIO()
        figure.savefig(pixels, format="png", metadata={"Software": None}, pil_kwargs={"compress_level": 4})
        figure.savefig(svg, format="svg", metadata={"Date": None, "Creator": None})
    return Picture(stem, words, svg.getvalue(), pixels.getvalue())
