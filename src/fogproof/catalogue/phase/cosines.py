"""Samplers of the scattering cosine alone against the oracle's densities and distributions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import phase_cdf, phase_pdf
from fogproof.catalogue.cases import Altered, SamplerCase, Twin
from fogproof.catalogue.phase.directions import NESTED, TABLE
from fogproof.contracts import Reference
from fogproof.estimators import Cosines
from fogproof.scene import CornetteShanks, Draine, Hazy, HenyeyGreenstein, Murky, PhaseFunction, Rayleigh, Schlick


def _density(phase: PhaseFunction) -> Callable[[np.ndarray], Reference]:
    """Return mu (n,) -> the oracle's density of the cosine; what moving mu by a few roundings of 1 changes is part of the error."""
    rounding = 1e-15

    def reference(mu: np.ndarray) -> Reference:
        below, at, above = (phase_pdf(phase, np.clip(mu + shift, -1, 1)) for shift in (-rounding, 0, rounding))
        spread = np.maximum(np.abs(below.value - at.value), np.abs(above.value - at.value))
        error = 2 * np.pi * (at.error + spread + 1e-16 * at.value)
        return Reference(2 * np.pi * at.value, error, at.method, at.source)

    return reference


def _case(
    name: str, title: str, phase: PhaseFunction, source: str, error: str, sample: Any, pdf: Any = None
) -> SamplerCase:
    return SamplerCase(
        name=f"cosines/{name}",
        title=title,
        make=lambda: Cosines(phase),
        reference=_density(phase),
        oracle="phase_pdf, phase_cdf",
        source=source,
        twin=Twin(error, lambda: Altered(Cosines(phase), sample, pdf)),
        options={"cdf": lambda mu: phase_cdf(phase, mu).value},
    )


def _from(phase: PhaseFunction) -> Callable[[Cosines, np.ndarray], np.ndarray]:
    return lambda sampler, u: Cosines(phase).sample(u).x


def _cancelling(sampler: Cosines, u: np.ndarray) -> np.ndarray:
    """The textbook inverse with its singularity guarded at the wrong size: below, uniform; above, digits are lost."""
    assert isinstance(sampler.phase, HenyeyGreenstein)
    g = sampler.phase.g
    s = (1 - g * g) / (1 - g + 2 * g * u[:, 0])
    return (1 + g * g - s * s) / (2 * g) if abs(g) > 1e-16 else 2 * u[:, 0] - 1


def _two_powers_less(sampler: Cosines, u: np.ndarray) -> np.ndarray:
    """u = xi^(1/n), the root of two powers less than the cdf has."""
    v = np.abs(2 * u[:, 0] - 1)
    return 2 * np.where(u[:, 0] < 0.5, v, v ** (1 / 31)) - 1


def _lobe_always(sampler: Cosines, u: np.ndarray) -> np.ndarray:
    return 2 * u[:, 0] ** (1 / 9) - 1


def _first_component(sampler: Cosines, u: np.ndarray) -> np.ndarray:
    """The uniform that chose the component is used again as it is: every component is cut to its share."""
    return np.where(u[:, 0] < 0.25, Cosines(Murky()).sample(u).x, sampler.sample(u).x)


def cases() -> list[SamplerCase]:
    """Return the cases of cosines."""
    nishita = "Nishita, Miyawaki & Nakamae 1987"
    return [
        _case(
            "henyey-greenstein/g=0.9",
            "Henyey-Greenstein cosine, g = 0.9",
            HenyeyGreenstein(0.9),
            "Henyey & Greenstein 1941",
            "the sign of 2 g mu in the density alone",
            None,
            lambda sampler, mu: sampler.pdf(-mu),
        ),
        _case(
            "henyey-greenstein/g=1e-14",
            "Henyey-Greenstein cosine, g = 1e-14",
            HenyeyGreenstein(1e-14),
            "Henyey & Greenstein 1941",
            "the textbook inverse, whose digits cancel",
            _cancelling,
        ),
        _case(
            "rayleigh",
            "Rayleigh cosine",
            Rayleigh(),
            "Rayleigh 1871",
            "the cubic is inverted to first order only",
            lambda sampler, u: np.clip((8 * u[:, 0] - 4) / 3, -1, 1),
        ),
        _case(
            "schlick",
            "Schlick cosine, k = -0.8",
            Schlick(-0.8),
            "Blasi, Le Saec & Schlick 1993",
            "the sampler has k = -0.78",
            _from(Schlick(-0.78)),
        ),
        _case("hazy", "Hazy cosine", Hazy(), nishita, "the isotropic half is forgotten in the sampler", _lobe_always),
        _case("murky", "Murky cosine", Murky(), nishita, "the root 1/31 in place of 1/33", _two_powers_less),
        _case(
            "cornette-shanks",
            "Cornette-Shanks cosine, g = -0.5",
            CornetteShanks(-0.5),
            "Cornette & Shanks 1992",
            "g is taken for the mean cosine",
            _from(CornetteShanks(-0.46)),
        ),
        _case(
            "draine",
            "Draine cosine, g = 0.2, alpha = 1000",
            Draine(0.2, 1000.0),
            "Draine 2003",
            "one step of Newton's method",
            lambda sampler, u: np.cbrt(2 * u[:, 0] - 1),
        ),
        _case(
            "tabulated",
            "Tabulated cosine",
            TABLE,
            "piecewise linear in the cosine",
            "the density is taken as constant in each cell",
            lambda sampler, u: np.interp(u[:, 0], phase_cdf(TABLE, np.array(TABLE.cosines)).value, TABLE.cosines),
        ),
        _case(
            "mixture",
            "Cosine of a mixture of mixtures",
            NESTED,
            "sum of weighted densities",
            "the uniform that chose a component is used again as it is",
            _first_component,
        ),
    ]
