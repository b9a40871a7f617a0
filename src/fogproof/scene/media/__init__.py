"""Participating media, one module a kind. Coefficients are in 1/m; a tuple has one value a colour or wavelength channel.

The homogeneous `Medium` is given by sigma_a and sigma_s, the others by sigma_t and the albedo sigma_s / sigma_t. A
medium fills space; where a kind has bounds, there is vacuum outside. Positions are world coordinates [m].

A kind has `channels`, `albedo`, `phase` and `emission`; `sources_vary` if albedo or emission may differ from place to place,
`is_empty` if it can be vacuum everywhere, `channel(c)` if one channel of it is more than that channel of each tuple, `lower` and
`upper` if it ends.
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Annotated, Any, Protocol, runtime_checkable

import numpy as np

from fogproof.scene.kinds import ByKind
from fogproof.scene.media.anisotropic import AnisotropicMedium
from fogproof.scene.media.common import channel_of
from fogproof.scene.media.composite import CompositeMedium
from fogproof.scene.media.exponential import ExponentialMedium
from fogproof.scene.media.gaussian_puffs import GaussianPuffs
from fogproof.scene.media.homogeneous import Medium
from fogproof.scene.media.linear import LinearMedium
from fogproof.scene.media.opengl_fog import OpenGLFog
from fogproof.scene.media.piecewise_constant import PiecewiseConstantMedium
from fogproof.scene.media.procedural import Procedural
from fogproof.scene.media.temperature_grid import TemperatureGrid
from fogproof.scene.media.transformed import TransformedMedium
from fogproof.scene.media.voxel_grid import VoxelGrid

__all__ = [
    "AnisotropicMedium",
    "AnyMedium",
    "CompositeMedium",
    "ExponentialMedium",
    "GaussianPuffs",
    "LinearMedium",
    "Medium",
    "OpenGLFog",
    "PiecewiseConstantMedium",
    "Procedural",
    "TemperatureGrid",
    "TransformedMedium",
    "VoxelGrid",
]

KINDS: dict[str, type] = {
    "homogeneous": Medium,
    "linear": LinearMedium,
    "exponential": ExponentialMedium,
    "piecewise-constant": PiecewiseConstantMedium,
    "anisotropic": AnisotropicMedium,
    "opengl-fog": OpenGLFog,
    "voxel-grid": VoxelGrid,
    "gaussian-puffs": GaussianPuffs,
    "composite": CompositeMedium,
    "temperature-grid": TemperatureGrid,
    "transformed": TransformedMedium,
}
"""The `kind` of each medium in files and requests; without one a medium is homogeneous."""

FROM_PYTHON: tuple[type, ...] = (Procedural,)
"""Kinds that no file can hold: a function cannot be written there."""


@runtime_checkable
class AnyMedium(Protocol):
    """What every kind of medium has: its channels (None if grey), and what may differ from channel to channel.

    albedo    sigma_s / sigma_t
    phase     phase function
    emission  emitted radiance L_e [W/(m^2 sr)]
    """

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""

    @property
    def albedo(self) -> Any:
        """A number, one a channel, one a cell, or a function of the place."""

    @property
    def phase(self) -> Any:
        """The same everywhere, or varying."""

    @property
    def emission(self) -> Any:
        """As the albedo."""


AnyMediumField = Annotated[AnyMedium, ByKind("fogproof.scene.media", default="homogeneous")]


def sources_vary(medium: AnyMedium) -> bool:
    """Return whether albedo or emission may differ from place to place."""
    return bool(getattr(medium, "sources_vary", False))


def is_empty(medium: AnyMedium) -> bool:
    """Return whether the medium is known to be vacuum everywhere."""
    return bool(getattr(medium, "is_empty", False))


def medium_of_channel(medium: AnyMedium, c: int) -> AnyMedium:
    """Return the grey medium that channel c of a medium sees; a grey medium is returned as it is."""
    if medium.channels is None:
        return medium
    own = getattr(medium, "channel", None)
    grey: AnyMedium
    if own is not None:
        grey = own(c)
        return grey
    data: Any = medium
    grey = replace(data, **{field.name: channel_of(getattr(data, field.name), c) for field in fields(data)})
    return grey


def box(medium: AnyMedium) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners (3,) outside of which is vacuum [m], infinite if the medium has no end."""
    return np.array(getattr(medium, "lower", (-np.inf,) * 3)), np.array(getattr(medium, "upper", (np.inf,) * 3))
