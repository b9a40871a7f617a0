"""What an estimator's draw returned, held to its contract: n real numbers, and what they cost."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import SubjectError


def numbers_of(name: str, drawn: Any, n: int) -> tuple[np.ndarray, float]:
    """Return (n,) values and their mean cost, NaN where it is not counted; whatever else was drawn is told with the name."""
    draws = drawn if isinstance(drawn, Draws) else Draws(drawn)
    try:
        values = np.asarray(draws.value)
        if values.dtype.kind in "cSUmMV":  # NumPy would drop a part of some, and read others as numbers
            fix = "; return the real or the imaginary part" if values.dtype.kind == "c" else ""
            raise SubjectError(f"{name}: draw must return real numbers, got dtype {values.dtype}{fix}", "draw")
        x = np.ascontiguousarray(values, dtype=np.float64)
        cost = float("nan") if draws.cost is None else float(np.mean(draws.cost))
    except (TypeError, ValueError, OverflowError) as error:
        raise SubjectError(f"{name}: draw: {type(error).__name__}: {error}", "draw") from None
    if values.shape not in ((n,), (n, 1)):
        what = f"draw(rng, {n}) must return {n} numbers, got shape {values.shape}"
        raise SubjectError(f"{name}: {what}", "draw")
    return x.reshape(n), cost
