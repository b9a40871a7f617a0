"""Modes of scattering by any phase function, given by its Legendre moments chi_l.

With symmetric matrices A = 1 - c sum_{even l} chi_l v_l v_l^T and B likewise over odd l, v_l = sqrt((2 l + 1) w_i) P_l(mu_i),
the modes solve A p = k^2 M B^-1 M p: a symmetric problem for 1/k^2 after A is taken apart as L L^T. As c -> 1 one k
vanishes; it belongs to v_0, an exact eigenvector of A whose eigenvalue 1 - c stands on its own, and it is split off
before rounding could spoil the others.
Source: Stamnes, Tsay, Wiscombe & Jayaweera 1988, Applied Optics 27, section III; Nakajima & Tanaka 1986.
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.multiple.slab_modes import Modes, legendre

NEARLY_CONSERVATIVE = 0.05
"""1 - c below which the smallest k is split off."""

_ITERATIONS = 500


def legendre_modes(c: float, absorbed: float, chi: np.ndarray, mu: np.ndarray, w: np.ndarray) -> Modes:
    """Return the modes for an albedo c in [0, 1] and moments chi (L + 1,) at nodes mu (n,) with weights w.

    absorbed  1 - c
    """
    v, root = _vectors(chi, mu, w)
    A, B = _matrix(c, chi[2::2], v[2::2]), _matrix(c, chi[1::2], v[1::2])
    N = mu[:, None] * np.linalg.inv(B) * mu
    turn = _reflection(v[0])  # its last column is v_0
    L = np.linalg.cholesky(_symmetric((turn @ A @ turn)[:-1, :-1]))
    N = turn @ N @ turn
    across = np.linalg.solve(L, N[:-1, -1])
    inner = _symmetric(np.linalg.solve(L, np.linalg.solve(L, N[:-1, :-1]).T))
    if absorbed < NEARLY_CONSERVATIVE:
        inverse_squares, rest, along = _split(inner, across, N[-1, -1], absorbed)
    else:
        whole = np.block(
            [[inner, across[:, None] / np.sqrt(absorbed)], [across / np.sqrt(absorbed), N[-1, -1] / absorbed]]
        )
        inverse_squares, y = np.linalg.eigh(whole)
        rest, along = y[:-1], y[-1] / np.sqrt(absorbed)
    k = np.where(np.isinf(inverse_squares), 0.0, 1 / np.sqrt(np.maximum(inverse_squares, np.min(mu) ** 2)))
    symmetric_p = turn @ np.vstack([np.linalg.solve(L.T, rest), along])
    return _modes(c, chi, mu, w, k, symmetric_p, np.linalg.solve(B, mu[:, None] * symmetric_p), v, root)


def _split(
    inner: np.ndarray, across: np.ndarray, corner: float, absorbed: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return all 1/k^2 and their vectors (rest, along v_0 / sqrt(absorbed)), the smallest k last.

    In coordinates where v_0 is divided by s = sqrt(absorbed), the matrix is [[inner, across/s], [across/s, corner/s^2]]. Its
    dominant vector is (s z, 1) with z a fixed point; in the basis orthogonal to it nothing is divided by s any more.
    """
    identity = np.eye(len(inner))
    m, z = corner, across / corner
    for _ in range(_ITERATIONS):  # each gains the ratio of the two smallest k^2
        previous, z = z, (across + absorbed * (inner @ z)) / m
        m = corner + absorbed * float(across @ z)
        if np.max(np.abs(z - previous)) <= EPS * np.max(np.abs(z)):
            break
    square = 1 + absorbed * (z @ z)
    r = np.sqrt(square)
    basis = identity - absorbed / (r * (1 + r)) * np.outer(z, z)
    x = basis @ across / r
    deflated = basis @ inner @ basis - np.outer(x, z) - np.outer(z, x) + corner / square * np.outer(z, z)
    inverse_squares, y = np.linalg.eigh(_symmetric(deflated))
    largest = m / absorbed if absorbed > 0 else np.inf
    rest = np.column_stack([basis @ y, absorbed * z])
    along = np.append(-(z @ y) / r, 1.0)
    return np.append(inverse_squares, largest), rest, along


def complex_legendre_modes(c: complex, chi: np.ndarray, mu: np.ndarray, w: np.ndarray) -> Modes:
    """Return the modes for a complex albedo of magnitude well below 1, for scattering orders."""
    v, root = _vectors(chi, mu, w)
    even, even_basis = np.linalg.eigh(np.eye(len(mu)) - _matrix(1.0, chi[0::2], v[0::2]))
    odd, odd_basis = np.linalg.eigh(np.eye(len(mu)) - _matrix(1.0, chi[1::2], v[1::2]))
    half = (even_basis * (1 - c * even) ** -0.5) @ even_basis.T  # A^(-1/2)
    inverse = (odd_basis / (1 - c * odd)) @ odd_basis.T  # B^-1
    inverse_squares, y = np.linalg.eig(half @ (mu[:, None] * inverse * mu) @ half)
    k = 1 / np.sqrt(inverse_squares)
    symmetric_p = half @ y
    return _modes(c, chi, mu, w, k, symmetric_p, inverse @ (mu[:, None] * symmetric_p), v, root)


def _vectors(chi: np.ndarray, mu: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return v_l (L + 1, n) and sqrt(w); v_0 is made exactly orthogonal to the other even ones."""
    root = np.sqrt(w)
    v = legendre(len(chi) - 1, mu) * root * np.sqrt(2 * np.arange(len(chi)) + 1)[:, None]
    v[0] /= np.linalg.norm(v[0])
    v[2::2] -= np.outer(v[2::2] @ v[0], v[0])
    return v, root


def _matrix(c: float, chi: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.eye(v.shape[1]) - c * (v.T * chi) @ v


def _symmetric(a: np.ndarray) -> np.ndarray:
    return (a + a.T) / 2


def _reflection(unit: np.ndarray) -> np.ndarray:
    """Return the Householder reflection whose last column is the unit vector."""
    u = unit.copy()
    u[-1] -= 1
    length = np.linalg.norm(u)
    return np.eye(len(u)) - 2 * np.outer(u / length, u / length) if length > 0 else np.eye(len(u))


def _modes(
    c: complex,
    chi: np.ndarray,
    mu: np.ndarray,
    w: np.ndarray,
    k: np.ndarray,
    p: np.ndarray,
    q: np.ndarray,
    v: np.ndarray,
    root: np.ndarray,
) -> Modes:
    """Return the modes from their symmetric form, sqrt(w) times p and q."""
    scale = (c / 2) * chi * np.sqrt(2 * np.arange(len(chi)) + 1)
    source = np.empty((len(chi), len(k)), p.dtype)
    source[0::2] = scale[0::2, None] * (v[0::2] @ p)
    source[1::2] = scale[1::2, None] * (v[1::2] @ q)
    return Modes(mu, w, k, p / root[:, None], q / root[:, None], source)
