"""SGGX microflakes: where they scatter to depends on both directions, not on their angle alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import MatrixArray
from fogproof.validate import as_float_array, number, one_direction, require

Reflection = Literal["specular", "diffuse"]

FLATTEST = 1e-8
"""Least eigenvalue of S over the greatest."""


@dataclass(frozen=True, eq=False)
class Microflakes:
    """Flakes whose normals follow the SGGX distribution (Heitz, Dupuy, Crassin & Dachsbacher 2015).

    S           (3, 3) symmetric positive definite: w . S w is the squared projected area of a flake seen along w. A medium of such
                flakes is `AnisotropicMedium` with the same S
    reflection  "specular": flakes are mirrors; "diffuse": both their sides are Lambertian. Nothing is absorbed
    """

    S: MatrixArray
    reflection: Reflection = "specular"

    def __post_init__(self) -> None:
        S = as_float_array("S", self.S)
        if S.shape != (3, 3):
            raise InvalidValueError("S", "must be a 3 x 3 matrix", list(S.shape))
        require("S", S, np.isfinite(S), "must be finite")
        require("S", S, S == S.T, "must be symmetric")
        eigenvalues = np.linalg.eigvalsh(S)
        if not eigenvalues[0] >= FLATTEST * eigenvalues[-1] > 0:
            rule = f"must be positive definite, its least eigenvalue at least {FLATTEST:g} of the greatest"
            raise InvalidValueError(
                "S", rule, eigenvalues.tolist(), "flakes flatter than that reflect into single directions"
            )
        if self.reflection not in get_args(Reflection):
            raise InvalidValueError("reflection", "must be 'specular' or 'diffuse'", self.reflection)
        S = S.copy()
        S.flags.writeable = False
        object.__setattr__(self, "S", S)

    @classmethod
    def along(
        cls, axis: Any, roughness: float, shape: Literal["fibre", "surface"], reflection: Reflection = "specular"
    ) -> Microflakes:
        """Return flakes as on a fibre along a unit vector, or as on a surface with that normal; roughness in [1e-4, 1]."""
        n = np.array(one_direction("axis", axis))
        r = number("roughness", roughness, "must lie in [1e-4, 1]", 1e-4, 1)
        if shape not in ("fibre", "surface"):
            raise InvalidValueError("shape", "must be 'fibre' or 'surface'", shape)
        own, other = (r * r, 1.0) if shape == "fibre" else (1.0, r * r)
        S = other * np.eye(3) + (own - other) * np.outer(n, n)
        return cls((S + S.T) / 2, reflection)
