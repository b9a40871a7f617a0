"""Directions in single precision against the oracle."""

from __future__ import annotations

import numpy as np

from fogproof.catalogue.cases import Case
from fogproof.catalogue.phase.directions import (
    TILTED,
    case_of_directions,
    sampled_from,
    textbook_inverse,
)
from fogproof.scene import (
    Hazy,
    HenyeyGreenstein,
    Murky,
    Rayleigh,
    Schlick,
)


def cases() -> list[Case]:
    """Return the cases of single precision."""
    nishita = "Nishita, Miyawaki & Nakamae 1987"
    schlick = "Blasi, Le Saec & Schlick 1993"
    return [
        case_of_directions(
            name="float32/henyey-greenstein",
            title="Henyey-Greenstein directions in single precision, g = 1e-6",
            phase=HenyeyGreenstein(1e-6),
            source="Henyey & Greenstein 1941",
            error="the textbook inverse, whose digits cancel long before g = 0",
            sample=textbook_inverse,
            precision="float32",
        ),
        case_of_directions(
            name="float32/henyey-greenstein/sharp",
            title="Henyey-Greenstein directions in single precision, g = 0.98",
            phase=HenyeyGreenstein(0.98),
            source="Henyey & Greenstein 1941",
            error="uniforms of 12 bits",
            sample=lambda sampler, u: sampler.sample(np.floor(4096 * u) / 4096).x,
            axis=TILTED,
            precision="float32",
        ),
        case_of_directions(
            name="float32/rayleigh",
            title="Rayleigh directions in single precision",
            phase=Rayleigh(),
            source="Rayleigh 1871",
            error="the azimuth is drawn once for sixty-four directions",
            sample=lambda sampler, u: (
                sampler.sample(np.stack([u[:, 0], np.repeat(u[::64, 1], 64)[: len(u)]], axis=-1)).x
            ),
            precision="float32",
        ),
        case_of_directions(
            name="float32/hazy",
            title="Hazy atmosphere in single precision",
            phase=Hazy(),
            source=nishita,
            error="the power of the murky atmosphere in the sampler",
            sample=sampled_from(Murky()),
            axis=TILTED,
            precision="float32",
        ),
        case_of_directions(
            name="float32/schlick",
            title="Schlick directions in single precision, k = -0.9",
            phase=Schlick(-0.9),
            source=schlick,
            error="the sampler has k = -0.88",
            sample=sampled_from(Schlick(-0.88)),
            axis=TILTED,
            precision="float32",
        ),
    ]
