"""Pictures of single scattering: where samples fall around a light, and the glow that a camera sees."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fogproof.analytic import (
    airlight_integral,
    ambient_fog,
    single_scattering,
    transmittance,
)
from fogproof.estimators import Airlight, Equiangular, FreePath
from fogproof.reports.charts.colours import EXPECTED, OBSERVED, THIRD
from fogproof.scene import HenyeyGreenstein, Medium, PointLight, Ray

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class SamplesAroundALight:
    """Equiangular and free-path samples of a ray that passes a light, against the airlight they are to integrate."""

    rng: np.random.Generator
    samples: int = 20_000

    def draw(self, figure: Figure) -> str:
        """Draw densities over the distance from the camera; the light is 0.3 m beside the ray, 6 m on."""
        axes = figure.add_axes((0.12, 0.16, 0.85, 0.80))
        sigma_t, h, a, b = 0.2, 0.3, -6.0, 6.0
        edges = np.linspace(a, b, 97)
        part = airlight_integral(sigma_t, h, a, edges[1:]).value - airlight_integral(sigma_t, h, a, edges[:-1]).value
        part[0] = airlight_integral(sigma_t, h, a, edges[1]).value
        share = part / part.sum()
        u = self.rng.random((self.samples, 1))
        equiangular = np.histogram(Equiangular(h, a, b).sample(u).x, edges)[0] / self.samples
        path = np.histogram(FreePath(sigma_t).sample(u).x + a, edges)[0] / self.samples
        distance, width = edges - a, np.diff(edges)
        for value, colour, name in ((path, THIRD, "free-path samples"), (equiangular, OBSERVED, "equiangular samples")):
            axes.stairs(value / width, distance, fill=True, color=colour, alpha=0.4, label=name)
        axes.stairs(share / width, distance, color=EXPECTED, label="airlight, by the oracle", linewidth=1.6)
        axes.set(xlabel="distance from the camera [m]", ylabel="density [1/m]", xlim=(0, b - a))
        axes.legend(loc="upper left")
        return (
            "Where samples of a ray fall whose closest point to a light is 6 m on: equiangular samples follow the airlight's "
            "peak, free-path samples miss it."
        )


@dataclass(frozen=True)
class Glow:
    """A light in fog: the oracle's image on the left half, an estimate of few samples a pixel on the right."""

    rng: np.random.Generator
    width: int = 96
    height: int = 54
    samples: int = 8

    def draw(self, figure: Figure) -> str:
        """Draw radiance, logarithmic, as a camera sees it that looks at a light 5 m away."""
        from matplotlib.colors import LogNorm

        medium, light = Medium(0.02, 0.18, HenyeyGreenstein(0.6)), PointLight((0.03, 0.02, 5.0), 10.0)
        x, y = np.meshgrid(np.linspace(-1.6, 1.6, self.width), np.linspace(0.9, -0.9, self.height))
        view = np.stack([x, y, np.full_like(x, 2.0)], axis=-1)
        view /= np.linalg.norm(view, axis=-1, keepdims=True)
        image = single_scattering(medium, Ray([0, 0, 0], view), light).value.copy()
        exact = image.copy()
        for i, j in np.ndindex(self.height, self.width // 2):
            ray = Ray([0, 0, 0], view[i, j + self.width // 2])
            image[i, j + self.width // 2] = Airlight(medium, ray, light).draw(self.rng, self.samples).value.mean()
        axes = figure.add_axes((0.02, 0.08, 0.80, 0.88))
        shown = axes.imshow(image, norm=LogNorm(exact.min(), np.quantile(exact, 0.999)), cmap="cividis", aspect="auto")
        axes.set(xticks=[], yticks=[])
        axes.set_xlabel(f"oracle  |  {self.samples} equiangular samples a pixel")
        figure.colorbar(shown, cax=figure.add_axes((0.84, 0.08, 0.03, 0.88))).set_label("airlight [W/(m² sr)]")
        off = float(np.sqrt(np.mean((image / exact - 1)[:, self.width // 2 :] ** 2)))
        return (
            f"A light of 10 W/sr in fog, 5 m from the camera: left by the oracle, right estimated with {self.samples} "
            f"equiangular samples a pixel, whose relative errors have a root mean square of {off:.0%}."
        )


@dataclass(frozen=True)
class FoggyScene:
    """Four balls on a chequered floor, each twice as far as the one before, on a clear day and in fog."""

    width: int = 180
    height: int = 200

    def draw(self, figure: Figure) -> str:
        """Draw the same view twice; the fog is the oracle's ambient fog, three channels."""
        x, y = np.meshgrid(np.linspace(-0.9, 0.9, self.width), np.linspace(0.8, -1.2, self.height))
        view = np.stack([x, y, np.full_like(x, 1.8)], axis=-1)
        view /= np.linalg.norm(view, axis=-1, keepdims=True)
        distance, colour = _trace(view)
        medium = Medium((0.002, 0.002, 0.003), (0.06, 0.065, 0.07))
        sky = (0.62, 0.70, 0.80)
        rays = Ray([0, 0, 0], view, distance)
        foggy = ambient_fog(medium, rays, sky, 0.0).value + transmittance(medium, rays).value * colour
        for place, image, name in ((0.01, colour, "clear day"), (0.51, foggy, "fog")):
            axes = figure.add_axes((place, 0.1, 0.48, 0.88))
            axes.imshow(np.clip(image, 0, 1) ** (1 / 2.2), aspect="auto")
            axes.set(xticks=[], yticks=[], xlabel=name)
        return (
            "Balls 5 to 40 m away on a chequered floor, on a clear day and in fog of 0.06 to 0.07 1/m: near things keep "
            "their colours, far ones take the fog's."
        )


def _trace(view: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the distance [m] and radiance of what each ray of a camera 1.2 m above the floor meets."""
    distance = np.where(view[..., 1] < 0, -1.2 / np.minimum(view[..., 1], -1e-9), np.inf)
    at = view * np.where(np.isfinite(distance), distance, 0)[..., None]
    tile = (np.floor(at[..., 0] / 2) + np.floor(at[..., 2] / 2)) % 2
    colour = np.where(tile[..., None] > 0, 0.55, 0.18) * np.ones(3)
    colour[np.isinf(distance)] = (0.30, 0.48, 0.80)
    sun = np.array([0.5, 0.8, -0.33])
    red, yellow, blue = (0.75, 0.12, 0.08), (0.9, 0.7, 0.1), (0.1, 0.25, 0.7)
    for z, side, hue in ((5.0, -0.48, red), (10.0, 0.0, yellow), (20.0, 0.3, blue), (40.0, 0.5, red)):
        centre, radius = np.array([side * z / 1.8, -0.4, z]), 0.8
        along = view @ centre
        inside = radius**2 - (centre @ centre - along**2)
        t = along - np.sqrt(np.maximum(inside, 0))
        hit = (inside > 0) & (t > 0) & (t < distance)
        normal = (view * t[..., None] - centre) / radius
        shade = 0.25 + 0.75 * np.clip(normal @ sun, 0, 1)
        distance = np.where(hit, t, distance)
        colour = np.where(hit[..., None], shade[..., None] * np.array(hue), colour)
    return distance, colour
