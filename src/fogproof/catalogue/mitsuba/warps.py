"""Mitsuba's warps of the unit square against the densities that it has beside them."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from fogproof.adapters.mitsuba import MitsubaWarp
from fogproof.catalogue.cases import SamplerCase
from fogproof.catalogue.mitsuba.builders import mitsuba_case
from fogproof.domains import (
    Domain,
    Interval,
    Product,
    RealLine,
    Rectangle,
    SpherePart,
    Triangle,
    UnitDisk,
    UnitHemisphere,
    UnitSphere,
    UnitSquare,
)


def _cap(cutoff: float, x: np.ndarray) -> np.ndarray:
    return x[:, 2] >= cutoff - 1e-6  # single precision


_CENTRE = "u = (1/2, 1/2) gives NaN (docs/findings.md)"
_BESSEL = "log I0 has half of its second term in the asymptotic series, for arguments above 12 (docs/findings.md)"


def _case(label: str, name: str, domain: Domain, reason: str = "", **more: Any) -> SamplerCase:
    def build() -> MitsubaWarp:
        return MitsubaWarp(name, domain, **more)

    known: dict[str, Any] = {"expected": "rejected", "reason": reason} if reason else {}
    return mitsuba_case(name=f"warp/{label}", title=f"warp {label}", make=build, **known)


def cases() -> list[SamplerCase]:
    """Return the cases of warps, over their parameters."""
    found = [
        _case("uniform_disk", "square_to_uniform_disk", UnitDisk()),
        _case("uniform_disk_concentric", "square_to_uniform_disk_concentric", UnitDisk()),
        _case("uniform_square_concentric", "square_to_uniform_square_concentric", UnitSquare(), _CENTRE, density=1.0),
        _case("uniform_sphere", "square_to_uniform_sphere", UnitSphere()),
        _case("uniform_hemisphere", "square_to_uniform_hemisphere", UnitHemisphere()),
        _case("cosine_hemisphere", "square_to_cosine_hemisphere", UnitHemisphere()),
        _case("uniform_triangle", "square_to_uniform_triangle", Triangle((0, 0), (1, 0), (0, 1))),
        _case("tent", "square_to_tent", Rectangle((-1, -1), (1, 1))),
        _case("std_normal", "square_to_std_normal", Product(RealLine(), RealLine())),
        _case(
            "interval_to_tent",
            "interval_to_tent",
            Interval(-1.0, 1.0),
            dimensions=1,
            density=lambda x: np.maximum(1 - np.abs(x), 0),
        ),
        _case("bilinear", "square_to_bilinear", UnitSquare(), leading=(0.3, 2.0, 1.4, 0.3)),
    ]
    for cutoff in (0.99, 0.5, -0.3):
        found.append(
            _case(
                f"uniform_cone/{cutoff:g}", "square_to_uniform_cone", SpherePart(partial(_cap, cutoff)), later=(cutoff,)
            )
        )
    for alpha in (0.05, 0.3, 0.8):
        found.append(_case(f"beckmann/{alpha:g}", "square_to_beckmann", UnitHemisphere(), _CENTRE, later=(alpha,)))
    for kappa in (0.1, 5.0, 100.0):
        found.append(_case(f"von_mises_fisher/{kappa:g}", "square_to_von_mises_fisher", UnitSphere(), later=(kappa,)))
    for kappa in (2.0, 20.0, 200.0):
        found.append(
            _case(
                f"rough_fiber/{kappa:g}",
                "square_to_rough_fiber",
                UnitSphere(),
                _BESSEL if kappa > 12 else "",
                later=((0.6, 0.0, 0.8), (1.0, 0.0, 0.0), kappa),
                dimensions=3,
            )
        )
    return found
