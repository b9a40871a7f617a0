"""An isotropic point source in an infinite medium of any phase function, through the Fourier transform of its fluence.

With moments chi_l and h_l = (2 l + 1)(1 - c chi_l) the transform at the wave number i kappa is 1/D(kappa), where

    D = h_0 - kappa rho_1,    rho_l = l kappa / (h_l - (l + 1) kappa rho_(l + 1)),

a continued fraction that ends in the ratio of Legendre functions Q_(L + 1)/Q_L(1/kappa) once chi_l = 0 beyond L. Poles lie at
0 <= kappa < 1; the number of negative denominators, D among them, is that of poles below kappa (Sturm), so none is missed.
Across the cut from kappa = 1 on the transform jumps, and

    4 pi r phi(r) = sum_j residue_j exp(-kappa_j r) + int_1^inf (2 kappa/pi) |Im(1/D)| exp(-kappa r) dkappa.

Source: Davison & Sykes 1957, Neutron Transport Theory, chapter 17; McCormick & Kuscer 1966, Journal of Mathematical Physics 7.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

HALVINGS, POLISHES = 30, 3
"""Of the interval of logit(kappa) that holds a pole, and steps of Newton's method inside it then."""

FIRST, LAST = -90.0, 230.0
"""That interval: from kappa = 1e-39 on, and up to 1 - kappa = 1e-100, nearer to which no pole is worth anything."""

CLIMBS = 4.0
"""Exponent up to which Legendre functions of the second kind are climbed upwards, which loses twice as much."""

FADES = 20.0
"""Exponent after which it does not matter where their continued fraction began."""


class Poles(NamedTuple):
    """Where the transform has poles, and what each is worth, (m,) each."""

    kappa: np.ndarray
    residue: np.ndarray


def poles(c: float, chi: np.ndarray) -> Poles:
    """Return all poles for an albedo c in (0, 1] and moments chi (L + 1,), L >= 1."""
    h = _shares(c, chi)
    count = int(_transform(h, np.array([LAST]))[1][0])
    first = 1 if c == 1 else 0  # nothing absorbed: D is -kappa^2/h_1 at the origin, to all that matters
    low, high = np.full(count - first, FIRST), np.full(count - first, LAST)
    order = np.arange(first, count)
    for _ in range(HALVINGS if len(order) else 0):
        middle = (low + high) / 2
        above = _transform(h, middle)[1] > order
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    at = (low + high) / 2
    for _ in range(POLISHES + 1):
        kappa, gap = 1 / (1 + np.exp(-at)), 1 / (1 + np.exp(at))
        step = 1e-30 * gap
        D, _ = _transform(h, at, step)
        slope = np.imag(D) / step
        at = np.clip(at - np.real(D) / (slope * kappa * gap), low, high)
    residue = -2 * kappa / slope
    if first:
        kappa, residue = np.append(0.0, kappa), np.append(h[1], residue)
    return Poles(kappa, residue)


def cut(c: float, chi: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return (2 kappa/pi) |Im(1/D)| at kappa = 1 + u (n,)."""
    h, kappa = _shares(c, chi), 1 + u
    # Q_l + i pi/2 P_l at 1/kappa in (0, 1), upwards: neither grows.
    last = 0.5 * np.log1p(2 / u) + 0.5j * np.pi
    ratio = _climbed(len(h) - 1, kappa, last)
    D, _ = _fraction(h, kappa, ratio)
    density: np.ndarray = 2 * kappa / np.pi * np.abs(np.imag(1 / D))
    return density


def _shares(c: float, chi: np.ndarray) -> np.ndarray:
    """Return h_l = (2 l + 1)(1 - c chi_l), (L + 1,); h_0 is 3-digit safe for any c."""
    return (2 * np.arange(len(chi)) + 1) * ((1 - c) + c * (1 - chi))


def _transform(h: np.ndarray, at: np.ndarray, step: np.ndarray | float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return D at kappa = 1/(1 + e^-at) (n,), and how many poles lie below; a step is taken along the imaginary axis."""
    kappa = 1 / (1 + np.exp(-at)) + 1j * step
    gap = 1 / (1 + np.exp(at)) - 1j * step
    last = len(h) - 1
    # cosh a = 1/kappa: Q_l falls like exp(-a l).
    a = np.log1p((np.real(gap) + np.sqrt(np.real(gap) * (1 + np.real(kappa)))) / np.real(kappa))
    near = a * (last + 1) < CLIMBS
    ratio = np.zeros_like(kappa)
    if near.any():
        ratio[near] = _climbed(last, kappa[near], 0.5 * np.log((1 + kappa[near]) / gap[near]))
    if not near.all():
        far = kappa[~near]
        for degree in range(last + 10 + max(0, int(FADES / a[~near].min()) - last), last, -1):
            ratio[~near] = degree * far / ((2 * degree + 1) - (degree + 1) * far * ratio[~near])
    return _fraction(h, kappa, ratio)


def _climbed(last: int, kappa: np.ndarray, zeroth: np.ndarray) -> np.ndarray:
    """Return Q_(last + 1)/Q_last at 1/kappa from Q_0."""
    before, now = zeroth, zeroth / kappa - 1
    for degree in range(1, last + 1):
        before, now = now, ((2 * degree + 1) * now / kappa - degree * before) / (degree + 1)
    ratio: np.ndarray = now / before
    return ratio


def _fraction(h: np.ndarray, kappa: np.ndarray, ratio: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return D from the last ratio, and how many denominators have a negative real part."""
    negative = np.zeros(kappa.shape, int)
    for degree in range(len(h) - 1, 0, -1):
        denominator = h[degree] - (degree + 1) * kappa * ratio
        negative += np.real(denominator) < 0
        ratio = degree * kappa / denominator
    D = h[0] - kappa * ratio
    return D, negative + (np.real(D) < 0)
