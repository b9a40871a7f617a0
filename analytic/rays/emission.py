"""Emission alone: volumes that glow, with and without the absorption coefficient in the source."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY
from fogproof.analytic.declaration import FOG, RADIANCE, RAY, quantity
from fogproof.analytic.geometry.rays import channels_of, rays_with_channels
from fogproof.analytic.media.coefficients import ROOM
from fogproof.analytic.media.thickness import thickness
from fogproof.analytic.proven.radiance import proven_radiance
from fogproof.analytic.rays.ambient_fog import ambient_fog
from fogproof.analytic.rays.compositing import phi1
from fogproof.analytic.rays.radiance_by_quadrature import radiance_by_quadrature
from fogproof.contracts import Reference
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.kinds import given
from fogproof.scene.media import AnyMediumField

SOURCE = "Chandrasekhar 1960, Radiative Transfer, section 7"


@quantity(
    unit=RADIANCE,
    convention="times_sigma_a: the medium's emission is L_e and is multiplied by sigma_a; otherwise it is a power per volume",
    source="Chandrasekhar 1960, Radiative Transfer, section 7",
    example={"medium": {**FOG, "emission": 2}, "ray": RAY},
)
def emitted_radiance(
    medium: AnyMediumField, ray: Ray, *, times_sigma_a: bool = True, rigorous: bool = False
) -> Reference:
    """Return the radiance that the medium itself sends to the camera [W/(m^2 sr)], shape R or R + (channels,).

    times_sigma_a  True: int T sigma_a L_e dt, with the medium's emission L_e [W/(m^2 sr)];
                   False: int T q dt, where the medium's emission is q, per volume [W/(m^3 sr)]: without extinction it
                   grows with the length of the ray, and is inf on an infinite one
    rigorous       prove the result by ball arithmetic (any medium but a `Procedural` one; slow)

    Error: about 16 EPS relative in closed form (constant extinction: s q phi1(tau), phi1(x) = (1 - e^{-x})/x; cells
    composited); by quadrature, estimated, for the others.
    """
    if rigorous:
        return proven_radiance(medium, ray, times_sigma_a=times_sigma_a).reference()
    if times_sigma_a:
        return ambient_fog(medium, ray)
    own = given(medium, ROOM, "emission_per_volume")
    if own is not None:
        found: Reference = own(medium, ray)
        return found
    return radiance_by_quadrature(medium, ray, times_sigma_a=False)


def constant_extinction(medium: AnyMedium, ray: Ray) -> Reference:
    """Return q s phi1(tau) for extinction constant along a ray; s phi1(tau) -> s for small tau, 1/sigma_t for large."""
    channels = channels_of(medium)
    tau, s = thickness(medium, ray, channels), rays_with_channels(ray, channels).length
    unit = thickness(medium, Ray(ray.origin, ray.direction, np.ones(())), channels)
    q = np.asarray(medium.emission)
    with np.errstate(under="ignore", over="ignore", invalid="ignore", divide="ignore"):
        reach = np.where(tau.value < 1, s * phi1(tau.value), -np.expm1(-tau.value) / unit.value)
        value = np.where(q > 0, q * reach, 0.0)
        # d reach / d tau = -reach/2 at most, for a change of tau at fixed s.
        slack = np.where(unit.error > 0, unit.error / np.maximum(unit.value, TINY), 0.0)
        error = value * (ELEMENTARY + 6 * EPS + np.minimum(slack, tau.error)) + 4 * TINY * (1 + q)
    error = np.where(np.isinf(value), 0.0, error)
    return Reference(value, error, "q s phi1(tau)", SOURCE)
