"""The catalogue: every sampler and estimator with its scene, its reference, its source and its broken twin.

A module below this folder that has a function `cases()` is a part of it; nothing lists the modules.
"""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache

from fogproof.catalogue.cases import Altered, Case, EstimatorCase, SamplerCase, Twin

__all__ = ["Altered", "Case", "EstimatorCase", "SamplerCase", "Twin", "all_cases"]


@cache
def all_cases() -> tuple[Case, ...]:
    """Return every case, in the order of the folders; in a folder, in the order of the modules' names."""
    names = sorted(found.name for found in pkgutil.walk_packages(__path__, prefix=f"{__name__}.") if not found.ispkg)
    groups = (getattr(importlib.import_module(name), "cases", None) for name in names)
    return tuple(case for group in groups if group is not None for case in group())
