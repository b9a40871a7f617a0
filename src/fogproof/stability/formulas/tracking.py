"""Second moments, variances and look-ups of trackers, in a medium of extinction 1."""

from __future__ import annotations

import numpy as np

from fogproof import analytic
from fogproof.scene import Medium
from fogproof.stability.axes import decades
from fogproof.stability.exact import flint
from fogproof.stability.forms import each
from fogproof.stability.formula import Formula, HardRegion, Naive
from fogproof.stability.formulas.rays import THICK, passed, ray


def moment(tracking, function):
    """Return a quantity of a tracker in a medium of extinction 1."""
    control = {"control": 0.5} if tracking == "residual-ratio" else {}
    return each("majorant")(lambda t, majorant: function(Medium(1.0, 0.0), ray(t), tracking, majorant, **control))


def ratio_square(t, majorant, control=0):
    """T^2 exp(V), V the integral of (sigma_t - control)^2/majorant."""
    return (-2 * t + (1 - control) ** 2 * t / majorant).exp()


def ratio_variance(t, majorant, control=0):
    return (-2 * t).exp() * ((1 - control) ** 2 * t / majorant).expm1()


FORMULAS = [
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
