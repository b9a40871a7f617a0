"""Optical thickness, transmittance and free paths along a ray, for each medium with a closed form."""

from __future__ import annotations

import math

import numpy as np

from fogproof import analytic
from fogproof.scene import ExponentialMedium, LinearMedium, Medium, OpenGLFog
from fogproof.stability.axes import both_signs, decades
from fogproof.stability.exact import flint
from fogproof.stability.forms import each
from fogproof.stability.formula import Formula, HardRegion, Naive
from fogproof.stability.formulas.rays import THICK, passed, ray

LENGTHS = decades(1e-150, 1e150, 0.0, math.inf)
SLOPES = both_signs(1e-90, 1e6, 0.0)
"""Components of gradients below 1e-100 count as 0 in the oracle's media."""


def linear(sigma_0, slope):
    return LinearMedium(sigma_0, (0.0, 0.0, slope))


def exponential(sigma_0, rate):
    return ExponentialMedium(sigma_0, (0.0, 0.0, rate))


def true_linear(t, sigma_0, slope):
    if slope < 0:
        end = -sigma_0 / slope
        t = end if end < t else t
    elif slope.is_zero() or not t.is_finite():
        return sigma_0 * t
    return t * (sigma_0 + slope * t / 2)


def true_exponential(t, sigma_0, rate):
    if rate.is_zero():
        return sigma_0 * t
    if not t.is_finite():
        return t if rate > 0 else -sigma_0 / rate
    return sigma_0 * (rate * t).expm1() / rate


def true_linear_path(tau, sigma_0, slope):
    if slope.is_zero():
        return tau / sigma_0
    square = sigma_0 * sigma_0 + 2 * slope * tau
    return flint().arb.pos_inf() if square < 0 else (square.sqrt() - sigma_0) / slope


def true_exponential_path(tau, sigma_0, rate):
    if rate.is_zero():
        return tau / sigma_0
    x = rate * tau / sigma_0
    return flint().arb.pos_inf() if x <= -1 else x.log1p() / rate


FORMULAS = [
    Formula(
        "ray/thickness_linear",
        "Optical thickness of extinction that grows or falls linearly",
        "analytic.optical_thickness",
        each("sigma_0", "slope")(lambda t, sigma_0, slope: analytic.optical_thickness(linear(sigma_0, slope), ray(t))),
        true_linear,
        (HardRegion("slopes", {"slope": SLOPES, "t": LENGTHS}, {"sigma_0": 0.75}),),
        naive=(
            Naive(
                "difference of squares",
                "the antiderivative at both ends",
                lambda t, sigma_0, slope: ((sigma_0 + slope * t) ** 2 - sigma_0**2) / (2 * slope),
            ),
        ),
    ),
    Formula(
        "ray/thickness_exponential",
        "Optical thickness of an exponential atmosphere",
        "analytic.optical_thickness",
        each("sigma_0", "rate")(
            lambda t, sigma_0, rate: analytic.optical_thickness(exponential(sigma_0, rate), ray(t))
        ),
        true_exponential,
        (HardRegion("rates", {"rate": SLOPES, "t": LENGTHS}, {"sigma_0": 0.75}),),
        naive=(
            Naive(
                "sigma_0 (exp(rate t) - 1)/rate",
                "the antiderivative at both ends",
                lambda t, sigma_0, rate: sigma_0 * (np.exp(rate * t) - 1) / rate,
            ),
        ),
    ),
    Formula(
        "ray/thickness_opengl",
        "Optical thickness of OpenGL's exp2 fog, (density t)^2",
        "analytic.optical_thickness",
        each("density")(lambda t, density: analytic.optical_thickness(OpenGLFog("exp2", density), ray(t))),
        lambda t, density: (density * t) ** 2,
        (HardRegion("thin to opaque", {"t": decades(1e-140, 1e3), "density": decades(1e-3, 1e3)}),),
    ),
    Formula(
        "ray/transmittance",
        "Transmittance of a homogeneous medium",
        "analytic.transmittance",
        each("sigma_t")(lambda t, sigma_t: analytic.transmittance(Medium(sigma_t, 0.0), ray(t))),
        lambda t, sigma_t: passed(sigma_t * t),
        (HardRegion("thin to opaque", {"t": THICK, "sigma_t": decades(0.3, 3.0)}),),
    ),
    Formula(
        "ray/transmittance_linear",
        "Transmittance of extinction that grows or falls linearly",
        "analytic.transmittance",
        each("sigma_0", "slope")(lambda t, sigma_0, slope: analytic.transmittance(linear(sigma_0, slope), ray(t))),
        lambda **x: passed(true_linear(**x)),
        (HardRegion("slopes", {"slope": both_signs(1e-90, 10.0), "t": decades(1e-9, 30)}, {"sigma_0": 0.75}),),
    ),
    Formula(
        "ray/transmittance_exponential",
        "Transmittance of an exponential atmosphere",
        "analytic.transmittance",
        each("sigma_0", "rate")(lambda t, sigma_0, rate: analytic.transmittance(exponential(sigma_0, rate), ray(t))),
        lambda **x: passed(true_exponential(**x)),
        (HardRegion("rates", {"rate": both_signs(1e-90, 0.2), "t": decades(1e-9, 30)}, {"sigma_0": 0.75}),),
    ),
    Formula(
        "ray/free_path",
        "Distance at which a thickness is reached, homogeneous",
        "analytic.free_path",
        each("sigma_t")(lambda tau, sigma_t: analytic.free_path(Medium(sigma_t, 0.0), ray(math.inf), tau)),
        lambda tau, sigma_t: tau / sigma_t,
        (HardRegion("thin to opaque", {"tau": THICK, "sigma_t": decades(1e-6, 1e6)}),),
    ),
    Formula(
        "ray/free_path_linear",
        "Distance at which a thickness is reached where extinction grows or falls linearly",
        "analytic.free_path",
        each("sigma_0", "slope")(
            lambda tau, sigma_0, slope: analytic.free_path(linear(sigma_0, slope), ray(math.inf), tau)
        ),
        true_linear_path,
        (HardRegion("slopes", {"slope": SLOPES, "tau": decades(1e-300, 700)}, {"sigma_0": 0.75}),),
        naive=(
            Naive(
                "root by the quadratic formula",
                "textbooks",
                lambda tau, sigma_0, slope: (np.sqrt(sigma_0 * sigma_0 + 2 * slope * tau) - sigma_0) / slope,
            ),
        ),
    ),
    Formula(
        "ray/free_path_exponential",
        "Distance at which a thickness is reached in an exponential atmosphere",
        "analytic.free_path",
        each("sigma_0", "rate")(
            lambda tau, sigma_0, rate: analytic.free_path(exponential(sigma_0, rate), ray(math.inf), tau)
        ),
        true_exponential_path,
        (HardRegion("rates", {"rate": SLOPES, "tau": decades(1e-300, 700)}, {"sigma_0": 0.75}),),
        naive=(
            Naive(
                "log(1 + rate tau/sigma_0)/rate",
                "textbooks",
                lambda tau, sigma_0, rate: np.log(1 + rate * tau / sigma_0) / rate,
            ),
        ),
    ),
]
