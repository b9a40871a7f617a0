"""The sky: Rayleigh's coefficient, the air, single scattering in a plane layer."""

from __future__ import annotations

import numpy as np

from fogproof import analytic
from fogproof.stability.axes import around, decades
from fogproof.stability.exact import flint
from fogproof.stability.formula import Formula, HardRegion, Naive


def decimal(text):
    """Return a decimal number, exactly: what a formula of measurement prints."""
    return flint().arb(flint().fmpq(*map(int, fraction(text))))


def fraction(text):
    digits, _, power = text.partition("e")
    whole, _, part = digits.partition(".")
    shift = int(power or 0) - len(part)
    return int(whole + part) * 10 ** max(shift, 0), 10 ** max(-shift, 0)


def cross_section(wavelength):
    """Bodhaine et al. 1999 with Peck & Reeder's index, per molecule of standard air."""
    s = (decimal("1e-6") / wavelength) ** 2
    n = 1 + (decimal("5792105") / (decimal("238.0185") - s) + decimal("167917") / (decimal("57.362") - s)) / 10**8
    nitrogen = decimal("1.034") + decimal("3.17e-4") * s
    oxygen = decimal("1.096") + decimal("1.385e-3") * s + decimal("1.448e-4") * s**2
    parts = (("78.084", nitrogen), ("20.946", oxygen), ("0.934", flint().arb(1)), ("0.036", decimal("1.15")))
    king = sum((decimal(share) * factor for share, factor in parts), flint().arb(0))
    king /= sum((decimal(share) for share, _ in parts), flint().arb(0))
    density = decimal("101325") / (decimal("1.380649e-23") * decimal("288.15"))
    ratio = ((n**2 - 1) / (n**2 + 2)) ** 2
    return 24 * flint().arb.pi() ** 3 * ratio / (wavelength**4 * density**2) * king


def optical_depth(wavelength):
    column = decimal("101325") * decimal("6.02214076e23") / (decimal("28.9647e-3") * decimal("9.80665"))
    return cross_section(wavelength) * column


def coefficient(diameter, index, density, wavelength):
    ratio = (index**2 - 1) / (index**2 + 2)
    return 2 * flint().arb.pi() ** 5 / 3 * density * diameter**6 / wavelength**4 * ratio**2


def layer(tau, mu_sun, mu_view, azimuth):
    cosine = mu_sun * mu_view + ((1 - mu_sun**2) * (1 - mu_view**2)).sqrt() * azimuth.cos()
    phase = 3 * (1 + cosine**2) / (16 * flint().arb.pi())
    if (mu_sun - mu_view).is_zero():
        return phase * tau / mu_view * (-tau / mu_view).exp()
    return phase * mu_sun / (mu_sun - mu_view) * ((-tau / mu_sun).exp() - (-tau / mu_view).exp())


def naive_layer(tau, mu_sun, mu_view, azimuth):
    cosine = mu_sun * mu_view + np.sqrt((1 - mu_sun**2) * (1 - mu_view**2)) * np.cos(azimuth)
    phase = 3 * (1 + cosine**2) / (16 * np.pi)
    return phase * mu_sun / (mu_sun - mu_view) * (np.exp(-tau / mu_sun) - np.exp(-tau / mu_view))


FORMULAS = [
    Formula(
        "sky/cross_section",
        "Scattering cross section of air",
        "analytic.air_cross_section",
        analytic.air_cross_section,
        cross_section,
        (HardRegion("ultraviolet to infrared", {"wavelength": decades(2.6e-7, 9e-7)}),),
    ),
    Formula(
        "sky/optical_depth",
        "Optical depth of the atmosphere",
        "analytic.air_optical_depth",
        analytic.air_optical_depth,
        optical_depth,
        (HardRegion("ultraviolet to infrared", {"wavelength": decades(2.6e-7, 9e-7)}),),
    ),
    Formula(
        "sky/rayleigh_coefficient",
        "Rayleigh's scattering coefficient",
        "analytic.rayleigh_scattering_coefficient",
        lambda diameter, index, density, wavelength: analytic.rayleigh_scattering_coefficient(
            diameter, index, density, wavelength
        ),
        coefficient,
        (
            HardRegion(
                "nearly no contrast",
                {"diameter": decades(1e-12, 1e-7), "index": decades(1.0 + 1e-9, 3.0)},
                {"density": 2.5e25, "wavelength": 5e-7},
            ),
        ),
    ),
    Formula(
        "sky/plane_parallel",
        "Single scattering in a plane layer of air",
        "analytic.plane_parallel_sky",
        analytic.plane_parallel_sky,
        layer,
        (
            HardRegion(
                "sun beside the view",
                {"mu_sun": around(0.5, 1e-16, 0.9), "tau": decades(1e-12, 30.0)},
                {"mu_view": 0.5, "azimuth": 1.0},
            ),
            HardRegion(
                "thin to thick",
                {"tau": decades(1e-300, 50.0), "mu_view": decades(0.1, 0.9)},
                {"mu_sun": 0.5, "azimuth": 1.0},
            ),
        ),
        naive=(Naive("difference of exponentials", "Chandrasekhar 1960", naive_layer),),
    ),
]
