"""The slab, one scattering order at a time."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import quantity
from fogproof.analytic.multiple.legendre_modes import complex_legendre_modes
from fogproof.analytic.multiple.orders import taylor_coefficients
from fogproof.analytic.multiple.scattering_arguments import (
    DEEPEST,
    checked_cosine,
    checked_count,
    checked_length,
    seen_at,
)
from fogproof.analytic.multiple.slab import slab_reflectance, slab_transmittance
from fogproof.analytic.multiple.slab_modes import SOURCE, quadrature
from fogproof.analytic.multiple.slab_solution import leaving_slab
from fogproof.analytic.phase.functions import phase_legendre_moments
from fogproof.contracts import Reference
from fogproof.errors import InvalidValueError
from fogproof.scene.arrays import Count, FloatArray
from fogproof.scene.phase import Isotropic, PhaseFunctionField

Side = Literal["reflected", "transmitted"]

FEWEST_NODES, MOST_NODES = 14, 32
"""Half the number of nodes: complex modes cost more than real ones."""

GRAZING = 1e-13
"""Cosine, over the thickness or 1, below which what is scattered is taken from there."""

NEGLIGIBLE = 1e-7
"""Legendre moment below which the moments are cut off."""


@quantity(
    unit="1",
    convention="after n = 0 … count scatterings at albedo 1, in the last axis",
    source="Chandrasekhar 1960, Radiative Transfer, chapter 8; Stamnes, Tsay, Wiscombe & Jayaweera 1988",
    example={"tau": 1, "mu0": [0.2, 0.5, 1], "count": 3},
)
def slab_reflectance_orders(
    tau: float, mu0: FloatArray, count: Count, phase: PhaseFunctionField | None = None
) -> Reference:
    """Return the share R_n of a beam that a slab reflects after n scatterings at albedo 1, n = 0 … count: (..., count + 1).

    tau    optical thickness >= 0, one number
    mu0    (...) cosine of the beam to the normal, in (0, 1]
    count  the highest order, a whole number >= 0
    phase  isotropic unless given

    At albedo c the n-th order is c^n R_n, and their sum over all n is `slab_reflectance`.
    """
    return _orders(tau, mu0, count, phase, "reflected", slab_reflectance)


@quantity(
    unit="1",
    convention="after n = 0 … count scatterings at albedo 1, in the last axis",
    source="Chandrasekhar 1960, Radiative Transfer, chapter 8; Stamnes, Tsay, Wiscombe & Jayaweera 1988",
    example={"tau": 1, "mu0": [0.2, 0.5, 1], "count": 3},
)
def slab_transmittance_orders(
    tau: float, mu0: FloatArray, count: Count, phase: PhaseFunctionField | None = None
) -> Reference:
    """Return the share of a beam that passes a slab after n scatterings at albedo 1, see `slab_reflectance_orders`."""
    return _orders(tau, mu0, count, phase, "transmitted", slab_transmittance)


def _orders(tau: Any, mu0: Any, count: Any, phase: Any, side: Side, real: Any) -> Reference:
    b = checked_length("tau", tau)
    if b.ndim:
        raise InvalidValueError("tau", "must be a single number", tau)
    mu0 = checked_cosine("mu0", mu0)
    moments = phase_legendre_moments(phase or Isotropic(), 2 * MOST_NODES)
    chi = moments.value
    n = int(np.clip(1 + np.flatnonzero(np.abs(chi) > NEGLIGIBLE)[-1] // 2, FEWEST_NODES, MOST_NODES))
    deep = min(float(b), DEEPEST)
    looked = seen_at(mu0, deep, GRAZING)
    nodes = quadrature(min(deep, 10 * float(np.min(looked, initial=1.0))), n)
    with np.errstate(over="ignore", under="ignore"):
        straight, collides = np.exp(-b / mu0), -np.expm1(-b / mu0)

    def at(c: complex) -> np.ndarray:
        modes = complex_legendre_modes(c, chi[: 2 * n], *nodes) if b > 0 else None
        return getattr(leaving_slab(modes, deep, looked.ravel()), side)

    def solution(albedos: np.ndarray) -> np.ndarray:
        return np.stack([at(c) for c in albedos], axis=-1).reshape(*mu0.shape, len(albedos))

    orders = taylor_coefficients(
        solution,
        checked_count("count", count),
        known=lambda c: real(c, b, mu0, phase),
        source=SOURCE,
        first=np.zeros_like(mu0) if side == "reflected" else straight,
        most=collides,
    )
    # Each collision is off by the integral of the error of the phase function, at most the root of the sum (Parseval);
    # who does not collide once does not collide again.
    change = np.sqrt((2 * np.arange(2 * n) + 1) @ moments.error[: 2 * n] ** 2)
    underflow = TINY if side == "transmitted" else 0.0
    scattered = np.arange(orders.error.shape[-1])
    # T_0 where the quotient is rounded; what scatters at grazing incidence where it is not looked at.
    with np.errstate(over="ignore", under="ignore"):
        exponent = EPS * np.minimum(b / mu0, 800.0)[..., None] * orders.value
    grazes = np.where(looked > mu0, 64 * GRAZING, 0.0)[..., None] * np.minimum(orders.value + orders.error, 1.0)
    error = (
        orders.error
        + change * scattered * np.minimum(collides, 1.0)[..., None]
        + np.where(scattered > 0, grazes, exponent + underflow)
    )
    return Reference(orders.value, error, orders.method, orders.source)
