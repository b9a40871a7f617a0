"""Slabs and balls: modes against doubling, doubling against PythonicDISORT, everything against walks and many digits.

What is compared shares the albedo, the thickness and the cosine and nothing that is computed from them.
"""

from __future__ import annotations

import flint
import mpmath as mp
import numpy as np
from doubling_truth import doubled_truth
from transport_truth import disort, slab_truth

from fogproof import analytic
from fogproof.scene import HenyeyGreenstein, Rayleigh
from hard.case import Kind, albedo, number
from hard.walk import walked

DIRECTIONAL = (analytic.slab_reflectance, analytic.slab_transmittance, analytic.slab_emissivity)
DIFFUSE = (analytic.slab_diffuse_reflectance, analytic.slab_diffuse_transmittance)
ALMOST_ISOTROPIC = HenyeyGreenstein(1e-18)


def by_doubling(which):
    """Thin, deep, grazing, nearly conservative: layers put on one another."""

    def draw(rng):
        c, tau, mu0 = albedo(rng), number(rng, 1e-250, 1e3), number(rng, 1e-3, 1)
        function = DIRECTIONAL[which]
        other = function(c, tau, mu0, ALMOST_ISOTROPIC)
        return lambda: function(c, tau, mu0), mp.mpf(float(other.value)), float(other.error), f"{c} {tau} {mu0}"

    return draw


def average(function, c, tau, n):
    """The average of a function of the cosine over a diffuse sky, by n nodes in sqrt(mu)."""
    y, w = np.polynomial.legendre.leggauss(n)
    y, w = (1 + y) / 2, w / 2
    return float(np.sum(4 * y**3 * w * function(c, tau, y * y).value))


def diffuse(which):
    """The average over cosines of what a beam gives."""

    def draw(rng):
        c, tau = albedo(rng), number(rng, 1e-2, 1e3)
        coarse, fine = (average(DIRECTIONAL[which], c, tau, n) for n in (64, 96))
        doubt = 2 * abs(fine - coarse) + 1e-14 * fine
        return lambda: DIFFUSE[which](c, tau), mp.mpf(fine), doubt, f"{c} {tau}"

    return draw


def by_digits(which):
    def draw(rng):
        c, tau, mu0 = float(rng.uniform(0.01, 1)), number(rng, 0.3, 30), float(rng.uniform(0.1, 1))
        coarse, fine = (slab_truth(c, tau, mu0, step=step)[which] for step in (1 / 13, 1 / 17))
        return lambda: DIRECTIONAL[which](c, tau, mu0), mp.mpf(fine), abs(fine - coarse), f"{c} {tau} {mu0}"

    return draw


def by_disort(which):
    """Henyey-Greenstein and Rayleigh at 48 streams; its own error from half of them, and rounding."""

    def draw(rng):
        c, tau, mu0 = float(rng.uniform(0.05, 0.99)), number(rng, 0.05, 10), float(rng.uniform(0.15, 1))
        g = float(rng.uniform(-0.5, 0.5))
        phase, chi = (
            (Rayleigh(), np.array([1, 0, 0.1] + [0] * 46))
            if rng.random() < 0.2
            else (HenyeyGreenstein(g), g ** np.arange(49.0))
        )
        coarse, fine = (disort(c, tau, mu0, chi, streams)[which] for streams in (24, 48))
        return (
            lambda: DIRECTIONAL[which](c, tau, mu0, phase),
            mp.mpf(fine),
            abs(fine - coarse) + 1e-11,
            f"{c} {tau} {mu0} {phase}",
        )

    return draw


def in_bits(which):
    """Layers of Henyey-Greenstein scattering, any thickness, nearly conservative: added in 340 bits at two sets of nodes."""

    def draw(rng):
        c, tau, mu0 = 1 - number(rng, 1e-9, 1), number(rng, 1e-3, 1e3), number(rng, 0.05, 1)
        g = float(rng.uniform(-0.3, 0.3))
        coarse, fine = (
            doubled_truth(c, tau, mu0, lambda degree: flint.arb(g) ** degree, n=n, moments=n)[which] for n in (20, 28)
        )
        phase = HenyeyGreenstein(g)
        return lambda: DIRECTIONAL[which](c, tau, mu0, phase), mp.mpf(fine), abs(fine - coarse), f"{c} {tau} {mu0} {g}"

    return draw


def by_walks(which):
    """Peaked phase functions: photons on analog walks, within six standard errors."""

    def draw(rng):
        c, tau, mu0 = float(rng.uniform(0.3, 1)), number(rng, 0.3, 20), float(rng.uniform(0.2, 1))
        g = float(rng.choice([-0.9, 0.7, 0.9, 0.97, 0.99, 0.999, 0.9999]))
        mean, spread = walked(rng, c, tau, mu0, g)
        function = DIRECTIONAL[which]
        return (
            lambda: function(c, tau, mu0, HenyeyGreenstein(g)),
            mp.mpf(mean[which]),
            6 * spread[which],
            f"{c} {tau} {mu0} {g}",
        )

    return draw


def refracted(which):
    """A plate that does not scatter, by the sum of its echoes."""

    def draw(rng):
        n, tau, mu0 = float(1 + number(rng, 1e-6, 2)), number(rng, 1e-6, 100), number(rng, 1e-18, 1)
        with mp.workdps(80):
            index, outside = mp.mpf(n), mp.mpf(mu0)
            inside = mp.sqrt(1 - (1 - outside**2) / index**2)
            s = ((index * inside - outside) / (index * inside + outside)) ** 2
            p = ((index * outside - inside) / (index * outside + inside)) ** 2
            r, e = (s + p) / 2, mp.exp(-mp.mpf(tau) / inside)
            reflected = r + (1 - r) ** 2 * r * e**2 / (1 - r**2 * e**2)
            passed = (1 - r) ** 2 * e / (1 - r**2 * e**2)
            truth = (reflected, passed, 1 - reflected - passed)[which]
        return lambda: DIRECTIONAL[which](0.0, tau, mu0, None, n), truth, 0, f"{n} {tau} {mu0}"

    return draw


def kernel(which):
    """Directions: what goes from one to the other comes back; isotropic scattering by X and Y functions."""
    function = (analytic.slab_brdf, analytic.slab_btdf)[which]

    def draw(rng):
        c, tau, mu0, mu = float(rng.uniform(0.05, 1)), number(rng, 1e-3, 1e5), *map(float, rng.uniform(0.1, 1, 2))
        azimuth = float(rng.uniform(0, 6))
        if which == 0 and rng.random() < 0.7:
            other = function(c, tau, mu0, mu, ALMOST_ISOTROPIC, azimuth)
            return (
                lambda: function(c, tau, mu0, mu),
                mp.mpf(float(other.value)),
                float(other.error),
                f"{c} {tau} {mu0} {mu}",
            )
        phase = HenyeyGreenstein(float(rng.uniform(-0.4, 0.4)))
        other = function(c, tau, mu, mu0, phase, azimuth)
        value, error = float(other.value), float(other.error)
        return (
            lambda: function(c, tau, mu0, mu, phase, azimuth),
            mp.mpf(value),
            error,
            f"{c} {tau} {mu0} {mu} {phase} {azimuth}",
        )

    return draw


def orders(which):
    """Their sum with the powers of the albedo is the whole."""
    function = (analytic.slab_reflectance_orders, analytic.slab_transmittance_orders)[which]

    def draw(rng):
        c, tau, mu0 = float(rng.uniform(0.01, 0.3)), number(rng, 1e-2, 10), float(rng.uniform(0.1, 1))
        whole = DIRECTIONAL[which](c, tau, mu0)

        def summed():
            found = function(tau, mu0, 30)
            powers = c ** np.arange(31.0)
            return type(found)(found.value @ powers, found.error @ powers, found.method, found.source)

        return summed, mp.mpf(float(whole.value)), float(whole.error) + c**31, f"{c} {tau} {mu0}"

    return draw


def ball_without(which):
    """Balls that do not scatter, in closed form; ones that do not absorb send back everything and look like their sky."""

    def draw(rng):
        R, share = number(rng, 1e-6, 100), float(rng.uniform(0, 1))
        c = float(rng.choice([0.0, 1.0]))
        with mp.workdps(60):
            x, p = 2 * mp.mpf(R), mp.mpf(share * R)
            if which == "albedo":
                truth = 2 * (1 - (1 + x) * mp.exp(-x)) / x**2 if c == 0 else mp.mpf(1)
                return lambda: analytic.ball_albedo(c, R), truth, 0, f"{c} {R}"
            if which == "radiance":
                truth = mp.exp(-2 * mp.sqrt(mp.mpf(R) ** 2 - p**2)) if c == 0 else mp.mpf(1)
                return lambda: analytic.ball_radiance(c, R, share * R), truth, 0, f"{c} {R} {share}"
        return lambda: analytic.ball_source(c, R, share * R), mp.mpf(c), 0, f"{c} {R} {share}"

    return draw


def ball_orders(which):
    def draw(rng):
        c, R, share = float(rng.uniform(0.01, 0.3)), number(rng, 0.1, 5), float(rng.uniform(0, 0.9))
        whole = analytic.ball_albedo(c, R) if which == "albedo" else analytic.ball_radiance(c, R, share * R)

        def summed():
            found = (
                analytic.ball_albedo_orders(R, 25)
                if which == "albedo"
                else analytic.ball_radiance_orders(R, share * R, 25)
            )
            powers = c ** np.arange(26.0)
            return type(found)(found.value @ powers, found.error @ powers, found.method, found.source)

        return summed, mp.mpf(float(whole.value)), float(whole.error) + c**26, f"{c} {R} {share}"

    return draw


NAMES = ("slab_reflectance", "slab_transmittance", "slab_emissivity")
KINDS = {
    **{f"{name}/doubling": Kind(by_doubling(i), 0.3) for i, name in enumerate(NAMES)},
    **{f"{name}/digits": Kind(by_digits(i), 0.01) for i, name in enumerate(NAMES[:2])},
    **{f"{name}/bits": Kind(in_bits(i), 0.01) for i, name in enumerate(NAMES[:2])},
    **{f"{name}/disort": Kind(by_disort(i), 0.1) for i, name in enumerate(NAMES[:2])},
    **{f"{name}/walks": Kind(by_walks(i), 0.1) for i, name in enumerate(NAMES)},
    **{f"{name}/refracted": Kind(refracted(i), 1) for i, name in enumerate(NAMES)},
    "slab_diffuse_reflectance": Kind(diffuse(0), 0.3),
    "slab_diffuse_transmittance": Kind(diffuse(1), 0.3),
    "slab_brdf": Kind(kernel(0), 0.1),
    "slab_btdf": Kind(kernel(1), 0.05),
    "slab_reflectance_orders": Kind(orders(0), 0.1),
    "slab_transmittance_orders": Kind(orders(1), 0.1),
    "ball_albedo": Kind(ball_without("albedo"), 1),
    "ball_radiance": Kind(ball_without("radiance"), 1),
    "ball_source": Kind(ball_without("source"), 1),
    "ball_albedo_orders": Kind(ball_orders("albedo"), 0.1),
    "ball_radiance_orders": Kind(ball_orders("radiance"), 0.1),
}
