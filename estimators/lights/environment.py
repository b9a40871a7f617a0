"""The constant environment."""

from __future__ import annotations

from fogproof.estimators.grey import grey
from fogproof.estimators.kernels.path_data import SKY, Lamp
from fogproof.scene.lights import Environment


def lamp(light: Environment) -> Lamp:
    """Return the light for kernels."""
    return Lamp(SKY, 0.0, 0.0, 0.0, grey("radiance", light.radiance))
