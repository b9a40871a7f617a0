"""Direction samplers against the oracle's phase functions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import phase_pdf
from fogproof.catalogue.cases import Altered, SamplerCase, Twin
from fogproof.contracts import Draw, Reference
from fogproof.estimators import HenyeyGreensteinDirections, IsotropicDirections, RayleighDirections
from fogproof.scene import HenyeyGreenstein, Isotropic, PhaseFunction, Rayleigh

Axis = tuple[float, float, float]

POLE: Axis = (0.0, 0.0, 1.0)
TILTED: Axis = (2 / 7, -3 / 7, 6 / 7)


def oracle_pdf(phase: PhaseFunction, axis: Axis) -> Callable[[np.ndarray], Reference]:
    """Return x (n, 3) -> the oracle's density of directions about `axis` [1/sr].

    A direction in floating point fixes its cosine only to a few roundings: what that changes is part of the error.
    """
    rounding = 2e-15

    def reference(x: np.ndarray) -> Reference:
        mu = x @ np.asarray(axis)
        below, at, above = (phase_pdf(phase, np.clip(mu + shift, -1, 1)) for shift in (-rounding, 0, rounding))
        spread = np.maximum(np.abs(below.value - at.value), np.abs(above.value - at.value))
        return Reference(at.value, at.error + spread, at.method, at.source)

    return reference


def direction_case(
    name: str,
    title: str,
    phase: PhaseFunction,
    mean: float,
    make: Callable[[], Any],
    twin: Twin,
    source: str,
    **more: Any,
) -> SamplerCase:
    """Return the case of a direction sampler: its pdf is the oracle's, and forward means forward."""
    axis = more.pop("axis", POLE)
    options = {"axis": axis, "mean_cosine": mean, **more.pop("options", {})}
    reference = oracle_pdf(phase, axis)
    return SamplerCase(
        name=name,
        title=title,
        make=make,
        reference=reference,
        oracle="phase_pdf",
        source=source,
        twin=twin,
        options=options,
        **more,
    )


def _uniform_in_angle(sampler: Any, u: np.ndarray) -> np.ndarray:
    theta, phi = np.pi * u[:, 0], 2 * np.pi * u[:, 1]
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def _textbook(sampler: HenyeyGreensteinDirections, u: np.ndarray) -> np.ndarray:
    g, phi = sampler.g, 2 * np.pi * u[:, 1]
    s = (1 - g * g) / (1 - g + 2 * g * u[:, 0])
    mu = np.clip((1 + g * g - s * s) / (2 * g), -1, 1)
    sine = np.sqrt(1 - mu * mu)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)


def _isotropic(sampler: Any, u: np.ndarray) -> np.ndarray:
    return IsotropicDirections(sampler.axis).sample(u).x


def _other_g(g: float) -> Callable[[Any, np.ndarray], np.ndarray]:
    return lambda sampler, u: HenyeyGreensteinDirections(g, sampler.axis).sample(u).x


def _power_one(sampler: HenyeyGreensteinDirections, x: np.ndarray) -> np.ndarray:
    g = sampler.g
    return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * x[:, 2]))


def _density_of_cosine(sampler: Any, u: np.ndarray) -> Draw:
    draw = sampler.sample(u)
    return Draw(draw.x, 2 * np.pi * draw.pdf)


def _unrotated(sampler: HenyeyGreensteinDirections, u: np.ndarray) -> np.ndarray:
    return HenyeyGreensteinDirections(sampler.g).sample(u).x


def _altered(make: Callable[[], Any], error: str, sample: Any = None, pdf: Any = None) -> Twin:
    return Twin(error, lambda: Altered(make(), sample, pdf))


def _henyey_greenstein(g: float, axis: Axis, error: str, sample: Any = None, pdf: Any = None) -> SamplerCase:
    def make() -> HenyeyGreensteinDirections:
        return HenyeyGreensteinDirections(g, axis)

    twin = _altered(make, error, sample, pdf)
    if error.startswith("backward"):
        twin = Twin(error, lambda: HenyeyGreensteinDirections(-g, axis))
    tilt = ", about a tilted axis" if axis == TILTED else ""
    return direction_case(
        f"directions/henyey-greenstein/g={g:g}",
        f"Henyey-Greenstein directions, g = {g:g}{tilt}",
        HenyeyGreenstein(g),
        g,
        make,
        twin,
        "Henyey & Greenstein 1941",
        axis=axis,
    )


def cases() -> list[SamplerCase]:
    """Return the direction cases."""
    missing_tail = "the forward 2 % of the cone are never sampled"
    return [
        direction_case(
            "directions/isotropic",
            "Isotropic directions",
            Isotropic(),
            0.0,
            IsotropicDirections,
            _altered(IsotropicDirections, "uniform in the angle theta, not in its cosine", _uniform_in_angle),
            "Archimedes",
        ),
        direction_case(
            "directions/rayleigh",
            "Rayleigh directions",
            Rayleigh(),
            0.0,
            RayleighDirections,
            _altered(RayleighDirections, "isotropic sampling under the Rayleigh density", _isotropic),
            "Rayleigh 1871",
        ),
        direction_case(
            "directions/rayleigh/tilted",
            "Rayleigh directions about a tilted axis",
            Rayleigh(),
            0.0,
            lambda: RayleighDirections(TILTED),
            _altered(
                lambda: RayleighDirections(TILTED),
                "the local direction is returned without rotation",
                lambda sampler, u: RayleighDirections().sample(u).x,
            ),
            "Rayleigh 1871",
            axis=TILTED,
        ),
        _henyey_greenstein(-0.7, POLE, "for g < 0 the cosine is drawn uniformly", _isotropic),
        _henyey_greenstein(1e-16, POLE, "the textbook inverse that divides by 2 g", _textbook),
        _henyey_greenstein(0.3, POLE, "backward means forward, in sampler and density alike"),
        _henyey_greenstein(0.6, POLE, "exponent 1 instead of 3/2 in the density", None, _power_one),
        _henyey_greenstein(0.85, TILTED, "the sampler has g = 0.83", _other_g(0.83)),
        _henyey_greenstein(
            0.95, POLE, "the returned pdf is the density of the cosine, 2 pi too large", _density_of_cosine
        ),
        _henyey_greenstein(0.99, TILTED, "the local direction is returned without rotation", _unrotated),
        _henyey_greenstein(-0.999, TILTED, missing_tail, _without_peak),
    ]


def _without_peak(sampler: HenyeyGreensteinDirections, u: np.ndarray) -> np.ndarray:
    squeezed = u.copy()
    squeezed[:, 0] = 0.02 + 0.98 * u[:, 0] if sampler.g < 0 else 0.98 * u[:, 0]
    return sampler.sample(squeezed).x
