"""Constants that people forget: named only where the measured factor pins one of them."""

from __future__ import annotations

import math
from collections.abc import Mapping

_PI = math.pi
FACTORS = {
    "2 pi": 2 * _PI,
    "4 pi": 4 * _PI,
    "pi": _PI,
    "pi/2": _PI / 2,
    "pi/4": _PI / 4,
    "2/pi": 2 / _PI,
    "4/pi": 4 / _PI,
    "1/pi": 1 / _PI,
    "1/(2 pi)": 0.5 / _PI,
    "1/(4 pi)": 0.25 / _PI,
    "2": 2.0,
    "1/2": 0.5,
    "4": 4.0,
    "1/4": 0.25,
}
_PINNED = 0.01  # relative error of a factor that may be named


def named_factor(value: float, error: float, more: Mapping[str, float] | None = None) -> str:
    """Return the name of the one constant that value +- error can be, "" if there is none or it is not pinned.

    more  further constants, such as an albedo or the measure of the domain
    """
    if not (abs(value) < math.inf and 0 <= error <= _PINNED * abs(value)):
        return ""
    known = {**(more or {}), **FACTORS}
    room = error + 1e-4 * abs(value)
    near = [name for name, factor in known.items() if abs(value - factor) <= room and abs(factor - 1) > 1e-3]
    different = {round(math.log(abs(known[name])), 6) for name in near}
    return near[0] if len(different) == 1 else ""
