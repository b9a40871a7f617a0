"""The droplet-size fit of Jendersie & d'Eon 2023: fog, cloud, and haze."""

from __future__ import annotations

import numpy as np

from fogproof.analytic import slab_emissivity
from fogproof.catalogue.cases import Case, EstimatorCase, Twin
from fogproof.catalogue.phase.directions import TILTED, case_of_directions, sampled_from
from fogproof.contracts import Reference
from fogproof.estimators import Directions, PathTracer
from fogproof.estimators.phase.approximate_mie import parts
from fogproof.scene import ApproximateMie, Environment, HenyeyGreenstein, Medium, Mixture, Ray, Slab

SOURCE = "Jendersie & d'Eon 2023, An approximate Mie scattering function for fog and cloud rendering"

HAZE, MIST, FOG, CLOUD = (ApproximateMie(d) for d in (0.05e-6, 2e-6, 10e-6, 40e-6))
MEDIUM, SLAB, ABOVE = Medium(0.1, 0.9, FOG), Slab((0, 0, 0), (0, 0, 1), 1.0), Ray((0, 0, 1), (0.8, 0, -0.6), np.inf)
SKY = Environment(1.0)


def _swapped(phase: ApproximateMie) -> Mixture:
    """Each lobe with the weight of the other."""
    (first, one), (second, other) = parts(phase)
    return Mixture((one, other), (second, first))


def _emitted() -> Reference:
    """Of a uniform sky that is seen which the slab does not absorb; tables of the kernel are off by 1e-6 a collision."""
    absorbed = slab_emissivity(0.9, 1.0, 0.6, FOG)
    return Reference(1 - absorbed.value, absorbed.error + 1e-5, absorbed.method, absorbed.source)


def cases() -> list[Case]:
    """Return the cases of this phase function."""
    return [
        case_of_directions(
            name="approximate-mie/fog",
            title="Fitted Mie directions, droplets of 10 micrometres",
            phase=FOG,
            source=SOURCE,
            error="the radius is taken for the diameter",
            sample=sampled_from(ApproximateMie(FOG.diameter / 2)),
        ),
        case_of_directions(
            name="approximate-mie/cloud",
            title="Fitted Mie directions, droplets of 40 micrometres",
            phase=CLOUD,
            source=SOURCE,
            error="each lobe has the weight of the other",
            sample=sampled_from(_swapped(CLOUD)),
            axis=TILTED,
        ),
        case_of_directions(
            name="approximate-mie/mist",
            title="Fitted Mie directions, droplets of 2 micrometres",
            phase=MIST,
            source=SOURCE,
            error="the formulas of 5 to 50 micrometres for a smaller droplet",
            pdf=lambda sampler, x: Directions(ApproximateMie(5e-6), sampler.axis).pdf(x),
        ),
        case_of_directions(
            name="approximate-mie/haze",
            title="Fitted Mie directions, droplets of 0.05 micrometres",
            phase=HAZE,
            source=SOURCE,
            error="the density scatters backwards",
            pdf=lambda sampler, x: sampler.pdf(-x),
        ),
        EstimatorCase(
            name="paths/slab/approximate-mie",
            title="Slab of fog under a uniform sky, droplets of 10 micrometres",
            make=lambda: PathTracer(MEDIUM, SLAB, ABOVE, SKY),
            reference=_emitted,
            oracle="slab_emissivity",
            source=SOURCE,
            twin=Twin(
                "Henyey-Greenstein with the g of the peak alone",
                lambda: PathTracer(Medium(0.1, 0.9, HenyeyGreenstein(0.988)), SLAB, ABOVE, SKY),
            ),
            samples=300_000,
        ),
    ]
