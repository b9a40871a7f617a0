"""The droplet-size fit of Jendersie & d'Eon 2023: two lobes; `weighted` draws from them.

Each range of the diameter d [micrometres] is a row: its end, and functions of d and log d for the two mean cosines, for Draine's
alpha and for its share.
"""

from __future__ import annotations

import numpy as np

from fogproof.scene.phase import ApproximateMie, Draine, HenyeyGreenstein, PhaseFunction

RANGES = (
    (
        np.nextafter(0.1, 1),
        lambda d, _: 13.8 * d * d,
        lambda d, _: 1.1456 * d * np.sin(9.29044 * d),
        lambda _d, _: 250.0,
        lambda d, _: 0.252977 - 312.983 * np.power(d, 4.3),
    ),
    (
        1.5,
        lambda _, t: 0.862 - 0.143 * t * t,
        lambda _, t: (
            0.344213
            + 0.379685
            * np.cos(
                0.0625835 + 1.37932 * t + 1.19692 * np.cos((t - 0.238604) * (t + 1.00667) / (0.507522 - 0.15677 * t))
            )
        ),
        lambda _d, _: 250.0,
        lambda _, t: 0.316072 + 0.0778917 * t + 0.146209 * np.cos(2.11193 + 3.38707 * t),
    ),
    (
        5.0,
        lambda _, t: 0.940256 + 0.0604931 * np.log(t),
        lambda _, t: 0.500411 - 0.081287 / (1.27551 + np.tan(t) - 2 * t),
        lambda _, t: 6.31675 + 7.30354 * t,
        lambda _, t: 0.376475 + 0.026914 * (t - np.cos(5.68947 * np.log(t) - 5.68947 * 0.0292149)),
    ),
    (
        np.inf,
        lambda d, _: np.exp(0.0990567 / (1.67154 - d)),
        lambda d, _: np.exp(-0.428934) * np.exp(-2.20679 / (3.91029 + d)),
        lambda d, _: np.exp(3.62489) / np.exp(8.29288 / (5.52825 + d)),
        lambda d, _: np.exp(-0.665888) / np.exp(0.599085 / (d - 0.641583)),
    ),
)


def parts(phase: ApproximateMie) -> list[tuple[float, PhaseFunction]]:
    """Return the two lobes and their weights."""
    d = phase.diameter * 1e6
    row = next(row for row in RANGES if d < row[0])
    g, g_draine, alpha, share = (float(f(d, np.log(d))) for f in row[1:])
    return [(1 - share, HenyeyGreenstein(g)), (share, Draine(g_draine, alpha))]
