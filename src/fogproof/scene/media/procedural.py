"""A medium given by the user's own function of position, for example noise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.media.common import albedo_channels, channel_of
from fogproof.scene.phase import AnyPhase, Isotropic, require_any_phase
from fogproof.validate import Channels, as_float_array, channel_count, nonnegative_channels, number, require

Field = Callable[..., Any]
"""An array function of points (..., 3) [m] that returns (...), or (..., channels)."""


@dataclass(frozen=True, eq=False)
class Procedural:
    """Extinction sigma_t(x), or sigma_t(x, w) with the direction w of travel, from an array function.

    sigma_t      points (..., 3) -> (...), or (..., channels) if the medium has channels [1/m]; with `directional` it
                 is called as sigma_t(x, w) with unit vectors w that broadcast against x
    majorant     a number that sigma_t never exceeds [1/m]: needed by delta and ratio tracking, and checked wherever
                 the oracle looks
    directional  whether sigma_t takes the direction as well
    channels     how many colour or wavelength channels sigma_t returns; None if it is grey
    lower, upper (3,) corners of the box outside of which is vacuum [m]; infinite unless given
    detail       a length in which sigma_t (and albedo, emission) changes smoothly but for at most one jump or kink [m]. This
                 is what error bounds rest on: nobody sees between the places looked at. Where none is given, an eighth of
                 what a ray crosses is taken for it
    albedo       sigma_s / sigma_t in [0, 1]: a constant, or an array function of points
    phase        phase function
    emission     emitted radiance L_e [W/(m^2 sr)]: a constant, or an array function of points; multiplied by sigma_a
    """

    sigma_t: Field
    majorant: float
    directional: bool = False
    channels: int | None = None
    lower: Any = (-np.inf, -np.inf, -np.inf)
    upper: Any = (np.inf, np.inf, np.inf)
    detail: float = np.inf
    albedo: Channels | Field = 0.0
    phase: AnyPhase = field(default_factory=Isotropic)
    emission: Channels | Field = 0.0

    def __post_init__(self) -> None:
        if not callable(self.sigma_t):
            raise InvalidValueError("sigma_t", "must be a function of points (..., 3)", self.sigma_t)
        majorant = number("majorant", self.majorant, "must be finite and >= 0 [1/m]", low=0)
        object.__setattr__(self, "majorant", majorant)
        if self.channels is not None and not (isinstance(self.channels, int) and self.channels > 0):
            raise InvalidValueError("channels", "must be None or a whole number > 0", self.channels)
        for name in ("lower", "upper"):
            corner = as_float_array(name, getattr(self, name))
            if corner.shape != (3,):
                raise InvalidValueError(name, "must be one corner [x, y, z]", getattr(self, name))
            require(name, corner, ~np.isnan(corner), "must not be NaN")
            corner.flags.writeable = False
            object.__setattr__(self, name, corner)
        require(
            "upper", self.upper, self.upper > self.lower, f"must be above lower = {self.lower.tolist()} on each axis"
        )
        detail = as_float_array("detail", self.detail)
        if detail.ndim:
            raise InvalidValueError("detail", "must be a single number", self.detail)
        require("detail", detail, detail > 0, "must be > 0 [m]")
        object.__setattr__(self, "detail", float(detail))
        if not callable(self.albedo):
            object.__setattr__(self, "albedo", albedo_channels(self.albedo))
        if not callable(self.emission):
            object.__setattr__(self, "emission", nonnegative_channels("emission", self.emission, "W/(m^2 sr)"))
        require_any_phase("phase", self.phase)
        constants = {"albedo": self.albedo, "emission": self.emission}
        declared = (0.0,) * self.channels if self.channels else 0.0
        count = channel_count(sigma_t=declared, **{k: v for k, v in constants.items() if not callable(v)})
        object.__setattr__(self, "channels", count)

    @property
    def sources_vary(self) -> bool:
        """Whether albedo or emission is a function of the place."""
        return callable(self.albedo) or callable(self.emission)

    def channel(self, c: int) -> Procedural:
        """Return the grey medium that channel c sees."""
        given = self.sigma_t
        sources = {name: channel_of(getattr(self, name), c) for name in ("albedo", "emission")}
        return replace(self, sigma_t=lambda *at: np.asarray(given(*at))[..., c], channels=None, **sources)
