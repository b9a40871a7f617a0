"""The rod: transport in one dimension, forwards and backwards only, in closed form.

Of what collides, a share c is scattered, (1 + g)/2 of it forwards. With k = sqrt((1 - c)(1 - c g)) and t = tanh(k L)/k,
a = 1 - c (1 + g)/2,

    R = c (1 - g)/2 t / (1 + a t),      T = 1 / (cosh(k L) (1 + a t)),

which has no singular case: t = L where nothing is absorbed.
Source: Hoogenboom 2008, The two-direction neutral-particle transport model; Schuster 1905.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.declaration import MEAN_FREE_PATHS, quantity
from fogproof.analytic.multiple.rod_orders import rod_orders
from fogproof.analytic.multiple.scattering_arguments import checked_albedo, checked_count, checked_length
from fogproof.contracts import Reference
from fogproof.scene.arrays import Count, FloatArray
from fogproof.validate import as_float_array, require

METHOD = "closed form"
DOUBLING = "doubling of power series in the albedo"

SOURCE = "Schuster 1905, Radiation through a foggy atmosphere"


@quantity(
    unit="1",
    convention="scattering in one dimension: a share (1 + g)/2 goes on forwards; " + MEAN_FREE_PATHS,
    source="Hoogenboom 2008, The two-direction neutral-particle transport model; Schuster 1905",
    example={"albedo": [0.5, 0.9, 1], "length": 2, "g": 0.5},
)
def rod_reflectance(albedo: FloatArray, length: FloatArray, g: FloatArray = 0.0) -> Reference:
    """Return what a rod sends back.

    albedo  (...) share c of the collisions that scatter, in [0, 1]
    length  (...) in mean free paths, >= 0
    g       (...) mean cosine in [-1, 1]: a share (1 + g)/2 goes on forwards; all three broadcast

    Relative error: below (16 + 4 k L) eps.
    """
    c, L, g = _checked(albedo, length, g)
    with np.errstate(under="ignore"):
        value = _reflectance(c, 1 - c, L, g)
        return Reference(value, 16 * EPS * value + TINY, METHOD, SOURCE)


@quantity(
    unit="1",
    convention="scattered or not, in one dimension: a share (1 + g)/2 goes on forwards; " + MEAN_FREE_PATHS,
    source="Hoogenboom 2008, The two-direction neutral-particle transport model; Schuster 1905",
    example={"albedo": [0.5, 0.9, 1], "length": 2, "g": 0.5},
)
def rod_transmittance(albedo: FloatArray, length: FloatArray, g: FloatArray = 0.0) -> Reference:
    """Return what passes a rod, scattered or not; arguments and error as in `rod_reflectance`."""
    c, L, g = _checked(albedo, length, g)
    with np.errstate(under="ignore"):
        value = _transmittance(c, 1 - c, L, g)
        depth = np.sqrt((1 - c) * _kept(c, 1 - c, g)) * L
        return Reference(value, (16 + 4 * depth) * EPS * value + 2 * TINY, METHOD, SOURCE)


@quantity(
    unit="1",
    convention="after n = 0 … count scatterings at albedo 1, in the last axis; " + MEAN_FREE_PATHS,
    source="Hoogenboom 2008, The two-direction neutral-particle transport model; Schuster 1905",
    example={"length": 2, "count": 3, "g": [0, 0.5]},
)
def rod_reflectance_orders(length: FloatArray, count: Count, g: FloatArray = 0.0) -> Reference:
    """Return what a rod sends back after n scatterings at albedo 1, n = 0 … count: (..., count + 1).

    length  (...) in mean free paths, >= 0
    count   the highest order, a whole number >= 0
    g       (...) mean cosine in [-1, 1]; it broadcasts against the length

    Relative error: 4 eps for each order and doubling of 2^-12 mean free paths, 1e-12 or less; see `rod_orders`.
    """
    _, L, g = _checked(0.0, length, g)
    R, _, off, lost = rod_orders(L, g, checked_count("count", count))
    return Reference(R, off * R + lost, DOUBLING, SOURCE)


@quantity(
    unit="1",
    convention="after n = 0 … count scatterings at albedo 1, in the last axis; " + MEAN_FREE_PATHS,
    source="Hoogenboom 2008, The two-direction neutral-particle transport model; Schuster 1905",
    example={"length": 2, "count": 3, "g": [0, 0.5]},
)
def rod_transmittance_orders(length: FloatArray, count: Count, g: FloatArray = 0.0) -> Reference:
    """Return what passes a rod after n scatterings at albedo 1, n = 0 … count: (..., count + 1).

    length  (...) in mean free paths, >= 0
    count   the highest order, a whole number >= 0
    g       (...) mean cosine in [-1, 1]; it broadcasts against the length
    """
    _, L, g = _checked(0.0, length, g)
    _, T, off, lost = rod_orders(L, g, checked_count("count", count))
    return Reference(T, off * T + lost, DOUBLING, SOURCE)


def _checked(albedo: Any, length: Any, g: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    c, L, g = checked_albedo(albedo), checked_length("length", length), as_float_array("g", g)
    require("g", g, np.abs(g) <= 1, "must lie in [-1, 1]", "it is the mean cosine")
    arrays = np.broadcast_arrays(c, L, g)
    return arrays[0], arrays[1], arrays[2]


def _kept(c: Any, absorbed: Any, g: np.ndarray) -> Any:
    """Return 1 - c g, which does not cancel."""
    return absorbed + c * (1 - g)


def _over_k(k: np.ndarray, L: np.ndarray) -> np.ndarray:
    """Return tanh(k L)/k."""
    small = np.abs(k) * L < 1e-8
    return np.where(small, L, np.tanh(k * L) / np.where(small, 1.0, k))


def _reflectance(c: Any, absorbed: Any, L: np.ndarray, g: np.ndarray) -> np.ndarray:
    with np.errstate(under="ignore"):
        t = _over_k(np.sqrt(absorbed * _kept(c, absorbed, g)), L)
        back = c * (1 - g) / 2
        return back * t / (1 + (absorbed + back) * t)


def _transmittance(c: Any, absorbed: Any, L: np.ndarray, g: np.ndarray) -> np.ndarray:
    with np.errstate(under="ignore"):
        k = np.sqrt(absorbed * _kept(c, absorbed, g))
        decay = np.exp(-k * L)
        return 2 * decay / ((1 + decay * decay) * (1 + (absorbed + c * (1 - g) / 2) * _over_k(k, L)))
