"""The airlight integral in closed form with the complex exponential integral (isotropic scattering).

    I = 2/h e^(sigma a) (J(v_a) - J(v_b)),    v = (t + r)/h,    J(v) = int_v^inf e^(-H x) / (1 + x^2) dx
                                                                     = Im[ e^(-i H) E_1(H (v - i)) ]

In float64 the difference of two J cancels for short or distant segments, and J itself is a small imaginary part where
v >> 1 (light behind the camera, or close to the line). The error estimate counts rounding of E_1 (that of SciPy's
series for |z| < 5 loses four digits, measured against ball arithmetic) and of its argument.
Source: Pegoraro & Parker 2009, An analytical solution to single scattering in homogeneous participating media, eq. 14.
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.errors import UnsupportedError
from fogproof.scene.phase import Isotropic, PhaseFunction

METHOD = "Pegoraro & Parker 2009, complex exponential integral"
SOURCE = "Pegoraro & Parker 2009, eq. 14"


def integrate(
    sigma: np.ndarray, h: np.ndarray, a: np.ndarray, b: np.ndarray, phase: PhaseFunction
) -> tuple[np.ndarray, np.ndarray]:
    """Return the integral over each segment, and an estimate of its error."""
    if not isinstance(phase, Isotropic):
        raise UnsupportedError(f"the closed form of Pegoraro & Parker 2009 is for isotropic scattering, not {phase!r}")
    H = sigma * h
    (Ja, error_a), (Jb, error_b) = _tail(H, v_of(a, h)), _tail(H, v_of(b, h))
    scale = 2 / h * np.exp(sigma * a)
    value = scale * (Ja - Jb)
    error = scale * (error_a + error_b) + (4 + sigma * np.abs(a)) * EPS * np.abs(value) + 4 * TINY
    return value, np.where(np.isfinite(value) & np.isfinite(error), error, np.inf)


def v_of(t: np.ndarray, h: np.ndarray) -> np.ndarray:
    """Return (t + hypot(t, h))/h, without cancellation."""
    r = np.hypot(t, h)
    return np.where(t >= 0, (t + r) / h, h / (r - t))


def exponential_integral(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return E_1(z) for Re z >= 0, z != 0, and its error: 20 eps, beside what SciPy's series loses for |z| < 5."""
    from scipy.special import exp1

    size = np.abs(z)
    with np.errstate(all="ignore"):
        value = exp1(z)
        return value, EPS * (20 + np.where(size <= 5.01, 4 * np.exp(1.9 * size), 0.0)) * np.abs(value) + 4 * TINY


def _tail(H: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return J(v) and its error; 0 at v = inf."""
    there = v < np.inf
    z = np.where(there & (H > 0), H * (np.where(there, v, 0) - 1j), 1.0)
    value, error = exponential_integral(z)
    J = (np.exp(-1j * H) * value).imag
    moved = 4 * EPS * (1 + np.abs(z)) * np.exp(-z.real) / np.abs(z) * np.abs(z)
    error = error + 2 * EPS * (1 + H) * np.abs(value) + moved
    empty = H == 0
    J = np.where(empty, np.arctan2(1.0, v), J)
    error = np.where(empty, 4 * EPS * J, error)
    return np.where(there, J, 0.0), np.where(there, error, 0.0)
