"""Legendre polynomials at many cosines, without loss near the poles."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np


def legendre_polynomials(count: int, x: np.ndarray, y: np.ndarray) -> Iterator[np.ndarray]:
    """Yield P_0 … P_count at the cosines with (1 - mu)/2 = x and (1 + mu)/2 = y; absolute errors of some l eps.

    Bonnet's recurrence is run on the differences d_l = P_l - P_(l-1) and on 1 - |mu|, which keeps its digits where mu is
    near 1 and P_l near 1; P_l(-mu) = (-1)^l P_l(mu).
    """
    c, sign = 2 * np.minimum(x, y), np.where(y >= x, 1.0, -1.0)
    P, d, parity = np.ones_like(c), np.zeros_like(c), np.ones_like(c)
    yield P
    for l in range(count):  # noqa: E741
        d = (l * d - (2 * l + 1) * c * P) / (l + 1)
        P = P + d
        parity = parity * sign
        yield parity * P
