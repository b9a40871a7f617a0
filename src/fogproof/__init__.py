"""fogproof proves Monte Carlo volume estimators right or wrong.

The two calls every user meets first are `check_sampler` and `check_estimator`; the oracle is `fogproof.analytic`.
Importing this package loads NumPy alone; everything heavier loads where it is used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from fogproof.contracts import Draw, Draws, Estimator, Reference, Sampler
from fogproof.domains import (
    Ball,
    Box,
    Discrete,
    HalfLine,
    Interval,
    Product,
    RealLine,
    Rectangle,
    Rotations,
    SpherePart,
    SphericalTriangle,
    Triangle,
    UnitDisk,
    UnitHemisphere,
    UnitSphere,
    UnitSquare,
)
from fogproof.errors import FogproofError, InvalidValueError
from fogproof.scene import HenyeyGreenstein, Isotropic, Medium, PointLight, Ray, Rayleigh, Scene

if TYPE_CHECKING:
    from fogproof.checks import (
        Finding,
        Verdict,
        check_bound,
        check_convergence,
        check_estimator,
        check_family,
        check_mis,
        check_reciprocity,
        check_sampler,
        check_streams,
        compare_estimators,
        samples_for,
    )
    from fogproof.runs import Run
    from fogproof.scene.files import read_scene
    from fogproof.scene.volume_files import read_voxel_grid
    from fogproof.scene_estimator import estimator_for

__version__ = "0.1.0"

__all__ = [
    "Ball",
    "Box",
    "Discrete",
    "Draw",
    "Draws",
    "Estimator",
    "Finding",
    "FogproofError",
    "HalfLine",
    "HenyeyGreenstein",
    "Interval",
    "InvalidValueError",
    "Isotropic",
    "Medium",
    "PointLight",
    "Product",
    "Ray",
    "Rayleigh",
    "RealLine",
    "Rectangle",
    "Reference",
    "Rotations",
    "Run",
    "Sampler",
    "Scene",
    "SpherePart",
    "SphericalTriangle",
    "Triangle",
    "UnitDisk",
    "UnitHemisphere",
    "UnitSphere",
    "UnitSquare",
    "Verdict",
    "check_bound",
    "check_convergence",
    "check_estimator",
    "check_family",
    "check_mis",
    "check_reciprocity",
    "check_sampler",
    "check_streams",
    "compare_estimators",
    "estimator_for",
    "read_scene",
    "read_voxel_grid",
    "samples_for",
]

_LAZY = {
    "check_sampler": "fogproof.checks",
    "check_estimator": "fogproof.checks",
    "check_family": "fogproof.checks",
    "compare_estimators": "fogproof.checks",
    "check_bound": "fogproof.checks",
    "check_convergence": "fogproof.checks",
    "check_mis": "fogproof.checks",
    "check_reciprocity": "fogproof.checks",
    "check_streams": "fogproof.checks",
    "samples_for": "fogproof.checks",
    "Verdict": "fogproof.checks",
    "Finding": "fogproof.checks",
    "Run": "fogproof.runs",
    "estimator_for": "fogproof.scene_estimator",
    "read_scene": "fogproof.scene.files",
    "read_voxel_grid": "fogproof.scene.volume_files",
}
_SUBPACKAGES = {"adapters", "analytic", "catalogue", "checks", "estimators", "reports", "scene", "strategies", "study"}


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        return getattr(importlib.import_module(_LAZY[name]), name)
    if name in _SUBPACKAGES:
        return importlib.import_module(f"fogproof.{name}")
    raise AttributeError(f"module 'fogproof' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *_LAZY, *_SUBPACKAGES})
