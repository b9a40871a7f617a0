"""What is known of a program without asking it: the oracle's density, atoms and expectation, or a table of its density."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fogproof.analytic import coefficients, optical_thickness, phase_mean_cosine, phase_pdf, radiance, transmittance
from fogproof.checks.subject import Precision
from fogproof.contracts import Reference
from fogproof.domains import Domain, HalfLine, Interval, UnitSphere
from fogproof.errors import InvalidInputError, InvalidValueError
from fogproof.oracle.answers import evaluate, read_arguments, require_numbers
from fogproof.oracle.limits import Limits
from fogproof.pipe.spec import Spec
from fogproof.pipe.tables import read_density
from fogproof.scene import AnyMedium, PhaseFunction, Ray

_ROUNDING = {"float64": 2e-15, "float32": 1e-6}
"""What rounding of a direction may change about its cosine."""
_TINY = np.finfo(np.float64).tiny

Density = Callable[[np.ndarray], Reference]


@dataclass(frozen=True)
class KnownLaw:
    """What a spec knows of a sampler.

    density      x -> its density with an error bound, None if only the program can say it
    domain       the spec's, or that of the medium's ray
    atoms        point -> probability
    axis, mean_cosine  declared, or the oracle's for a phase function
    cdf          x -> the distribution, atoms included, where it is known exactly
    most         samples at most, where a table is known too coarsely for more
    """

    density: Density | None
    domain: Domain
    atoms: dict[Any, float]
    axis: tuple[float, float, float] | None = None
    mean_cosine: float | None = None
    cdf: Callable[[np.ndarray], np.ndarray] | None = None
    most: int | None = None
    notes: tuple[str, ...] = field(default=())


def truth_of(spec: Spec, precision: Precision) -> KnownLaw:
    """Return what a sampler's spec knows."""
    assert spec.domain is not None
    atoms = {atom.at: atom.probability for atom in spec.atoms}
    if spec.medium is not None and spec.ray is not None:
        return _along(spec, spec.medium, spec.ray, atoms, precision)
    if spec.phase is not None:
        return _scattered(spec, spec.phase, spec.domain, atoms, precision)
    if spec.table is not None:
        left = max(1 - sum(atoms.values()), _TINY)
        table = read_density(spec.folder / spec.table, spec.domain, spec.axis, spec.exact, left, spec.interpolation)
        return KnownLaw(
            table.density, spec.domain, atoms, spec.axis, spec.mean_cosine, table.cdf, table.most, table.notes
        )
    return KnownLaw(None, spec.domain, atoms, spec.axis, spec.mean_cosine)


def expectation_of(spec: Spec) -> Reference:
    """Return what an estimator's realisations should average to."""
    if spec.scene is not None:
        return radiance(spec.scene)
    if spec.quantity is not None:
        quantity, arguments = read_arguments(spec.quantity)
        value, error, reference = evaluate(quantity, arguments, Limits())
        require_numbers(quantity, value, error)
        if value.ndim > 1:
            raise InvalidInputError(f"quantity has {value.size} values; an estimator has one a channel", "quantity")
        return Reference(value, error, reference.method, reference.source)
    assert spec.reference is not None
    return Reference(np.asarray(spec.reference), np.asarray(spec.error))


def _scattered(
    spec: Spec, phase: PhaseFunction, domain: Domain, atoms: dict[Any, float], precision: Precision
) -> KnownLaw:
    mean = float(phase_mean_cosine(phase).value)
    rounding = _ROUNDING[precision]
    if domain == Interval(-1.0, 1.0):
        return KnownLaw(lambda mu: _about(phase, mu, rounding, 2 * np.pi), domain, atoms)
    if not isinstance(domain, UnitSphere):
        fix = "leave it out for directions, or write { kind = 'interval', a = -1, b = 1 } for their cosines"
        raise InvalidValueError("domain", "must be the sphere for a phase function", domain, fix)
    if spec.axis is None:
        fix = "the direction of propagation before scattering, for example axis = [0, 0, 1]"
        raise InvalidValueError("axis", "must be given with a phase function", None, fix)
    axis = np.asarray(spec.axis, dtype=float)
    mean = mean if spec.mean_cosine is None else spec.mean_cosine
    return KnownLaw(lambda x: _about(phase, x @ axis, rounding, 1.0), domain, atoms, spec.axis, mean)


def _about(phase: PhaseFunction, mu: np.ndarray, rounding: float, factor: float) -> Reference:
    """Return `factor` times the phase function at cosines that are known to `rounding`."""
    below, at, above = (phase_pdf(phase, np.clip(mu + shift, -1, 1)) for shift in (-rounding, 0, rounding))
    with np.errstate(invalid="ignore"):  # where it is infinite straight ahead
        spread = np.maximum(np.abs(below.value - at.value), np.abs(above.value - at.value))
    error = at.error + np.nan_to_num(spread, nan=np.inf) + 2e-16 * np.abs(at.value)
    return Reference(factor * at.value, factor * error, at.method, at.source)


def _along(spec: Spec, medium: AnyMedium, ray: Ray, atoms: dict[Any, float], precision: Precision) -> KnownLaw:
    if ray.shape:
        raise InvalidValueError("ray", "must be one ray", list(ray.shape))
    length = float(ray.length)
    through = transmittance(medium, ray).value
    reached = float(np.mean(through))
    domain = spec.domain if spec.domain != HalfLine(0.0) else Interval(0.0, length) if length < np.inf else spec.domain
    assert domain is not None
    if not atoms and reached > 0:
        atoms = {length: reached}

    def upto(t: np.ndarray) -> Ray:
        return Ray(ray.origin, ray.direction, np.clip(t, _TINY, length))

    def density(t: np.ndarray) -> Reference:
        known = transmittance(medium, upto(t))
        at = np.minimum(t, np.finfo(np.float64).max)
        sigma = coefficients(medium, ray.origin + at[:, None] * ray.direction, ray.direction).sigma_t
        value, error = sigma * known.value, sigma * known.error + 1e-14 * sigma * known.value
        if medium.channels is not None:
            value, error = value.mean(axis=-1), error.mean(axis=-1)
        return Reference(value, error, known.method, known.source)

    def cdf(t: np.ndarray) -> np.ndarray:
        lost = -np.expm1(-optical_thickness(medium, upto(t)).value)
        lost = lost.mean(axis=-1) if medium.channels is not None else lost
        return np.where(t >= length, 1.0, np.where(t <= 0, 0.0, lost))

    return KnownLaw(density, domain, atoms, cdf=cdf if precision == "float64" else None)
