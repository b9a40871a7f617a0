"""Value and sampler of any phase function: those of its own module, or what serves every kind."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.kernels.path_data import AnyLobe
from fogproof.estimators.phase import weighted
from fogproof.estimators.phase.kinds import ROOM, formula, weighted_parts
from fogproof.estimators.phase.polar import Polar
from fogproof.scene.kinds import given
from fogproof.scene.phase import AnyPhase, PhaseFunction


def phase_value(phase: PhaseFunction, mu: np.ndarray) -> np.ndarray:
    """Return the phase function at forward cosines mu (n,) [1/sr]."""
    return density(phase, 1 - mu, 1 + mu)


def density(phase: PhaseFunction, versine: np.ndarray, coversine: np.ndarray) -> np.ndarray:
    """Return the phase function at 1 - mu and 1 + mu (n,) [1/sr]."""
    if given(phase, ROOM, "parts") is not None:
        return weighted.density(weighted_parts(phase), versine, coversine)
    value: np.ndarray = formula(phase, "density")(phase, versine, coversine)
    return value


def polar(phase: PhaseFunction, xi: np.ndarray) -> Polar:
    """Map uniforms (n,) to scattering angles and their pdf."""
    if given(phase, ROOM, "parts") is not None:
        return weighted.polar(weighted_parts(phase), xi)
    at: Polar = formula(phase, "polar")(phase, xi)
    return at


def cosines(phase: PhaseFunction, xi: np.ndarray, out: np.ndarray) -> None:
    """Write to `out` the forward cosines that uniforms (n,) map to."""
    own = given(phase, ROOM, "cosines")
    if own is not None:
        own(phase, xi, out)
    else:
        at = polar(phase, xi)
        np.multiply(0.5, at.coversine - at.versine, out=out)


def phase_table(phase: PhaseFunction) -> PhaseFunction:
    """Return the phase function whose density the directions have: the table of a Lorenz-Mie function, the others' own."""
    table = given(phase, ROOM, "table")
    sampled: PhaseFunction = phase if table is None else table(phase)
    return sampled


def kernel_lobe(phase: AnyPhase) -> AnyLobe:
    """Return a phase function for compiled kernels: its own closed form, or a table of its density (see `tabulated_lobe`)."""
    own = given(phase, ROOM, "lobe")
    lobe: AnyLobe
    if own is not None:
        lobe = own(phase)
    else:
        from fogproof.estimators.phase.tabulated_lobe import tabulated_lobe

        lobe = tabulated_lobe(phase).lobe
    return lobe
