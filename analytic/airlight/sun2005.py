"""The airlight integral by the two-dimensional table of Sun et al. 2005 (isotropic scattering).

    F(u, v) = int_0^v exp(-u tan x) dx,    I = 2/h e^(sigma a) (F(H, v_b) - F(H, v_a)),    H = sigma h,  tan v = (t + r)/h

F is tabulated for u in [0, 20], v in [0, pi/2] and interpolated bilinearly, as it was in graphics hardware. It is
tabulated here over u^(1/4), which crowds the grid where F is steep.

Error bound. F is decreasing in u and increasing in v, so it and its interpolant lie between two corners of each cell.
Finer: along u it is convex, and along v concave, each with known slopes at the grid points; a convex function is below
its chord by at most a quarter of the width times the difference of the end slopes. The smaller of the two bounds holds.
Source: Sun, Ramamoorthi, Narasimhan & Nayar 2005, A practical analytic single scattering model, eqs. 9-11.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.errors import UnsupportedError
from fogproof.scene.phase import Isotropic, PhaseFunction

METHOD = "Sun et al. 2005, table of 512 x 512"
SOURCE = "Sun, Ramamoorthi, Narasimhan & Nayar 2005, eqs. 9-11"

SIZE = 512
LARGEST_U = 20.0


def integrate(
    sigma: np.ndarray, h: np.ndarray, a: np.ndarray, b: np.ndarray, phase: PhaseFunction
) -> tuple[np.ndarray, np.ndarray]:
    """Return the integral over each segment, and a bound of its error; infinite beyond the table."""
    if not isinstance(phase, Isotropic):
        raise UnsupportedError(f"the table of Sun et al. 2005 is for isotropic scattering, not {phase!r}", "phase")
    H = sigma * h
    (Fa, error_a), (Fb, error_b) = (_interpolate(H, _angle(t, h)) for t in (a, b))
    scale = 2 / h * np.exp(sigma * a)
    return scale * (Fb - Fa), np.where(H <= LARGEST_U, scale * (error_a + error_b), np.inf)


def _angle(t: np.ndarray, h: np.ndarray) -> np.ndarray:
    """Return atan((t + r)/h) = pi/4 + atan(t/h)/2."""
    return np.pi / 4 + 0.5 * np.arctan2(t, h)


def _interpolate(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    us, vs, F, bends = _table()
    i = np.clip(np.searchsorted(us, u) - 1, 0, SIZE - 2)
    j = np.clip(np.searchsorted(vs, v) - 1, 0, SIZE - 2)
    x = np.clip((u - us[i]) / (us[i + 1] - us[i]), 0, 1)
    y = np.clip((v - vs[j]) / (vs[j + 1] - vs[j]), 0, 1)
    low, high = F[i + 1, j], F[i, j + 1]
    value = (1 - x) * ((1 - y) * F[i, j] + y * F[i, j + 1]) + x * ((1 - y) * F[i + 1, j] + y * F[i + 1, j + 1])
    error = np.minimum(high - low, bends[i, j]) + 16 * EPS
    return value, error


@cache
def _table() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the grid, F on it, and the bound of the interpolation error from the slopes in each cell."""
    us, vs = LARGEST_U * np.linspace(0, 1, SIZE) ** 4, np.linspace(0, np.pi / 2, SIZE)
    x, w = np.polynomial.legendre.leggauss(16)
    inner = vs[:-1, None] + np.diff(vs)[:, None] * (1 + x) / 2
    tangent = np.tan(inner)
    cells = np.exp(-us[:, None, None] * tangent) @ (w / 2) * np.diff(vs)
    F = np.concatenate([np.zeros((SIZE, 1)), np.cumsum(cells, axis=1)], axis=1)
    moments = (np.exp(-us[:, None, None] * tangent) * tangent) @ (w / 2) * np.diff(vs)
    F_u = -np.concatenate([np.zeros((SIZE, 1)), np.cumsum(moments, axis=1)], axis=1)
    F_u[0] = np.log(np.cos(vs))
    F_u[0, -1] = -np.inf
    with np.errstate(invalid="ignore"):
        F_v = np.exp(-us[:, None] * np.where(vs < vs[-1], np.tan(vs), np.inf))
    F_v[0] = 1.0
    along_u = np.diff(us)[:, None] / 4 * np.diff(F_u, axis=0)
    along_v = np.diff(vs) / 4 * -np.diff(F_v, axis=1)
    bends = np.maximum(along_u[:, :-1], along_u[:, 1:]) + np.maximum(along_v[:-1], along_v[1:])
    return us, vs, F, bends
