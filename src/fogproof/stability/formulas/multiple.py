"""Multiple scattering in closed form: rods, half spaces, flights, point sources, furnaces, mean paths."""

from __future__ import annotations

import math

import numpy as np

from fogproof import analytic
from fogproof.scene import Ball, Box, Medium, Ray
from fogproof.stability.axes import decades, including, symmetric, to_one
from fogproof.stability.exact import flint
from fogproof.stability.forms import each
from fogproof.stability.formula import Formula, HardRegion, Naive

ALBEDOS = including(to_one(1e-15, 1e-300), 1.0)
LENGTHS = decades(1e-300, 1e4)


def rod(albedo, length, g):
    """Reflectance and transmittance, by hyperbolic functions of k L."""
    k = ((1 - albedo) * (1 - albedo * g)).sqrt()
    front = 1 - albedo * (1 + g) / 2
    tangent = (k * length).tanh() / k if not k.is_zero() else length
    whole = 1 + front * tangent
    return albedo * (1 - g) / 2 * tangent / whole, 1 / ((k * length).cosh() * whole)


def printed_rod(albedo, length, g):
    k = np.sqrt((1 - albedo) * (1 - albedo * g))
    whole = k * np.cosh(k * length) + (1 - albedo * (1 + g) / 2) * np.sinh(k * length)
    return albedo * (1 - g) / 2 * np.sinh(k * length) / whole, k / whole


RODS = (
    HardRegion("thin to thick", {"albedo": ALBEDOS, "length": LENGTHS}, {"g": 0.0}),
    HardRegion("forward and backward", {"albedo": ALBEDOS, "g": symmetric(1e-12)}, {"length": 2.5}),
)


def log_h(albedo, mu):
    """The integral over theta in [0, pi/2] of log(1 - c theta cot theta)/(cos^2 + mu^2 sin^2) (Chandrasekhar 1960).

    Near 0 1 - theta cot theta is the sum of 2 zeta(2 k) (theta/pi)^2k, all terms of which are positive.
    """
    arb, acb = flint().arb, flint().acb
    pi, terms = arb.pi(), flint().ctx.prec // 4 + 4
    zeta = [2 * arb(2 * k).zeta() for k in range(1, terms + 1)]

    def missing(theta):
        if not abs(theta) < 0.75:
            return 1 - theta * theta.cot()
        x = (theta / pi) ** 2
        total = acb(0)
        for coefficient in reversed(zeta):
            total = (total + coefficient) * x
        size = abs(x).upper()
        rest = 4 * size ** (terms + 1)
        return total + acb(arb(0, 1) * rest, arb(0, 1) * rest)

    def integrand(theta, _analytic):
        inner = (1 - albedo) + albedo * missing(theta)
        if not inner.real > 0:
            return acb(arb.nan())
        return inner.log() / (theta.cos() ** 2 + mu * mu * theta.sin() ** 2)

    return -mu / pi * acb.integral(integrand, acb(0), acb(pi / 2), rel_tol=arb(2) ** -190).real


def h_function(albedo, mu):
    return log_h(albedo, mu).exp()


def plane_albedo(albedo, mu0):
    return 1 - (1 - albedo).sqrt() * h_function(albedo, mu0)


def displacement(flights):
    return lambda g: sum((g**k for k in range(flights)), flint().arb(0))


def square_displacement(flights):
    """2 l^2 times the sum of g^|i - j| over i <= j, but half of the diagonal twice: from the moments of each pair."""
    return lambda g: 2 * sum(((flights - k) * g**k for k in range(flights)), flint().arb(0))


def brdf(albedo, mu0, mu):
    pi4 = 4 * flint().arb.pi()
    return albedo / pi4 * h_function(albedo, mu0) * h_function(albedo, mu) / (mu0 + mu)


FLIGHTS = 50

FORMULAS = [
    Formula(
        "multiple/rod_reflectance",
        "Reflectance of a rod",
        "analytic.rod_reflectance",
        analytic.rod_reflectance,
        lambda albedo, length, g: rod(albedo, length, g)[0],
        RODS,
        naive=(Naive("hyperbolic functions", "the closed form as printed", lambda **x: printed_rod(**x)[0]),),
    ),
    Formula(
        "multiple/rod_transmittance",
        "Transmittance of a rod",
        "analytic.rod_transmittance",
        analytic.rod_transmittance,
        lambda albedo, length, g: rod(albedo, length, g)[1],
        RODS,
        naive=(Naive("hyperbolic functions", "the closed form as printed", lambda **x: printed_rod(**x)[1]),),
    ),
    Formula(
        "multiple/h_function",
        "Chandrasekhar's H",
        "analytic.chandrasekhar_h",
        analytic.chandrasekhar_h,
        h_function,
        (HardRegion("albedo to 1", {"albedo": to_one(1e-9, 1e-12), "mu": decades(1e-2, 1.0)}),),
        size=0.2,
        condition=False,
    ),
    Formula(
        "multiple/plane_albedo",
        "Reflectance of a half space",
        "analytic.half_space_reflectance",
        analytic.half_space_reflectance,
        plane_albedo,
        (HardRegion("albedo to 1", {"albedo": to_one(1e-9, 1e-12), "mu0": decades(1e-2, 1.0)}),),
        naive=(
            Naive(
                "1 - sqrt(1 - c) H",
                "Chandrasekhar 1960",
                lambda albedo, mu0: 1 - np.sqrt(1 - albedo) * analytic.chandrasekhar_h(albedo, mu0).value,
            ),
        ),
        size=0.2,
        condition=False,
    ),
    Formula(
        "multiple/half_space_brdf",
        "Brightness of a half space over the light on it",
        "analytic.half_space_brdf",
        analytic.half_space_brdf,
        brdf,
        (HardRegion("albedo to 1", {"albedo": to_one(1e-9, 1e-12), "mu": decades(1e-2, 1.0)}, {"mu0": 0.5}),),
        size=0.12,
        condition=False,
    ),
    Formula(
        "multiple/mean_displacement",
        "Mean displacement after 50 flights, (1 - g^n)/(1 - g)",
        "analytic.mean_displacement",
        lambda g: analytic.mean_displacement(FLIGHTS, g),
        displacement(FLIGHTS),
        (HardRegion("forward and backward", {"g": symmetric(1e-15)}),),
        naive=(Naive("(1 - g^n)/(1 - g)", "the closed form", lambda g: (1 - g**FLIGHTS) / (1 - g)),),
    ),
    Formula(
        "multiple/mean_square_displacement",
        "Mean square displacement after 50 flights",
        "analytic.mean_square_displacement",
        lambda g: analytic.mean_square_displacement(FLIGHTS, g),
        square_displacement(FLIGHTS),
        (HardRegion("forward and backward", {"g": symmetric(1e-15)}),),
        naive=(
            Naive(
                "n/(1 - g) - g (1 - g^n)/(1 - g)^2",
                "the closed form",
                lambda g: 2 * (FLIGHTS / (1 - g) - g * (1 - g**FLIGHTS) / (1 - g) ** 2),
            ),
        ),
    ),
    Formula(
        "multiple/mean_path_length",
        "Mean path through a ball, 4 R/3",
        "analytic.mean_path_length",
        each("radius")(lambda radius: analytic.mean_path_length(Ball((0.0, 0.0, 0.0), radius))),
        lambda radius: 4 * radius / 3,
        (HardRegion("sizes", {"radius": decades(1e-100, 1e100)}),),
    ),
    Formula(
        "multiple/mean_scatterings",
        "Mean number of scatterings in a box, 4 V sigma_s/S",
        "analytic.mean_scatterings",
        each("height", "sigma_s")(
            lambda height, sigma_s: analytic.mean_scatterings(Box((0.0, 0.0, 0.0), (1.0, 2.0, height)), sigma_s)
        ),
        lambda height, sigma_s: 4 * sigma_s * 2 * height / (2 * (2 + 3 * height)),
        (HardRegion("flat to long", {"height": decades(1e-50, 1e50), "sigma_s": decades(1e-50, 1e50)}),),
    ),
    Formula(
        "multiple/white_furnace",
        "Radiance in a white furnace",
        "analytic.white_furnace",
        each("sigma_s")(
            lambda radiance, sigma_s: analytic.white_furnace(
                Medium(0.0, sigma_s), Ray((0, 0, 0), (0, 0, 1), math.inf), radiance[0]
            )
        ),
        lambda radiance, sigma_s: radiance,
        (HardRegion("extinctions", {"sigma_s": decades(1e-300, 1e300, 0.0)}, {"radiance": 0.7}),),
    ),
    Formula(
        "multiple/thermal_furnace",
        "Radiance in a thermal furnace",
        "analytic.thermal_furnace",
        each("sigma_a")(
            lambda radiance, sigma_a: analytic.thermal_furnace(
                Medium(sigma_a, 1.0, emission=radiance[0]), Ray((0, 0, 0), (0, 0, 1), math.inf), radiance[0]
            )
        ),
        lambda radiance, sigma_a: radiance,
        (HardRegion("extinctions", {"sigma_a": decades(1e-300, 1e300, 0.0)}, {"radiance": 0.7}),),
    ),
]
