"""Pictures of attenuation: transmittance of each medium, and fog over distance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fogproof.analytic import ambient_fog, transmittance
from fogproof.estimators import AnalogFog, AnalogTransmittance
from fogproof.reports.colours import EXPECTED, INK, OBSERVED, THIRD
from fogproof.scene import AnyMedium, ExponentialMedium, LinearMedium, Medium, PiecewiseConstantMedium, Ray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DISTANCE = np.linspace(0.01, 10, 300)
_STOPS = np.linspace(1, 9, 9)


def _ray(length: np.ndarray) -> Ray:
    return Ray([0, 0, 0], [0, 0, 1], length)


@dataclass(frozen=True)
class Transmittances:
    """Transmittance over distance in a homogeneous, a linear, an exponential and a layered medium."""

    rng: np.random.Generator
    samples: int = 1000

    def draw(self, figure: Figure) -> str:
        """Draw the oracle's curves, and analog estimates with two standard errors in the homogeneous medium."""
        axes = figure.add_axes((0.12, 0.16, 0.85, 0.80))
        media: dict[str, tuple[AnyMedium, str, str]] = {
            "homogeneous": (Medium(0.1, 0.2), OBSERVED, "-"),
            "linear": (LinearMedium(0.0, [0, 0, 0.1]), EXPECTED, "--"),
            "exponential": (ExponentialMedium(1.0, [0, 0, -0.5]), THIRD, "-."),
            "layers": (PiecewiseConstantMedium([0, 2, 4, 6, np.inf], [0.05, 0.8, 0.05, 0.3]), INK, ":"),
        }
        for name, (medium, colour, style) in media.items():
            value = transmittance(medium, _ray(_DISTANCE)).value
            axes.plot(_DISTANCE, value, color=colour, linestyle=style, label=name)
        mean = [AnalogTransmittance(0.3, z).draw(self.rng, self.samples).value.mean() for z in _STOPS]
        error = np.sqrt(np.multiply(mean, np.subtract(1, mean)) / self.samples)
        axes.errorbar(
            _STOPS, mean, 2 * error, fmt="o", color=OBSERVED, markersize=4, label="analog, ± 2 standard errors"
        )
        axes.set(xlabel="distance [m]", ylabel="transmittance", ylim=(0, 1.02), xlim=(0, 10))
        axes.legend(loc="upper right")
        return (
            "Transmittance over distance in four media by the oracle; points are analog estimates in the homogeneous "
            f"medium, {self.samples} free paths each."
        )


@dataclass(frozen=True)
class Fog:
    """Radiance of a surface seen through fog in constant light, over its distance."""

    rng: np.random.Generator
    samples: int = 1000

    def draw(self, figure: Figure) -> str:
        """Draw three densities from the background's radiance to the fog's own, with analog estimates."""
        axes = figure.add_axes((0.12, 0.16, 0.85, 0.80))
        ambient, background, albedo = 0.5, 1.0, 0.8
        for sigma_t, colour, style in ((0.1, OBSERVED, "-"), (0.3, EXPECTED, "--"), (1.0, THIRD, "-.")):
            medium = Medium(sigma_t * (1 - albedo), sigma_t * albedo)
            value = ambient_fog(medium, _ray(_DISTANCE), ambient, background).value
            axes.plot(_DISTANCE, value, color=colour, linestyle=style, label=f"sigma_t = {sigma_t:g} 1/m")
            drawn = [AnalogFog(medium, _ray(z), ambient, background).draw(self.rng, self.samples).value for z in _STOPS]
            mean = [float(np.mean(values)) for values in drawn]
            error = [float(np.std(values)) / np.sqrt(self.samples) for values in drawn]
            axes.errorbar(_STOPS, mean, 2 * np.array(error), fmt="o", color=colour, markersize=4)
        axes.axhline(albedo * ambient, color=INK, linewidth=1, linestyle=":", label="albedo times ambient")
        axes.set(xlabel="distance of the surface [m]", ylabel="radiance [W/(m² sr)]", xlim=(0, 10), ylim=(0.3, 1.02))
        axes.legend(loc="upper right")
        return (
            "Radiance of a surface of 1 W/(m² sr) through fog of albedo 0.8 in ambient light of 0.5 W/(m² sr), over its "
            f"distance: lines by the oracle, points analog estimates of {self.samples} paths with two standard errors."
        )
