"""Media and rays that the tests of trackers share, and draws of random ones."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import strategies as st

from fogproof.estimators import FractalNoise
from fogproof.scene import (
    ExponentialMedium,
    LinearMedium,
    Medium,
    PiecewiseConstantMedium,
    Procedural,
    Ray,
    VoxelGrid,
)


def unit(*v: float) -> np.ndarray:
    """Return the unit vector along v."""
    return np.array(v) / np.linalg.norm(v)


def voxels(
    shape: tuple[int, ...] = (4, 5, 6), interpolation: Any = "trilinear", seed: int = 5, high: float = 3.0
) -> VoxelGrid:
    """Return a grid of random voxels, an eighth of them empty."""
    rng = np.random.default_rng(seed)
    sigma = rng.random(shape) * high
    return VoxelGrid(
        np.where(rng.random(shape) < 0.125, 0.0, sigma), (-1.0, -0.7, -1.3), (0.9, 1.1, 1.2), interpolation
    )


def waves(x: np.ndarray) -> np.ndarray:
    """Return a smooth extinction in [0.2, 1.8] at points (..., 3)."""
    return 1 + 0.8 * np.sin(3 * x[..., 0] + 1) * np.sin(2 * x[..., 1] + x[..., 2])


OBLIQUE = Ray((-0.5, -0.4, -0.7), unit(0.6, 0.5, 0.9), 1.5)

MEDIA = {
    "homogeneous": Medium(0.3, 0.5),
    "linear": LinearMedium(0.5, (0.1, 0.2, 0.3)),
    "linear to vacuum": LinearMedium(0.2, (0.0, 0.0, -0.6)),
    "exponential": ExponentialMedium(0.5, (0.1, 0.3, -0.8)),
    "layers": PiecewiseConstantMedium((-1.0, -0.2, 0.1, 1.0), (0.4, 2.0, 0.0)),
    "nearest": voxels(interpolation="nearest"),
    "trilinear": voxels(),
    "noise": FractalNoise(2.0, 1.5, octaves=3, seed=4).medium(),
    "waves": Procedural(waves, 1.8, detail=0.5),
    "waves in a box": Procedural(waves, 1.8, detail=0.5, lower=(-0.5, -0.5, -0.5), upper=(0.5, 0.5, 0.5)),
}

finite = st.floats(-2.0, 2.0).map(lambda x: round(x, 12))  # closer to a plane than rounding, a ray has no side


@st.composite
def directions(draw: st.DrawFn) -> np.ndarray:
    """Draw unit vectors, often parallel to an axis or a face."""
    v = np.array([draw(st.one_of(st.just(0.0), st.floats(-1.0, 1.0)).map(lambda x: round(x, 12))) for _ in range(3)])
    length = np.linalg.norm(v)
    return np.array([0.0, 0.0, 1.0]) if length < 1e-3 else v / length


@st.composite
def rays(draw: st.DrawFn, lattice: float = 0.25) -> Ray:
    """Draw rays that often start on a face, an edge or a corner of a lattice, inside or outside of it."""
    nodes = st.integers(-8, 8).map(lambda k: k * lattice)
    origin = [draw(st.one_of(nodes, finite)) for _ in range(3)]
    length = draw(st.one_of(st.just(np.inf), st.floats(1e-12, 6.0), nodes.map(lambda t: abs(t) + lattice)))
    return Ray(origin, draw(directions()), length)
