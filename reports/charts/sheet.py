"""A sheet of shapes and words, written as SVG: what the charts of the page are made of.

A page may hold hundreds of charts. Written by hand a chart takes about a millisecond and a few kilobytes, fifty times less
than a plotting library takes; `sheet_png` makes pixels of the same shapes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Literal

from fogproof.text import visible

FONT_SIZE = 14.0
"""Of all words [px]; half of it can still be read."""

Points = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Outline:
    """Lines through points [px, y down]; filled if `fill` is a colour, drawn if `stroke` is one.

    crisp  filled rectangles whose edges are not smoothed: cells that touch show no seam
    """

    paths: Sequence[Points]
    stroke: str = ""
    width: float = 1.8
    dash: tuple[float, float] | None = None
    fill: str = ""
    opacity: float = 1.0
    crisp: bool = False


@dataclass(frozen=True)
class Dots:
    """Filled circles around points [px]."""

    at: Points
    colour: str
    radius: float


@dataclass(frozen=True)
class Words:
    """Text whose baseline starts, is centred, or ends at (x, y); `turned` reads upwards."""

    x: float
    y: float
    text: str
    colour: str
    anchor: Literal["start", "middle", "end"] = "start"
    turned: bool = False
    size: float = FONT_SIZE


Mark = Outline | Dots | Words


@dataclass(frozen=True)
class Group:
    """Marks of which only what lies in `box` (x, y, width, height) is seen."""

    box: tuple[float, float, float, float]
    shapes: list[Mark]


@dataclass
class Sheet:
    """Shapes in the order in which they are drawn."""

    width: float
    height: float
    paper: str
    shapes: list[Mark | Group] = field(default_factory=list)

    def svg(self) -> str:
        """Return the sheet as an SVG document without ids, links or styles."""
        body = "\n".join(_svg(shape) for shape in self.shapes)
        size = f'width="{self.width:g}" height="{self.height:g}" viewBox="0 0 {self.width:g} {self.height:g}"'
        font = f'font-family="DejaVu Sans, Verdana, sans-serif" font-size="{FONT_SIZE:g}"'
        ground = f'<path d="M0 0h{self.width:g}v{self.height:g}H0z" fill="{self.paper}"/>'
        return f'<svg xmlns="http://www.w3.org/2000/svg" {size} {font} fill="none">\n{ground}\n{body}\n</svg>\n'


def _svg(shape: Mark | Group) -> str:
    match shape:
        case Group((x, y, width, height), shapes):
            place = f'x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}"'
            inner = "\n".join(_svg(one) for one in shapes)
            return f'<svg {place} viewBox="{x:g} {y:g} {width:g} {height:g}">\n{inner}\n</svg>'
        case Dots():
            d = "".join(f"M{x:.1f} {y:.1f}h0" for x, y in shape.at)
            return f'<path d="{d}" stroke="{shape.colour}" stroke-width="{2 * shape.radius:g}" stroke-linecap="round"/>'
        case Words():
            text = escape(visible(shape.text))
            turn = f' transform="rotate(-90 {shape.x:.1f} {shape.y:.1f})"' if shape.turned else ""
            size = "" if shape.size == FONT_SIZE else f' font-size="{shape.size:g}"'
            anchor = "" if shape.anchor == "start" else f' text-anchor="{shape.anchor}"'
            return f'<text x="{shape.x:.1f}" y="{shape.y:.1f}" fill="{shape.colour}"{anchor}{size}{turn}>{text}</text>'
    closed = "z" if shape.fill else ""
    d = "".join(_path(points) + closed for points in shape.paths)
    look = f' fill="{shape.fill}"' if shape.fill else ""
    if shape.stroke:
        look += f' stroke="{shape.stroke}" stroke-width="{shape.width:g}" stroke-linejoin="round"'
        if shape.dash:
            look += f' stroke-dasharray="{shape.dash[0]:g} {shape.dash[1]:g}"'
    if shape.crisp:
        look += ' shape-rendering="crispEdges"'
    if shape.opacity < 1:
        look += f' opacity="{shape.opacity:g}"'
    return f'<path d="{d}"{look}/>'


def _path(points: Points) -> str:
    """Return the path through `points`; level and upright steps take the short form."""
    (x, y), *rest = [(f"{a:.1f}", f"{b:.1f}") for a, b in points]
    path = f"M{x} {y}"
    for a, b in rest:
        if b == y:
            path += f"H{a}" if a != x else ""
        else:
            path += f"V{b}" if a == x else f"L{a} {b}"
        x, y = a, b
    return path
