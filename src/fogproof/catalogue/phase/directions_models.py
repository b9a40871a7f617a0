"""Directions of the phase functions of computer graphics and astronomy against the oracle."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fogproof.catalogue.cases import Case
from fogproof.catalogue.phase.directions import (
    TILTED,
    case_of_directions,
    sampled_from,
)
from fogproof.estimators import Directions
from fogproof.scene import (
    CornetteShanks,
    Draine,
    Hazy,
    HenyeyGreenstein,
    Murky,
    Schlick,
)


def _printed(constant: float, power: int) -> Callable[[Directions, np.ndarray], np.ndarray]:
    return lambda sampler, x: (constant + ((1 + x[:, 2]) / 2) ** power) / (4 * np.pi)


def _normalised_as_cornette_shanks(sampler: Directions, x: np.ndarray) -> np.ndarray:
    assert isinstance(sampler.phase, Draine)
    g, alpha = sampler.phase.g, sampler.phase.alpha
    return sampler.pdf(x) * (1 + alpha * (1 + 2 * g * g) / 3) / (1 + (1 + 2 * g * g) / 3)


def cases() -> list[Case]:
    """Return the cases of the phase functions of Schlick, Nishita, Cornette and Shanks, and Draine."""
    cornette = "Cornette & Shanks 1992"
    draine = "Draine 2003"
    nishita = "Nishita, Miyawaki & Nakamae 1987"
    schlick = "Blasi, Le Saec & Schlick 1993"
    return [
        case_of_directions(
            name="schlick",
            title="Schlick directions, k = 0.7",
            phase=Schlick(0.7),
            source=schlick,
            error="k is taken for g, and Henyey-Greenstein sampled",
            sample=sampled_from(HenyeyGreenstein(0.7)),
        ),
        case_of_directions(
            name="schlick/backward",
            title="Schlick directions, k = -0.95",
            phase=Schlick(-0.95),
            source=schlick,
            error="backward means forward, in sampler and density alike",
            twin=lambda: Directions(Schlick(0.95), TILTED),
            axis=TILTED,
        ),
        case_of_directions(
            name="hazy",
            title="Hazy atmosphere",
            phase=Hazy(),
            source=nishita,
            error="the density 5 + u^8 over 4 pi, whose integral is 46/9",
            pdf=_printed(5, 8),
        ),
        case_of_directions(
            name="murky",
            title="Murky atmosphere",
            phase=Murky(),
            source=nishita,
            error="the density 17 + u^32 over 4 pi, whose integral is 562/33",
            pdf=_printed(17, 32),
        ),
        case_of_directions(
            name="murky/tilted",
            title="Murky atmosphere",
            phase=Murky(),
            source=nishita,
            error="the power of the hazy atmosphere in the sampler",
            sample=sampled_from(Hazy()),
            axis=TILTED,
        ),
        case_of_directions(
            name="cornette-shanks",
            title="Cornette-Shanks directions, g = 0.6",
            phase=CornetteShanks(0.6),
            source=cornette,
            error="Henyey-Greenstein sampling, whose weight is taken for 1",
            sample=sampled_from(HenyeyGreenstein(0.6)),
            axis=TILTED,
        ),
        case_of_directions(
            name="draine",
            title="Draine directions, g = -0.4, alpha = 3",
            phase=Draine(-0.4, 3.0),
            source=draine,
            error="the density is normalised as if alpha were 1",
            pdf=_normalised_as_cornette_shanks,
        ),
        case_of_directions(
            name="draine/sharp",
            title="Draine directions, g = 0.97, alpha = 0.5",
            phase=Draine(0.97, 0.5),
            source=draine,
            error="alpha is forgotten in the sampler",
            sample=sampled_from(Draine(0.97, 0.0)),
            axis=TILTED,
        ),
    ]
