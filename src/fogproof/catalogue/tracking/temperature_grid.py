"""A hot grid of voxels: a path that collides sees what a black body of the temperature there glows with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.analytic import emitted_radiance
from fogproof.catalogue.cases import EstimatorCase, Twin
from fogproof.contracts import Draws
from fogproof.estimators import delta_tracking
from fogproof.estimators.media.sources import sources_at
from fogproof.scene import Ray, TemperatureGrid, VoxelGrid

SMOKE = VoxelGrid(
    np.array([0.2, 0.9, 0.5, 1.3, 0.1, 0.7, 0.4, 1.1]).reshape(2, 2, 2), (-1, -1, -1), (1, 1, 1), albedo=0.3
)
HEAT = 900.0 + 200.0 * np.arange(8.0).reshape(2, 2, 2)
FIRE = TemperatureGrid(SMOKE, HEAT, 1.5e-6)
THROUGH = Ray((0.1, 0.2, -2.0), (0.0, 0.0, 1.0), 4.0)


@dataclass(frozen=True, eq=False)
class BlackBodyCollisions:
    """What delta tracking meets of a medium that glows [W/(m^2 sr nm)]: (1 - albedo) L_e at the first real collision."""

    medium: TemperatureGrid

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations of the radiance along the ray."""
        rays = Ray(np.tile(THROUGH.origin, (n, 1)), np.tile(THROUGH.direction, (n, 1)), np.full(n, THROUGH.length))
        paths = delta_tracking(self.medium, rays, rng)
        hit = paths.event == 0
        albedo, emission = sources_at(self.medium, THROUGH.origin + paths.distance[hit, None] * THROUGH.direction)
        value = np.zeros(n)
        value[hit] = (1 - albedo) * emission
        return Draws(value, paths.cost)


def cases() -> list[EstimatorCase]:
    """Return the case of fire."""
    return [
        EstimatorCase(
            name="emission/fire",
            title="A grid of temperatures that glows as black bodies do, met by delta tracking",
            make=lambda: BlackBodyCollisions(FIRE),
            reference=lambda: emitted_radiance(FIRE, THROUGH),
            oracle="emitted_radiance",
            source="Planck 1900; volume rendering equation with emission alone",
            twin=Twin("degrees Celsius", lambda: BlackBodyCollisions(TemperatureGrid(SMOKE, HEAT - 273.15, 1.5e-6))),
        )
    ]
