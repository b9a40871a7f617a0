"""The oracle along a ray: thickness, transmittance, free paths, fog, emission, and the moments of trackers."""

from __future__ import annotations

import math

import numpy as np

from fogproof import analytic
from fogproof.scene import ExponentialMedium, LinearMedium, Medium, OpenGLFog, Ray
from fogproof.stability.axes import both_signs, decades, of
from fogproof.stability.exact import flint
from fogproof.stability.forms import each
from fogproof.stability.formula import Formula, HardRegion, Naive

THICK = decades(1e-300, 1e3, 0.0)
LENGTHS = decades(1e-150, 1e150, 0.0, math.inf)
SLOPES = both_signs(1e-90, 1e6, 0.0)
"""Components of gradients below 1e-100 count as 0 in the oracle's media."""


def ray(length):
    return Ray((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), length)


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


def passed(tau):
    return (-tau).exp() if tau.is_finite() else flint().arb(0)


def true_fog(tau, albedo, ambient, background):
    """Extinction 1, so that tau is the length; sigma_a is what is left of 1, exactly."""
    kept = passed(tau)
    return kept * background + albedo * ambient * (1 - kept)


def glowing(sigma_a, sigma_s):
    return Medium(sigma_a, sigma_s, emission=2.0)


def true_emission(t, sigma_a, sigma_s):
    sigma_t = sigma_a + sigma_s
    if sigma_t.is_zero():
        return flint().arb(0)
    return 2 * sigma_a / sigma_t * (1 - passed(sigma_t * t if sigma_t > 0 else sigma_t))


def true_source(t, sigma_a):
    """q times the length that is seen."""
    if sigma_a.is_zero():
        return 2 * t
    return 2 * (1 - passed(sigma_a * t)) / sigma_a


def fog_variance(t, ambient, background):
    kept = (-t).exp()
    return (ambient / 2 - background) ** 2 * kept * (1 - kept)


def moment(tracking, function):
    """Return a quantity of a tracker in a medium of extinction 1."""
    control = {"control": 0.5} if tracking == "residual-ratio" else {}
    return each("majorant")(lambda t, majorant: function(Medium(1.0, 0.0), ray(t), tracking, majorant, **control))


def ratio_square(t, majorant, control=0):
    """T^2 exp(V), V the integral of (sigma_t - control)^2/majorant."""
    return (-2 * t + (1 - control) ** 2 * t / majorant).exp()


def ratio_variance(t, majorant, control=0):
    return (-2 * t).exp() * ((1 - control) ** 2 * t / majorant).expm1()


HALF = of(0.5)

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
    Formula(
        "ray/fog",
        "Ambient fog, the lerp of the lecture, without background",
        "analytic.ambient_fog",
        each("sigma_s", "sigma_a")(
            lambda t, sigma_s, sigma_a: analytic.ambient_fog(Medium(sigma_a, sigma_s), ray(t), 0.75)
        ),
        lambda t, sigma_s, sigma_a: 0.75 * sigma_s / (sigma_s + sigma_a) * (1 - passed((sigma_s + sigma_a) * t)),
        (
            HardRegion("thin to opaque", {"t": THICK, "sigma_a": decades(1e-20, 10.0)}, {"sigma_s": 0.25}),
            HardRegion(
                "nearly nothing", {"t": decades(1e-3, 1e30), "sigma_s": decades(1e-300, 1e-3)}, {"sigma_a": 1e-300}
            ),
        ),
        naive=(
            Naive(
                "albedo L_i (1 - exp(-tau))",
                "the lecture, homogeneous ambient media",
                lambda t, sigma_s, sigma_a: (
                    0.75 * sigma_s / (sigma_s + sigma_a) * (1 - np.exp(-t * (sigma_s + sigma_a)))
                ),
            ),
        ),
    ),
    Formula(
        "ray/fog_before_background",
        "Ambient fog before a background",
        "analytic.ambient_fog",
        each("background")(lambda t, background: analytic.ambient_fog(Medium(0.5, 0.5), ray(t), 2.0, background)),
        lambda t, background: true_fog(t, flint().arb(0.5), flint().arb(2), background),
        (HardRegion("thin to opaque", {"t": THICK, "background": decades(1e-12, 1e12)}),),
    ),
    Formula(
        "ray/emission",
        "Emission of a hot medium that scatters too",
        "analytic.emitted_radiance",
        each("sigma_a", "sigma_s")(
            lambda t, sigma_a, sigma_s: analytic.emitted_radiance(glowing(sigma_a, sigma_s), ray(t))
        ),
        true_emission,
        (HardRegion("thin to opaque", {"t": THICK, "sigma_s": decades(1e-20, 1e15)}, {"sigma_a": 0.25}),),
        naive=(
            Naive(
                "(1 - albedo) L_e (1 - exp(-tau))",
                "renderers that store an albedo",
                lambda t, sigma_a, sigma_s: (
                    2 * (1 - sigma_s / (sigma_a + sigma_s)) * (1 - np.exp(-t * (sigma_a + sigma_s)))
                ),
            ),
        ),
    ),
    Formula(
        "ray/emission_per_volume",
        "Emission per volume, q (1 - exp(-tau))/sigma_t",
        "analytic.emitted_radiance",
        each("sigma_a")(
            lambda t, sigma_a: analytic.emitted_radiance(glowing(sigma_a, 0.0), ray(t), times_sigma_a=False)
        ),
        true_source,
        (HardRegion("thin to opaque", {"t": decades(1e-150, 1e3), "sigma_a": decades(1e-150, 1e2, 0.0)}),),
        naive=(
            Naive(
                "q (1 - exp(-tau))/sigma_t",
                "the usual form",
                lambda t, sigma_a: 2 * (1 - np.exp(-sigma_a * t)) / sigma_a,
            ),
        ),
    ),
    Formula(
        "ray/fog_variance",
        "Variance of fog by analog free paths",
        "analytic.ambient_fog_variance",
        each("ambient", "background")(
            lambda t, ambient, background: analytic.ambient_fog_variance(Medium(0.5, 0.5), ray(t), ambient, background)
        ),
        fog_variance,
        (
            HardRegion(
                "thin to opaque", {"t": decades(1e-300, 7e2), "ambient": decades(1e-3, 1e3)}, {"background": 0.5}
            ),
        ),
        naive=(
            Naive(
                "E[x^2] - E[x]^2",
                "the definition",
                lambda t, ambient, background: (
                    (background**2 * np.exp(-t) + (ambient / 2) ** 2 * (1 - np.exp(-t)))
                    - (background * np.exp(-t) + ambient / 2 * (1 - np.exp(-t))) ** 2
                ),
            ),
        ),
    ),
    Formula(
        "ray/second_moment_ratio",
        "Second moment of ratio tracking",
        "analytic.transmittance_second_moment",
        moment("ratio", analytic.transmittance_second_moment),
        ratio_square,
        (HardRegion("majorants", {"t": decades(1e-300, 100), "majorant": decades(0.6, 1e9)}),),
    ),
    Formula(
        "ray/variance_ratio",
        "Variance of ratio tracking",
        "analytic.transmittance_variance",
        moment("ratio", analytic.transmittance_variance),
        ratio_variance,
        (HardRegion("majorants", {"t": decades(1e-300, 100), "majorant": decades(0.6, 1e9, 1.0)}),),
        naive=(
            Naive(
                "second moment less T^2",
                "the definition",
                lambda t, majorant: np.exp(-2 * t + t / majorant) - np.exp(-t) ** 2,
            ),
        ),
    ),
    Formula(
        "ray/variance_residual_ratio",
        "Variance of residual-ratio tracking, control 1/2",
        "analytic.transmittance_variance",
        moment("residual-ratio", analytic.transmittance_variance),
        lambda t, majorant: ratio_variance(t, majorant, flint().arb(0.5)),
        (HardRegion("majorants", {"t": decades(1e-300, 100), "majorant": decades(0.6, 1e9)}),),
    ),
    Formula(
        "ray/variance_delta",
        "Variance of delta tracking, T (1 - T)",
        "analytic.transmittance_variance",
        moment("delta", analytic.transmittance_variance),
        lambda t, majorant: (-t).exp() * (1 - (-t).exp()),
        (HardRegion("thin to opaque", {"t": decades(1e-300, 700)}, {"majorant": 2.0}),),
        naive=(Naive("T - T^2", "the usual form", lambda t, majorant: np.exp(-t) - np.exp(-t) ** 2),),
    ),
    Formula(
        "ray/lookups",
        "Expected look-ups of delta tracking, majorant (1 - T)/sigma_t",
        "analytic.transmittance_lookups",
        moment("delta", analytic.transmittance_lookups),
        lambda t, majorant: majorant * (1 - passed(t)),
        (HardRegion("majorants", {"t": THICK, "majorant": decades(1.0, 1e9)}),),
        naive=(Naive("majorant (1 - exp(-tau))", "the usual form", lambda t, majorant: majorant * (1 - np.exp(-t))),),
    ),
]
