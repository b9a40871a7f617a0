"""Figures of a record that no run can have: a false-alarm probability of NaN spends nothing, and rejects nothing, in silence."""

from __future__ import annotations

import math
from typing import Any

from fogproof.errors import InvalidInputError, shorten

_MOST = {"alpha": 1.0, "seconds": math.inf, "cpu_seconds": math.inf, "confidence": 1.0, "p_value": 1.0}
"""The largest value of each figure; none is negative, NaN or infinite."""
_COUNTS = ("samples", "seed")
"""What no run has below 0; a text or a list among them is judged elsewhere."""
_SUM = "run"
"""The kind of run whose alpha counts those of verdicts beside its own, and may come to more than 1."""
_THEIRS = ("options", "described", "settings", "environment")
"""Tables whose keys are not ours."""


def require_figures(value: Any, origin: str, place: str = "") -> None:
    """Raise `InvalidInputError` for a number that is none of its kind. Where infinity may stand, a record has the text "inf"."""
    if isinstance(value, dict):
        for key, item in value.items():
            if key not in _THEIRS:
                inside = f"{place}.{key}" if place else str(key)
                if key in _MOST and item is not None:
                    sums = inside == "alpha" and value.get("kind") == _SUM
                    _require(item, math.inf if sums else _MOST[key], origin, inside)
                elif key in _COUNTS and isinstance(item, int | float):
                    _require(item, math.inf, origin, inside)
                require_figures(item, origin, inside)
    elif isinstance(value, list):
        for number, item in enumerate(value):
            require_figures(item, origin, f"{place}.{number}")
    elif isinstance(value, float) and not math.isfinite(value):
        raise InvalidInputError(f"{origin}: {place} must be finite, got {value}; it was changed by hand", place)


def _require(value: Any, most: float, origin: str, place: str) -> None:
    try:
        figure = math.nan if isinstance(value, bool) else float(value)
    except (TypeError, ValueError, OverflowError):
        figure = math.nan
    if not (0 <= figure <= most and math.isfinite(figure)):
        rule = "must be a finite number >= 0" if most == math.inf else f"must be a number from 0 to {most:g}"
        raise InvalidInputError(f"{origin}: {place} {rule}, got {shorten(value)}; it was changed by hand", place)
