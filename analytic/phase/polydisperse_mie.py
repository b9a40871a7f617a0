"""Lorenz-Mie scattering by spheres of many sizes: the mean of one sphere's series, weighted by number and cross section.

Weighted with the area of the spheres, diameters are gamma distributed with mean a and variance b a^2, or log-normal with the same
two: that law is cut off at both ends and integrated in ln d by panels of 16 Gauss-Legendre nodes, whose number is doubled until
nothing changes any more. The angular functions are the same for all sizes, so amplitudes are matrix products.

The error is an estimate: the change that the last doubling made, and what was cut off. Spheres that do not absorb have resonances
narrower than any panel; they are most of it.
Source: Hansen & Travis 1974, Space Sci. Rev. 16, 527, section 2.4.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fogproof.analytic.airlight.phase import AirlightPhase
from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.arithmetic.panel_rule import NODES, WEIGHTS
from fogproof.analytic.phase import mie
from fogproof.errors import UnsupportedError
from fogproof.scene.phase import PolydisperseMie

SOURCE = "Hansen & Travis 1974, Space Sci. Rev. 16, 527; Bohren & Huffman 1983, ch. 4"
METHOD = "Lorenz-Mie series, integrated over sizes"

CUT = 1e-14
"""Share of the area of all spheres that is left out at either end."""

LARGEST_SIZE = 1000.0
"""Size parameter of the largest sphere that is served: the time grows with its square."""

PANELS = (8, 16, 32, 64, 128, 256)
ENOUGH = 1e-9
"""Change of the density by the last doubling, relative to its greatest value, with which doubling ends."""

BRIGHTEST = 6.0
"""No sphere scatters more than so many times the light that falls on it; twice what is met in practice."""


@dataclass(frozen=True)
class MeanOverSizes:
    """The density as Chebyshev coefficients, the changes of the last doubling, and its relative size and rounding."""

    coefficients: np.ndarray
    change: np.ndarray
    relative: float
    absolute: float


def pdf(phase: PolydisperseMie, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return f(mu) [1/sr]."""
    known = _mean(phase)
    value = np.maximum(np.polynomial.chebyshev.chebval(mu, known.coefficients), 0.0)
    change = np.abs(np.polynomial.chebyshev.chebval(mu, known.change))
    return value, change + known.relative * value + known.absolute


def cdf(phase: PolydisperseMie, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F(mu): the integral of a polynomial, exactly."""
    known = _mean(phase)
    value, change = (
        2 * np.pi * np.polynomial.chebyshev.chebval(mu, np.polynomial.chebyshev.chebint(c, lbnd=-1))
        for c in (known.coefficients, known.change)
    )
    absolute = 2 * np.pi * known.absolute * (1 + mu)
    return np.clip(value, 0, 1), np.abs(change) + known.relative * np.minimum(value, 1 - value).clip(0) + absolute


def mean_cosine(phase: PolydisperseMie) -> tuple[float, float]:
    """Return g: int T_k mu dmu is the mean of those of T_(k-1) and T_(k+1)."""
    known = _mean(phase)
    orders = range(known.coefficients.size)
    whole = np.array([_whole(abs(k - 1)) / 2 + _whole(k + 1) / 2 for k in orders])
    value, change = (2 * np.pi * float(c @ whole) for c in (known.coefficients, known.change))
    return value, abs(change) + known.relative * (1 - abs(value)) + 4 * np.pi * known.absolute


def airlight(phase: PolydisperseMie) -> AirlightPhase:
    """Return 4 pi f."""
    return mie.airlight_of_series(lambda mu: pdf(phase, mu), _mean(phase).coefficients.size - 1)


def _whole(k: int) -> float:
    """Return the integral of T_k over [-1, 1]."""
    return 2 / (1.0 - k * k) if k % 2 == 0 else 0.0


def _ends(phase: PolydisperseMie) -> tuple[float, float]:
    """Return the smallest and the largest diameter that count, over the effective one."""
    from scipy.special import gammainccinv, gammaincinv, ndtri

    b = phase.effective_variance
    if phase.distribution == "gamma":
        return b * gammaincinv(1 / b, CUT), b * gammainccinv(1 / b, CUT)
    s = math.sqrt(math.log1p(b))
    return math.exp(s * ndtri(CUT) - s * s / 2), math.exp(-s * ndtri(CUT) - s * s / 2)


def _area(phase: PolydisperseMie, ratio: np.ndarray) -> np.ndarray:
    """Return the density of ln d, weighted with the area and up to a factor, at diameters over the effective one."""
    b = phase.effective_variance
    if phase.distribution == "gamma":
        return np.exp((np.log(ratio) - ratio + 1) / b)
    s2 = math.log1p(b)
    return np.exp(-((np.log(ratio) + s2 / 2) ** 2) / (2 * s2))


@lru_cache(maxsize=16)
def _mean(phase: PolydisperseMie) -> MeanOverSizes:
    from scipy.fft import dct

    low, high = _ends(phase)
    size = math.pi * phase.effective_diameter * phase.medium_index / phase.wavelength
    if not (size * high <= LARGEST_SIZE and size * low >= mie.SIZES[0]):
        raise UnsupportedError(
            f"means over sizes are served for size parameters {mie.SIZES[0]:g} <= pi d n/wavelength <= {LARGEST_SIZE:g}, and these "
            f"spheres have {size * low:.4g} to {size * high:.4g}: take a smaller effective diameter or variance",
            "phase",
        )
    order = math.ceil(size * high + 8 * (size * high) ** (1 / 3) + 5)
    theta = np.pi * np.arange(2 * order + 1) / (2 * order)
    even, odd = _angular(np.cos(theta), order)
    density = np.zeros((2, theta.size))
    efficiency = 0.0
    for panels in PANELS:
        width = math.log(high / low) / panels
        ratio = np.exp(math.log(low) + width * (np.arange(panels)[:, None] + NODES)).ravel()
        weight = np.tile(WEIGHTS, panels) * _area(phase, ratio)
        light, scattered = _scattered(phase, ratio, weight / ratio**2, even, odd)
        density = np.stack([density[1], light / scattered])
        efficiency = scattered / (np.pi * size * size * float(weight.sum()))
        if panels > PANELS[0] and np.max(np.abs(density[1] - density[0])) <= ENOUGH * density[1].max():
            break
    coefficients, change = (_chebyshev(dct(row, type=1)) for row in (density[1], density[1] - density[0]))
    relative = np.abs(density[1] - density[0]) / np.maximum(density[1], 1e-300)
    # Spheres that are left out scatter that share of the light, none of them more than x^2/pi of its own in any direction.
    lost = 2 * CUT * BRIGHTEST / efficiency
    absolute = (64 + order) * EPS * float(density[1].max()) + 2 * lost * (size * high) ** 2 / np.pi
    return MeanOverSizes(coefficients, change, float(np.sqrt(np.mean(relative**2))) + lost, absolute)


def _chebyshev(transformed: np.ndarray) -> np.ndarray:
    coefficients: np.ndarray = transformed / (transformed.size - 1)
    coefficients[[0, -1]] /= 2
    return coefficients


def _angular(mu: np.ndarray, order: int) -> tuple[np.ndarray, np.ndarray]:
    """Return (2 n + 1)/(n (n + 1)) times pi_n and tau_n, (order, m) each, by the differences that `mie` uses."""
    c, sign = 1 - np.abs(mu), np.where(mu < 0, -1.0, 1.0)
    even, odd = np.empty((2, order, mu.size))
    pi, d, parity = np.ones_like(mu), np.ones_like(mu), np.ones_like(mu)
    for n in range(1, order + 1):
        scale = (2 * n + 1) / (n * (n + 1)) * parity
        even[n - 1], odd[n - 1] = scale * pi, scale * sign * ((n + 1) * d - pi - n * c * pi)
        d = ((n + 1) * d - (2 * n + 1) * c * pi) / n
        pi, parity = pi + d, parity * sign
    return even, odd


def _scattered(
    phase: PolydisperseMie, ratio: np.ndarray, weight: np.ndarray, even: np.ndarray, odd: np.ndarray
) -> tuple[np.ndarray, float]:
    """Return the weighted sums over sizes of (|S1|^2 + |S2|^2)/2, and of its integral over the sphere."""
    light, whole = np.zeros(even.shape[1]), 0.0
    m = phase.refractive_index / phase.medium_index
    for block in np.array_split(np.arange(ratio.size), max(1, ratio.size // 64)):
        a, b = np.zeros((2, block.size, even.shape[0]), complex)
        for row, i in enumerate(block):
            x = math.pi * phase.effective_diameter * ratio[i] * phase.medium_index / phase.wavelength
            series = mie.coefficients(m, x)
            a[row, : series[0].size], b[row, : series[1].size] = series
        S1, S2 = a @ even + b @ odd, a @ odd + b @ even
        light += weight[block] @ (np.abs(S1) ** 2 + np.abs(S2) ** 2) / 2
        n = np.arange(1.0, even.shape[0] + 1)
        whole += 2 * np.pi * float(weight[block] @ ((np.abs(a) ** 2 + np.abs(b) ** 2) @ (2 * n + 1)))
    return light, whole
