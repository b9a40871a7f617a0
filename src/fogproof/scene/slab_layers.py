"""Layers of a medium that changes with the depth alone, the uppermost first."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from fogproof.errors import InvalidValueError
from fogproof.scene.phase import Isotropic, PhaseFunctionField, require_phase
from fogproof.validate import number

MOST_LAYERS = 100
"""Layers of one stack: each takes as long as a slab."""


@dataclass(frozen=True)
class SlabLayer:
    """One layer, endless to the sides.

    tau       optical thickness, finite and >= 0
    albedo    single-scattering albedo in [0, 1]
    phase     phase function
    emission  emitted radiance L_e [W/(m^2 sr)]; the rendering equation multiplies it by the absorption
    """

    tau: float
    albedo: float
    phase: PhaseFunctionField = field(default_factory=Isotropic)
    emission: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "tau", number("tau", self.tau, "must be finite and >= 0 [mean free paths]", 0))
        object.__setattr__(self, "albedo", number("albedo", self.albedo, "must lie in [0, 1]", 0, 1))
        require_phase("phase", self.phase)
        rule = "must be finite and >= 0 [W/(m^2 sr)]"
        object.__setattr__(self, "emission", number("emission", self.emission, rule, 0))


def require_layers(name: str, layers: Any) -> tuple[SlabLayer, ...]:
    """Return layers as a tuple, or say what is wrong with them."""
    if isinstance(layers, SlabLayer):
        layers = (layers,)
    if not isinstance(layers, tuple | list) or not 1 <= len(layers) <= MOST_LAYERS:
        rule = f"must be a list of 1 to {MOST_LAYERS} layers, the uppermost first"
        raise InvalidValueError(name, rule, layers, "for example [SlabLayer(tau=1, albedo=0.9)]")
    for one in layers:
        if not isinstance(one, SlabLayer):
            raise InvalidValueError(name, "must be a list of layers", one, "SlabLayer(tau, albedo, phase)")
    return tuple(layers)
