"""How cases of Mitsuba's are made: single precision, 200000 samples, and a twin whose density is a tenth too small."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.catalogue.cases import Altered, SamplerCase, Twin

SOURCE = "mitsuba-renderer.org"
SAMPLES = 200_000


def direction(degrees: float, azimuth: float) -> tuple[float, float, float]:
    """Return a unit vector by its angle to z and its azimuth [degrees]."""
    theta, phi = np.radians(degrees), np.radians(azimuth)
    x, y, z = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)
    return float(x), float(y), float(z)


def _too_small(sampler: Any, x: np.ndarray) -> np.ndarray:
    return 0.9 * np.asarray(sampler.pdf(x))


def mitsuba_case(name: str, title: str, make: Callable[[], Any], **more: Any) -> SamplerCase:
    """Return a case that runs by its name; `more` are fields of `SamplerCase`."""
    options = {"precision": "float32", **more.pop("options", {})}
    fields: dict[str, Any] = {
        "name": f"mitsuba/{name}",
        "title": f"Mitsuba 3, {title}",
        "make": make,
        "oracle": "its own pdf",
        "source": SOURCE,
        "twin": Twin("the density is a tenth too small", lambda: Altered(make(), None, _too_small)),
        "samples": SAMPLES,
        "needs": "mitsuba",
        "by_name": True,
        "options": options,
    }
    return SamplerCase(**{**fields, **more})
