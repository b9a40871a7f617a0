"""A weighted mean of phase functions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.phase.phase_function import PhaseFunction, PhaseFunctionField, require_phase
from fogproof.validate import as_float_array, require


@dataclass(frozen=True)
class Mixture(PhaseFunction):
    """A weighted mean of phase functions: `weights` >= 0 that sum to 1 (to 1e-9; what remains is divided out)."""

    components: tuple[PhaseFunctionField, ...]
    weights: tuple[float, ...]

    def __post_init__(self) -> None:
        components = self.components
        if not (isinstance(components, tuple | list) and components):
            raise InvalidValueError("components", "must be a list of phase functions", components)
        for component in components:
            require_phase("components", component, "must be a list of phase functions")
        weights = as_float_array("weights", self.weights)
        if weights.shape != (len(components),):
            fix = f"there are {len(components)} components"
            raise InvalidValueError("weights", "must be one number a component", self.weights, fix)
        require("weights", weights, np.isfinite(weights) & (weights >= 0), "must be finite and >= 0")
        if not abs(weights.sum() - 1) <= 1e-9:
            raise InvalidValueError("weights", "must sum to 1", weights.sum(), "divide each by their sum")
        object.__setattr__(self, "components", tuple(components))
        object.__setattr__(self, "weights", tuple(weights.tolist()))
