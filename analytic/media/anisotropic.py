"""The medium of aligned flakes, whose extinction depends on the direction alone."""

from __future__ import annotations

from itertools import product

import numpy as np

from fogproof.analytic.arithmetic import double_double as dd
from fogproof.analytic.arithmetic.double_double import UNIT
from fogproof.analytic.arithmetic.error_free import EPS, TINY
from fogproof.analytic.geometry.rays import Thickness, rays_with_channels
from fogproof.analytic.media.coefficients import Coefficients, Points, by_albedo
from fogproof.analytic.media.squared_extinction import Integral
from fogproof.analytic.proven.balls import flint, rational, vector
from fogproof.analytic.proven.pieces import Piece, constant
from fogproof.contracts import Reference
from fogproof.scene import AnisotropicMedium, Ray

SOURCE = "Heitz, Dupuy, Crassin & Dachsbacher 2015, The SGGX microflake distribution, eq. 10"


def coefficients(medium: AnisotropicMedium, at: Points) -> Coefficients:
    """Return sigma sqrt(w . S w) and what belongs to it."""
    area = np.sqrt(np.maximum(0.0, np.einsum("...i,ij,...j", at.w, medium.S, at.w)))
    grey = len(at.shape) == area.ndim
    return by_albedo(np.multiply(medium.sigma, area if grey else area[..., None]), medium.albedo, medium.emission)


def thickness(medium: AnisotropicMedium, ray: Ray, channels: int | None) -> Thickness:
    """Return tau = s sigma sqrt(w . S w).

    Error: 2^-100 (1 + condition of w . S w) relative.
    """
    rays = rays_with_channels(ray, channels)
    w = rays.direction
    columns = [dd.times(dd.dot(row, w), dd.pair(w[..., i])) for i, row in enumerate(medium.S)]
    square = dd.add(dd.add(columns[0], columns[1]), columns[2])
    slack = UNIT * np.sum(np.abs(w) * np.sum(np.abs(medium.S * w[..., None, :]), axis=-1), axis=-1)
    square = dd.where(square[0] > 0, square, dd.pair(np.zeros_like(slack)))
    area = dd.square_root(square)
    with np.errstate(divide="ignore", invalid="ignore"):
        area_error = np.fmin(np.sqrt(slack), slack / area[0])
    sigma = dd.times(area, dd.pair(medium.sigma))
    reach = np.where(sigma[0] > 0, rays.length, 0.0)
    tau = dd.times(sigma, dd.pair(reach))
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        error = UNIT * tau[0] + np.where(area_error > 0, area_error * medium.sigma * rays.length, 0.0) + 2 * TINY
    return Thickness(*tau, np.where(np.isinf(tau[0]), 0.0, error), "tau = s sigma(w)", SOURCE)


def emission_per_volume(medium: AnisotropicMedium, ray: Ray) -> Reference:
    """Return q s phi1(tau)."""
    from fogproof.analytic.rays.emission import constant_extinction

    return constant_extinction(medium, ray)


def squared_extinction(medium: AnisotropicMedium, ray: Ray, channels: int | None) -> Integral:
    """Return sigma_t(w)^2 s."""
    unit = thickness(medium, Ray(ray.origin, ray.direction, np.ones(())), channels)
    length = rays_with_channels(ray, channels).length
    with np.errstate(invalid="ignore", over="ignore"):
        value = np.where(unit.value > 0, unit.value**2 * length, 0.0)
        error = np.where(np.isfinite(value), value * 6 * EPS + 3 * unit.value * unit.error * length, 0.0)
    return Integral(value, error + TINY, "constant along the ray")


def pieces(medium: AnisotropicMedium, origin: np.ndarray, direction: np.ndarray, length: object) -> list[Piece]:
    """Return the one piece of the ray."""
    fq, w = flint().fmpq, vector(direction)
    S = [[rational(x) for x in row] for row in medium.S]
    square = sum((w[i] * S[i][j] * w[j] for i, j in product(range(3), repeat=2)), fq(0))
    area = flint().arb(max(square, fq(0))).sqrt()
    sigma = area * rational(medium.sigma) if square > 0 else fq(0)
    return [constant(sigma, length, rational(medium.albedo), rational(medium.emission))]
