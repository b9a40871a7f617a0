"""Colours of every figure: the first three are Okabe and Ito's, which differ in every common colour blindness, and by lightness
in print; further ones never stand without marks of different shapes.
"""

INK, GRID, PAPER = "#1b1f24", "#cfd6dd", "#fffffe"
EXPECTED, OBSERVED, THIRD = "#d55e00", "#0072b2", "#009e73"
FOURTH, FIFTH, SIXTH = "#a6448c", "#b87a00", "#57606a"

ON_PAGE = {
    INK: "var(--ink)",
    GRID: "var(--rule)",
    PAPER: "var(--paper)",
    EXPECTED: "var(--warm)",
    OBSERVED: "var(--cool)",
    THIRD: "var(--third)",
    FOURTH: "var(--fourth)",
    FIFTH: "var(--fifth)",
    SIXTH: "var(--soft)",
}
"""The variables of the page, light or dark, that stand for them there."""

_RED_TO_BLUE = [
    "67001f",
    "b2182b",
    "d6604d",
    "f4a582",
    "fddbc7",
    "f7f7f7",
    "d1e5f0",
    "92c5de",
    "4393c3",
    "2166ac",
    "053061",
]
"""Brewer's diverging scheme RdBu."""


def diverging(value: float) -> str:
    """Return the colour of a value from -1 (blue) over 0 (nearly white) to 1 (red), one of 41; grey if it is not a number."""
    return _DIVERGING[round(20 * min(max(value, -1.0), 1.0))] if value == value else "#888888"


def _mixed(place: float) -> str:
    at = 5 - 5 * place
    index = min(int(at), 9)
    pair = [[int(colour[k : k + 2], 16) for k in (0, 2, 4)] for colour in _RED_TO_BLUE[index : index + 2]]
    mixed = [round(a + (b - a) * (at - index)) for a, b in zip(*pair, strict=True)]
    return "#" + "".join(f"{part:02x}" for part in mixed)


_DIVERGING = {i: _mixed(i / 20) for i in range(-20, 21)}
