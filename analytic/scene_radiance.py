"""What a camera ray sees in a scene: background, emission and in-scattering together."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.airlight.single_scattering import single_scattering
from fogproof.analytic.declaration import FOG, LAMP, RADIANCE, RAY, quantity
from fogproof.analytic.rays.ambient_fog import ambient_fog
from fogproof.contracts import Reference
from fogproof.scene import Scene


@quantity(
    unit=RADIANCE,
    convention="everything a camera ray sees: background, emission, and in-scattering as far as `scattering` says",
    source="Chandrasekhar 1960, Radiative Transfer, section 7",
    example={"medium": {**FOG, "emission": 2}, "ray": RAY, "scattering": "single", "light": LAMP, "background": 2},
)
def radiance(scene: Scene) -> Reference:
    """Return the radiance that reaches the camera [W/(m^2 sr)], shape R or R + (channels,).

        L = T L_bg + int T sigma_a L_e dt + int T sigma_s L_s dt

    with the in-scattered radiance L_s that `scene.scattering` names: none, a constant, or one bounce from the light. The error is
    the sum of the parts'. Source: Chandrasekhar 1960, Radiative Transfer, section 7.
    """
    ambient = scene.ambient if scene.scattering == "ambient" else 0.0
    direct = ambient_fog(scene.medium, scene.ray, ambient, scene.background)
    if scene.scattering != "single":
        return _in_channels(direct, scene)
    assert scene.light is not None  # a Scene sees to it
    airlight = single_scattering(scene.medium, scene.ray, scene.light, occluders=scene.occluders)
    direct, airlight = _in_channels(direct, scene), _in_channels(airlight, scene)
    value = direct.value + airlight.value
    return Reference(
        value,
        direct.error + airlight.error + 2.3e-16 * value,
        f"{direct.method}; {airlight.method}",
        f"{direct.source}; {airlight.source}",
    )


def _in_channels(part: Reference, scene: Scene) -> Reference:
    """Return a part with the scene's channels, also where nothing that is coloured contributes to it."""
    if scene.channels is None:
        return part
    grey = part.value.ndim == len(scene.ray.shape)
    value, error = ((x[..., None] if grey else x) for x in (part.value, part.error))
    shape = (*scene.ray.shape, scene.channels)
    return Reference(np.broadcast_to(value, shape), np.broadcast_to(error, shape), part.method, part.source)
