"""Ambient fog and emission along a ray, and the variance of fog by free paths."""

from __future__ import annotations

import numpy as np

from fogproof import analytic
from fogproof.scene import Medium
from fogproof.stability.axes import decades
from fogproof.stability.exact import flint
from fogproof.stability.forms import each
from fogproof.stability.formula import Formula, HardRegion, Naive
from fogproof.stability.formulas.rays import THICK, passed, ray


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


FORMULAS = [
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
]
