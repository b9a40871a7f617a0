"""Several media in one, tracked: a ball in a ball."""

from __future__ import annotations

from fogproof.analytic import transmittance, transmittance_lookups, transmittance_variance
from fogproof.catalogue.cases import EstimatorCase, Twin
from fogproof.catalogue.tracking.scenes import MEAN_VARIANCE_COST, NOVAK
from fogproof.estimators import RatioTransmittance
from fogproof.scene import CompositeMedium, HenyeyGreenstein, Medium, Ray, Rayleigh
from fogproof.scene.shapes import Ball

CORE, SHELL = Medium(0.5, 2.0, Rayleigh()), Medium(0.1, 0.4, HenyeyGreenstein(0.5))
YOLK = (Ball((0.1, 0.0, 0.0), 0.6), Ball((0.0, 0.0, 0.0), 1.0))
ACROSS = Ray((0.1, 0.2, -3.0), (0.0, 0.0, 1.0), 6.0)
MAJORANT = 3.5


def _egg(overlap: str) -> CompositeMedium:
    return CompositeMedium((CORE, SHELL), YOLK, overlap)  # type: ignore[arg-type]


def cases() -> list[EstimatorCase]:
    """Return the cases of several media."""
    return [
        EstimatorCase(
            name="tracking/ratio/nested",
            title="Ratio tracking through a ball in a ball, where the inner counts",
            make=lambda: RatioTransmittance(_egg("first"), ACROSS, MAJORANT),
            reference=lambda: transmittance(_egg("first"), ACROSS),
            variance=lambda: transmittance_variance(_egg("first"), ACROSS, "ratio", MAJORANT),
            cost=lambda: transmittance_lookups(_egg("first"), ACROSS, "ratio", MAJORANT),
            oracle=MEAN_VARIANCE_COST,
            source=NOVAK,
            options={"bounds": (0.0, 1.0)},
            twin=Twin("both media count in the inner ball", lambda: RatioTransmittance(_egg("sum"), ACROSS, MAJORANT)),
        ),
    ]
