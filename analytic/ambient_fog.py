"""Fog with a constant in-scattered radiance: the lecture's homogeneous ambient medium, with emission."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.error_free import EPS, TINY, exp_minus
from fogproof.analytic.transmittance import channels_of, tau_pair
from fogproof.contracts import Reference
from fogproof.scene import Medium, Ray
from fogproof.validate import nonnegative_channels

SOURCE = "Chandrasekhar 1960, Radiative Transfer, section 7, with a constant source function"


def ambient_fog(medium: Medium, ray: Ray, ambient: Any = 0.0, background: Any = 0.0) -> Reference:
    """Return the radiance that reaches the camera [W/(m^2 sr)], shape R or R + (channels,).

        L = L_bg e^{-tau} + s (sigma_s L_i + sigma_a L_e) phi1(tau),   phi1(x) = (1 - e^{-x})/x

    ambient     L_i, in-scattered radiance taken as constant [W/(m^2 sr)], grey or one value a channel
    background  L_bg, radiance of the surface at the ray's end [W/(m^2 sr)]; L_e is the medium's emission

    Computed as a lerp with the three weights e^{-tau}, albedo (1 - e^{-tau}) and (1 - albedo)(1 - e^{-tau}), each
    without cancellation: none exceeds 1, so neither an empty medium (which shows the background) nor an infinite ray
    nor a product of extremes needs a case of its own.
    Error: at most 8 EPS relative, plus 4 TINY of each radiance where a weight underflows.
    Source: Chandrasekhar 1960, Radiative Transfer, section 7, with a constant source function.
    """
    ambient = nonnegative_channels("ambient", ambient, "W/(m^2 sr)")
    background = nonnegative_channels("background", background, "W/(m^2 sr)")
    tau, low = tau_pair(medium, ray, channels_of(medium, ambient=ambient, background=background))
    with np.errstate(under="ignore", over="ignore"):
        survived, _ = exp_minus(tau, low)
        extinguished = -np.expm1(-tau)
        scattered = medium.albedo * extinguished
        absorbed = _share(medium.sigma_a, medium.sigma_t) * extinguished
        value = survived * background + scattered * ambient + absorbed * medium.emission
        underflow = 4 * TINY * (1 + np.maximum(np.maximum(background, ambient), medium.emission))
        return Reference(value, 8 * EPS * value + underflow, "lerp of radiances", SOURCE)


def _share(part: Any, whole: np.ndarray) -> np.ndarray:
    """Return part / whole, 0 where the whole is 0."""
    return np.divide(part, whole, out=np.zeros_like(whole), where=whole > 0)
