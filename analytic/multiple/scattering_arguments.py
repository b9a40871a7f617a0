"""Arguments of the solutions for multiple scattering, checked once. Lengths are in mean free paths: sigma_t times metres."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.validate import as_float_array, require


def checked_albedo(albedo: Any) -> np.ndarray:
    """Return single-scattering albedos sigma_s / sigma_t in [0, 1]."""
    array = as_float_array("albedo", albedo)
    require("albedo", array, (array >= 0) & (array <= 1), "must lie in [0, 1]", "it is sigma_s / sigma_t")
    return array


def checked_cosine(name: str, mu: Any) -> np.ndarray:
    """Return cosines to a surface normal in (0, 1]."""
    array = as_float_array(name, mu)
    require(name, array, (array > 0) & (array <= 1), "must lie in (0, 1]", "it is the cosine to the surface normal")
    return array


def checked_length(name: str, value: Any) -> np.ndarray:
    """Return finite lengths >= 0 in mean free paths."""
    array = as_float_array(name, value)
    require(name, array, (array >= 0) & np.isfinite(array), "must be finite and >= 0 [mean free paths]")
    return array


def checked_count(name: str, value: Any) -> int:
    """Return a whole number >= 0."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < 0:
        raise InvalidValueError(name, "must be a whole number >= 0", value)
    return int(value)
