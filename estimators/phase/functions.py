"""From a scene's phase function to its formulas."""

from __future__ import annotations

from types import ModuleType

import numpy as np

from fogproof.estimators.phase import (
    draine,
    henyey_greenstein,
    isotropic,
    lobes,
    lorenz_mie,
    mixture,
    rayleigh,
    schlick,
    tabulated,
)
from fogproof.estimators.phase.polar import Polar
from fogproof.scene import phase_functions as scene
from fogproof.scene.phase_functions import PhaseFunction

FORMULAS: dict[type, ModuleType] = {
    scene.Isotropic: isotropic,
    scene.HenyeyGreenstein: henyey_greenstein,
    scene.Schlick: schlick,
    scene.Hazy: lobes,
    scene.Murky: lobes,
    scene.Rayleigh: rayleigh,
    scene.CornetteShanks: draine,
    scene.Draine: draine,
    scene.Mie: lorenz_mie,
    scene.Tabulated: tabulated,
}
"""The module of each simple kind, see `polar`; the others are mixtures of these."""


def phase_value(phase: PhaseFunction, mu: np.ndarray) -> np.ndarray:
    """Return the phase function at forward cosines mu (n,) [1/sr]."""
    return density(phase, 1 - mu, 1 + mu)


def density(phase: PhaseFunction, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function at 1 - mu and 1 + mu (n,) [1/sr]."""
    formulas = FORMULAS.get(type(phase))
    return (
        formulas.density(phase, versine, coversine) if formulas else mixture.density(_parts(phase), versine, coversine)
    )


def polar(phase: PhaseFunction, xi: np.ndarray) -> Polar:
    """Map uniforms (n,) to scattering angles and their pdf."""
    formulas = FORMULAS.get(type(phase))
    return formulas.polar(phase, xi) if formulas else mixture.polar(_parts(phase), xi)


def cosines(phase: PhaseFunction, xi: np.ndarray, out: np.ndarray) -> None:
    """Write to `out` the forward cosines that uniforms (n,) map to."""
    formulas = FORMULAS.get(type(phase))
    if formulas:
        formulas.cosines(phase, xi, out)
    else:
        at = mixture.polar(_parts(phase), xi)
        np.multiply(0.5, at.coversine - at.versine, out=out)


def phase_table(phase: PhaseFunction) -> PhaseFunction:
    """Return the phase function whose density the directions have: the table of a Lorenz-Mie function, the others' own."""
    match phase:
        case scene.Mie():
            return lorenz_mie.table(phase)
        case scene.Mixture(components, weights):
            return scene.Mixture(tuple(phase_table(part) for part in components), weights)
    return phase


def _parts(phase: PhaseFunction, share: float = 1.0) -> list[mixture.Part]:
    """Return the components of a mixture, nested ones unpacked."""
    match phase:
        case scene.DoubleHenyeyGreenstein(g1, g2, weight):
            lobes_of = ((weight, scene.HenyeyGreenstein(g1)), (1 - weight, scene.HenyeyGreenstein(g2)))
            return [(share * w, henyey_greenstein, lobe) for w, lobe in lobes_of if w > 0]
        case scene.Mixture(components, weights):
            total = sum(weights)
            pairs = zip(weights, components, strict=True)
            return [part for w, inner in pairs if w > 0 for part in _parts(inner, share * w / total)]
    return [(share, FORMULAS[type(phase)], phase)]
