"""How cases of direction samplers are made, and the phase functions and axes they share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import phase_cdf, phase_mean_cosine, phase_pdf
from fogproof.catalogue.cases import Altered, SamplerCase, Twin
from fogproof.contracts import Reference
from fogproof.estimators import Directions
from fogproof.scene import (
    HenyeyGreenstein,
    Mixture,
    Murky,
    PhaseFunction,
    Rayleigh,
    Schlick,
    Tabulated,
)

Axis = tuple[float, float, float]


POLE: Axis = (0.0, 0.0, 1.0)


TILTED: Axis = (2 / 7, -3 / 7, 6 / 7)


NEARLY_DOWN: Axis = (6e-9, -8e-9, -1.0)


TABLE = Tabulated.normalised(
    (-1.0, -0.8, -0.5, -0.1, 0.0, 0.3, 0.7, 0.9, 0.97, 1.0), (2.0, 0.5, 0.2, 0.0, 0.0, 0.3, 0.4, 3.0, 11.0, 25.0)
)
"""Backscatter, a gap of density 0 and a forward peak."""


NESTED = Mixture((Murky(), Mixture((HenyeyGreenstein(0.85), Schlick(-0.6)), (0.6, 0.4)), Rayleigh()), (0.25, 0.65, 0.1))


def oracle_pdf(phase: PhaseFunction, axis: Axis, rounding: float = 2e-15) -> Callable[[np.ndarray], Reference]:
    """Return x (n, 3) -> the oracle's density of directions about `axis` [1/sr].

    A direction in floating point fixes its cosine only to a few roundings: what that changes is part of the error.
    """

    def reference(x: np.ndarray) -> Reference:
        mu = x @ np.asarray(axis)
        below, at, above = (phase_pdf(phase, np.clip(mu + shift, -1, 1)) for shift in (-rounding, 0, rounding))
        with np.errstate(invalid="ignore"):  # where it is infinite straight ahead
            spread = np.maximum(np.abs(below.value - at.value), np.abs(above.value - at.value))
        return Reference(at.value, at.error + np.nan_to_num(spread, nan=np.inf), at.method, at.source)

    return reference


def rosenblatt(phase: PhaseFunction, axis: Axis) -> Callable[[np.ndarray], np.ndarray]:
    """Return x (n, 3) -> (n, 2): the oracle's distribution of the cosine to `axis`, and the azimuth over 2 pi.

    For densities whose kinks would blur a quadrature over cells.
    """
    across = np.cross(axis, (1.0, 0.0, 0.0))
    first = across / np.linalg.norm(across)
    second = np.cross(axis, first)

    def cdf(x: np.ndarray) -> np.ndarray:
        mu = np.clip(x @ np.asarray(axis), -1, 1)
        return np.stack([phase_cdf(phase, mu).value, np.arctan2(x @ second, x @ first) / (2 * np.pi) % 1], axis=-1)

    return cdf


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
    reference = oracle_pdf(phase, axis, 1e-6 if options.get("precision") == "float32" else 2e-15)
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


def case_of_directions(
    name: str,
    title: str,
    phase: PhaseFunction,
    source: str,
    error: str,
    sample: Any = None,
    pdf: Any = None,
    *,
    axis: Axis = POLE,
    twin: Callable[[], Any] | None = None,
    **options: Any,
) -> SamplerCase:
    """Return the case of `Directions(phase, axis)`; `options` are of `check_sampler`.

    The twin is the subject with `sample` or `pdf` replaced, unless `twin` makes another.
    """

    def make() -> Directions:
        return Directions(phase, axis)

    tilt = {TILTED: ", about a tilted axis", NEARLY_DOWN: ", about an axis 1e-8 from -z"}.get(axis, "")
    broken = Twin(error, twin or (lambda: Altered(make(), sample, pdf)))
    mean = float(phase_mean_cosine(phase).value)
    return direction_case(
        f"directions/{name}", title + tilt, phase, mean, make, broken, source, axis=axis, options=options
    )


def sampled_from(phase: PhaseFunction) -> Callable[[Directions, np.ndarray], np.ndarray]:
    """Return a sampler of another phase function about the same axis."""
    return lambda sampler, u: Directions(phase, sampler.axis).sample(u).x


def about_z(cosine: np.ndarray, u_phi: np.ndarray) -> np.ndarray:
    """Return directions about +z from cosines and uniforms of the azimuth."""
    sine, phi = np.sqrt(np.maximum(1 - cosine * cosine, 0)), 2 * np.pi * u_phi
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=-1)


def textbook_inverse(sampler: Directions, u: np.ndarray) -> np.ndarray:
    """The inverse of Henyey and Greenstein's distribution that divides by 2 g."""
    assert isinstance(sampler.phase, HenyeyGreenstein)
    g = sampler.phase.g
    s = (1 - g * g) / (1 - g + 2 * g * u[:, 0])
    return about_z(np.clip((1 + g * g - s * s) / (2 * g), -1, 1), u[:, 1])


def unrotated(sampler: Directions, u: np.ndarray) -> np.ndarray:
    """The local direction is returned without rotation."""
    return Directions(sampler.phase).sample(u).x
