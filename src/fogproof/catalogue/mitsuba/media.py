"""Mitsuba's media against the oracle: free paths under the majorant, and transmittance by ratio tracking with its collisions."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from fogproof.adapters.mitsuba import MitsubaFreePath, MitsubaTransmittance, load
from fogproof.analytic import transmittance
from fogproof.catalogue.cases import Drawn, EstimatorCase, SamplerCase, Twin
from fogproof.catalogue.mitsuba.builders import SOURCE, mitsuba_case
from fogproof.contracts import Draws, Reference
from fogproof.scene import Ray, VoxelGrid

_SIGMA = 0.7
_HOMOGENEOUS: dict[str, Any] = {"type": "homogeneous", "sigma_t": _SIGMA, "albedo": 0.6}
_LONG = Ray((0.1, 0.2, 0.3), (2 / 7, -3 / 7, 6 / 7), np.inf)
_ACROSS = Ray((0.05, 0.1, 0.02), (0.48, 0.6, 0.64), 1.2)
_SCALE = 3.0


def _values() -> np.ndarray:
    """Return a grid (x, y, z) of densities that is alike nowhere."""
    return np.random.default_rng(5).random((5, 4, 6)).astype(np.float32)


def _grid(interpolation: str) -> dict[str, Any]:
    """Return a medium in the unit cube; Mitsuba's arrays have the order z, y, x, channel."""
    volume = load().VolumeGrid(np.ascontiguousarray(_values().transpose(2, 1, 0)[..., None]))
    density = {"type": "gridvolume", "grid": volume, "filter_type": interpolation, "wrap_mode": "clamp"}
    return {"type": "heterogeneous", "albedo": 0.5, "scale": _SCALE, "sigma_t": density}


def _reference(interpolation: Any) -> Reference:
    values = _values().astype(np.float64) * _SCALE
    known = transmittance(VoxelGrid(values, (0, 0, 0), (1, 1, 1), interpolation), _ACROSS)
    return Reference(known.value, known.error + 1e-5, known.method, known.source)  # single precision


def _transmittance(interpolation: str, ours: str) -> EstimatorCase:
    def make() -> MitsubaTransmittance:
        return MitsubaTransmittance(partial(_grid, interpolation), _ACROSS)

    def twice(rng: np.random.Generator, n: int) -> Draws:
        draws = make().draw(rng, n)
        return Draws(np.asarray(draws.value) ** 2)

    return EstimatorCase(
        name=f"mitsuba/medium/heterogeneous/{ours}",
        title=f"Mitsuba 3, transmittance of a voxel grid, {interpolation}",
        make=make,
        reference=lambda: _reference(ours),
        oracle="transmittance",
        source=SOURCE,
        twin=Twin("every factor is applied twice", lambda: Drawn(twice)),
        options={"bounds": (0.0, 1.0)},
        samples=100_000,
        needs="mitsuba",
        by_name=True,
    )


def cases() -> list[SamplerCase | EstimatorCase]:
    """Return the cases of media."""
    return [
        mitsuba_case(
            name="medium/homogeneous/free-path",
            title="free path in a homogeneous medium",
            make=lambda: MitsubaFreePath(_HOMOGENEOUS, _LONG, _SIGMA),
        ),
        _transmittance("nearest", "nearest"),
        _transmittance("trilinear", "trilinear"),
    ]
