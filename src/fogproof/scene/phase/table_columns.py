"""Two columns as programs write a phase function: which angles, which order, which normalisation they have.

Nothing is guessed in silence: what was understood is said in one sentence, with the mean cosine that follows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.validate import as_float_array, require

ROUNDED = 2e-5
"""How far the ends of a column may lie from the poles, in cosines or radians: files are written with six digits or so."""

CENTRED = 0.02
"""How far, as a share of a cell, the ends of a column of cell centres may lie from half a cell."""

TOTALS = {"1": 1.0, "2 pi (1 over the cosine)": 2 * np.pi, "4 pi (2 over the cosine)": 4 * np.pi}


@dataclass(frozen=True)
class Columns:
    """What two columns mean.

    cosines, values  increasing from -1 to 1, and the density there, in whatever normalisation
    sentence         what was understood of the columns; the caller adds what follows from it
    """

    cosines: np.ndarray
    values: np.ndarray
    sentence: str


def understand(places: Any, values: Any) -> Columns:
    """Return what two columns mean: forward cosines, or scattering angles in radians or degrees, and values >= 0.

    Both orders do, and centres of equal cells as well as both poles; between places the density is linear in the cosine.
    """
    x, f = as_float_array("places", places), as_float_array("values", values)
    if x.ndim != 1 or x.size < 2:
        raise InvalidValueError("places", "must be a list of at least two numbers", places)
    require("places", x, np.isfinite(x), "must be finite")
    if f.shape != x.shape:
        raise InvalidValueError("values", "must be one number a place", values, f"there are {x.size} places")
    require("values", f, np.isfinite(f) & (f >= 0), "must be finite and >= 0")
    unit, low, high = _unit(x)
    down = x[0] > x[-1]
    x, f = (x[::-1], f[::-1]) if down else (x, f)
    if not np.all(np.diff(x) > 0):
        i = int(np.argmin(np.diff(x)))
        pair = [float(x[i]), float(x[i + 1])]
        raise InvalidValueError("places", "must increase or decrease all the way", pair, "merge equal ones")
    x, f, where = _to_the_poles(x, f, low, high)
    c = x if unit == "cosines" else np.cos(np.radians(x) if unit == "degrees" else x)
    if unit != "cosines":
        c, f = c[::-1], f[::-1]
    c = np.concatenate([[-1.0], c[1:-1], [1.0]])
    order = "decreasing" if down else "increasing"
    return Columns(c, f, f"{len(np.atleast_1d(places))} {unit}, {order}, {where}")


def normalisation(total: float) -> str:
    """Return what the integral of the values over the sphere says of them."""
    for name, one in TOTALS.items():
        if abs(total / one - 1) < 1e-2:
            return f"values whose integral over the sphere is {total:.6g}, about {name}"
    return f"values in units of their own, whose integral over the sphere is {total:.6g}"


def _unit(x: np.ndarray) -> tuple[str, float, float]:
    """Return what the places are, and what they lie between."""
    least, most = float(x.min()), float(x.max())
    if least < -1 - ROUNDED or most > 180 + 180 * ROUNDED:
        fix = "forward cosines lie in [-1, 1], angles in [0, pi] or [0, 180]"
        raise InvalidValueError("places", "must be cosines or scattering angles", [least, most], fix)
    if least < -0.5 and most <= 1 + ROUNDED:
        return "cosines", -1.0, 1.0
    if least >= -ROUNDED and 1.5 < most <= np.pi + ROUNDED:
        return "radians", 0.0, np.pi
    if least >= -ROUNDED and most > 90:
        return "degrees", 0.0, 180.0
    fix = "from -1 to 1, from 0 to pi, or from 0 to 180; a table of one hemisphere has to be completed first"
    raise InvalidValueError("places", "must reach from pole to pole", [least, most], fix)


def _to_the_poles(x: np.ndarray, f: np.ndarray, low: float, high: float) -> tuple[np.ndarray, np.ndarray, str]:
    """Return the table with both poles in it, and how it had them."""
    slack = ROUNDED * (high - low) / 2
    if abs(x[0] - low) <= slack and abs(x[-1] - high) <= slack:
        return np.concatenate([[low], x[1:-1], [high]]), f, "with both poles"
    cell = (high - low) / x.size
    centres = low + cell * (np.arange(x.size) + 0.5)
    if np.all(np.abs(x - centres) <= CENTRED * cell):
        ends = np.concatenate([[low], x, [high]])
        return (
            ends,
            np.concatenate([f[:1], f, f[-1:]]),
            "the centres of equal cells (the outermost values reach the poles)",
        )
    gaps = [float(x[0]), float(x[-1])]
    rule = f"must reach from {low:g} to {high:.6g}, or be the centres of equal cells between"
    raise InvalidValueError("places", rule, gaps, "add the values at the poles")
