"""Modes of scattering by any phase function, given by its Legendre moments chi_l.

With symmetric matrices A = 1 - c sum_{even l} chi_l v_l v_l^T and B likewise over odd l, v_l = sqrt((2 l + 1) w_i) P_l(mu_i),
the modes solve A p = k^2 M B^-1 M p. Albedos are complex, for scattering orders.
Source: Stamnes, Tsay, Wiscombe & Jayaweera 1988, Applied Optics 27, section III; Nakajima & Tanaka 1986.
"""

from __future__ import annotations

import numpy as np

from fogproof.analytic.multiple.slab_modes import Modes, legendre


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
