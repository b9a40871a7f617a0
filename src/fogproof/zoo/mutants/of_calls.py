"""Errors of how a sampler is written, seen from one call to the next: state, pairs, uniforms written into."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.catalogue import SamplerCase
from fogproof.zoo.mutants.mutation import Mutated
from fogproof.zoo.mutants.planting import Array, planted


def stateful(case: SamplerCase) -> Mutated | None:
    """Reverse the rows of every second call."""
    right = planted(case)
    if right.dimensions is None:
        return None
    calls = [0]

    def sample(u: Array) -> Any:
        calls[0] += 1
        return right.sample(u if calls[0] % 2 else u[::-1])

    return Mutated(replace(right, sample=sample))


def paired(case: SamplerCase) -> Mutated | None:
    """Return every point twice."""
    right = planted(case)
    if right.dimensions is None:
        return None
    return Mutated(replace(right, sample=lambda u: right.sample(u[np.arange(len(u)) // 2 * 2])))


def writing(case: SamplerCase) -> Mutated | None:
    """Halve the uniforms in place, after they were used."""
    right = planted(case)
    if right.dimensions is None:
        return None

    def sample(u: Array) -> Any:
        result = right.sample(u.copy())
        u *= 0.5
        return result

    return Mutated(replace(right, sample=sample))
