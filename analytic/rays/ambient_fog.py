"""Fog with a constant in-scattered radiance, and emission: the lecture's ambient medium, homogeneous or not."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import FOG, RADIANCE, RAY, quantity
from fogproof.analytic.geometry.rays import channels_of
from fogproof.analytic.media.coefficients import ROOM, shares
from fogproof.analytic.media.thickness import survival, thickness
from fogproof.analytic.proven.radiance import proven_radiance
from fogproof.analytic.rays.radiance_by_quadrature import radiance_by_quadrature
from fogproof.contracts import Reference
from fogproof.scene import Ray
from fogproof.scene.arrays import ChannelArray
from fogproof.scene.kinds import given
from fogproof.scene.media import AnyMediumField, sources_vary
from fogproof.validate import nonnegative_channels

SOURCE = "Chandrasekhar 1960, Radiative Transfer, section 7, with a constant source function"


@quantity(
    unit=RADIANCE,
    convention="in-scattered radiance constant along the ray; emission is multiplied by sigma_a",
    source="Chandrasekhar 1960, Radiative Transfer, section 7",
    example={"medium": {**FOG, "emission": 2}, "ray": RAY, "ambient": 0.5, "background": 3},
)
def ambient_fog(
    medium: AnyMediumField,
    ray: Ray,
    ambient: ChannelArray = 0.0,
    background: ChannelArray = 0.0,
    *,
    rigorous: bool = False,
) -> Reference:
    """Return the radiance that reaches the camera [W/(m^2 sr)], shape R or R + (channels,).

        L = L_bg e^{-tau} + s (sigma_s L_i + sigma_a L_e) phi1(tau),   phi1(x) = (1 - e^{-x})/x

    ambient     L_i, in-scattered radiance taken as constant [W/(m^2 sr)], grey or one value a channel
    background  L_bg, radiance of the surface at the ray's end [W/(m^2 sr)]; L_e is the medium's emission
    rigorous    prove the result by ball arithmetic (any medium but a `Procedural` one; slow)

    Computed as a lerp with the three weights e^{-tau}, albedo (1 - e^{-tau}) and (1 - albedo)(1 - e^{-tau}), each
    without cancellation: none exceeds 1, so neither an empty medium (which shows the background) nor an infinite ray
    nor a product of extremes needs a case of its own. The same lerp holds for any extinction as long as albedo and
    emission are constant; cells are composited, and only a continuously varying source needs quadrature.
    Error: 12 EPS relative plus the error of tau where T is still there; 6 TINY of each radiance where it underflows.
    """
    ambient = nonnegative_channels("ambient", ambient, "W/(m^2 sr)")
    background = nonnegative_channels("background", background, "W/(m^2 sr)")
    channels = channels_of(medium, ambient=ambient, background=background)
    if rigorous:
        return proven_radiance(medium, ray, ambient, background).reference()
    if sources_vary(medium):
        found: Reference = (given(medium, ROOM, "radiance") or radiance_by_quadrature)(medium, ray, ambient, background)
        return found

    tau = thickness(medium, ray, channels)
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        scattered, absorbed = shares(medium)
        survived, _, inherited = survival(tau)
        extinguished = -np.expm1(-tau.value)
        source = np.multiply(scattered, ambient) + np.multiply(absorbed, medium.emission)
        value = survived * background + extinguished * source
        error = 12 * EPS * value + inherited * np.maximum(background, source)
        error = error + 6 * TINY * (1 + np.maximum(np.maximum(background, ambient), medium.emission))
        # Nothing shines: 0 for sure. A product that is 0 because it underflows is none of these.
        dark = (np.asarray(background) == 0) & ~((np.asarray(ambient) > 0) & _present(medium, "sigma_s", scattered))
        dark &= ~((np.asarray(medium.emission) > 0) & _present(medium, "sigma_a", absorbed))
        error = np.where(dark, 0.0, error)
    return Reference(value, error, f"lerp of radiances, {tau.method}", SOURCE)


def _present(medium: object, name: str, share: np.ndarray) -> np.ndarray:
    """Return whether a medium scatters or absorbs at all; its share of the extinction may have underflowed."""
    return np.asarray(getattr(medium, name, share)) > 0
