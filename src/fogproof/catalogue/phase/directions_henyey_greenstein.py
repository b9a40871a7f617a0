"""Henyey-Greenstein directions against the oracle."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.catalogue.cases import Case, SamplerCase
from fogproof.catalogue.phase.directions import (
    NEARLY_DOWN,
    POLE,
    TILTED,
    Axis,
    case_of_directions,
    sampled_from,
    textbook_inverse,
    unrotated,
)
from fogproof.contracts import Draw
from fogproof.estimators import Directions
from fogproof.scene import (
    DoubleHenyeyGreenstein,
    HenyeyGreenstein,
    Isotropic,
)


def _henyey_greenstein(
    g: float, axis: Axis, error: str, sample: Any = None, pdf: Any = None, **more: Any
) -> SamplerCase:
    title = f"Henyey-Greenstein directions, g = {g:g}"
    phase = HenyeyGreenstein(g)
    source = "Henyey & Greenstein 1941"
    return case_of_directions(f"henyey-greenstein/g={g:g}", title, phase, source, error, sample, pdf, axis=axis, **more)


def _power_one(sampler: Directions, x: np.ndarray) -> np.ndarray:
    assert isinstance(sampler.phase, HenyeyGreenstein)
    g = sampler.phase.g
    return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * x[:, 2]))


def _density_of_cosine(sampler: Directions, u: np.ndarray) -> Draw:
    draw = sampler.sample(u)
    assert draw.pdf is not None
    return Draw(draw.x, 2 * np.pi * draw.pdf)


def _without_peak(sampler: Directions, u: np.ndarray) -> np.ndarray:
    squeezed = u.copy()
    squeezed[:, 0] = 0.02 + 0.98 * u[:, 0]
    return sampler.sample(squeezed).x


def _sign_of_z_lost(sampler: Directions, u: np.ndarray) -> np.ndarray:
    x = sampler.sample(u).x
    x[:, 2] = np.sqrt(np.maximum(1 - x[:, 0] ** 2 - x[:, 1] ** 2, 0))
    return x


def _unguarded_basis(sampler: Directions, u: np.ndarray) -> np.ndarray:
    """The frame of an axis away from the pole, 1/sqrt(1 - z^2), used at the pole, with z in double precision."""
    x, y, z = sampler.axis
    local = Directions(sampler.phase).sample(u).x
    s = np.sqrt(1 - z * z)
    with np.errstate(all="ignore"):
        t1, t2 = np.array([x * z, y * z, -s * s]) / np.float64(s), np.array([-y, x, 0]) / np.float64(s)
        return local @ np.stack([t1, t2, np.array([x, y, z])])


def _component_pdf(sampler: Directions, u: np.ndarray) -> Draw:
    """The density of the chosen lobe only, as if there were no other."""
    phase = sampler.phase
    assert isinstance(phase, DoubleHenyeyGreenstein)
    draw = sampler.sample(u)
    lobes = [Directions(HenyeyGreenstein(g), sampler.axis).pdf(draw.x) for g in (phase.g1, phase.g2)]
    return Draw(draw.x, np.where(u[:, 0] < phase.weight, *lobes))


def cases() -> list[Case]:
    """Return the cases of one and of two peaks."""
    local = "the local direction is returned without rotation"
    return [
        _henyey_greenstein(
            g=-0.7,
            axis=POLE,
            error="for g < 0 the cosine is drawn uniformly",
            sample=sampled_from(Isotropic()),
        ),
        _henyey_greenstein(
            g=1e-16,
            axis=POLE,
            error="the textbook inverse that divides by 2 g",
            sample=textbook_inverse,
        ),
        _henyey_greenstein(
            g=0.3,
            axis=POLE,
            error="backward means forward, in sampler and density alike",
            twin=lambda: Directions(HenyeyGreenstein(-0.3)),
        ),
        _henyey_greenstein(
            g=0.6,
            axis=POLE,
            error="exponent 1 instead of 3/2 in the density",
            pdf=_power_one,
        ),
        _henyey_greenstein(
            g=0.85,
            axis=TILTED,
            error="the sampler has g = 0.83",
            sample=sampled_from(HenyeyGreenstein(0.83)),
        ),
        _henyey_greenstein(
            g=0.95,
            axis=POLE,
            error="the returned pdf is the density of the cosine, 2 pi too large",
            sample=_density_of_cosine,
        ),
        _henyey_greenstein(
            g=0.99,
            axis=TILTED,
            error=local,
            sample=unrotated,
        ),
        _henyey_greenstein(
            g=-0.999,
            axis=TILTED,
            error="the peak's last 2 % are never sampled",
            sample=_without_peak,
        ),
        _henyey_greenstein(
            g=0.5,
            axis=NEARLY_DOWN,
            error="the frame divides by sin theta, which is lost next to the pole",
            sample=_unguarded_basis,
        ),
        _henyey_greenstein(
            g=-0.2,
            axis=TILTED,
            error="z is rebuilt from x and y, and its sign is lost",
            sample=_sign_of_z_lost,
        ),
        case_of_directions(
            name="double-henyey-greenstein",
            title="Two Henyey-Greenstein lobes, g = 0.8 and -0.3",
            phase=DoubleHenyeyGreenstein(0.8, -0.3, 0.6),
            source="Henyey & Greenstein 1941",
            error="the pdf returned is that of the chosen lobe alone",
            sample=_component_pdf,
            axis=TILTED,
        ),
    ]
