"""Media that study files may name beside those of scene files: noise, random voxels, and voxels from a file.

Each is plain data with a method `medium()`, so that a study travels as text to whichever process runs its batches.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from fogproof.errors import InvalidInputError, InvalidValueError, UnsupportedError
from fogproof.estimators import FractalNoise
from fogproof.input_files import open_regular
from fogproof.scene import AnyMedium, Isotropic, Procedural, VoxelGrid
from fogproof.scene.arrays import FloatArray
from fogproof.scene.kinds import ByKind
from fogproof.scene.media import KINDS as MEDIA
from fogproof.scene.media.voxel_grid import Interpolation
from fogproof.scene.phase import PhaseFunctionField
from fogproof.scene.volume_files import read_voxel_grid
from fogproof.validate import number


@dataclass(frozen=True)
class Noise:
    """Fractal noise, see `FractalNoise`: density [1/m], frequency [1/m]."""

    density: float
    frequency: float
    octaves: int = 4
    gain: float = 0.5
    seed: int = 0
    albedo: float = 0.0
    phase: PhaseFunctionField = field(default_factory=Isotropic)

    def medium(self) -> Procedural:
        """Return the medium."""
        noise = FractalNoise(self.density, self.frequency, self.octaves, self.gain, self.seed)
        return noise.medium(albedo=self.albedo, phase=self.phase)


@dataclass(frozen=True, eq=False)
class RandomGrid:
    """Voxels of independent extinctions, uniform between low and high [1/m]: as much high frequency as a grid can hold."""

    cells: tuple[int, int, int]
    lower: FloatArray
    upper: FloatArray
    high: float
    low: float = 0.0
    seed: int = 0
    interpolation: Interpolation = "nearest"
    albedo: float = 0.0
    phase: PhaseFunctionField = field(default_factory=Isotropic)

    def __post_init__(self) -> None:
        if len(self.cells) != 3 or min(self.cells) < 1:
            raise InvalidValueError("cells", "must be three whole numbers >= 1", self.cells)
        number("low", self.low, "must be finite and >= 0 [1/m]", 0)
        number("high", self.high, f"must be finite and >= low = {self.low:g} [1/m]", self.low)
        if self.seed < 0:
            raise InvalidValueError("seed", "must be a whole number >= 0", self.seed)

    def medium(self) -> VoxelGrid:
        """Return the grid; the same seed gives the same voxels everywhere."""
        sigma_t = np.random.default_rng(self.seed).uniform(self.low, self.high, self.cells)
        return VoxelGrid(sigma_t, self.lower, self.upper, self.interpolation, self.albedo, self.phase)


@dataclass(frozen=True, eq=False)
class GridFile:
    """Voxels from a `.npy` or `.vol` file; the fields are those of `read_voxel_grid`.

    path    as the study file has it, relative to the folder of the study file; made absolute when it is read
    sha256  of the file, filled in when the study is read: other voxels make another study
    """

    path: str
    sha256: str = ""
    scale: float = 1.0
    lower: FloatArray | None = None
    upper: FloatArray | None = None
    interpolation: Interpolation = "trilinear"
    albedo: float = 0.0
    phase: PhaseFunctionField = field(default_factory=Isotropic)

    def medium(self) -> VoxelGrid:
        """Return the grid, or say that the file is not what it was."""
        if self.sha256 and sha256_of(Path(self.path)) != self.sha256:
            raise InvalidInputError(f"the grid {self.path} has changed since the study was started", self.path)
        more: dict[str, Any] = {"interpolation": self.interpolation, "albedo": self.albedo, "phase": self.phase}
        found: Any = read_voxel_grid(self.path, scale=self.scale, lower=self.lower, upper=self.upper, **more)
        if hasattr(found, "to_world"):
            raise UnsupportedError(f"{self.path} is turned in the world; a study takes grids along the axes", "path")
        grid: VoxelGrid = found
        return grid


def sha256_of(path: Path) -> str:
    """Return the digest of a file."""
    with open_regular(path, "the grid") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


_KINDS: dict[str, type] = {**MEDIA, "noise": Noise, "random-grid": RandomGrid, "grid-file": GridFile}
StudyMedium = Annotated[Any, ByKind(_KINDS, default="homogeneous")]
"""A medium of a scene file, or one of this module."""


def built(medium: Any) -> AnyMedium:
    """Return the medium that estimators and oracle take."""
    return medium.medium() if isinstance(medium, Noise | RandomGrid | GridFile) else medium
