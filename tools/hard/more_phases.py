"""Phase functions beyond the closed forms of `phases`: Draine, tables, hazy and murky, two lobes, and Lorenz-Mie by its series."""

from __future__ import annotations

import bisect

import mpmath as mp
import numpy as np

from fogproof import analytic
from fogproof.scene import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    Hazy,
    Mie,
    Mixture,
    Murky,
    Rayleigh,
    Tabulated,
)
from hard.case import Kind, number
from hard.phases import cosine


def lobe(g, m):
    return (1 - g * g) / (4 * mp.pi) / mp.sqrt(1 + g * g - 2 * g * m) ** 3


def function(rng):
    """Return a phase function, its density as a formula, and the cosines where that has kinks."""
    g, h, share = (float(x) for x in rng.uniform(-0.95, 0.95, 3))
    gg, hh, alpha, weight = mp.mpf(g), mp.mpf(h), number(rng, 1e-6, 1e3), mp.mpf(abs(share))
    kind = rng.integers(7)
    if kind == 0:
        a = mp.mpf(alpha)
        return Draine(g, alpha), lambda m: lobe(gg, m) * (1 + a * m * m) / (1 + a * (1 + 2 * gg * gg) / 3), []
    if kind == 1:
        size = 3 / (8 * mp.pi) * (1 - gg * gg) / (2 + gg * gg)
        return CornetteShanks(g), lambda m: size * (1 + m * m) / mp.sqrt(1 + gg * gg - 2 * gg * m) ** 3, []
    if kind == 2:
        return DoubleHenyeyGreenstein(g, h, abs(share)), lambda m: weight * lobe(gg, m) + (1 - weight) * lobe(hh, m), []
    if kind == 3:
        return Hazy(), lambda m: (1 + 9 * ((1 + m) / 2) ** 8) / (8 * mp.pi), []
    if kind == 4:
        return Murky(), lambda m: (1 + 33 * ((1 + m) / 2) ** 32) / (8 * mp.pi), []
    if kind == 5:
        phase = Mixture((Draine(g, alpha), Rayleigh()), (0.25, 0.75))
        a = mp.mpf(alpha)
        return (
            phase,
            lambda m: (
                lobe(gg, m) * (1 + a * m * m) / (1 + a * (1 + 2 * gg * gg) / 3) / 4 + 9 * (1 + m * m) / (64 * mp.pi)
            ),
            [],
        )
    at = sorted({-1.0, 1.0, *(float(x) for x in rng.uniform(-1, 1, int(rng.integers(0, 5))))})
    phase = Tabulated.normalised(tuple(at), tuple(float(x) for x in 10.0 ** rng.uniform(-3, 3, len(at))))
    x, y = [mp.mpf(v) for v in phase.cosines], [mp.mpf(v) for v in phase.values]

    def table(m):
        i = min(max(bisect.bisect_right(x, m) - 1, 0), len(x) - 2)
        return y[i] + (y[i + 1] - y[i]) * (m - x[i]) / (x[i + 1] - x[i])

    return phase, table, x[1:-1]


def integral(formula, low, high, kinks):
    """Return the integral over the cosine and how far it may be off, in pieces that end at kinks and crowd at the peaks."""
    ends = {mp.mpf(low), mp.mpf(high)}
    ends |= {mp.mpf(e) for e in (*kinks, -0.99, -0.9, -0.5, 0, 0.5, 0.9, 0.99) if low < e < high}
    value, off = mp.quad(formula, sorted(ends), error=True)
    return value, 10 * off + abs(value) * mp.mpf(10) ** -18


def density(rng):
    with mp.workdps(40):
        phase, formula, _ = function(rng)
        mu = cosine(rng)
        truth = formula(mp.mpf(mu))
    # A table is normalised to a rounding.
    return (
        lambda: analytic.phase_pdf(phase, mu),
        truth,
        truth * 1e-15 if isinstance(phase, Tabulated) else 0,
        f"{phase} {mu}",
    )


def distribution(rng):
    with mp.workdps(25):
        phase, formula, kinks = function(rng)
        mu = float(rng.uniform(-1, 1))
        truth, doubt = integral(lambda m: 2 * mp.pi * formula(m), -1, mu, kinks)
        doubt += truth * mp.mpf("1e-15") * isinstance(phase, Tabulated)
    return lambda: analytic.phase_cdf(phase, mu), truth, doubt, f"{phase} {mu}"


def moment(mean):
    def draw(rng):
        order = 1 if mean else int(rng.integers(1, 12))
        with mp.workdps(25):
            phase, formula, kinks = function(rng)
            truth, doubt = integral(lambda m: 2 * mp.pi * formula(m) * mp.legendre(order, m), -1, 1, kinks)
            doubt += mp.mpf("1e-20") + mp.mpf("1e-15") * isinstance(phase, Tabulated)
        if mean:
            return lambda: analytic.phase_mean_cosine(phase), truth, doubt, f"{phase}"

        def call():
            found = analytic.phase_legendre_moments(phase, order)
            return type(found)(found.value[order], found.error[order], found.method, found.source)

        return call, truth, doubt, f"{phase} {order}"

    return draw


def sphere(rng):
    """Lorenz and Mie's series in many digits, with Bessel functions of half order.

    Source: Bohren & Huffman 1983, eqs. 4.53, 4.62 and 4.74.
    """
    x = number(rng, 1e-2, 12)
    index = complex(float(rng.uniform(1.05, 2)), float(rng.choice([0.0, number(rng, 1e-6, 1)])))
    mu, wavelength = float(rng.uniform(-1, 1)), 5e-7
    diameter = float(x * wavelength / np.pi)
    with mp.workdps(40):
        x, m, cosine = mp.pi * mp.mpf(diameter) / mp.mpf(wavelength), mp.mpc(index), mp.mpf(mu)

        def riccati(bessel, n, z):
            return mp.sqrt(mp.pi * z / 2) * bessel(n + mp.mpf(1) / 2, z)

        def slope(bessel, n, z):
            return riccati(bessel, n - 1, z) - n * riccati(bessel, n, z) / z

        s1 = s2 = scattering = mp.mpf(0)
        before, pi = mp.mpf(0), mp.mpf(1)
        for n in range(1, int(x + 8 * x ** (mp.mpf(1) / 3)) + 22):
            psi, psi_slope = riccati(mp.besselj, n, x), slope(mp.besselj, n, x)
            inner, inner_slope = riccati(mp.besselj, n, m * x), slope(mp.besselj, n, m * x)
            xi, xi_slope = riccati(mp.hankel1, n, x), slope(mp.hankel1, n, x)
            a = (m * inner * psi_slope - psi * inner_slope) / (m * inner * xi_slope - xi * inner_slope)
            b = (inner * psi_slope - m * psi * inner_slope) / (inner * xi_slope - m * xi * inner_slope)
            tau = n * cosine * pi - (n + 1) * before
            share = mp.mpf(2 * n + 1) / (n * (n + 1))
            s1, s2 = s1 + share * (a * pi + b * tau), s2 + share * (a * tau + b * pi)
            scattering += (2 * n + 1) * (abs(a) ** 2 + abs(b) ** 2)
            before, pi = pi, ((2 * n + 1) * cosine * pi - (n + 1) * before) / n
        truth = (abs(s1) ** 2 + abs(s2) ** 2) / (4 * mp.pi * scattering)
    phase = Mie(diameter, wavelength, index)
    return lambda: analytic.phase_pdf(phase, mu), truth, truth * mp.mpf(10) ** -25, f"{phase} {mu}"


KINDS = {
    "phase_pdf/others": Kind(density, 5),
    "phase_cdf/others": Kind(distribution, 0.5),
    "phase_mean_cosine/others": Kind(moment(True), 0.5),
    "phase_legendre_moments/others": Kind(moment(False), 0.5),
    "phase_pdf/mie": Kind(sphere, 0.5),
}
