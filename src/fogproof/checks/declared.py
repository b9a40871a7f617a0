"""What a caller declares about a sampler: arguments made clean or refused with the fix, and what nothing declared can check."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, get_args

import numpy as np

from fogproof.checks.arguments import require_albedo
from fogproof.checks.density.lattice import lattice
from fogproof.checks.streams import fresh_seed
from fogproof.checks.subject import UNIT_ROUNDOFF, Precision, Subject, in_domain
from fogproof.domains import Discrete, Domain
from fogproof.errors import InvalidValueError
from fogproof.validate import number, unit_vectors

_SPREAD = 1 << 12  # points that show how large a domain is
_SURE = 6.0  # standard deviations, as if they were drawn by chance: they are more even
_MOST_ENTRIES = 2**53  # of a table: all are whole numbers in double precision too
_LEAST_ALPHA = 1e-100  # tails of the tests' laws are accurate some way beyond


def declared(
    subject: Subject, resolution: float | None, samples: Any, alpha: float, seed: Any
) -> tuple[Subject, int, int]:
    """Return the subject, the number of samples and the seed, clean, or raise `InvalidValueError` on the first bad argument."""
    for name, function in (
        ("sample", subject.sample),
        ("pdf", subject.pdf),
        ("cdf", subject.cdf),
        ("eval", subject.eval),
        ("inverse", subject.inverse),
    ):
        if function is not None and not callable(function):
            raise InvalidValueError(name, "must be a function", function)
    if isinstance(subject.domain, type):
        raise InvalidValueError("domain", "must be a domain", subject.domain, f"write {subject.domain.__name__}(...)")
    if not isinstance(subject.domain, Domain):
        raise InvalidValueError("domain", "must be one of fogproof.domains, or have its parts", subject.domain)
    _check_measure(subject.domain)
    dimensions = subject.dimensions
    if dimensions is not None:
        dimensions = whole("dimensions", dimensions, 1, "or None for sample(rng, n)")
    if subject.precision not in get_args(Precision):
        raise InvalidValueError("precision", "must be 'float64' or 'float32'", subject.precision)
    if subject.uniform_bits is not None:
        whole("uniform_bits", subject.uniform_bits, 8, "53 are those of double precision")
    number("alpha", alpha, f"must lie in [{_LEAST_ALPHA:g}, 1)", _LEAST_ALPHA, np.nextafter(1, 0))
    if resolution is not None:
        number("resolution", resolution, "must lie in (0, 1)", 0, 1, open_ends=True)
    _check_atoms_and_events(subject)
    breaks = _breaks(subject)
    if subject.albedo is not None:
        require_albedo(subject.albedo)
    axis = subject.axis
    if axis is not None:
        axis = tuple(unit_vectors("axis", axis).tolist())
    if subject.mean_cosine is not None:
        if axis is None:
            raise InvalidValueError("axis", "must be given with mean_cosine", axis)
        number("mean_cosine", subject.mean_cosine, "must lie in [-1, 1]", -1, 1)
    return (
        replace(_asked_with_integers(subject), dimensions=dimensions, axis=axis, breaks=breaks),
        whole("samples", samples, 100),
        fresh_seed() if seed is None else whole("seed", seed, 0, "any whole number >= 0, or None for a fresh one"),
    )


def _asked_with_integers(subject: Subject) -> Subject:
    """Return the subject with functions that get integers where points are entries of a table, which they may index.

    Without an end, numbers may be too large for integers; beside other coordinates, an array has one type for all.
    """
    if not isinstance(subject.domain, Discrete) or subject.domain.n > _MOST_ENTRIES:
        return subject
    optional = [None if f is None else partial(_of_integers, f) for f in (subject.cdf, subject.eval, subject.inverse)]
    cdf, evaluate, inverse = optional
    reference = None if subject.reference is None else partial(_of_integers, subject.reference)
    pdf = partial(_of_integers, subject.pdf)
    return replace(subject, pdf=pdf, cdf=cdf, eval=evaluate, inverse=inverse, reference=reference)


def _of_integers(f: Callable[[np.ndarray], Any], x: np.ndarray) -> Any:
    return f(x.astype(np.int64))


def _check_atoms_and_events(subject: Subject) -> None:
    if subject.atoms and isinstance(subject.domain, Discrete):
        raise InvalidValueError("atoms", "need a density: on Discrete the pdf is a probability", subject.domain)
    for point in subject.atoms:
        if np.shape(point) != subject.domain.shape or not _in_reach(subject, point):
            rule = f"must be points of {subject.domain}, or inf"
            raise InvalidValueError("atoms", rule, point, "a larger domain has it; inf is where a path leaves")
    _probabilities("atoms", subject.atoms)
    atoms = sum(subject.atoms.values())
    if atoms > 1 + 1e-9:
        raise InvalidValueError("atoms", "must have probabilities that sum to 1 at most", atoms)
    _probabilities("events", subject.events)
    events = sum(subject.events.values())
    if subject.events and abs(events - 1) > 1e-9:
        raise InvalidValueError("events", "must have probabilities that sum to 1", events, "declare every label")


def _in_reach(subject: Subject, point: Any) -> bool:
    """Return whether an atom is a point of the domain, as single precision may round it, or at infinity on a line."""
    x = np.asarray([point], dtype=np.float64)
    at_infinity = x.ndim == 1 and bool(np.isinf(x[0]))
    return at_infinity or bool(in_domain(subject.domain, x, UNIT_ROUNDOFF["float32"])[0])


def _check_measure(domain: Domain) -> None:
    """Hold a finite measure to evenly spread points of the known law: whoever recognises a part may know its size wrongly."""
    law = domain.law(np.empty((0, *domain.shape)))
    if law.stepped or not np.isfinite(domain.measure):
        return
    x = law.place(lattice(_SPREAD, len(law.axes), np.full(len(law.axes), 0.5)))
    each = 1 / (law.density(x) * domain.measure)
    share = np.where(in_domain(domain, x, UNIT_ROUNDOFF["float64"]), each, 0.0)
    error = _SURE * (float(share.std()) + float(each.max()) / math.sqrt(_SPREAD)) / math.sqrt(_SPREAD)
    if abs(float(share.mean()) - 1) > error:
        rule = f"must have the measure of what it contains, about {share.mean() * domain.measure:.4g}"
        raise InvalidValueError("domain", rule, domain, "leave the measure out where it is not known")


def _breaks(subject: Subject) -> dict[str, np.ndarray]:
    """Return the declared breaks, each a sorted array of different numbers, or say what is wrong with them."""
    if not isinstance(subject.breaks, Mapping):
        raise InvalidValueError("breaks", "must be {coordinate: numbers}", subject.breaks, 'write breaks={"x": edges}')
    found = {}
    for label, values in subject.breaks.items():
        try:
            edges = np.unique(np.asarray(values, dtype=np.float64))
        except (TypeError, ValueError):
            raise InvalidValueError(f"breaks[{label!r}]", "must be numbers", values) from None
        if edges.ndim != 1 or not np.isfinite(edges).all():
            raise InvalidValueError(f"breaks[{label!r}]", "must be finite numbers", values)
        found[str(label)] = edges
    if subject.support is not None and not isinstance(subject.support, Domain):
        fix = "SpherePart(inside) is one that a function recognises"
        raise InvalidValueError("support", "must be a domain inside the domain", subject.support, fix)
    if subject.support is not None and subject.support.shape != subject.domain.shape:
        raise InvalidValueError("support", f"must have points like those of {subject.domain}", subject.support)
    return found


def whole(name: str, value: Any, least: int, fix: str = "") -> int:
    """Return a whole number >= `least`, whatever type it comes in: 1e6 is one million."""
    rule = f"must be a whole number >= {least}"
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise InvalidValueError(name, rule, value, fix)
    if abs(value) == np.inf or value != value or value != int(value) or value < least:
        raise InvalidValueError(name, rule, value, fix)
    return int(value)


def _probabilities(name: str, table: Mapping[Any, float]) -> None:
    for point, probability in table.items():
        number(f"{name}[{point!r}]", probability, "must be a probability in [0, 1]", 0, 1)


def unchecked(subject: Subject, channels: int, labels: bool) -> tuple[str, ...]:
    """Return what a sampler returns and nothing was declared for, in words.

    channels  of the returned weights, 0 if there are none
    labels    whether event labels are returned
    """
    found = []
    if subject.albedo is not None and not channels and subject.eval is None:
        found.append("albedo (the sampler returns no weights, and eval is not given)")
    if subject.axis is not None and subject.domain.shape != (3,):
        found.append("axis (the points are no directions)")
    if channels and subject.eval is None and subject.albedo is None:
        found.append("weights (declare eval, albedo, or both)")
    if labels and not subject.events and not subject.atoms:
        found.append("event labels (declare events={label: probability})")
    return tuple(found)
