"""What a case of the catalogue is: a subject, the reference that says what is right, and a broken twin."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

import numpy as np

from fogproof.checks import Outcome, Verdict, check_estimator, sampler_check
from fogproof.checks.sampler_parts import SamplerCheck
from fogproof.contracts import Draw, Estimator, Reference, Sampler
from fogproof.domains import Domain
from fogproof.errors import InvalidValueError, SubjectError
from fogproof.validate import number

LONGEST_NAME = 200
"""Characters of a case's name: it stands in tables, figures and file names."""


@dataclass(frozen=True)
class Altered:
    """A sampler with a part replaced: how most broken twins are made. What is not replaced is the original's."""

    original: Sampler
    alter_sample: Callable[[Any, np.ndarray], Any] | None = None
    alter_pdf: Callable[[Any, np.ndarray], np.ndarray] | None = None

    @property
    def domain(self) -> Domain:
        """The original's domain."""
        return self.original.domain

    @property
    def dimensions(self) -> int | None:
        """The original's number of uniforms."""
        return self.original.dimensions

    @property
    def atoms(self) -> Mapping[float, float]:
        """The original's atoms."""
        return getattr(self.original, "atoms", {})

    @property
    def eval(self) -> Callable[[np.ndarray], np.ndarray] | None:
        """What the original's weights are for, if it has any."""
        return getattr(self.original, "eval", None)

    def sample(self, u: np.ndarray) -> Any:
        """Sample as the original does, or as its replacement."""
        return self.original.sample(u) if self.alter_sample is None else self.alter_sample(self.original, u)

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the original's density, or its replacement's."""
        return self.original.pdf(x) if self.alter_pdf is None else self.alter_pdf(self.original, x)


@dataclass(frozen=True)
class Twin:
    """A copy of the subject with one planted error, which the same checks must reject."""

    error: str
    make: Callable[[], Any]


@dataclass(frozen=True, kw_only=True)
class SamplerCase:
    """A sampler against its oracle.

    make        builds the sampler; nothing heavy happens before
    reference   x -> `Reference`: the oracle's density; None where a sampler is held to its own pdf alone
    oracle      the name of the oracle's functions, for people
    options     further arguments of `check_sampler`: cdf, axis, mean_cosine, albedo, precision, …
    source      the paper
    twin        the subject with a planted error; the catalogue has one for every case
    samples     most samples to draw
    weight      share of the run's false-alarm probability, relative to the other cases
    expected    the outcome; "rejected" is a known finding, "inconclusive" one that nobody can tell; `reason` says why
    needs       the extra that must be installed, "" if none
    by_name     whether it runs only when asked for by its name or its folder's
    origin      what names the file or package it comes from, "" for the catalogue; set where it is read
    """

    kind: Literal["sampler"] = "sampler"
    name: str
    make: Callable[[], Sampler]
    title: str = ""
    reference: Callable[[np.ndarray], Reference] | None = None
    oracle: str = ""
    source: str = ""
    twin: Twin | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    samples: int = 1_000_000
    weight: float = 1.0
    expected: Outcome = "not rejected"
    reason: str = ""
    needs: str = ""
    by_name: bool = False
    origin: str = ""

    def __post_init__(self) -> None:
        _refuse_nonsense(self)

    def run(self, alpha: float, seed: int, samples: int | None = None, twin: bool = False) -> Verdict:
        """Check the subject, or its twin, inside the false-alarm probability alpha."""
        return self.check(alpha, seed, samples, twin).run()

    def check(self, alpha: float, seed: int, samples: int | None = None, twin: bool = False) -> SamplerCheck:
        """Return the check of the subject, or of its twin, to be drawn in parts."""
        sampler = _subject(self, twin, ("sample", "pdf", "domain", "dimensions"))
        return sampler_check(
            sampler.sample,
            sampler.pdf,
            sampler.domain,
            dimensions=sampler.dimensions,
            atoms=getattr(sampler, "atoms", None),
            eval=getattr(sampler, "eval", None),
            reference=self.reference,
            samples=samples or self.samples,
            alpha=alpha,
            seed=seed,
            **self.options,
        )


@dataclass(frozen=True, kw_only=True)
class EstimatorCase:
    """An estimator against its oracle; the fields are those of `SamplerCase`, but the reference is one value.

    reference  what the estimator should average to, or a function that returns it, if it costs anything
    variance   the oracle's variance of one realisation, if it knows it
    cost       the oracle's expectation of the cost of one realisation, if it knows it
    """

    kind: Literal["estimator"] = "estimator"
    name: str
    make: Callable[[], Estimator]
    reference: Callable[[], Reference] | Reference | float
    title: str = ""
    oracle: str = ""
    source: str = ""
    twin: Twin | None = None
    variance: Callable[[], Reference | float] | None = None
    cost: Callable[[], Reference | float] | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    samples: int = 1_000_000
    weight: float = 1.0
    expected: Outcome = "not rejected"
    reason: str = ""
    needs: str = ""
    by_name: bool = False
    origin: str = ""

    def __post_init__(self) -> None:
        _refuse_nonsense(self)

    def run(self, alpha: float, seed: int, samples: int | None = None, twin: bool = False) -> Verdict:
        """Check the subject, or its twin, inside the false-alarm probability alpha."""
        estimator = _subject(self, twin, ("draw",))
        return check_estimator(
            estimator.draw,
            self.reference() if callable(self.reference) else self.reference,
            variance=self.variance() if self.variance else None,
            cost=self.cost() if self.cost else None,
            samples=samples or self.samples,
            alpha=alpha,
            seed=seed,
            **self.options,
        )


Case = SamplerCase | EstimatorCase


def _refuse_nonsense(case: Case) -> None:
    """Refuse what no run could do anything with; what the checks refuse by themselves is theirs."""
    if not (isinstance(case.name, str) and case.name.strip()):
        raise InvalidValueError("name", "must be a text", case.name)
    if len(case.name) > LONGEST_NAME:
        raise InvalidValueError("name", f"must have at most {LONGEST_NAME} characters", case.name)
    if not callable(case.make):
        fix = "give a function that builds it, for example make=lambda: MySampler(g=0.5), or the class itself"
        raise InvalidValueError("make", f"of case {case.name!r} must be a function without arguments", case.make, fix)
    if isinstance(case, SamplerCase) and not (case.reference is None or callable(case.reference)):
        raise InvalidValueError("reference", f"of case {case.name!r} must be a function of points", case.reference)
    if not (case.twin is None or isinstance(case.twin, Twin)):
        raise InvalidValueError("twin", f"of case {case.name!r} must be a Twin(error, make)", case.twin)
    if case.expected not in get_args(Outcome):
        raise InvalidValueError("expected", f"of case {case.name!r} must be one of {get_args(Outcome)}", case.expected)
    if not isinstance(case.options, Mapping):
        raise InvalidValueError("options", f"of case {case.name!r} must be a dict of arguments", case.options)
    number("weight", case.weight, f"of case {case.name!r} must be finite and > 0", 0, np.inf, open_ends=True)
    number("samples", case.samples, f"of case {case.name!r} must be >= 1", 1)


def _subject(case: Case, twin: bool, parts: tuple[str, ...]) -> Any:
    """Build the subject, or its twin, and refuse one that lacks a part."""
    subject = case.twin.make() if twin and case.twin else case.make()
    if missing := [part for part in parts if not hasattr(subject, part)]:
        what = f"make returned {type(subject).__name__}, which has no {' and no '.join(missing)}"
        raise SubjectError(f"{what}; a {case.kind} has {', '.join(parts)}", missing[0])
    return subject


@dataclass(frozen=True)
class Drawn:
    """An estimator made of a single function, for twins."""

    draw: Callable[[np.random.Generator, int], Any]


def points_of(result: Any) -> np.ndarray:
    """Return the points of what a sampler returned, a `Draw` or bare points."""
    return result.x if isinstance(result, Draw) else np.asarray(result)
