"""What the cases of derivatives share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof import analytic
from fogproof.catalogue.cases import Drawn, EstimatorCase, Twin
from fogproof.contracts import Draws, Reference


def slopes(quantity: str, *parameters: str, **arguments: Any) -> Reference:
    """Return the derivatives of a quantity by several parameters, one behind the other."""
    found = [analytic.gradient(quantity, name, **arguments) for name in parameters]
    value, error = (np.stack([getattr(slope, what) for slope in found], axis=-1) for what in ("value", "error"))
    return Reference(value, error, found[0].method, found[0].source)


def altered(subject: Any, alter: Callable[[np.ndarray], np.ndarray]) -> Drawn:
    """Return the subject with its values altered."""

    def draw(rng: np.random.Generator, n: int) -> Draws:
        draws = subject.draw(rng, n)
        return draws._replace(value=alter(np.asarray(draws.value)))

    return Drawn(draw)


def derivative_case(
    name: str,
    title: str,
    make: Callable[[], Any],
    reference: Callable[[], Reference],
    oracle: str,
    error: str,
    twin: Callable[[], Any],
    **more: Any,
) -> EstimatorCase:
    """Return a case; `more` are further fields of `EstimatorCase`."""
    return EstimatorCase(
        name=name,
        title=title,
        make=make,
        reference=reference,
        oracle=oracle,
        twin=Twin(error, twin),
        **{"samples": 500_000, **more},
    )
