"""Radiance along rays by adaptive quadrature: any medium, constant in-scattered radiance, emission, background."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY
from fogproof.analytic.declaration import RADIANCE, RAY, quantity
from fogproof.analytic.geometry.rays import channels_of
from fogproof.analytic.media.adaptive import SOURCE, SourceTerm, integrate_along
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene import Ray
from fogproof.scene.arrays import ChannelArray
from fogproof.scene.media import AnyMediumField
from fogproof.validate import Channels, nonnegative_channels


@quantity(
    unit=RADIANCE,
    convention="in-scattered radiance constant along the ray; a second way to ambient_fog and emitted_radiance",
    source="Chandrasekhar 1960, Radiative Transfer, section 7",
    example={
        "medium": {"kind": "exponential", "sigma_0": 0.3, "rate": [0, 0, -0.5], "albedo": 0.9, "emission": 2},
        "ray": {**RAY, "length": 5},
        "ambient": 0.5,
        "background": 3,
    },
)
def radiance_by_quadrature(
    medium: AnyMediumField,
    ray: Ray,
    ambient: ChannelArray = 0.0,
    background: ChannelArray = 0.0,
    *,
    times_sigma_a: bool = True,
) -> Reference:
    """Return int_0^s T (sigma_s L_i + sigma_a L_e) dt + T(s) L_bg [W/(m^2 sr)], shape R or R + (channels,).

    ambient        L_i, in-scattered radiance taken as constant [W/(m^2 sr)]
    background     L_bg, radiance of the surface at the ray's end [W/(m^2 sr)]
    times_sigma_a  False: the medium's emission is per volume [W/(m^3 sr)], without the factor sigma_a

    A second way to what `ambient_fog` and `emitted_radiance` know in closed form, and the only one where albedo or
    emission vary continuously.
    Error: estimated, panels against their halves, plus rounding; about 1e-13 relative.
    """
    ambient = nonnegative_channels("ambient", ambient, "W/(m^2 sr)")
    background = nonnegative_channels("background", background, "W/(m^2 sr)")
    channels = channels_of(medium, ambient=ambient, background=background)
    along = integrate_along(medium, ray, source_term(ambient, times_sigma_a), channels)
    with np.errstate(under="ignore", over="ignore"):
        survived = np.exp(-along.tau)
        value = along.gain + survived * background
        error = along.gain_error + survived * background * (np.expm1(along.tau_error) + ELEMENTARY) + EPS * value
        error = error + 4 * TINY * (1 + np.add(background, 0.0))
    if np.isnan(value).any():
        raise UnsupportedError("the extinction exceeds the largest float64 somewhere on the ray", "medium")
    shape = ray.shape if channels is None else (*ray.shape, channels)
    return Reference(value.reshape(shape), error.reshape(shape), "adaptive Gauss-Legendre 16", SOURCE)


def source_term(ambient: Channels, times_sigma_a: bool) -> SourceTerm:
    """Return the radiance gained per metre [W/(m^3 sr)] as a function of the local coefficients."""
    if times_sigma_a:
        return lambda local: local.sigma_s * ambient + local.sigma_a * local.emission
    return lambda local: local.sigma_s * ambient + local.emission
