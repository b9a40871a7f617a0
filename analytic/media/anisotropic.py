"""Optical thickness of extinction that depends on the direction alone."""

from __future__ import annotations

import numpy as np

from fogproof.analytic.arithmetic import double_double as dd
from fogproof.analytic.arithmetic.double_double import UNIT
from fogproof.analytic.arithmetic.error_free import TINY
from fogproof.analytic.geometry.rays import Rays, Thickness
from fogproof.scene import AnisotropicMedium

SOURCE = "Heitz, Dupuy, Crassin & Dachsbacher 2015, The SGGX microflake distribution, eq. 10"


def anisotropic_thickness(medium: AnisotropicMedium, rays: Rays) -> Thickness:
    """Return tau = s sigma sqrt(w . S w).

    Error: 2^-100 (1 + condition of w . S w) relative.
    """
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
