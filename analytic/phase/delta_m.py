"""Delta-M: what scatters almost straight ahead is taken for light that did not scatter (Wiscombe 1977).

A share f = chi_M of the phase function becomes a delta forwards, and the rest keeps the first M moments:
chi*_l = (chi_l - f)/(1 - f). The medium with that rest and sigma_s* = (1 - f) sigma_s transports the same first M moments.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.declaration import FORWARD, quantity
from fogproof.analytic.media.coefficients import is_uniform
from fogproof.analytic.phase.functions import phase_legendre_moments
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError, UnsupportedError, shorten
from fogproof.scene import LegendreSeries, Medium
from fogproof.scene.arrays import Count
from fogproof.scene.phase import PhaseFunction, PhaseFunctionField

SOURCE = "Wiscombe 1977, J. Atmos. Sci. 34, 1408"


@quantity(
    unit="1",
    convention="chi*_l, l = 0 … count - 1, in the last axis: what is left of chi_l without the delta of weight chi_count; "
    + FORWARD,
    source=SOURCE,
    example={"phase": {"kind": "henyey-greenstein", "g": 0.85}, "count": 4},
)
def delta_m_moments(phase: PhaseFunctionField, count: Count) -> Reference:
    """Return chi*_l = (chi_l - f)/(1 - f) with f = chi_count, for l = 0 … count - 1.

    phase  a phase function of the scene description
    count  how many moments are kept, at least 1

    The phase function is then f delta(mu = 1) + (1 - f) sum_l (2 l + 1)/(4 pi) chi*_l P_l, right in the first count + 1 moments.
    Errors: those of chi_l and f, carried through the quotient.
    """
    share, kept = _split(phase, count)
    rest = 1 - share.value
    value = (kept.value - share.value) / rest
    error = (kept.error + share.error * (1 + np.abs(value))) / rest + 4 * EPS * np.abs(value)
    error += 2 * EPS * np.abs(share.value) / rest
    value[0], error[0] = 1.0, 0.0
    return Reference(value, error, kept.method, f"{SOURCE}; {kept.source}")


def delta_m(medium: Medium, count: int) -> Medium:
    """Return the homogeneous medium whose phase function is truncated after `count` moments; sigma_a stays as it is.

    What is left must be nowhere negative to be a phase function: otherwise it is refused, with the place where it is. Then
    `delta_m_moments` still serves those who need moments only.
    Example: `delta_m(Medium(0.1, 0.9, HenyeyGreenstein(0.85)), 32)`.
    Source: Wiscombe 1977.
    """
    if not is_uniform(medium):
        raise UnsupportedError(f"delta-M truncates a homogeneous Medium, not {shorten(medium)}", "medium")
    share, _ = _split(medium.phase, count)
    moments = delta_m_moments(medium.phase, count).value
    try:
        phase = LegendreSeries(tuple(moments.tolist()))
    except InvalidValueError as error:
        fix = "another count may do; delta_m_moments gives the moments themselves"
        rule = f"must leave a phase function that is nowhere negative ({error.rule})"
        raise InvalidValueError("count", rule, count, fix) from None
    sigma_s: Any = np.multiply(medium.sigma_s, 1 - float(share.value))
    return replace(medium, sigma_s=sigma_s.tolist(), phase=phase)


def _split(phase: PhaseFunction, count: int) -> tuple[Reference, Reference]:
    """Return the weight of the delta, and the moments that are kept."""
    if isinstance(count, int | np.integer) and not isinstance(count, bool) and count < 1:
        raise InvalidValueError("count", "must be at least 1", count)
    all_of_them = phase_legendre_moments(phase, count)
    share = Reference(all_of_them.value[-1], all_of_them.error[-1], all_of_them.method, all_of_them.source)
    if not share.value + share.error < 1:
        raise InvalidValueError("count", "must leave something beside the delta", count, "all light goes straight on")
    kept = Reference(all_of_them.value[:-1], all_of_them.error[:-1], all_of_them.method, all_of_them.source)
    return share, kept
