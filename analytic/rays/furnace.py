"""The furnaces: closed rooms in which every radiance is known without solving anything.

White furnace: a medium that absorbs nothing, in an environment of radiance L, shows L in every direction, whatever its
extinction, shape and phase function: what is scattered out is scattered in. Thermal furnace: a medium that also emits
L_e = L shows L for every albedo (Kirchhoff). Truncated paths, missing terms and unnormalised phase functions all show.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.declaration import FOG, RADIANCE, RAY, quantity
from fogproof.analytic.geometry.rays import channels_of
from fogproof.analytic.media.coefficients import shares
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError
from fogproof.scene import AnyMedium, Ray
from fogproof.scene.arrays import ChannelArray
from fogproof.scene.media import AnyMediumField
from fogproof.validate import nonnegative_channels

SOURCE = "Kirchhoff 1860; Chandrasekhar 1960, Radiative Transfer, section 7"


@quantity(
    unit=RADIANCE,
    convention="albedo 1 in uniform light: nothing changes",
    source="conservation of energy",
    example={"medium": {"sigma_a": 0, "sigma_s": 3}, "ray": RAY, "radiance": 2},
)
def white_furnace(medium: AnyMediumField, ray: Ray, radiance: ChannelArray = 1.0) -> Reference:
    """Return what every ray sees in a white furnace of that radiance [W/(m^2 sr)], exactly.

    medium    of albedo 1 and without emission; its shape and phase function are of no account
    radiance  of the environment [W/(m^2 sr)], grey or one value a channel
    """
    _require(medium, "albedo", 1.0, "in a white furnace: nothing may be absorbed")
    _require(medium, "emission", 0.0, "in a white furnace; with emission it is a thermal_furnace")
    return _constant(medium, ray, radiance, "white furnace")


@quantity(
    unit=RADIANCE,
    convention="emission equal to the surrounding radiance: nothing changes",
    source="Kirchhoff 1860",
    example={"medium": {**FOG, "emission": 2}, "ray": RAY, "radiance": 2},
)
def thermal_furnace(medium: AnyMediumField, ray: Ray, radiance: ChannelArray = 1.0) -> Reference:
    """Return what every ray sees in a thermal furnace of that radiance [W/(m^2 sr)], exactly.

    medium    of any albedo, whose emission is the radiance of the environment
    radiance  of the environment [W/(m^2 sr)], grey or one value a channel
    """
    _require(medium, "emission", np.asarray(nonnegative_channels("radiance", radiance, "W/(m^2 sr)")), "the radiance")
    return _constant(medium, ray, radiance, "thermal furnace")


def _require(medium: Any, name: str, wanted: Any, why: str) -> None:
    channels_of(medium)
    value = getattr(medium, name)
    if callable(value):
        fits = False
    elif name == "albedo":  # by what is absorbed: beside 1, sigma_a = 1e-20 would be lost
        fits = not np.any(shares(medium)[1])
    else:
        fits = bool(np.all(np.equal(value, wanted)))
    if not fits:
        raise InvalidValueError(name, f"must be {wanted} {why}", value)


def _constant(medium: AnyMedium, ray: Ray, radiance: Any, method: str) -> Reference:
    radiance = nonnegative_channels("radiance", radiance, "W/(m^2 sr)")
    channels = channels_of(medium, radiance=radiance)
    shape = ray.shape if channels is None else (*ray.shape, channels)
    return Reference(np.full(shape, radiance), np.zeros(shape), method, SOURCE)
