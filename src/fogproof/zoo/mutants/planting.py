"""The right sampler of a case, in which an error is planted, and what it returns."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.catalogue import SamplerCase
from fogproof.contracts import Draw
from fogproof.zoo.bug import Planted

Array = np.ndarray


def planted(case: SamplerCase) -> Planted:
    """Return the case's own sampler, as it is."""
    s = case.make()
    return Planted(s.sample, s.pdf, s.domain, s.dimensions, dict(getattr(s, "atoms", {})), getattr(s, "eval", None))


def draw_of(result: Any) -> Draw:
    """Return what a sampler gave as a `Draw`."""
    return result if isinstance(result, Draw) else Draw(np.asarray(result))


def share_of(u: Array) -> Array:
    """Return a number in [0, 1) for each sample, a function of its uniforms: which samples an error meets."""
    return np.asarray(u[:, 0] * 4099.0 % 1, dtype=float)
