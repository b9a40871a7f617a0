"""A sum of Gaussian puffs: ratio tracking through it, and its free paths by delta tracking and by inverting erf."""

from __future__ import annotations

import numpy as np

from fogproof.analytic import transmittance, transmittance_lookups, transmittance_variance
from fogproof.catalogue.cases import Altered, Case, EstimatorCase, SamplerCase, Twin
from fogproof.catalogue.tracking.scenes import MEAN_VARIANCE_COST, NOVAK, RAY, path_density
from fogproof.estimators import FreePath, RatioTransmittance, along
from fogproof.scene.media.gaussian_puffs import GaussianPuffs

PUFFS = GaussianPuffs(
    [(-0.4, -0.3, -0.2), (0.1, 0.3, 0.4), (0.0, 0.1, 0.1)], [0.25, 0.4, 0.8], [2.0, 1.5, 0.4], albedo=0.8
)
WIDER = GaussianPuffs(PUFFS.centers, PUFFS.widths * np.sqrt(2), PUFFS.densities, PUFFS.albedo)
MAJORANT = 4.0


def cases() -> list[Case]:
    """Return the cases of Gaussian puffs."""
    length = float(RAY.length)
    return [
        EstimatorCase(
            name="tracking/ratio/puffs",
            title="Ratio tracking through Gaussian puffs",
            make=lambda: RatioTransmittance(PUFFS, RAY, MAJORANT),
            reference=lambda: transmittance(PUFFS, RAY),
            variance=lambda: transmittance_variance(PUFFS, RAY, "ratio", MAJORANT),
            cost=lambda: transmittance_lookups(PUFFS, RAY, "ratio", MAJORANT),
            oracle=MEAN_VARIANCE_COST,
            source=NOVAK,
            options={"bounds": (0.0, 1.0)},  # a product of 1 - sigma_t/majorant
            twin=Twin("exp(-x^2/w^2) taken for exp(-x^2/(2 w^2))", lambda: RatioTransmittance(WIDER, RAY, MAJORANT)),
        ),
        SamplerCase(
            name="free-path/puffs",
            title="Free path in Gaussian puffs, erf inverted by a bracketed Newton iteration",
            make=lambda: FreePath(along(PUFFS, RAY), length),
            reference=path_density(PUFFS, RAY),
            oracle="transmittance, coefficients",
            source="elementary: the optical depth is a sum of erfs",
            twin=Twin(
                "the depth behind the camera counts too",
                lambda: Altered(
                    FreePath(along(PUFFS, RAY), length),
                    alter_sample=lambda sampler, u: np.minimum(along(WIDER, RAY).reach(-np.log1p(-u[:, 0])), length),
                ),
            ),
        ),
    ]
