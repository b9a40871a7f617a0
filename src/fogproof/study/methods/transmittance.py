"""Methods for the transmittance along a ray."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from fogproof.analytic import transmittance_variance
from fogproof.capabilities import has_cells
from fogproof.contracts import Draws, Estimator, Reference
from fogproof.errors import UnsupportedError
from fogproof.estimators import (
    AnalogTransmittance,
    DeltaTransmittance,
    MarchedTransmittance,
    RatioTransmittance,
    ResidualRatioTransmittance,
    along,
    regular_tracking,
)
from fogproof.estimators.tracking.medium_data import extremes
from fogproof.scene import Ray, VoxelGrid
from fogproof.study.methods.method import NO_VARIANCE, Method
from fogproof.study.question import Question


@dataclass(frozen=True, eq=False)
class _Walks:
    """Regular tracking, walked once for each realisation: its time is that of a walk, as a renderer would pay it."""

    grid: VoxelGrid
    ray: Ray

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        walks = regular_tracking(self.grid, self.ray, np.full(n, np.inf))
        return Draws(np.exp(-walks.tau), walks.cells)


@dataclass(frozen=True)
class Regular(Method):
    """Every voxel on the way in closed form."""

    quantity = "transmittance"
    title = "Regular tracking"
    axis = "nothing"

    def make(self, scene: Question, count: int) -> Estimator:
        """Return the estimator."""
        if not has_cells(scene.built_medium):
            raise UnsupportedError(
                f"regular tracking needs a VoxelGrid, got {type(scene.built_medium).__name__}", "medium"
            )
        grid: Any = scene.built_medium
        return _Walks(grid, scene.ray)

    def variance(self, scene: Question) -> Reference | None:
        """Return 0."""
        return NO_VARIANCE


@dataclass(frozen=True)
class Analog(Method):
    """A free path by the closed inverse: 1 if it reaches the end of the ray."""

    quantity = "transmittance"
    title = "Free path"
    dimensions = 1

    def make(self, scene: Question, count: int) -> Estimator:
        """Return the estimator."""
        return AnalogTransmittance(along(scene.built_medium, scene.ray), float(scene.ray.length))

    def variance(self, scene: Question) -> Reference | None:
        """Return T (1 - T)."""
        return transmittance_variance(scene.built_medium, scene.ray, "delta")

    def bounds(self, scene: Question) -> tuple[float, float]:
        """Return 0 and 1."""
        return 0.0, 1.0


@dataclass(frozen=True)
class Delta(Method):
    """Delta tracking; majorant [1/m], None for the tightest known without a search."""

    majorant: float | None = None
    quantity = "transmittance"
    title = "Delta tracking"

    def make(self, scene: Question, count: int) -> Estimator:
        """Return the estimator."""
        return DeltaTransmittance(scene.built_medium, scene.ray, self.majorant)

    def variance(self, scene: Question) -> Reference | None:
        """Return T (1 - T), whatever the majorant."""
        return transmittance_variance(scene.built_medium, scene.ray, "delta")

    def bounds(self, scene: Question) -> tuple[float, float]:
        """Return 0 and 1."""
        return 0.0, 1.0


@dataclass(frozen=True)
class Ratio(Method):
    """Ratio tracking; majorant [1/m], None for the tightest known without a search."""

    majorant: float | None = None
    quantity = "transmittance"
    title = "Ratio tracking"

    def make(self, scene: Question, count: int) -> Estimator:
        """Return the estimator."""
        return RatioTransmittance(scene.built_medium, scene.ray, self.majorant)

    def variance(self, scene: Question) -> Reference | None:
        """Return T^2 (exp(integral of sigma_t^2 / majorant) - 1)."""
        majorant = self.majorant or _bounds(scene)[1]
        if majorant == 0:  # nothing there to collide with
            return NO_VARIANCE
        return transmittance_variance(scene.built_medium, scene.ray, "ratio", majorant)

    def bounds(self, scene: Question) -> tuple[float, float]:
        """Return 0 and 1: a product of numbers between them."""
        return 0.0, 1.0


@dataclass(frozen=True)
class ResidualRatio(Method):
    """Residual ratio tracking; majorant and control [1/m]."""

    majorant: float | None = None
    control: float | Literal["low", "middle"] = "low"
    quantity = "transmittance"
    title = "Residual ratio tracking"

    def make(self, scene: Question, count: int) -> Estimator:
        """Return the estimator."""
        return ResidualRatioTransmittance(scene.built_medium, scene.ray, self.majorant, self.control)

    def variance(self, scene: Question) -> Reference | None:
        """Return T^2 (exp(integral of (sigma_t - control)^2 / residual majorant) - 1); a grid's control ends with the grid."""
        if has_cells(scene.built_medium):
            return None
        low, high = _bounds(scene)
        high = self.majorant or high
        low = min(low, high)
        named = {"low": low, "middle": 0.5 * (low + high)}
        control = named[self.control] if isinstance(self.control, str) else self.control
        residual = max(high - control, control - low if control > 0 else 0.0)
        return transmittance_variance(scene.built_medium, scene.ray, "residual-ratio", residual, control)


@dataclass(frozen=True)
class MarchedTransmittanceMethod(Method):
    """Ray marching, the study's counts being its steps."""

    rule: Literal["midpoint", "right"] = "midpoint"
    quantity = "transmittance"
    title = "Ray marching"
    axis = "steps"
    bias = "a Riemann sum is biased; the bias falls with the step"

    def make(self, scene: Question, count: int) -> Estimator:
        """Return the estimator with so many steps."""
        step = float(scene.ray.length) / count * (1 + 1e-12)  # rounding must not make it one more
        return MarchedTransmittance(scene.built_medium, scene.ray, step, self.rule)

    def variance(self, scene: Question) -> Reference | None:
        """Return 0."""
        return NO_VARIANCE


def _bounds(scene: Question) -> tuple[float, float]:
    """Return what a tracker takes for the least and the greatest extinction on the way [1/m]."""
    ray = scene.ray
    low, high = extremes(scene.built_medium, ray.origin[None], ray.direction[None], ray.length[None])
    return float(low[0]), float(high[0])
