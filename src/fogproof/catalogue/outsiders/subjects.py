"""What an outsider is, and the three errors that its twins have."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from fogproof.catalogue.cases import SamplerCase, Twin
from fogproof.domains import Domain

Sample = Callable[[np.ndarray], Any]
Density = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Outsider:
    """A sampler made of two functions."""

    sample: Sample
    pdf: Density
    domain: Domain
    dimensions: int
    atoms: Mapping[Any, float] = field(default_factory=dict)


def too_small(subject: Outsider) -> Outsider:
    """Return the subject with a pdf of .98 of what it should be."""
    return replace(subject, pdf=lambda x: 0.98 * subject.pdf(x))


def shifted(subject: Outsider) -> Outsider:
    """Return the subject with its first uniform raised to the power 1.1: 3.5 % of the samples lie elsewhere."""
    return replace(subject, sample=lambda u: subject.sample(np.concatenate([u[:, :1] ** 1.1, u[:, 1:]], axis=1)))


def missing(subject: Outsider, mass: float = 0.02) -> Outsider:
    """Return the subject with a piece of the given mass left out: its first uniform skips it, from .41 on."""

    def skipping(u: np.ndarray) -> Any:
        first = (1 - mass) * u[:, :1]
        return subject.sample(np.concatenate([np.where(first > 0.41, first + mass, first), u[:, 1:]], axis=1))

    return replace(subject, sample=skipping)


ERRORS: dict[str, Callable[[Outsider], Outsider]] = {
    "pdf x .98": too_small,
    "shifted": shifted,
    "a piece of mass .02 is missing": missing,
}


_MANY, _FEWER = 1_000_000, 250_000  # samples of those that run by name, and of those that always run


def case(
    name: str,
    title: str,
    make: Callable[[], Outsider],
    source: str,
    by_name: bool = True,
    **more: Any,
) -> SamplerCase:
    """Return the case of one outsider.

    Which of the errors its twin has depends on its name; those that always run miss a large piece, which no chance hides.
    """
    error, broken = list(ERRORS.items())[sum(map(ord, name)) % len(ERRORS)]
    if not by_name:
        error, broken = "a piece of mass .1 is missing", partial(missing, mass=0.1)
    return SamplerCase(
        name=f"outsiders/{name}",
        title=title,
        make=make,
        reference=None,
        oracle="its own pdf",
        source=source,
        twin=Twin(error, lambda: broken(make())),
        samples=_MANY if by_name else _FEWER,
        weight=0.02,
        by_name=by_name,
        **more,
    )
