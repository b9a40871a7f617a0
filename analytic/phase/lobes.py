"""Hazy and murky atmosphere: f(mu) = (1/2 + (n+1)/2 u^n)/(4 pi), u = (1 + mu)/2, n = 8 (hazy) and 32 (murky).

The lobe (n+1) u^n/(4 pi) integrates to 1, and so does the isotropic part: half of the light goes into each. (Lectures print
5 + u^8 and 17 + u^32; 5 and 17 are the peak values of the right bracket, not its constant.)
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.scene.phase_functions import Hazy, Murky

SOURCE = "Nishita, Miyawaki & Nakamae 1987, SIGGRAPH '87, 303, normalised"
METHOD = "closed form"
EXPONENT = {Hazy: 8, Murky: 32}


def _lobe(phase: Hazy | Murky, mu: np.ndarray) -> tuple[int, np.ndarray, np.ndarray]:
    """Return n, u and u^n, whose relative errors are eps/2 and (n/2 + 1) eps."""
    n = EXPONENT[type(phase)]
    u = (1 + mu) / 2
    power = u
    for _ in range(n.bit_length() - 1):
        power = power * power
    return n, u, power


def pdf(phase: Hazy | Murky, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) [1/sr]; relative error 3 eps, and n eps of the lobe's part."""
    n, _, power = _lobe(phase, mu)
    lobe = (n + 1) / (8 * np.pi) * power
    value = 1 / (8 * np.pi) + lobe
    return value, EPS * (3 * value + n * lobe)


def cdf(phase: Hazy | Murky, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu) = (u + u^(n+1))/2; relative error 2 eps, and n eps of the lobe's part."""
    n, u, power = _lobe(phase, mu)
    lobe = u * power / 2
    value = u / 2 + lobe
    return value, EPS * (2 * value + n * lobe)


def mean_cosine(phase: Hazy | Murky) -> tuple[float, float]:
    """Return n/(2 (n + 2)): 2/5 and 8/17."""
    n = EXPONENT[type(phase)]
    value = n / (2 * (n + 2))
    return value, EPS / 2 * value
