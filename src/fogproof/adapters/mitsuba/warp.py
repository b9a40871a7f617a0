"""Mitsuba's warps of the unit square: `mitsuba.warp.square_to_NAME` beside `square_to_NAME_pdf`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.adapters.mitsuba.runtime import evaluate, load
from fogproof.domains import Domain


@dataclass(frozen=True, eq=False)
class MitsubaWarp:
    """A warp by its name.

    leading   arguments before the sample or the point; `later` those behind
    density   what the warp's density is where Mitsuba has no function for it; a constant, or a function of the points
    """

    name: str
    domain: Domain
    leading: tuple[Any, ...] = ()
    later: tuple[Any, ...] = ()
    density: float | Callable[[np.ndarray], np.ndarray] | None = None
    dimensions: int = 2

    def sample(self, u: np.ndarray) -> np.ndarray:
        """Map uniforms (n, dimensions) to points."""
        function = getattr(load().warp, self.name)

        def ask(*parts: Any) -> tuple[Any, ...]:
            answer = function(*self._arguments(self.leading), *parts, *self._arguments(self.later))
            return answer[:1] if isinstance(answer, tuple) else (answer,)

        rows = evaluate(ask, u if self.dimensions > 1 else u[:, 0])
        return rows if self.domain.shape else rows[:, 0]

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the density at points."""
        if callable(self.density):
            return self.density(x)
        if self.density is not None:
            return np.full(len(x), self.density)
        function = getattr(load().warp, f"{self.name}_pdf")

        def ask(point: Any) -> tuple[Any, ...]:
            return (function(*self._arguments(self.leading), point, *self._arguments(self.later)),)

        return evaluate(ask, x)[:, 0]

    def _arguments(self, given: tuple[Any, ...]) -> list[Any]:
        mi = load()
        return [mi.Vector3f(*one) if isinstance(one, tuple) else mi.Float(one) for one in given]
