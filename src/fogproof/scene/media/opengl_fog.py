"""The fog of fixed-function OpenGL as what it is: a participating medium centred at the camera."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, get_args

from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import FloatArray
from fogproof.scene.media.common import albedo_channels
from fogproof.scene.phase import AnyPhaseField, Isotropic, require_any_phase
from fogproof.validate import Channels, channel_count, nonnegative_channels, number, points

FogMode = Literal["linear", "exp", "exp2"]


@dataclass(frozen=True, eq=False)
class OpenGLFog:
    """Extinction that depends on the distance t from the eye, such that the transmittance is OpenGL's fog factor.

    mode      "exp":    sigma_t = density,                            f = exp(-density t)
              "exp2":   sigma_t = 2 density^2 t,                      f = exp(-(density t)^2)
              "linear": sigma_t = 1/(end - t) for start < t < end,    f = (end - t)/(end - start) there, then 0
    density   [1/m], for "exp" and "exp2"
    start     [m], for "linear"
    end       [m], for "linear", > start
    eye       (3,) the camera [m], from which every ray must start
    albedo    sigma_s / sigma_t; with 1, the fog colour is the ambient radiance, with 0 the emission
    phase     phase function
    emission  emitted radiance L_e [W/(m^2 sr)]; the rendering equation multiplies it by sigma_a

    Source: Segal & Akeley 2010, The OpenGL Graphics System, version 4.0 compatibility profile, section 3.11.
    """

    mode: FogMode
    density: float = 1.0
    start: float = 0.0
    end: float = 1.0
    eye: FloatArray = (0.0, 0.0, 0.0)
    albedo: Channels = 1.0
    phase: AnyPhaseField = field(default_factory=Isotropic)
    emission: Channels = 0.0

    def __post_init__(self) -> None:
        if self.mode not in get_args(FogMode):
            raise InvalidValueError("mode", f"must be one of {', '.join(get_args(FogMode))}", self.mode)
        object.__setattr__(self, "density", number("density", self.density, "must be finite and >= 0 [1/m]", low=0))
        object.__setattr__(self, "start", number("start", self.start, "must be finite and >= 0 [m]", low=0))
        object.__setattr__(self, "end", number("end", self.end, "must be finite and >= 0 [m]", low=0))
        if self.mode == "linear" and not self.end > self.start:
            raise InvalidValueError("end", f"must be greater than start = {self.start}", self.end)
        eye = points("eye", self.eye)
        if eye.ndim != 1:
            raise InvalidValueError("eye", "must be one point [x, y, z]", self.eye)
        object.__setattr__(self, "eye", eye)
        object.__setattr__(self, "albedo", albedo_channels(self.albedo))
        object.__setattr__(self, "emission", nonnegative_channels("emission", self.emission, "W/(m^2 sr)"))
        require_any_phase("phase", self.phase)
        _ = self.channels

    @property
    def is_empty(self) -> bool:
        """Whether there is vacuum everywhere."""
        return self.mode != "linear" and self.density == 0

    @property
    def channels(self) -> int | None:
        """How many channels the medium has; None if it is grey."""
        return channel_count(albedo=self.albedo, emission=self.emission)
