"""Exact variance of ambient fog by analog free paths."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY
from fogproof.analytic.declaration import FOG, RAY, quantity
from fogproof.analytic.geometry.rays import channels_of
from fogproof.analytic.media.coefficients import shares
from fogproof.analytic.media.thickness import survival, thickness
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene import Ray
from fogproof.scene.arrays import ChannelArray
from fogproof.scene.media import AnyMediumField, sources_vary
from fogproof.validate import nonnegative_channels


@quantity(
    unit="(W/(m^2 sr))^2",
    convention="variance of one analog free path",
    source="elementary: a sample of two values",
    example={"medium": FOG, "ray": RAY, "ambient": 1, "background": 3},
)
def ambient_fog_variance(
    medium: AnyMediumField, ray: Ray, ambient: ChannelArray = 0.0, background: ChannelArray = 0.0
) -> Reference:
    """Return the variance of ambient fog by analog free paths [(W/(m^2 sr))^2], shape R or R + (channels,).

        (albedo L_i + (1 - albedo) L_e - L_bg)^2 T (1 - T)

    ambient, background  as for `ambient_fog`. A path that collides scores the source, one that does not the background:
    two values, if albedo and emission are the same everywhere; other media are refused.
    """
    ambient = nonnegative_channels("ambient", ambient, "W/(m^2 sr)")
    background = nonnegative_channels("background", background, "W/(m^2 sr)")
    channels = channels_of(medium, ambient=ambient, background=background)
    if sources_vary(medium):
        raise UnsupportedError(
            "the variance of fog needs an albedo and an emission that are constant in space", "medium"
        )
    tau = thickness(medium, ray, channels)
    with np.errstate(all="ignore"):
        survived, rounding, inherited = survival(tau)
        lost = -np.expm1(-tau.value)
        scattered, absorbed = shares(medium)
        source = np.multiply(scattered, ambient) + np.multiply(absorbed, medium.emission)
        source = np.where(tau.value > 0, source, 0.0)
        contrast = source - background
        off = 4 * EPS * source + EPS * np.abs(contrast)
        chance = survived * lost
        value = np.where(chance > 0, contrast * contrast * chance, 0.0)
        spread = (2 * ELEMENTARY + 6 * EPS) * survived * lost + (rounding + 2 * inherited) * lost + survived * tau.error
        error = np.where(spread > 0, contrast * contrast * spread, 0.0) + TINY
        error = error + np.where(chance > 0, (2 * np.abs(contrast) + off) * off * chance, 0.0)
    return Reference(
        value, error, f"two values with probabilities T and 1 - T, {tau.method}", "elementary: a sample of two values"
    )
