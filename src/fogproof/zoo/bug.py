"""One bug: what is wrong, where it was seen, what a person would call its cause, and the subject that has it."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from fogproof.catalogue import EstimatorCase, SamplerCase
from fogproof.checks import Verdict
from fogproof.contracts import Reference
from fogproof.domains import Domain, UnitSphere


class Runnable(Protocol):
    """What can be checked inside a false-alarm probability: a case of the catalogue, or a search of a family."""

    def run(self, alpha: float, seed: int, samples: int | None = None) -> Verdict:
        """Check it, with at most so many samples."""


@dataclass(frozen=True)
class Bug:
    """A planted bug.

    name      folder and words, without spaces: `field/log-of-0`
    title     what is wrong, for people
    source    where it was reported, or whose it is
    causes    names of causes that are right, as `Verdict.cause` gives them
    case      the subject that has it
    needed    lower bound on the samples that the best test of this one error needs, see `limits`; asked for where nothing is
              rejected
    equal     True where the change is known to change nothing: no test can tell it, and none should
    most      most samples, where one costs much; 0 for as many as are asked for
    """

    name: str
    title: str
    source: str
    causes: tuple[str, ...]
    case: Runnable
    needed: Callable[[], float] = lambda: 1.0
    equal: bool = False
    most: int = 0

    @property
    def folder(self) -> str:
        """The first part of the name."""
        return self.name.partition("/")[0]


@dataclass(frozen=True)
class Planted:
    """A sampler made of functions."""

    sample: Callable[..., Any]
    pdf: Callable[[np.ndarray], Any]
    domain: Domain
    dimensions: int | None
    atoms: Mapping[Any, float] = field(default_factory=dict)
    eval: Callable[[np.ndarray], Any] | None = None


def named(folder: str, title: str) -> str:
    """Return the name of a bug with a title.

    >>> named("field", "1 + g^2 - s^2 cancels")
    'field/1-g-2-s-2-cancels'
    """
    return f"{folder}/{re.sub('[^a-z0-9]+', '-', title.lower()).strip('-')}"


def sampler_bug(
    title: str,
    source: str,
    sample: Callable[..., Any],
    pdf: Callable[[np.ndarray], Any],
    causes: tuple[str, ...],
    domain: Domain | None = None,
    options: Mapping[str, Any] | None = None,
    folder: str = "field",
) -> Bug:
    """Return a bug of a sampler; `options` are further arguments of `check_sampler`, two uniforms if they say nothing."""
    rest = dict(options or {})
    parts = {"dimensions": rest.pop("dimensions", 2), "atoms": rest.pop("atoms", {}), "eval": rest.pop("eval", None)}
    subject = Planted(sample, pdf, UnitSphere() if domain is None else domain, **parts)
    name = named(folder, title)
    return Bug(name, title, source, causes, SamplerCase(name=name, make=lambda: subject, options=rest))


def estimator_bug(
    title: str,
    source: str,
    draw: Callable[[np.random.Generator, int], Any],
    reference: Callable[[], Reference] | Reference | float,
    causes: tuple[str, ...] = ("bias",),
    folder: str = "field",
    **options: Any,
) -> Bug:
    """Return a bug of an estimator; `options` are further arguments of `check_estimator`."""
    name = named(folder, title)
    subject = Estimating(draw)
    return Bug(
        name,
        title,
        source,
        causes,
        EstimatorCase(name=name, make=lambda: subject, reference=reference, options=options),
    )


@dataclass(frozen=True)
class Estimating:
    """An estimator made of a function."""

    draw: Callable[[np.random.Generator, int], Any]
