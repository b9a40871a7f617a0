"""Radiance through layers or voxels of constant coefficients: the cells met, composited from the far end.

L <- e^{-d tau} L + (1 - e^{-d tau}) S,    S = albedo L_i + (1 - albedo) L_e
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from fogproof.analytic.arithmetic import double_double as dd
from fogproof.analytic.arithmetic.error_free import ELEMENTARY, EPS, TINY, exp_minus
from fogproof.analytic.geometry.rays import channels_of
from fogproof.analytic.media.cells import CellSegments, values
from fogproof.contracts import Reference
from fogproof.scene import Ray
from fogproof.validate import Channels


def composite(
    medium: Any,
    parts: Iterator[tuple[slice, CellSegments]],
    ray: Ray,
    ambient: Channels,
    background: Channels,
    *,
    times_sigma_a: bool = True,
) -> Reference:
    """Return the radiance that reaches the camera [W/(m^2 sr)], shape R or R + (channels,).

    parts  what the rays meet in the medium, in blocks
    ambient, background, times_sigma_a  as for `radiance_by_quadrature`

    Error: carried along with the radiance, about 3 EPS for each cell that still shows.
    Source: Porter & Duff 1984, Compositing digital images, operator "over".
    """
    channels = channels_of(medium, ambient=ambient, background=background)
    columns = (len(ray.length.reshape(-1)), channels or 1)
    L = np.array(np.broadcast_to(np.asarray(background, float), columns))
    error = np.zeros(columns)
    ceiling = max(np.max(ambient), np.max(background), medium.emission.max())
    with np.errstate(under="ignore", over="ignore", invalid="ignore", divide="ignore"):
        for rays, part in parts:
            sigma, albedo, emission = (values(a, part) for a in (medium.sigma_t, medium.albedo, medium.emission))
            for i in range(part.slack.size and part.cells[0].shape[1])[::-1]:
                length = part.length[0][:, i, None], part.length[1][:, i, None]
                here = sigma[..., i]
                tau = dd.times(dd.pair(here), dd.where(here > 0, length, dd.pair(0.0)))
                survived, _ = exp_minus(*tau)
                gone = -np.expm1(-tau[0])
                gain = gone * albedo[..., i] * ambient
                if times_sigma_a:
                    gain = gain + gone * (1 - albedo[..., i]) * emission[..., i]
                else:
                    reach = np.where(tau[0] < 1, length[0] * phi1(tau[0]), gone / here)
                    gain = gain + np.where(emission[..., i] > 0, emission[..., i] * reach, 0.0)
                new = survived * L[rays] + gain
                error[rays] = survived * (error[rays] + (ELEMENTARY + 2 * EPS) * L[rays])
                error[rays] += (2 * ELEMENTARY + 4 * EPS) * gain + EPS * new + 4 * TINY * (1 + ceiling)
                error[rays] += part.slack[:, None] * (here * (L[rays] + ceiling) + emission[..., i])
                L[rays] = new
        error = np.where(np.isinf(L), 0.0, error)
    shape = ray.shape if channels is None else (*ray.shape, channels)
    return Reference(L.reshape(shape), error.reshape(shape), "cells composited from the far end", "Porter & Duff 1984")


def phi1(x: np.ndarray) -> np.ndarray:
    """Return (1 - exp(-x))/x, 1 at 0."""
    return np.where(x > 0, -np.expm1(-x) / np.where(x > 0, x, 1.0), 1.0)
