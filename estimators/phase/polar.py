"""The polar part of a scattered direction: what a phase function fixes; the azimuth is uniform for all of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Polar(NamedTuple):
    """Scattering angles of a batch.

    versine    (n,) 1 - mu, relative precision kept at the forward pole
    coversine  (n,) 1 + mu, relative precision kept at the backward pole
    pdf        (n,) [1/sr]

    Both are carried because the sine is sqrt((1 - mu)(1 + mu)): from mu alone it is lost near the poles, and with it the
    density of a sharp peak.
    """

    versine: np.ndarray
    coversine: np.ndarray
    pdf: np.ndarray
