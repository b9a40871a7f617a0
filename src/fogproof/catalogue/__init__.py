"""The catalogue: every sampler and estimator with its scene, its reference, its source and its broken twin."""

from __future__ import annotations

from functools import cache

from fogproof.catalogue import (
    cosines,
    directions,
    equiangular,
    free_paths,
    mitsuba,
    multiple_scattering,
    single_scattering,
    trackers,
    transmittance_and_fog,
)
from fogproof.catalogue.cases import Altered, Case, EstimatorCase, SamplerCase, Twin

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
