"""A grid of voxels turned and stretched into the world, tracked."""

from __future__ import annotations

import numpy as np

from fogproof.analytic import transmittance, transmittance_lookups, transmittance_variance
from fogproof.catalogue.cases import EstimatorCase, Twin
from fogproof.catalogue.tracking.scenes import MEAN_VARIANCE_COST, NOVAK
from fogproof.estimators import RatioTransmittance
from fogproof.scene import Ray, TransformedMedium, VoxelGrid

CELLS = VoxelGrid(
    np.array([0.2, 0.9, 0.5, 1.3, 0.1, 0.7, 0.4, 1.1]).reshape(2, 2, 2), (-1, -1, -1), (1, 1, 1), albedo=0.5
)
TO_WORLD = np.array([[0.6, -1.2, 0.0, 0.1], [0.8, 0.9, 0.0, -0.1], [0.0, 0.0, 1.3, 0.2]])
THROUGH = Ray((0.2, -0.1, -2.0), (0.0, 0.0, 1.0), 4.0)
MAJORANT = 1.5


def _tracked(matrix: np.ndarray) -> RatioTransmittance:
    return RatioTransmittance(TransformedMedium(CELLS, matrix), THROUGH, MAJORANT)


def cases() -> list[EstimatorCase]:
    """Return the case of a turned grid."""
    medium = TransformedMedium(CELLS, TO_WORLD)
    transposed = np.concatenate([TO_WORLD[:, :3].T, TO_WORLD[:, 3:]], axis=1)
    return [
        EstimatorCase(
            name="tracking/ratio/turned",
            title="Ratio tracking through a grid that is turned and stretched",
            make=lambda: _tracked(TO_WORLD),
            reference=lambda: transmittance(medium, THROUGH),
            variance=lambda: transmittance_variance(medium, THROUGH, "ratio", MAJORANT),
            cost=lambda: transmittance_lookups(medium, THROUGH, "ratio", MAJORANT),
            oracle=MEAN_VARIANCE_COST,
            source=NOVAK,
            options={"bounds": (0.0, 1.0)},
            twin=Twin("the matrix is transposed", lambda: _tracked(transposed)),
        )
    ]
