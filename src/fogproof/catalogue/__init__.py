"""The catalogue: every sampler and estimator with its scene, its reference, its source and its broken twin."""

from __future__ import annotations

from functools import cache

from fogproof.catalogue.airlight import equiangular, single_scattering
from fogproof.catalogue.cases import Altered, Case, EstimatorCase, SamplerCase, Twin
from fogproof.catalogue.free_paths import sampled as free_paths
from fogproof.catalogue.multiple import paths as multiple_scattering
from fogproof.catalogue.phase import cosines, directions, mitsuba
from fogproof.catalogue.rays import transmittance_and_fog
from fogproof.catalogue.tracking import trackers

__all__ = ["Altered", "Case", "EstimatorCase", "SamplerCase", "Twin", "all_cases"]


@cache
def all_cases() -> tuple[Case, ...]:
    """Return every case, in the order in which it is reported."""
    groups = (
        directions,
        cosines,
        free_paths,
        equiangular,
        transmittance_and_fog,
        trackers,
        single_scattering,
        multiple_scattering,
        mitsuba,
    )
    return tuple(case for group in groups for case in group.cases())
