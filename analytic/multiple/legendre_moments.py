"""Legendre moments of phase functions: chi_l = int P_l(mu) f(mu) dOmega, so chi_0 = 1 and chi_1 is the mean cosine."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.multiple.slab_modes import legendre
from fogproof.analytic.phase.functions import phase_pdf
from fogproof.scene.phase import HenyeyGreenstein, Isotropic, PhaseFunction, Rayleigh

NODES = 1024
"""Of the Gauss-Legendre rule for phase functions without a closed form."""


def legendre_moments(phase: PhaseFunction, count: int) -> np.ndarray:
    """Return chi_0 … chi_count, (count + 1,); closed forms where there are any, else within about 1e-13.

    A peak narrower than 0.01 in the cosine is not resolved by the rule of 1024 nodes.
    """
    match phase:
        case Isotropic():
            return np.eye(count + 1)[0]
        case HenyeyGreenstein(g):
            return g ** np.arange(count + 1.0)
        case Rayleigh():
            return np.pad([1.0, 0.0, 0.1], (0, max(count - 2, 0)))[: count + 1]
    mu, w = np.polynomial.legendre.leggauss(NODES)
    chi = legendre(count, mu) @ (2 * np.pi * w * phase_pdf(phase, mu).value)
    return chi / chi[0]
