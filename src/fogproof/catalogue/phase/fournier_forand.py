"""Fournier & Forand's phase function of sea water: infinite straight ahead."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fogproof.analytic import phase_mean_cosine, single_scattering, slab_emissivity
from fogproof.catalogue.cases import Altered, Case, EstimatorCase, SamplerCase, Twin
from fogproof.catalogue.phase.directions import POLE, TILTED, direction_case
from fogproof.contracts import Reference
from fogproof.estimators import Airlight, Directions, PathTracer
from fogproof.scene import FournierForand, Medium, PointLight, Ray
from fogproof.scene.lights import Environment
from fogproof.scene.shapes import Slab

SOURCE = "Fournier & Jonasz 1999"

OCEAN = FournierForand(1.1, 3.5835)
"""Fits Petzold's measurements: 1.83 % goes backwards (Mobley, Sundman & Boss 2002)."""

MINERAL = FournierForand(1.33, 4.9)
"""Many small particles: hardly more forward than backward."""

WATER, RAY, LAMP = Medium(0.1, 0.9, OCEAN), Ray((0, 0, 0), (0, 0, 1), 4.0), PointLight((1.0, 0.5, 2.0), 3.0)
SLAB, ABOVE = Slab((0, 0, 0), (0, 0, 1), 1.0), Ray((0, 0, 1), (0.8, 0, -0.6), np.inf)
SKY = Environment(1.0)


def _as_of_1994(sampler: Directions, x: np.ndarray) -> np.ndarray:
    """The density without the last term, which came in 1999."""
    mu, n, slope = x @ np.asarray(sampler.axis), OCEAN.refractive_index, OCEAN.junge_slope
    d180 = 4 / (3 * (n - 1) ** 2)
    term = (d180 ** ((slope - 3) / 2) - 1) / (d180 - 1) * (3 * mu * mu - 1) / (16 * np.pi)
    return sampler.pdf(x) - term


def _exponent_taken_for_slope(phase: FournierForand) -> FournierForand:
    """mu = 3 - nu in place of 3 - 2 nu."""
    return replace(phase, junge_slope=(phase.junge_slope + 3) / 2)


def _not_absorbed() -> Reference:
    """Of a uniform sky that is seen which the slab does not absorb; a table of the kernel is off by 1e-6 a collision."""
    absorbed = slab_emissivity(0.9, 1.0, 0.6, OCEAN)
    return Reference(1 - absorbed.value, absorbed.error + 1e-5, absorbed.method, absorbed.source)


def _other_slope(sampler: Directions, u: np.ndarray) -> np.ndarray:
    return Directions(_exponent_taken_for_slope(MINERAL), sampler.axis).sample(u).x


def _directions(name: str, phase: FournierForand, axis: tuple[float, float, float], twin: Twin) -> SamplerCase:
    title = f"Fournier-Forand directions, n = {phase.refractive_index:g}, slope {phase.junge_slope:g}"
    mean = float(phase_mean_cosine(phase).value)
    place = f"directions/fournier-forand/{name}"
    return direction_case(place, title, phase, mean, lambda: Directions(phase, axis), twin, SOURCE, axis=axis)


def cases() -> list[Case]:
    """Return the cases of this phase function."""
    ocean, mineral = Directions(OCEAN), Directions(MINERAL, TILTED)
    halved, wrong = "the exponent nu is taken for its half", replace(WATER, phase=_exponent_taken_for_slope(OCEAN))
    return [
        _directions(
            "ocean", OCEAN, POLE, Twin("the last term of 1999 is left out", lambda: Altered(ocean, None, _as_of_1994))
        ),
        _directions("mineral", MINERAL, TILTED, Twin(halved, lambda: Altered(mineral, _other_slope))),
        EstimatorCase(
            name="airlight/fournier-forand",
            title="Airlight in sea water, Fournier-Forand scattering",
            make=lambda: Airlight(WATER, RAY, LAMP),
            reference=lambda: single_scattering(WATER, RAY, LAMP),
            oracle="single_scattering",
            source=SOURCE,
            twin=Twin(halved, lambda: Airlight(wrong, RAY, LAMP)),
            samples=100_000,
        ),
        EstimatorCase(
            name="paths/slab/fournier-forand",
            title="Slab of sea water under a uniform sky, Fournier-Forand scattering from a table",
            make=lambda: PathTracer(WATER, SLAB, ABOVE, SKY),
            reference=_not_absorbed,
            oracle="slab_emissivity",
            source=SOURCE,
            twin=Twin(halved, lambda: PathTracer(wrong, SLAB, ABOVE, SKY)),
            samples=300_000,
        ),
    ]
