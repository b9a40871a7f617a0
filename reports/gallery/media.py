"""Pictures of attenuation: transmittance of each medium, and fog over distance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fogproof.analytic import ambient_fog, transmittance
from fogproof.estimators import AnalogFog, DeltaFreePath, FreePath, along
from fogproof.reports.charts.colours import EXPECTED, INK, OBSERVED, THIRD
from fogproof.scene import (
    AnyMedium,
    ExponentialMedium,
    LinearMedium,
    Medium,
    OpenGLFog,
    PiecewiseConstantMedium,
    Procedural,
    Ray,
    VoxelGrid,
)
from fogproof.scene.kinds import given

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DISTANCE = np.linspace(0.01, 10, 300)
_STOPS = np.linspace(1, 9, 9)


def _ray(length: np.ndarray) -> Ray:
    return Ray([0, 0, 0], [0, 0, 1], length)


@dataclass(frozen=True)
class Transmittances:
    """Transmittance over distance in several media, and the share of sampled free paths that come as far."""

    rng: np.random.Generator
    media: Mapping[str, AnyMedium]
    samples: int = 2000

    def draw(self, figure: Figure) -> str:
        """Draw the oracle's curves, and behind them in small steps what the samplers of free paths say."""
        axes = figure.add_axes((0.12, 0.16, 0.85, 0.80))
        edges, ray, worst = np.linspace(0, 10, 41), _ray(np.array(10.0)), 0.0
        looks = ((OBSERVED, "-"), (EXPECTED, "--"), (THIRD, "-."), (INK, ":"))
        for (name, medium), (colour, style) in zip(self.media.items(), looks, strict=True):
            paths = self._paths(medium, ray)
            share = np.array([np.mean(paths > z) for z in edges[:-1] + 0.125])
            exact = transmittance(medium, _ray(edges[:-1] + 0.125)).value
            worst = max(worst, float(np.abs(share - exact).max()))
            axes.stairs(share, edges, fill=True, color=colour, alpha=0.12)
            axes.stairs(share, edges, color=colour, alpha=0.5, linewidth=0.8)
            value = transmittance(medium, _ray(_DISTANCE)).value
            axes.plot(_DISTANCE, value, color=colour, linestyle=style, label=name)
        axes.set(xlabel="distance [m]", ylabel="transmittance", ylim=(0, 1.02), xlim=(0, 10))
        axes.legend(loc="upper right")
        return (
            f"Transmittance over distance: {', '.join(self.media)}. Curves by the oracle; steps are the shares of "
            f"{self.samples} sampled free paths each that come further, which differ from it by at most {worst:.2g}."
        )

    def _paths(self, medium: AnyMedium, ray: Ray) -> np.ndarray:
        if given(medium, "fogproof.estimators.media", "along") is None:  # no closed form
            return DeltaFreePath(medium, ray).sample(self.rng, self.samples).x
        return FreePath(along(medium, ray), 10.0).distances(self.rng.random((self.samples, 1)))


def closed_media() -> dict[str, AnyMedium]:
    """Return media whose free paths have a closed form."""
    return {
        "homogeneous": Medium(0.1, 0.2),
        "linear": LinearMedium(0.0, [0, 0, 0.1]),
        "exponential": ExponentialMedium(1.0, [0, 0, -0.5]),
        "OpenGL fog, exp2": OpenGLFog("exp2", 0.13),
    }


def tracked_media() -> dict[str, AnyMedium]:
    """Return media whose free paths are tracked."""
    cells = np.array([0.05, 0.9, 0.1, 0.05, 0.6, 0.2, 0.0, 0.3]).reshape(1, 1, 8)
    box = ([-1, -1, 0], [1, 1, 10])
    return {
        "layers": PiecewiseConstantMedium([0, 2, 4, 6, np.inf], [0.05, 0.8, 0.05, 0.3]),
        "voxels, nearest": VoxelGrid(cells, *box, interpolation="nearest"),
        "voxels, trilinear": VoxelGrid(cells, *box),
        "a function": Procedural(lambda points: 0.12 * (1 + np.sin(2 * points[..., 2])), 0.24, detail=0.3),
    }


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
