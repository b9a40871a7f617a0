"""How cases of free-path samplers are made, and the twins that several of them share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import coefficients, transmittance
from fogproof.catalogue.cases import Altered, SamplerCase, Twin
from fogproof.contracts import Draw, Reference
from fogproof.estimators import FreePath, TruncatedFreePath, along
from fogproof.scene import AnyMedium, Medium, Ray

START = ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))


_FARTHEST = 1e300


def _transmittance(medium: AnyMedium, t: np.ndarray) -> Reference:
    """Return the oracle's transmittance to distances t (n,), 1 at t = 0; (n, channels) if the medium has any."""
    return transmittance(medium, Ray(*START, np.clip(t, np.finfo(float).tiny, _FARTHEST)))


def _sigma_t(medium: AnyMedium, t: np.ndarray) -> np.ndarray:
    return coefficients(medium, np.multiply.outer(t, START[1]), START[1]).sigma_t


def _density(medium: AnyMedium, length: float) -> Callable[[np.ndarray], Reference]:
    """The density of collisions is sigma_t T(t), minus the derivative of the transmittance: on average over the channels,
    and divided by the probability of a collision before `length`."""

    def reference(t: np.ndarray) -> Reference:
        through, sigma = _transmittance(medium, t), _sigma_t(medium, t)
        nearby = np.abs(_sigma_t(medium, t * (1 + 4e-16)) - sigma) + np.abs(_sigma_t(medium, t * (1 - 4e-16)) - sigma)
        value = sigma * through.value
        error = sigma * through.error + nearby * through.value + 1e-15 * value
        if medium.channels is not None:
            value, error = value.mean(axis=-1), error.mean(axis=-1)
        within = _within(medium, length)
        return Reference(value / within, (error + 1e-15 * value) / within, through.method, through.source)

    return reference


def _within(medium: AnyMedium, length: float) -> float:
    """Return the probability of a collision before `length`; 1 for inf, which stands for no truncation."""
    if length == np.inf:
        return 1.0
    lost = 1 - float(_transmittance(medium, np.array([length])).value[0])
    return lost if lost > 0.1 else float(-np.expm1(-_sigma_t(medium, np.zeros(1))[0] * length))


def _cdf(medium: AnyMedium, surface: float, length: float) -> Callable[[np.ndarray], np.ndarray]:
    def cdf(t: np.ndarray) -> np.ndarray:
        through = _transmittance(medium, t).value
        if medium.channels is not None:
            through = through.mean(axis=-1)
        return np.where(t >= min(surface, length), 1.0, (1 - through) / _within(medium, length))

    return cdf


def free_path_case(
    name: str,
    title: str,
    medium: AnyMedium,
    make: Callable[[], Any],
    error: str,
    sample: Any = None,
    pdf: Any = None,
    *,
    length: float = np.inf,
    source: str = "Beer-Lambert law",
    with_cdf: bool = True,
    **options: Any,
) -> SamplerCase:
    """Return a case; the twin is the subject with `sample` or `pdf` replaced, and `options` are of `check_sampler`."""
    cdf = _cdf(medium, getattr(make(), "surface", np.inf), length)
    return SamplerCase(
        name=f"free-path/{name}",
        title=title,
        make=make,
        reference=_density(medium, length),
        oracle="transmittance",
        source=source,
        twin=Twin(error, lambda: Altered(make(), sample, pdf)),
        options={**({"cdf": cdf} if with_cdf else {}), **options},
    )


def homogeneous(
    name: str,
    title: str,
    sigma_t: float,
    surface: float,
    error: str,
    sample: Any = None,
    pdf: Any = None,
    **options: Any,
) -> SamplerCase:
    """Return the case of a free path in a homogeneous medium, with a surface at a distance."""
    return free_path_case(
        name, title, Medium(sigma_t, 0.0), lambda: FreePath(sigma_t, surface), error, sample, pdf, **options
    )


def graded(
    name: str,
    title: str,
    medium: AnyMedium,
    surface: float,
    error: str,
    sample: Any = None,
    pdf: Any = None,
    **options: Any,
) -> SamplerCase:
    """Return the case of a free path along +z, with a surface at a distance."""

    def make() -> FreePath:
        return FreePath(along(medium, Ray(*START)), surface)

    return free_path_case(name, title, medium, make, error, sample, pdf, **options)


def truncated(
    name: str,
    title: str,
    medium: AnyMedium,
    length: float,
    error: str,
    sample: Any = None,
    pdf: Any = None,
    with_cdf: bool = True,
    **options: Any,
) -> SamplerCase:
    """Return the case of a free path that is sure to end on the first metres of +z."""

    def make() -> TruncatedFreePath:
        return TruncatedFreePath(along(medium, Ray(*START)), length)

    return free_path_case(
        f"truncated/{name}", title, medium, make, error, sample, pdf, length=length, with_cdf=with_cdf, **options
    )


def density_at_surface(sampler: FreePath, u: np.ndarray) -> Draw:
    """At the surface the density stands in place of the probability."""
    draw = sampler.sample(u)
    return draw._replace(pdf=sampler.pdf(draw.x))


def leaky_surface(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    """A twentieth of the surface events is moved."""
    t = sampler.sample(u).x
    stopped = (t == sampler.surface) & (u[:, 0] > 1 - 0.05 * sampler.atoms[sampler.surface])
    return np.where(stopped, 0.5 * sampler.surface, t)


def nobody_escapes(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    """Paths that leave the medium are stopped where it ends."""
    return np.minimum(sampler.sample(u).x, 4.0)


def pole_clipped(sampler: FreePath, u: np.ndarray) -> np.ndarray:
    """The logarithm of a negative number is clipped to that of a small positive one: nobody escapes the atmosphere."""
    return np.minimum(sampler.sample(u).x, 100.0)
