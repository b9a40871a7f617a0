"""Sums of terms as estimators, for any renderer."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.relations.setting import PathSetting, RadianceTerm


def drawn(render: Callable[[PathSetting], Any], terms: tuple[RadianceTerm, ...]) -> Callable[..., np.ndarray]:
    """Return (rng, n) -> (n,) or (n, channels) realisations of a sum of terms.

    render  setting -> something with `draw(rng, n)`, or that function itself
    """
    estimators = [render(term.setting) for term in terms]
    draws: list[Any] = [getattr(estimator, "draw", estimator) for estimator in estimators]

    def draw(rng: np.random.Generator, n: int) -> np.ndarray:
        total: Any = 0.0
        for term, one in zip(terms, draws, strict=True):
            found = one(rng, n)
            value = np.asarray(getattr(found, "value", found))
            total = total + term.factor * (value if term.channel is None else value[:, term.channel])
        return np.asarray(total)

    return draw
