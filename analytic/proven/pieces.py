"""Any medium along one ray as exact pieces, in rational numbers and balls: what rigorous radiance is made of.

Nothing here is shared with the solvers that it judges: crossings are sorted as fractions, and a cell is found from the
exact middle of its piece.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fogproof.analytic.proven.balls import ProvenBall, flint, rational
from fogproof.errors import UnsupportedError
from fogproof.scene import AnyMedium
from fogproof.scene.kinds import given

Function = Callable[[Any], Any]
"""Analytic, from complex balls to complex balls; the argument is the distance from the start of the piece."""


@dataclass(frozen=True)
class Piece:
    """A stretch of a ray.

    length    [m], None if infinite
    tau       optical thickness of the whole piece
    sigma     extinction coefficient where it is constant, else None
    survived  z -> exp(-tau(z)), where the extinction is not constant
    albedo, emission  rational constants; polynomials (`flint.fmpq_poly`) in z inside trilinear voxels
    extinction  the polynomial sigma_t(z), inside trilinear voxels
    """

    length: Any
    tau: ProvenBall
    albedo: Any
    emission: Any
    sigma: Any = None
    survived: Function | None = None
    extinction: Any = None


def pieces(medium: AnyMedium, origin: np.ndarray, direction: np.ndarray, length: float) -> list[Piece]:
    """Return the pieces of a ray through a grey medium, in order; vacuum that contributes nothing is left out."""
    own = given(medium, "fogproof.analytic.media", "pieces")
    if own is None:
        raise UnsupportedError(
            f"nothing can be proven about a {type(medium).__name__}: ask without rigorous=True", "medium"
        )
    found: list[Piece] = own(medium, origin, direction, None if np.isinf(length) else rational(length))
    return found


def dot(a: list[Any], b: list[Any]) -> Any:
    """Return the scalar product of two vectors of rational numbers."""
    return sum((x * y for x, y in zip(a, b, strict=True)), flint().fmpq(0))


def constant(sigma: Any, length: Any, albedo: Any, emission: Any) -> Piece:
    """Return a piece of constant extinction."""
    arb = flint().arb
    tau = arb(0) if not sigma else arb.pos_inf() if length is None else arb(sigma) * length
    return Piece(length, tau, albedo, emission, sigma=sigma)


def horner(poly: Any) -> Function:
    """Return a polynomial with rational coefficients as a function of balls."""
    coefficients = poly.coeffs()[::-1]

    def value(z: Any) -> Any:
        total = z * 0
        for c in coefficients:
            total = total * z + c
        return total

    return value
